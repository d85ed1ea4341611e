#include "fitting/uncertainty/body_response.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/store/body_file.h"
#include "fitting/solver/joint_track_fit.h"
#include "fitting/uncertainty/track_uncertainty.h"
#include "tests/fitting/takes.h"

namespace mocurate {
namespace {

constexpr int kChest = 1, kElbowOfArm = 4, kWristOfArm = 5;

Matrix3d CovarianceOfJoint(const std::vector<float>& covariances, int frame, int joint, int joints) {
  return FromSixNumbers(covariances.data() + 6 * (static_cast<std::size_t>(frame) * joints + joint));
}

/// What other bodies add to the covariances of a take of ten frames at its true pose; the `hidden` joints are never
/// observed.
std::vector<float> OfTakeWithout(const std::vector<int>& hidden) {
  PlayedTake take = SmoothTake(10);
  const int joints = take.tracks.joints();
  for (const int j : hidden) {
    for (int f = 0; f < 10; ++f) Hide(take.tracks, f, j);
  }
  std::vector<bool> active(static_cast<std::size_t>(joints), false);
  for (int j = joints - 1; j > 0; --j) {
    const int parent = take.tracks.skeleton->joints[j].parent;
    if (active[j] || take.tracks.seen(0, j)) active[parent] = true;
  }
  PoseState state(*take.tracks.skeleton, 10, take.truth.bone_length, active);
  for (int f = 0; f < 10; ++f) {
    Eigen::Map<Vector3d>(state.translation(f)) = take.truth.joints.at(f, 0);
    for (int j = 0; j < joints; ++j) {
      if (active[j]) Eigen::Map<Vector3d>(state.rotation(f, j)) = LogQuaternion(take.truth.rotation_at(f, j));
    }
  }
  state.Update(0, 10, true);
  const double sigma = 0.005;
  JointTrackOptions options;
  const auto all = UncertaintyOfTracks(TrackProblem(take.tracks, state, sigma, options));
  options.rules.SwitchOff(FittingRule::kBodyErrors);
  const auto without = UncertaintyOfTracks(TrackProblem(take.tracks, state, sigma, options));
  EXPECT_TRUE(all) << all.error().Message();
  EXPECT_TRUE(without) << without.error().Message();
  std::vector<float> added = all->position_cov;
  for (std::size_t i = 0; i < added.size(); ++i) added[i] -= without->position_cov[i];
  return added;
}

TEST(BodySigma, IsSmallWhereAllJointsAreObserved) {
  const auto covariances = OfTakeWithout({});
  for (int j = 0; j < 14; ++j) {
    EXPECT_GT(CovarianceOfJoint(covariances, 5, j, 14).trace(), 1e-8) << j;
    EXPECT_LT(CovarianceOfJoint(covariances, 5, j, 14).trace(), 3.0 * kTrunkSigma * kTrunkSigma) << j;
  }
}

TEST(BodySigma, BeyondTheLastObservedJointIsThatOfOneBoneAndOneRotation) {
  const auto covariances = OfTakeWithout({kWristOfArm});
  const double arm = 0.25, along = kLimbSigma * kLimbSigma, across = along + arm * arm;  // rest pose: 1 rad
  for (const int frame : {0, 6, 9}) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(CovarianceOfJoint(covariances, frame, kWristOfArm, 14));
    const double of_elbow = CovarianceOfJoint(covariances, frame, kElbowOfArm, 14).trace();
    EXPECT_NEAR(eigen.eigenvalues()[0], along + 0.5 * of_elbow, 0.51 * of_elbow);
    EXPECT_NEAR(eigen.eigenvalues()[1], across, 0.01 * across);
    EXPECT_NEAR(eigen.eigenvalues()[2], across, 0.01 * across);
    EXPECT_LT(of_elbow, along) << "the arm above it varies, but the elbow is observed";
  }
}

TEST(BodySigma, IsBoundedFromBothSidesBetweenObservedJoints) {
  const std::vector<int> arms_and_head = {2, 3, kElbowOfArm, kWristOfArm, 6, 7, 8, 13};
  std::vector<int> with_chest = arms_and_head;
  with_chest.push_back(kChest);
  const auto between = OfTakeWithout({kChest});
  const auto beyond = OfTakeWithout(with_chest);
  const double open = CovarianceOfJoint(beyond, 5, kChest, 14).trace();
  const double own = 3.0 * kTrunkSigma * kTrunkSigma;
  EXPECT_GT(open, own) << "hips elsewhere rotate the pelvis";
  EXPECT_LT(CovarianceOfJoint(between, 5, kChest, 14).trace(), 0.8 * open);
  EXPECT_GT(CovarianceOfJoint(between, 5, kChest, 14).trace(), 0.5 * own);
  for (const int shoulder : {3, 6}) {
    EXPECT_LT(CovarianceOfJoint(between, 5, shoulder, 14).trace(), 0.3 * open);
    EXPECT_GT(CovarianceOfJoint(beyond, 5, shoulder, 14).trace(),
              2.0 * open);  // of two bones, and the chest may rotate
  }
}

/// Thirty people whose trunks differ as in a population, fitted with one skeleton; their chests are never observed.
TEST(BodySigma, CoversUnobservedJointsOfOtherBodies) {
  Random random(12, "bodies");
  int within_one = 0, within_two = 0, count = 0;
  for (int person = 0; person < 30; ++person) {
    auto body = std::make_shared<Skeleton>(*TestSkeleton());
    for (Joint& joint : body->joints) {
      if (joint.parent != kChest && joint.name != "chest") continue;
      joint.rest_offset += kTrunkSigma * Vector3d(random.Normal(), random.Normal(), random.Normal());
    }
    PlayedTake take = SmoothTake(20, Quaterniond::Identity(), 30.0, 0.4, body);
    AddNoise(take.tracks, 0.003, 100 + static_cast<std::uint64_t>(person));
    for (int f = 0; f < 20; ++f) Hide(take.tracks, f, kChest);
    take.tracks = OnBody(take.tracks, TestSkeleton());
    const auto fit = FitJointTracks(take.tracks, take.truth.rate, TestSkeleton()->RestBoneLengths(), {});
    ASSERT_TRUE(fit.has_value()) << fit.error().Message();
    for (const int frame : {0, 10, 19}) {
      const Eigen::LLT<Matrix3d> root(CovarianceOfJoint(fit->motion.position_cov, frame, kChest, 14));
      const Vector3d off = fit->motion.joints.at(frame, kChest) - take.truth.joints.at(frame, kChest);
      const Vector3d white = root.matrixL().solve(off);
      within_one += static_cast<int>((white.array().abs() < 1.0).count());
      within_two += static_cast<int>((white.array().abs() < 2.0).count());
      count += 3;
    }
  }
  EXPECT_NEAR(static_cast<double>(within_one) / count, 0.683, 0.12);
  EXPECT_NEAR(static_cast<double>(within_two) / count, 0.954, 0.05);
}

/// Bodies between the man and the woman of the template, all scaled to the skeleton's size.
TEST(BodySigma, EqualsTheVariationOfTemplateShapes) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "no shapes: set MOCURATE_DATA";
  const auto body = ReadBodyTemplate(std::filesystem::path(data) / "body_cc0" / "body_cc0.h5");
  ASSERT_TRUE(body.has_value()) << body.error().Message();
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  double trunk = 0.0, limbs = 0.0;
  int trunk_bones = 0, limb_bones = 0;
  for (double shape = -1.0; shape <= 1.0; shape += 0.125) {
    const RestBody own = Shaped(*body, {shape});
    const auto offset = [&](int j) { return Vector3d(own.joints[j] - own.joints[skeleton->joints[j].parent]); };
    double length = 0.0, rest_length = 0.0;
    for (int j = 1; j < skeleton->joint_count(); ++j) {
      length += offset(j).norm();
      rest_length += skeleton->joints[j].rest_offset.norm();
    }
    for (int j = 1; j < skeleton->joint_count(); ++j) {
      const double square = (rest_length / length * offset(j) - skeleton->joints[j].rest_offset).squaredNorm() / 3.0;
      const int start = skeleton->joints[j].parent;
      const bool in_trunk = skeleton->joints[start].mirror == start;
      (in_trunk ? trunk : limbs) += square;
      ++(in_trunk ? trunk_bones : limb_bones);
    }
  }
  EXPECT_NEAR(std::sqrt(trunk / trunk_bones), kTrunkSigma, 0.1 * kTrunkSigma);
  EXPECT_NEAR(std::sqrt(limbs / limb_bones), kLimbSigma, 0.1 * kLimbSigma);
}

}  // namespace
}  // namespace mocurate
