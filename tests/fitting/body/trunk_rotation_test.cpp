#include "fitting/solver/rest_directions.h"

#include <gtest/gtest.h>

#include "fitting/proportions.h"
#include "fitting/solver/bone_lengths.h"
#include "fitting/solver/joint_track_fit.h"
#include "tests/fitting/takes.h"

namespace mocurate {
namespace {

/// smpl24 with two points of a tracker, at the middle and the top of the trunk; the tracker has no joint above the
/// pelvis.
SkeletonPtr WithTrunkPoints() {
  auto body = std::make_shared<Skeleton>(**LoadSkeleton("smpl24"));
  for (const auto& [name, height] : {std::pair("middle_of_trunk", -0.005), std::pair("top_of_trunk", 0.249)}) {
    Joint point;
    point.name = name;
    point.parent = *body->FindJoint("spine3");
    point.rest_offset = {0.0, height, 0.022};
    point.mirror = body->joint_count();
    point.landmark = true;
    body->joints.push_back(point);
  }
  return body;
}

/// A person of `body`, upright except for a bow in every third second; the tracks are on `nominal`.
PlayedTake TakeOf(const SkeletonPtr& body, const SkeletonPtr& nominal) {
  PlayedTake take = SmoothTake(300, Quaterniond::Identity(), 30.0, 0.4, body);
  std::vector<Quaterniond> rotation = take.truth.rotation;
  for (int f = 0; f < 300; ++f) {
    for (const char* joint : {"spine1", "spine2", "spine3"}) {
      const double bow = f / 30 % 3 == 2 ? 0.3 : 0.0;
      rotation[static_cast<std::size_t>(f * body->joint_count() + *body->FindJoint(joint))] =
          ExpQuaternion(Vector3d(bow, 0.0, 0.0));
    }
  }
  take.truth =
      MakeMotion(body, take.truth.rate, take.truth.root_translation, rotation, take.truth.skeleton->RestBoneLengths());
  take.tracks.positions = take.truth.joints;
  take.tracks.skeleton = nominal;
  AddNoise(take.tracks, 0.004, 5);
  for (const char* joint : {"spine1", "spine2", "spine3", "neck", "head", "left_collar", "right_collar"}) {
    for (int f = 0; f < 300; ++f) Hide(take.tracks, f, *nominal->FindJoint(joint));
  }
  return take;
}

double DegreesBetween(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / 3.14159265358979;
}

/// Offset of the left hip of bodies whose hips lie away from the pelvis.
class HipsOfATracker : public testing::TestWithParam<Vector3d> {};

TEST_P(HipsOfATracker, PointTowardsTheTrunkOfUprightFrames) {
  const SkeletonPtr nominal = WithTrunkPoints();
  auto body = std::make_shared<Skeleton>(*nominal);
  const int left = *body->FindJoint("left_hip"), right = *body->FindJoint("right_hip");
  body->joints[left].rest_offset = GetParam();
  body->joints[right].rest_offset = GetParam().cwiseProduct(Vector3d(-1.0, 1.0, 1.0));
  const PlayedTake take = TakeOf(body, nominal);
  const auto person = EstimateProportions({take.tracks}, nominal, ProportionsOptions{});
  for (const int hip : {left, right})
    EXPECT_LT(DegreesBetween(person.skeleton->joints[hip].rest_offset, body->joints[hip].rest_offset), 6.0);
  JointTrackOptions options;
  options.solver = PoseSolver::kBanded;
  const SkeletonTracks upright = OnBody(CutTracks(take.tracks, 0, 60), person.skeleton);
  const auto fit = FitJointTracks(upright, take.truth.rate, person.bone_length, options);
  ASSERT_TRUE(fit.has_value());
  for (int f = 0; f < 60; f += 10) {
    const Vector3d up = fit->motion.rotation_at(f, 0) * Vector3d::UnitY();
    EXPECT_LT(DegreesBetween(up, take.truth.rotation_at(f, 0) * Vector3d::UnitY()), 10.0) << f;
  }
}

INSTANTIATE_TEST_SUITE_P(TrunkDirection, HipsOfATracker,
                         testing::Values(Vector3d(0.18, 0.0, 0.12), Vector3d(0.18, 0.03, 0.12),
                                         Vector3d(0.075, -0.075, 0.0), Vector3d(0.09, -0.04, -0.05)));

/// With hips and pelvis on one line, only noise would determine the pelvis's pitch.
TEST(TrunkDirection, KeepsTheSkeletonsHipsBesideThePelvis) {
  const SkeletonPtr nominal = WithTrunkPoints();
  auto body = std::make_shared<Skeleton>(*nominal);
  const int left = *body->FindJoint("left_hip"), right = *body->FindJoint("right_hip");
  body->joints[left].rest_offset = {0.101, 0.0, 0.0};
  body->joints[right].rest_offset = {-0.101, 0.0, 0.0};
  const auto person = EstimateProportions({TakeOf(body, nominal).tracks}, nominal, ProportionsOptions{});
  for (const int hip : {left, right})
    EXPECT_LT((person.skeleton->joints[hip].rest_offset - nominal->joints[hip].rest_offset).norm(), 0.008);
}

/// Whether the tracker observes the pelvis.
class TrunkOfATracker : public testing::TestWithParam<bool> {};

/// The middle of the trunk is a third higher than on the skeleton, its top hardly. One length of the unobserved bones
/// must reach both, from the pelvis, or from the hips if the pelvis is unobserved.
TEST_P(TrunkOfATracker, UnobservedBonesReachAllObservedPoints) {
  const SkeletonPtr nominal = WithTrunkPoints();
  auto body = std::make_shared<Skeleton>(*nominal);
  for (const char* joint : {"spine1", "spine2", "spine3"}) body->joints[*body->FindJoint(joint)].rest_offset *= 1.35;
  const int middle = *body->FindJoint("middle_of_trunk"), top = *body->FindJoint("top_of_trunk");
  body->joints[top].rest_offset *= 0.85;
  SkeletonTracks tracks = TakeOf(body, nominal).tracks;
  for (int f = 0; f < tracks.frames() && !GetParam(); ++f) Hide(tracks, f, 0);
  const BoneEstimate bones = EstimateBoneLengths({tracks}, *nominal, true);
  const auto reach = [&](const std::vector<double>& length, int end) {
    Vector3d offset = Vector3d::Zero();
    for (int j = end; j > 0; j = nominal->joints[j].parent)
      offset += length[j] * nominal->joints[j].rest_offset.normalized();
    return offset.norm();
  };
  EXPECT_NEAR(reach(bones.length, middle), reach(body->RestBoneLengths(), middle), 0.01);
  EXPECT_NEAR(reach(bones.length, top), reach(body->RestBoneLengths(), top), 0.01);
}

INSTANTIATE_TEST_SUITE_P(TrunkDirection, TrunkOfATracker, testing::Bool());

}  // namespace
}  // namespace mocurate
