#include "fitting/clouds/cloud_start.h"

#include <gtest/gtest.h>

#include "fitting/clouds/cloud_tracking.h"
#include "tests/fitting/cloud_scene.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

/// smpl24 with another root name: a body of bone capsules, recognised by shoulders and hips.
SkeletonPtr BoneBody() {
  const Expected<SkeletonPtr> smpl = LoadSkeleton("smpl24");
  if (!smpl) return nullptr;
  auto bones = std::make_shared<Skeleton>(**smpl);
  bones->name = "bones";
  bones->joints[0].name = "root";
  bones->joints[0].synonyms.clear();
  return bones;
}

/// Rotation vectors of joints by name, rad.
using RotationsByName = std::vector<std::pair<std::string, Vector3d>>;

/// A motion of one frame.
Motion Posed(const SkeletonPtr& skeleton, const RotationsByName& rotations) {
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(skeleton->joint_count()), Quaterniond::Identity());
  for (const auto& [name, by] : rotations) {
    rotation[static_cast<std::size_t>(*skeleton->FindJoint(name))] = ExpQuaternion(by);
  }
  return MakeMotion(skeleton, FrameRate{30, 1}, {Vector3d::Zero()}, rotation, skeleton->RestBoneLengths());
}

double FarthestWrist(const PoseState& state, const Motion& truth) {
  double farthest = 0.0;
  for (const char* wrist : {"left_wrist", "right_wrist"}) {
    const int j = *truth.skeleton->FindJoint(wrist);
    farthest = std::max(farthest, (state.position(0, j) - truth.joints.at(0, j)).norm());
  }
  return farthest;
}

PointCloudOptions BandedClouds() {
  PointCloudOptions options;
  options.solver = PoseSolver::kBanded;
  return options;
}

/// The fused cloud of a pose in three cameras; empty on failure.
FusedCloud CloudOfPose(const Motion& truth, const std::string& name) {
  const auto clip = RenderClip(truth, SharedScratch("arms_" + name));
  if (!clip) return {};
  const auto clouds = FuseClip(*clip, BandedClouds());
  return clouds ? (*clouds)[0] : FusedCloud{};
}

class FoldedArms : public testing::TestWithParam<int> {};

const std::vector<RotationsByName> kArmsBeforeTheTrunk = {
    {{"left_shoulder", {0.0, -0.9, -0.9}}, {"left_elbow", {0.0, -1.9, 0.0}}, {"right_shoulder", {0.0, 0.0, 1.2}}},
    {{"left_shoulder", {0.0, -1.0, -0.5}},
     {"left_elbow", {0.0, -1.6, 0.0}},
     {"right_shoulder", {0.0, 1.0, 0.5}},
     {"right_elbow", {0.0, 1.6, 0.0}}},
    {{"left_shoulder", {0.0, 0.0, 1.0}},
     {"left_elbow", {0.0, -1.9, 0.0}},
     {"right_shoulder", {0.0, 0.5, 1.0}},
     {"right_elbow", {0.0, 1.9, 0.0}}}};

/// A fit that starts with hanging arms does not reach arms before the trunk.
TEST_P(FoldedArms, AreFoundByALimbSearch) {
  const SkeletonPtr skeleton = BoneBody();
  ASSERT_NE(skeleton, nullptr);
  const Motion truth = Posed(skeleton, kArmsBeforeTheTrunk[static_cast<std::size_t>(GetParam())]);
  const FusedCloud cloud = CloudOfPose(truth, std::to_string(GetParam()));
  ASSERT_GT(cloud.size(), 0);
  const CapsuleBody body = CapsuleBody::Make(skeleton, 1.0);
  PoseState state(*skeleton, 1, skeleton->RestBoneLengths(), body.MovingJoints());
  const auto hang = [&] {
    for (int j = 0; j < state.joints(); ++j) Eigen::Map<Vector3d>(state.rotation(0, j)).setZero();
    Eigen::Map<Vector3d>(state.translation(0)).setZero();
    state.rotation(0, *skeleton->FindJoint("left_shoulder"))[2] = -1.3;
    state.rotation(0, *skeleton->FindJoint("right_shoulder"))[2] = 1.3;
  };
  hang();
  ASSERT_TRUE(FitCloudFrame(body, cloud, FrameFit{}, state, BandedClouds()));
  EXPECT_GT(FarthestWrist(state, truth), 0.1);
  hang();
  const auto cost = SearchLimbs(body, cloud, 0, BandedClouds(), state);
  ASSERT_TRUE(cost) << cost.error().Message();
  EXPECT_LT(FarthestWrist(state, truth), 0.03);
}

INSTANTIATE_TEST_SUITE_P(LimbSearch, FoldedArms, testing::Range(0, 3));

TEST(LimbSearch, KeepsAPoseThatExplainsThePoints) {
  const SkeletonPtr skeleton = BoneBody();
  ASSERT_NE(skeleton, nullptr);
  const Motion truth = Posed(skeleton, {{"left_shoulder", {0.0, 0.0, -1.2}}, {"right_shoulder", {0.0, 0.0, 1.2}}});
  const FusedCloud cloud = CloudOfPose(truth, "down");
  ASSERT_GT(cloud.size(), 0);
  const CapsuleBody body = CapsuleBody::Make(skeleton, 1.0);
  PoseState state(*skeleton, 1, skeleton->RestBoneLengths(), body.MovingJoints());
  for (int j = 0; j < state.joints(); ++j) {
    if (!state.active(j)) continue;
    Eigen::Map<Vector3d>(state.rotation(0, j)) = LogQuaternion(truth.rotation_at(0, j));
  }
  const auto cost = SearchLimbs(body, cloud, 0, BandedClouds(), state);
  ASSERT_TRUE(cost) << cost.error().Message();
  EXPECT_LT(FarthestWrist(state, truth), 0.02);
}

}  // namespace
}  // namespace mocurate
