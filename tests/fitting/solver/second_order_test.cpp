#include "fitting/uncertainty/body_sigma.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/fitting/takes.h"

namespace mocurate {
namespace {

/// A take whose joint `end` is not observed and has `sigma` radians of uncertainty across its bone; `covariance` of all
/// joints.
struct UncertainBone {
  PlayedTake take = SmoothTake(1);
  int end;
  std::vector<float> covariance;
  Vector3d bone;

  UncertainBone(int joint, double sigma) : end(joint), covariance(6 * take.tracks.confidence.size(), 0.0F) {
    const Vector3d from = take.truth.joints.at(0, take.tracks.skeleton->joints[end].parent);
    bone = take.truth.joints.at(0, end) - from;
    const Vector3d along = bone.normalized();
    const Matrix3d across = sigma * sigma * bone.squaredNorm() * (Matrix3d::Identity() - along * along.transpose());
    ToSixNumbers(across, covariance.data() + 6 * static_cast<std::size_t>(end));
    take.tracks.confidence[static_cast<std::size_t>(end)] = 0.0;
  }

  /// Variance of a joint along the uncertain bone, in units of the bone's length.
  double AlongInLengths(int joint) const {
    return bone.dot(FromSixNumbers(covariance.data() + 6 * static_cast<std::size_t>(joint)) * bone) /
           (bone.squaredNorm() * bone.squaredNorm());
  }

  void AddSecondOrder() {
    const double sigma = 0.01;
    const JointTrackOptions options;
    PoseState state(*take.tracks.skeleton, 1, take.truth.bone_length,
                    std::vector<bool>(static_cast<std::size_t>(take.tracks.joints()), true));
    Eigen::Map<Vector3d>(state.translation(0)) = take.truth.joints.at(0, 0);
    for (int j = 0; j < take.tracks.joints(); ++j)
      Eigen::Map<Vector3d>(state.rotation(0, j)) = LogQuaternion(take.truth.rotation_at(0, j));
    state.Update(0, 1, true);
    AddSecondOrderCovariance(TrackProblem(take.tracks, state, sigma, options), covariance);
  }
};

int FirstJointWithAChild(const Skeleton& skeleton) {
  for (std::size_t j = 1; j < skeleton.joints.size(); ++j) {
    if (skeleton.joints[j].parent > 0 && !skeleton.Children()[j].empty()) return static_cast<int>(j);
  }
  return -1;
}

/// Mean square of 1 - cos of the angle; the rotation vector is normal, with `sigma` on both axes across the bone.
double MeanSquareShortening(double sigma) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal(0.0, sigma);
  double sum = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double shortening = 1.0 - std::cos(std::hypot(normal(engine), normal(engine)));
    sum += shortening * shortening / 20000.0;
  }
  return sum;
}

TEST(SecondOrderCovariance, AddsTheShorteningOfABoneOfUncertainDirection) {
  const int joint = FirstJointWithAChild(*SmoothTake(1).tracks.skeleton);
  for (const double sigma : {0.1, 0.3, 0.6}) {
    UncertainBone body(joint, sigma);
    body.AddSecondOrder();
    EXPECT_NEAR(body.AlongInLengths(joint) / MeanSquareShortening(sigma), 1.0, 0.35) << sigma << " rad";
  }
  UncertainBone anywhere(joint, 3.0);
  anywhere.AddSecondOrder();
  EXPECT_NEAR(anywhere.AlongInLengths(joint), 4.0 / 3.0, 1e-3) << "the limit of a uniform direction on the sphere";
}

TEST(SecondOrderCovariance, ReachesUnobservedDescendantsOnly) {
  const SkeletonPtr skeleton = SmoothTake(1).tracks.skeleton;
  const int joint = FirstJointWithAChild(*skeleton);
  const int child = skeleton->Children()[static_cast<std::size_t>(joint)].front();
  UncertainBone observed(joint, 0.5);
  observed.AddSecondOrder();
  EXPECT_EQ(observed.AlongInLengths(child), 0.0);
  UncertainBone hidden(joint, 0.5);
  hidden.take.tracks.confidence[static_cast<std::size_t>(child)] = 0.0;
  hidden.AddSecondOrder();
  EXPECT_NEAR(hidden.AlongInLengths(child), hidden.AlongInLengths(joint), 1e-6);
}

}  // namespace
}  // namespace mocurate
