// One skeleton for all clips of a set, and what happens to those that differ.

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <filesystem>

#include "canon/options.h"
#include "canon/stages.h"
#include "canon/values/merge.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"
#include "tests/canon/moving_clips.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

/// Runs `assemble` over one clip per motion and reads the set.
struct Assembled {
  Expected<StageOutcome> outcome;
  Expected<Dataset> dataset;
};

Assembled AssembleMotions(const std::vector<Motion>& motions) {
  const ScratchFolder folder;
  StageRequest request{"assemble", "dataset", OptionsToJson(AssembleOptions()), {}, folder / "dataset.h5", folder};
  for (std::size_t i = 0; i < motions.size(); ++i) {
    Dataset one;
    one.skeleton = motions[i].rest_pose();
    Clip clip;
    clip.identity = {"test", "p", "r" + std::to_string(i), "", "", "", 0, motions[i].frame_count()};
    clip.label = "a";
    clip.rate = motions[i].rate;
    clip.motion = motions[i];
    one.clips = {clip};
    const auto file = folder / ("clip" + std::to_string(i) + ".h5");
    EXPECT_TRUE(WriteDataset(one, file));
    request.inputs.push_back({"clip", clip.id(), file, ""});
  }
  auto outcome = AssembleStage(request);
  auto dataset = ReadDataset(folder / "dataset.h5");
  return {std::move(outcome), std::move(dataset)};
}

Motion Standing(const SkeletonPtr& skeleton, FrameRate rate) {
  return MakeMotion(
      skeleton, rate, std::vector<Vector3d>(10, Vector3d(0, 1, 0)),
      std::vector<Quaterniond>(10 * static_cast<std::size_t>(skeleton->joint_count()), Quaterniond::Identity()), {});
}

/// A bone of the skeleton's left arm that is alone at its joint, or one of several at the torso.
int BoneOf(const Skeleton& skeleton, bool alone) {
  for (const std::vector<int>& children : skeleton.Children()) {
    if ((children.size() == 1) == alone && !children.empty()) return children[0];
  }
  return -1;
}

SkeletonPtr Turned(const SkeletonPtr& skeleton, int bone, const Vector3d& by) {
  auto turned = std::make_shared<Skeleton>(*skeleton);
  turned->joints[bone].rest_offset += by;
  return turned;
}

/// A person whose bone and its mirror image point further forwards, rotated as a whole to match the skeleton's.
SkeletonPtr Spread(const SkeletonPtr& skeleton, int bone) {
  auto own = std::make_shared<Skeleton>(*skeleton);
  const int parent = own->joints[static_cast<std::size_t>(bone)].parent;
  own->joints[static_cast<std::size_t>(bone)].rest_offset += Vector3d(0.0, 0.0, 0.05);
  Matrix3d shared = Matrix3d::Zero();
  for (std::size_t j = 1; j < own->joints.size(); ++j) {
    if (own->joints[j].parent == parent)
      shared += skeleton->joints[j].rest_offset * own->joints[j].rest_offset.transpose();
  }
  const Eigen::JacobiSVD<Matrix3d> svd(shared, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
  if (turn.determinant() < 0.0) turn = svd.matrixU() * Vector3d(1, 1, -1).asDiagonal() * svd.matrixV().transpose();
  for (std::size_t j = 1; j < own->joints.size(); ++j) {
    if (own->joints[j].parent == parent) own->joints[j].rest_offset = turn * own->joints[j].rest_offset;
  }
  return own;
}

TEST(Assemble, OneClipWhoseRotationsAreCountedFromAnotherRestPoseCostsOnlyItself) {
  const SkeletonPtr skeleton = Skeleton15();
  const int alone = BoneOf(*skeleton, true);
  const double length = skeleton->joints[alone].rest_offset.norm();
  const SkeletonPtr bent = Turned(skeleton, alone, length * skeleton->joints[alone].rest_offset.unitOrthogonal());
  const FrameRate rate{30, 1};
  const Assembled set = AssembleMotions({Standing(bent, rate), Standing(skeleton, rate), Standing(skeleton, rate)});
  ASSERT_TRUE(set.outcome) << set.outcome.error().Message();
  ASSERT_TRUE(set.dataset) << set.dataset.error().Message();
  EXPECT_EQ(set.dataset->clips.size(), 2u);
  ASSERT_EQ(set.dataset->findings.size(), 1u);
  EXPECT_EQ(set.dataset->findings[0].code, "other_skeleton");
  EXPECT_EQ(set.dataset->findings[0].clip, "test/p/r0#0-10");
  EXPECT_NEAR(set.dataset->findings[0].value, 0.7854, 1e-4);
  EXPECT_THAT(set.dataset->findings[0].message, HasSubstr("45 degrees"));
}

/// The bones of a joint rotated together: the joint's rotations refer to another pose.
TEST(Assemble, AClipWhoseTorsoIsTurnedInTheRestPoseIsExcluded) {
  const SkeletonPtr skeleton = Skeleton15();
  auto turned = std::make_shared<Skeleton>(*skeleton);
  const int parent = skeleton->joints[static_cast<std::size_t>(BoneOf(*skeleton, false))].parent;
  const Quaterniond turn(Eigen::AngleAxisd(0.3, Vector3d::UnitX()));
  for (Joint& joint : turned->joints) {
    if (joint.parent == parent) joint.rest_offset = turn * joint.rest_offset;
  }
  const FrameRate rate{30, 1};
  const Assembled set = AssembleMotions({Standing(turned, rate), Standing(skeleton, rate), Standing(skeleton, rate)});
  ASSERT_TRUE(set.dataset) << set.dataset.error().Message();
  EXPECT_EQ(set.dataset->clips.size(), 2u);
  ASSERT_EQ(set.dataset->findings.size(), 1u);
  EXPECT_EQ(set.dataset->findings[0].code, "other_skeleton");
}

/// A user's own skeleton with the name of a built-in one.
TEST(Assemble, ASkeletonThatOnlyBearsABuiltInNameStaysItself) {
  auto named = std::make_shared<Skeleton>(*Skeleton15());
  named->joints[2].limits = JointLimits{};
  const int torso = BoneOf(*named, false);
  const SkeletonPtr own = Spread(named, torso);
  const FrameRate rate{30, 1};
  const Assembled set = AssembleMotions({Standing(own, rate), Standing(named, rate)});
  ASSERT_TRUE(set.outcome) << set.outcome.error().Message();
  ASSERT_TRUE(set.dataset) << set.dataset.error().Message();
  EXPECT_EQ(set.dataset->clips.size(), 2u);
  EXPECT_TRUE(set.dataset->skeleton->joints[2].limits.has_value());
}

TEST(Assemble, PeopleKeepTheDirectionsOfTheirOwnBodies) {
  const SkeletonPtr skeleton = Skeleton15();
  const int torso = BoneOf(*skeleton, false);
  const SkeletonPtr own = Spread(skeleton, torso);
  const FrameRate rate{30, 1};
  const Assembled set = AssembleMotions({Standing(own, rate), Standing(own, rate), Standing(skeleton, rate)});
  ASSERT_TRUE(set.dataset) << set.dataset.error().Message();
  ASSERT_EQ(set.dataset->clips.size(), 3u);
  EXPECT_TRUE(set.dataset->findings.empty());
  EXPECT_EQ(set.dataset->skeleton->joints[torso].rest_offset, skeleton->joints[torso].rest_offset)
      << "the set has the built-in skeleton, not one person's";
  EXPECT_EQ(set.dataset->clips[0].motion->skeleton->joints[torso].rest_offset, own->joints[torso].rest_offset);
  EXPECT_EQ(set.dataset->clips[2].motion->skeleton->joints[torso].rest_offset, skeleton->joints[torso].rest_offset);
}

/// A set of 100,000 clips of 50 people has 50 skeletons in memory.
TEST(Assemble, ClipsThatShareASkeletonShareItInTheSet) {
  const SkeletonPtr skeleton = Skeleton15(), own = Spread(skeleton, BoneOf(*skeleton, false));
  Dataset set;
  for (const SkeletonPtr& body : {own, skeleton, own, skeleton, skeleton}) {
    set.clips.emplace_back().motion = Standing(body, FrameRate{30, 1});
  }
  std::vector<Finding> findings;
  UniteSkeletons(set, findings);
  ASSERT_EQ(set.clips.size(), 5u);
  EXPECT_EQ(set.clips[0].motion->skeleton, set.clips[2].motion->skeleton);
  EXPECT_NE(set.clips[0].motion->skeleton, set.clips[1].motion->skeleton);
  EXPECT_EQ(set.clips[1].motion->skeleton, set.clips[4].motion->skeleton);
  EXPECT_EQ(set.clips[2].motion->rotation_reference, set.skeleton);
}

/// Fits of people on one skeleton: rotations refer to its rest pose, whatever the bones' directions.
TEST(Assemble, FitsOfPeopleWithBodiesOfTheirOwnAllStay) {
  const SkeletonPtr skeleton = Skeleton15();
  const int alone = BoneOf(*skeleton, true), torso = BoneOf(*skeleton, false);
  const double length = skeleton->joints[alone].rest_offset.norm();
  const FrameRate rate{30, 1};
  std::vector<Motion> motions;
  for (const SkeletonPtr& body :
       {Turned(skeleton, alone, length * skeleton->joints[alone].rest_offset.unitOrthogonal()),
        Turned(skeleton, torso, Vector3d(0.0, 0.0, 0.1)), skeleton}) {
    motions.push_back(Standing(body, rate));
    motions.back().rotation_reference = body == skeleton ? nullptr : skeleton;
  }
  const Assembled set = AssembleMotions(motions);
  ASSERT_TRUE(set.dataset) << set.dataset.error().Message();
  ASSERT_EQ(set.dataset->clips.size(), 3u);
  EXPECT_TRUE(set.dataset->findings.empty());
  EXPECT_FALSE(set.outcome->summary.contains("excluded"));
  EXPECT_EQ(set.dataset->skeleton->joints[alone].rest_offset, skeleton->joints[alone].rest_offset);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Motion& stored = *set.dataset->clips[i].motion;
    const Motion again =
        MakeMotion(stored.skeleton, stored.rate, stored.root_translation, stored.rotation, stored.bone_length);
    for (int j = 0; j < stored.joint_count(); ++j) {
      EXPECT_LT((again.joints.at(3, j) - motions[i].joints.at(3, j)).norm(), 1e-9) << "clip " << i << ", joint " << j;
    }
  }
}

TEST(Assemble, WhichItemsAreExcludedStandsInTheSummary) {
  const SkeletonPtr skeleton = Skeleton15();
  const SkeletonPtr bent = Turned(skeleton, BoneOf(*skeleton, true), Vector3d(0.0, 0.1, 0.1));
  const FrameRate rate{30, 1};
  const Assembled set = AssembleMotions({Standing(bent, rate), Standing(skeleton, rate), Standing(skeleton, rate)});
  ASSERT_TRUE(set.outcome) << set.outcome.error().Message();
  const nlohmann::json& excluded = set.outcome->summary["excluded"];
  ASSERT_EQ(excluded.size(), 1u);
  EXPECT_EQ(excluded["test/p/r0#0-10"]["whole"], true);
  EXPECT_EQ(excluded["test/p/r0#0-10"]["findings"], nlohmann::json({0}));
  EXPECT_GT(excluded["test/p/r0#0-10"]["threshold"], 0.0);
}

TEST(Assemble, ClipsOfSeveralRatesAreFlagged) {
  const SkeletonPtr skeleton = Skeleton15();
  const Assembled set = AssembleMotions({Standing(skeleton, FrameRate{30, 1}), Standing(skeleton, FrameRate{60, 1})});
  ASSERT_TRUE(set.dataset) << set.dataset.error().Message();
  ASSERT_EQ(set.dataset->findings.size(), 1u);
  EXPECT_EQ(set.dataset->findings[0].code, "mixed_rates");
  EXPECT_THAT(set.dataset->findings[0].message, HasSubstr("30 Hz (1) 60 Hz (1)"));
}

}  // namespace
}  // namespace mocurate
