#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fitting/solver/joint_track_fit.h"
#include "tests/fitting/takes.h"
#include "tests/fitting/track_problems.h"

namespace mocurate {
namespace {

/// Four seconds of a person whose bent legs carry the pelvis sideways by `sway` metres and back. The feet stay parallel
/// to the floor and slide with it. `knee` bends the knees and `arms` raises the arms (radians), far from the rest pose.
PlayedTake Shuffling(double sway, double knee = 0.8, double arms = 0.0) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  std::vector<Vector3d> translation;
  std::vector<Quaterniond> rotation;
  PlayedTake take;
  take.tracks.skeleton = skeleton;
  for (int f = 0; f < 120; ++f) {
    take.tracks.time_s.push_back(f / 30.0);
    translation.emplace_back(sway * std::sin(0.1 * f), 0.9, 0.0);
    for (const Joint& joint : skeleton->joints) {
      const auto is = [&](const char* name) { return joint.name.find(name) != std::string::npos; };
      const double bend = is("hip") ? -0.5 * knee : is("knee") ? knee : is("ankle") ? -0.5 * knee : 0.0;
      rotation.push_back(ExpQuaternion(Vector3d(bend, 0.0, is("shoulder") ? (is("left") ? arms : -arms) : 0.0)));
    }
  }
  take.truth = MakeMotion(skeleton, FrameRate{30, 1}, translation, rotation, skeleton->RestBoneLengths());
  take.tracks.positions = take.truth.joints;
  take.tracks.confidence.assign(take.truth.joints.xyz.size() / 3, 1.0);
  return take;
}

Motion FittedMotion(const PlayedTake& take, const JointTrackOptions& options = {}) {
  const auto fit = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, options);
  EXPECT_TRUE(fit.has_value()) << fit.error().Message();
  return fit->motion;
}

double RmsOf(const Motion& fitted, const Motion& truth, const std::string& joint) {
  const int j = *truth.skeleton->FindJoint(joint);
  double sum = 0.0;
  for (int f = 0; f < truth.frame_count(); ++f)
    sum += (fitted.joints.at(f, j) - truth.joints.at(f, j)).squaredNorm() / truth.frame_count();
  return std::sqrt(sum);
}

/// Thighs spread and shins folded before the body: the thighs are twisted outwards, and the knees act as hinges.
TEST(Priors, KneesOfACrossLeggedPersonBendForwards) {
  PlayedTake take = Shuffling(0.05);
  const Skeleton& skeleton = *take.truth.skeleton;
  for (int f = 0; f < take.truth.frame_count(); ++f) {
    for (int j = 0; j < take.truth.joint_count(); ++j) {
      const std::string& name = skeleton.joints[j].name;
      const double side = name.find("left") == 0 ? 1.0 : -1.0;
      Quaterniond& rotation = take.truth.rotation_at(f, j);
      if (name.find("hip") != std::string::npos) {
        rotation = ExpQuaternion(Vector3d(-1.92, side * 1.54, side * -0.24));
      } else if (name.find("knee") != std::string::npos) {
        rotation = ExpQuaternion(Vector3d(2.5, 0.0, side * -0.3));
      } else {
        rotation.setIdentity();
      }
    }
  }
  take.truth = MakeMotion(take.truth.skeleton, take.truth.rate, take.truth.root_translation, take.truth.rotation,
                          take.truth.bone_length);
  take.tracks.positions = take.truth.joints;
  AddNoise(take.tracks, 0.01, 7);
  const Motion fitted = FittedMotion(take);
  // Within the hinge's limits, 0.6 rad, a thigh's twist is not observed.
  for (const char* joint : {"left_hip", "right_hip", "left_knee", "right_knee"}) {
    const int j = *skeleton.FindJoint(joint);
    EXPECT_LT(fitted.rotation_at(60, j).angularDistance(take.truth.rotation_at(60, j)), 0.7) << joint;
  }
}

/// A back has limits but is not a hinge: a bend beyond them is no evidence of twist.
TEST(Priors, BackBentSidewaysBeyondItsLimitsIsNotTwisted) {
  PlayedTake take = Shuffling(0.05);
  const int bent = *take.truth.skeleton->FindJoint("spine2");
  for (int f = 0; f < take.truth.frame_count(); ++f)
    take.truth.rotation_at(f, bent) = ExpQuaternion(Vector3d(0.0, 0.0, 1.2));
  take.truth = MakeMotion(take.truth.skeleton, take.truth.rate, take.truth.root_translation, take.truth.rotation,
                          take.truth.bone_length);
  take.tracks.positions = take.truth.joints;
  JointTrackOptions closed_form;
  closed_form.steps.clear();
  const Motion started = FittedMotion(take, closed_form);
  const int above_hips = *take.truth.skeleton->FindJoint("spine1");
  EXPECT_LT(LogQuaternion(started.rotation_at(60, above_hips)).norm(), 0.2);
}

TEST(Priors, UnobservedTrunkDoesNotTwistBetweenHipsAndShoulders) {
  PlayedTake take = Shuffling(0.1);
  for (const char* joint : {"pelvis", "spine1", "spine2", "spine3", "neck", "head", "left_collar", "right_collar"}) {
    for (int f = 0; f < take.truth.frame_count(); ++f) Hide(take.tracks, f, *take.truth.skeleton->FindJoint(joint));
  }
  AddNoise(take.tracks, 0.02, 7);
  const Motion fitted = FittedMotion(take);
  for (const char* joint : {"pelvis", "spine1", "spine2", "spine3"}) {
    const std::size_t j = *take.truth.skeleton->FindJoint(joint);
    const std::size_t joints = take.truth.skeleton->joints.size();
    double mean = 0.0;
    for (std::size_t f = 0; f < 120; ++f) mean += LogQuaternion(fitted.rotation[f * joints + j]).norm() / 120;
    EXPECT_LT(mean, 0.1) << joint << ": the trunk is straight";
  }
}

TEST(Priors, StanceFootDoesNotMove) {
  PlayedTake take = Shuffling(0.0);
  AddNoise(take.tracks, 0.02, 3);
  JointTrackOptions none;
  none.contact_process_noise.reset();
  const Motion fitted = FittedMotion(take), fitted_without = FittedMotion(take, none);
  for (const char* joint : {"left_ankle", "right_ankle", "left_foot", "right_foot"}) {
    const double without = RmsOf(fitted_without, take.truth, joint);
    EXPECT_LT(RmsOf(fitted, take.truth, joint), 0.8 * without) << joint << " without: " << without;
  }
}

/// Knees bent backwards, arms over the head, sliding feet: poses that priors consider improbable.
class ImprobablePoses : public testing::TestWithParam<double> {};

INSTANTIATE_TEST_SUITE_P(Priors, ImprobablePoses, testing::Values(0.002, 0.005, 0.01));

TEST_P(ImprobablePoses, AreFittedWithinTheNoise) {
  for (const double knee : {-0.3, 0.8}) {
    PlayedTake take = Shuffling(0.08, knee, 1.4);  // up to 0.24 m/s, within the speed of a contact
    AddNoise(take.tracks, GetParam(), 5);
    const Motion fitted = FittedMotion(take);
    for (const Joint& joint : take.truth.skeleton->joints)
      EXPECT_LT(RmsOf(fitted, take.truth, joint.name), std::sqrt(3.0) * GetParam()) << joint.name << ", knee " << knee;
  }
}

}  // namespace
}  // namespace mocurate
