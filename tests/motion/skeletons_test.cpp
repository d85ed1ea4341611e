#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>

#include "core/base/file.h"
#include "core/base/text.h"
#include "tests/motion/builders.h"

namespace mocurate {
namespace {

using test::Built;
using testing::HasSubstr;

const char* const kAll[] = {"smpl24", "humanact12", "ntu25",    "ntu18",    "ntu14", "cmu20",
                            "cmu31",  "kinect20",   "openni15", "openni16", "a2m21", "bandai22"};

TEST(Skeletons, EveryBuiltInOneLoadsAndKeepsAllRules) {
  const int joints[] = {24, 24, 25, 18, 14, 20, 31, 20, 15, 16, 21, 22};
  for (std::size_t i = 0; i < std::size(kAll); ++i) {
    const auto skeleton = LoadSkeleton(kAll[i]);
    ASSERT_TRUE(skeleton) << skeleton.error().Message();
    EXPECT_EQ((*skeleton)->name, kAll[i]);
    EXPECT_EQ((*skeleton)->joint_count(), joints[i]) << kAll[i];
    const Status check = (*skeleton)->Check();
    EXPECT_TRUE(check) << check.error().Message();
  }
}

TEST(Skeletons, APersonAtRestFacesFrontWithTheLeftSideAtPlusXAndIsSymmetric) {
  for (const char* name : kAll) {
    if (std::string(name) == "bandai22") continue;  // its identity pose is not a human pose
    const SkeletonPtr skeleton = Built(name);
    std::vector<Quaterniond> identity(skeleton->joints.size(), Quaterniond::Identity());
    std::vector<Vector3d> p(skeleton->joints.size());
    ForwardKinematics(*skeleton, Vector3d::Zero(), identity.data(), {}, p.data());
    const auto hips = skeleton->Hips();
    const auto shoulders = skeleton->Shoulders();
    ASSERT_TRUE(hips && shoulders) << name;
    EXPECT_GT(p[(*hips)[0]].x(), 0.05) << name;
    EXPECT_LT(p[(*shoulders)[1]].x(), -0.1) << name;
    EXPECT_GT(p[(*shoulders)[0]].y(), p[(*hips)[0]].y() + 0.3) << name;
    double lowest = 0, highest = 0;
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      const Vector3d mirrored = p[skeleton->joints[j].mirror].cwiseProduct(Vector3d(-1, 1, 1));
      EXPECT_LT((p[j] - mirrored).norm(), 1e-9) << name << " " << skeleton->joints[j].name;
      lowest = std::min(lowest, p[j].y());
      highest = std::max(highest, p[j].y());
    }
    EXPECT_GT(highest - lowest, 1.2) << name;
    EXPECT_LT(highest - lowest, 1.8) << name;
  }
}

TEST(Skeletons, LimitsOfBothSidesAreEachOthersMirrorImage) {
  for (const char* name : kAll) {
    const SkeletonPtr skeleton = Built(name);
    for (const Joint& joint : skeleton->joints) {
      if (!joint.limits) continue;
      EXPECT_TRUE((joint.limits->min.array() < joint.limits->max.array()).all()) << name << " " << joint.name;
      const auto& other = skeleton->joints[joint.mirror].limits;
      ASSERT_TRUE(other.has_value()) << name << " " << joint.name;
      // Across the sagittal plane turns about x stay, those about y and z change sign.
      const Vector3d min(other->min.x(), -other->max.y(), -other->max.z());
      const Vector3d max(other->max.x(), -other->min.y(), -other->min.z());
      EXPECT_LT((joint.limits->min - min).norm() + (joint.limits->max - max).norm(), 1e-12)
          << name << " " << joint.name;
    }
  }
}

TEST(Skeletons, JointsAreFoundByAnyUsualNameOfThem) {
  const SkeletonPtr smpl = Built("smpl24");
  for (const char* name : {"left_hip", "LHip", "hip_left", "LeftUpLeg", "Left Hip", "left-hip"}) {
    EXPECT_EQ(smpl->FindJoint(name), 1) << name;
  }
  EXPECT_EQ(smpl->FindJoint("third_arm"), std::nullopt);
  EXPECT_EQ(smpl->FindJoint(""), std::nullopt);
}

TEST(Skeletons, HandAndFootOfOpenNiAreWristAndAnkle) {
  for (const char* name : {"openni15", "openni16"}) {
    const SkeletonPtr skeleton = Built(name);
    EXPECT_EQ(skeleton->FindJoint("left_hand"), skeleton->FindJoint("left_wrist"));
    EXPECT_EQ(skeleton->FindJoint("RIGHT_FOOT"), skeleton->FindJoint("right_ankle"));
  }
}

TEST(Skeletons, BandaisOffsetsAreThoseOfItsFiles) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const std::filesystem::path folder = std::filesystem::path(data) / "bvh" / "bandai2";
  const std::string text = ReadFile(folder / "dataset-2_walk_normal_001.bvh").value_or("");
  ASSERT_FALSE(text.empty()) << folder;
  const SkeletonPtr skeleton = Built("bandai22");
  std::istringstream words(text);
  int joint = -1, checked = 0;
  for (std::string word, name; words >> word && word != "MOTION";) {
    if (word == "End") joint = -1;
    if (word == "ROOT" || word == "JOINT") {
      words >> name;
      joint = skeleton->FindJoint(name).value();
      EXPECT_EQ(skeleton->joints[joint].name, name);
    }
    if (word != "OFFSET" || joint < 0 || skeleton->joints[joint].name == "Hips") continue;
    for (int k = 0; k < 3; ++k) {
      words >> word;
      EXPECT_NEAR(skeleton->joints[joint].rest_offset[k], 0.01 * ParseDouble(word).value(), 1e-8) << name;
    }
    ++checked;
  }
  EXPECT_EQ(checked, 21);
}

TEST(Skeletons, AnUnknownNameIsRefusedWithTheNearestOne) {
  const auto skeleton = LoadSkeleton("smpl42");
  ASSERT_FALSE(skeleton);
  EXPECT_EQ(skeleton.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(skeleton.error().Message(), HasSubstr("smpl24"));
}

TEST(Skeletons, AParentThatDoesNotExistIsNamed) {
  const auto skeleton = ParseSkeleton("name: s\njoints:\n  - {name: hip}\n  - {name: knee, parent: hips}\n", "s.yaml");
  ASSERT_FALSE(skeleton);
  EXPECT_THAT(skeleton.error().Message(), HasSubstr("'hips' is not a joint"));
  EXPECT_THAT(skeleton.error().Message(), HasSubstr("did you mean 'hip'"));
}

TEST(Skeletons, AnUnknownKeyIsRefused) {
  const auto skeleton = ParseSkeleton("name: s\njoints:\n  - {name: hip, colour: red}\n", "s.yaml");
  ASSERT_FALSE(skeleton);
  EXPECT_THAT(skeleton.error().Message(), HasSubstr("colour"));
}

TEST(Skeletons, NameNoEnvironmentAndNoOtherFile) {
  const auto skeleton = ParseSkeleton("name: '${HOME}'\njoints:\n  - {name: hip}\n", "s.yaml");
  ASSERT_TRUE(skeleton) << skeleton.error().Message();
  EXPECT_EQ((*skeleton)->name, "${HOME}");
  EXPECT_EQ(ParseSkeleton("include: /dev/zero\nname: s\njoints:\n  - {name: hip}\n", "s.yaml").error().code,
            ErrorCode::kConfig);
}

/// A valid skeleton of three joints, to be broken in one place.
Skeleton Small() {
  Skeleton s;
  s.name = "small";
  for (const char* name : {"pelvis", "left_hip", "right_hip"}) {
    Joint joint;
    joint.name = name;
    s.joints.push_back(joint);
  }
  s.joints[0].mirror = 0;
  s.joints[1].parent = s.joints[2].parent = 0;
  s.joints[1].rest_offset = Vector3d(0.1, 0, 0);
  s.joints[2].rest_offset = Vector3d(-0.1, 0, 0);
  s.joints[1].mirror = 2;
  s.joints[2].mirror = 1;
  s.lie = LieChains{{{0, 1}, {0, 2}}, {Vector3d::Zero(), Vector3d::UnitX(), -Vector3d::UnitX()}};
  return s;
}

void ExpectBroken(const Skeleton& skeleton, const std::string& words) {
  const Status check = skeleton.Check();
  ASSERT_FALSE(check) << "expected: " << words;
  EXPECT_THAT(check.error().Message(), HasSubstr(words));
}

TEST(SkeletonCheck, FindsEachBrokenRule) {
  ASSERT_TRUE(Small().Check());
  Skeleton s = Small();
  s.joints[1].parent = 2;
  ExpectBroken(s, "has parent 2");
  s = Small();
  s.joints[2].name = "Left Hip";
  ExpectBroken(s, "stands for");
  s = Small();
  s.joints[2].synonyms = {"PELVIS"};
  ExpectBroken(s, "stands for");
  s = Small();
  s.joints[1].mirror = 1;
  ExpectBroken(s, "names another one");
  s = Small();
  s.joints[1].rest_offset.x() = std::nan("");
  ExpectBroken(s, "not finite");
  s = Small();
  s.joints[1].limits = JointLimits{Vector3d::Ones(), Vector3d::Zero()};
  ExpectBroken(s, "min above max");
  s = Small();
  s.landmarks = {{"nose", 7, Vector3d::Zero()}};
  ExpectBroken(s, "refers to no joint");
  s = Small();
  s.lie->chains.pop_back();
  ExpectBroken(s, "is in no Lie chain");
  s = Small();
  s.lie->raw_offsets[2] *= 0.5;
  ExpectBroken(s, "unit vectors");
  s = Small();
  s.joints[0].reflection = Matrix3d::Identity();
  ExpectBroken(s, "determinant -1");
}

}  // namespace
}  // namespace mocurate
