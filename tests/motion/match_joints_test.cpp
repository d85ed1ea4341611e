#include <gtest/gtest.h>

#include <map>

#include "core/motion/limbs.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

struct Bone {
  const char* name;
  int parent;
  Vector3d offset;
};

Skeleton Tree(const std::vector<Bone>& bones) {
  Skeleton skeleton;
  skeleton.name = "own tree";
  for (const Bone& bone : bones) {
    Joint joint;
    joint.name = bone.name;
    joint.parent = bone.parent;
    joint.rest_offset = bone.offset;
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

/// As character tools name bones: by what begins at the joint.
Skeleton CharacterTree() {
  return Tree({{"Hips", -1, {0, 0, 0}},
               {"Spine", 0, {0, 0.1, 0}},
               {"Spine1", 1, {0, 0.12, 0}},
               {"Spine2", 2, {0, 0.12, 0}},
               {"Neck", 3, {0, 0.16, 0}},
               {"Head", 4, {0, 0.1, 0}},
               {"LeftShoulder", 3, {0.05, 0.12, 0}},
               {"LeftArm", 6, {0.12, 0, 0}},
               {"LeftArmRoll", 7, {0.14, 0, 0}},
               {"LeftForeArm", 8, {0.14, 0, 0}},
               {"LeftHand", 9, {0.25, 0, 0}},
               {"LeftHandThumb1", 10, {0.03, 0, 0.03}},
               {"LeftHandMiddle1", 10, {0.09, 0, 0}},
               {"RightShoulder", 3, {-0.05, 0.12, 0}},
               {"RightArm", 13, {-0.12, 0, 0}},
               {"RightForeArm", 14, {-0.28, 0, 0}},
               {"RightHand", 15, {-0.25, 0, 0}},
               {"LeftUpLeg", 0, {0.1, -0.05, 0}},
               {"LeftLeg", 17, {0, -0.42, 0}},
               {"LeftFoot", 18, {0, -0.42, 0}},
               {"LeftToeBase", 19, {0, -0.06, 0.13}},
               {"RightUpLeg", 0, {-0.1, -0.05, 0}},
               {"RightLeg", 21, {0, -0.42, 0}},
               {"RightFoot", 22, {0, -0.42, 0}},
               {"RightToeBase", 23, {0, -0.06, 0.13}}});
}

/// Names of joints of `target` and the names of those of `source` that they are.
std::map<std::string, std::string> Matched(const Skeleton& source, const std::string& target_name) {
  const SkeletonPtr target = *LoadSkeleton(target_name);
  const std::vector<int> match = MatchJoints(source, *target);
  std::map<std::string, std::string> names;
  for (int j = 0; j < target->joint_count(); ++j) {
    if (match[j] >= 0) names[target->joints[j].name] = source.joints[match[j]].name;
  }
  return names;
}

TEST(MatchJoints, OneNameMeansOtherJointsInOtherTrees) {
  const auto smpl = Matched(CharacterTree(), "smpl24");
  EXPECT_EQ(smpl.at("left_collar"), "LeftShoulder");
  EXPECT_EQ(smpl.at("left_shoulder"), "LeftArm");
  EXPECT_EQ(smpl.at("left_elbow"), "LeftForeArm");
  EXPECT_EQ(smpl.at("left_wrist"), "LeftHand");
  EXPECT_EQ(smpl.at("left_hand"), "LeftHandMiddle1");
  EXPECT_EQ(smpl.at("right_ankle"), "RightFoot");
  EXPECT_EQ(smpl.at("right_foot"), "RightToeBase");
  EXPECT_EQ(smpl.count("right_hand"), 0u) << "a wrist is not a hand";
  EXPECT_EQ(smpl.at("spine1"), "Spine");
  EXPECT_EQ(smpl.at("spine2"), "Spine1");
  EXPECT_EQ(smpl.at("spine3"), "Spine2");
  EXPECT_EQ(smpl.at("neck"), "Neck");
}

TEST(MatchJoints, WhatAnExporterPutsBeforeAllNamesIsPassedOver) {
  const auto plain = Matched(CharacterTree(), "smpl24");
  for (const std::string prefix : {"mixamorig:", "Character1_", "Bip001 "}) {
    Skeleton tree = CharacterTree();
    for (Joint& joint : tree.joints) joint.name = prefix + joint.name;
    const auto named = Matched(tree, "smpl24");
    ASSERT_EQ(named.size(), plain.size()) << prefix;
    for (const auto& [joint, source] : plain) EXPECT_EQ(named.at(joint), prefix + source);
  }
}

TEST(MatchJoints, ACollarIsNotAShoulderOfASkeletonWithoutCollars) {
  const auto kinect = Matched(CharacterTree(), "kinect20");
  EXPECT_EQ(kinect.at("left_shoulder"), "LeftArm");
  EXPECT_EQ(kinect.at("left_ankle"), "LeftFoot");
  EXPECT_EQ(kinect.at("left_foot"), "LeftToeBase");
}

/// One bone of the back: the chest is where the arms hang, at half of it nothing lies.
TEST(MatchJoints, TheTrunkIsMatchedByHowFarAlongItsJointsLie) {
  Skeleton tree = CharacterTree();
  tree.joints[1].rest_offset = {0, 0.22, 0};
  for (const int joint : {4, 6, 13}) tree.joints[joint].parent = 1;
  tree.joints[2].name = "Belly";  // hangs from the back, leads nowhere
  tree.joints[3].name = "Belt";
  const auto smpl = Matched(tree, "smpl24");
  EXPECT_EQ(smpl.at("spine3"), "Spine");
  EXPECT_EQ(smpl.count("spine1"), 0u);
  EXPECT_EQ(smpl.count("spine2"), 0u);
}

TEST(MatchJoints, BuiltInSkeletonsMeetInTheirLimbs) {
  const auto bandai = Matched(**LoadSkeleton("bandai22"), "smpl24");
  EXPECT_EQ(bandai.at("left_collar"), "Shoulder_L");
  EXPECT_EQ(bandai.at("left_shoulder"), "UpperArm_L");
  EXPECT_EQ(bandai.at("left_ankle"), "Foot_L");
  EXPECT_EQ(bandai.at("pelvis"), "Hips");
  EXPECT_EQ(bandai.at("spine3"), "Chest");
  const auto back = Matched(**LoadSkeleton("smpl24"), "bandai22");
  EXPECT_EQ(back.at("Shoulder_R"), "right_collar");
  EXPECT_EQ(back.at("UpperArm_R"), "right_shoulder");
  EXPECT_EQ(back.at("Toes_R"), "right_foot");
  const auto cmu = Matched(**LoadSkeleton("cmu31"), "smpl24");
  EXPECT_EQ(cmu.at("spine3"), "thorax");
  EXPECT_EQ(cmu.at("right_foot"), "rtoes");
  EXPECT_EQ(cmu.at("left_shoulder"), "lhumerus");
  const auto heel = Matched(**LoadSkeleton("ntu18"), "smpl24");
  EXPECT_EQ(heel.count("left_foot"), 0u) << "a heel is not a toe";
}

TEST(MatchJoints, ASkeletonMatchesItself) {
  for (const char* name : {"smpl24", "cmu31", "bandai22", "ntu25", "openni16", "humanact12", "kinect20"}) {
    const SkeletonPtr skeleton = *LoadSkeleton(name);
    const std::vector<int> match = MatchJoints(*skeleton, *skeleton);
    for (int j = 0; j < skeleton->joint_count(); ++j) EXPECT_EQ(match[j], j) << name;
  }
}

TEST(Limbs, AreFoundByHowTheyHang) {
  const Skeleton tree = CharacterTree();
  const Limbs limbs = LimbsOf(tree);
  EXPECT_EQ(tree.joints[limbs.pelvis].name, "Hips");
  EXPECT_EQ(tree.joints[limbs.chest].name, "Spine2");
  EXPECT_EQ(tree.joints[limbs.arm[0].root].name, "LeftArm") << "twist joints are skipped";
  EXPECT_EQ(limbs.arm[1].tip, -1);
  EXPECT_FALSE(LimbsOf(Tree({{"root", -1, {0, 0, 0}}, {"tail", 0, {0, 0, -1}}})).leg[0].known());
}

}  // namespace
}  // namespace mocurate
