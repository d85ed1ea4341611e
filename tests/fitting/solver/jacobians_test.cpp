#include <ceres/autodiff_cost_function.h>
#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/rotation.h>

#include "core/base/random.h"
#include "fitting/costs/hinge_cost.h"
#include "fitting/costs/joint_limit_cost.h"
#include "fitting/costs/joint_position_cost.h"
#include "fitting/costs/joint_rotation_cost.h"
#include "fitting/costs/joint_velocity_cost.h"
#include "fitting/costs/pose_gaussian_cost.h"
#include "fitting/costs/rest_prior_cost.h"
#include "fitting/costs/rotation_smoothness_cost.h"
#include "tests/fitting/jacobian_check.h"

namespace mocurate {
namespace {

constexpr int kJointsOfBent = 5;
constexpr double kWeight = 3.0;
/// Three times as precise along one direction as along another, with correlation.
const Matrix3d kWhitening = (Matrix3d() << 3.0, 0.7, -0.4, 0.0, 1.2, 0.5, 0.0, 0.0, 0.9).finished();

/// A chain of five joints, bent at rest.
Skeleton BentChain() {
  Skeleton skeleton;
  const Vector3d offsets[kJointsOfBent] = {{0, 0, 0}, {0.1, 0.3, 0}, {0, 0.4, 0.1}, {0.3, 0, 0}, {0.2, 0.1, -0.1}};
  for (int j = 0; j < kJointsOfBent; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = j - 1;
    joint.mirror = j;
    joint.rest_offset = offsets[j];
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

/// Regimes in which rotation formulas are numerically critical.
enum class Regime { kRandom, kIdentity, kTiny, kNearPi };

class CostJacobian : public testing::TestWithParam<Regime> {
 protected:
  CostJacobian() : skeleton_(BentChain()), state_(skeleton_, 2, skeleton_.RestBoneLengths(), Active()) {
    Random random(7, "jacobians", std::to_string(static_cast<int>(GetParam())));
    for (int f = 0; f < 2; ++f) {
      for (int i = 0; i < 3; ++i) state_.translation(f)[i] = random.Normal();
      for (int j = 0; j < kJointsOfBent; ++j) Eigen::Map<Vector3d>(state_.rotation(f, j)) = Draw(random);
    }
    state_.Update(0, 2, true);
  }

  static std::vector<bool> Active() { return {true, true, false, true, false}; }

  /// Rotation vector of the regime. Inactive joints keep the identity, whatever their memory contains.
  static Vector3d Draw(Random& random) {
    const Vector3d direction = Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    switch (GetParam()) {
      case Regime::kRandom:
        return random.Uniform(0.1, 2.5) * direction;
      case Regime::kIdentity:
        return Vector3d::Zero();
      case Regime::kTiny:
        return 1e-8 * direction;
      case Regime::kNearPi:
        return (3.14159265358979 - 1e-7) * direction;
    }
    return direction;
  }

  CostAt At(const ceres::CostFunction& cost, std::vector<double*> blocks) {
    return {&cost, std::move(blocks), [this] { state_.Update(0, 2, true); }};
  }

  Skeleton skeleton_;
  PoseState state_;
};

INSTANTIATE_TEST_SUITE_P(Regimes, CostJacobian,
                         testing::Values(Regime::kRandom, Regime::kIdentity, Regime::kTiny, Regime::kNearPi));

/// Independent implementation of a joint's position for ceres::Jet: translation, active rotations above.
template <class T>
void ChainPosition(const Skeleton& skeleton, int joint, T const* translation, T const* const* rotations, T* position) {
  std::copy(translation, translation + 3, position);
  const std::vector<bool> moves{true, true, false, true, false};
  for (int k = 1; k <= joint; ++k) {
    const Vector3d rest = skeleton.joints[k].rest_offset;
    T offset[3];
    for (int i = 0; i < 3; ++i) offset[i] = T(rest[i]);
    int active = 0;
    for (int j = 0; j < k; ++j) active += moves[j] ? 1 : 0;
    for (int j = k - 1; j >= 0; --j) {
      if (!moves[j]) continue;
      T turned[3];
      ceres::AngleAxisRotatePoint(rotations[--active], offset, turned);
      std::copy(turned, turned + 3, offset);
    }
    for (int i = 0; i < 3; ++i) position[i] += offset[i];
  }
}

struct PositionResidual {
  const Skeleton& skeleton;
  int joint;
  Vector3d observed;
  template <class T>
  bool operator()(T const* const* blocks, T* residuals) const {
    T position[3];
    ChainPosition(skeleton, joint, blocks[0], blocks + 1, position);
    for (int i = 0; i < 3; ++i) {
      residuals[i] = T(0.0);
      for (int k = 0; k < 3; ++k) residuals[i] += kWhitening(i, k) * (position[k] - observed[k]);
    }
    return true;
  }
};

struct VelocityResidual {
  const Skeleton& skeleton;
  int joint;
  int above;
  template <class T>
  bool operator()(T const* const* blocks, T* residuals) const {
    T first[3];
    T next[3];
    ChainPosition(skeleton, joint, blocks[0], blocks + 1, first);
    ChainPosition(skeleton, joint, blocks[1 + above], blocks + 2 + above, next);
    for (int i = 0; i < 3; ++i) residuals[i] = kWeight * (next[i] - first[i]);
    return true;
  }
};

template <class Functor>
ceres::DynamicAutoDiffCostFunction<Functor> Automatic(Functor functor, const ceres::CostFunction& like) {
  ceres::DynamicAutoDiffCostFunction<Functor> cost(new Functor(functor));
  for (const int size : like.parameter_block_sizes()) cost.AddParameterBlock(size);
  cost.SetNumResiduals(like.num_residuals());
  return cost;
}

TEST_P(CostJacobian, OfJointPosition) {
  for (int joint = 0; joint < kJointsOfBent; ++joint) {
    for (const bool zero_residual : {false, true}) {
      const Vector3d observed = zero_residual ? state_.position(0, joint) : Vector3d(0.3, -0.2, 0.5);
      const JointPositionCost cost(state_, 0, joint, observed, kWhitening);
      const auto automatic = Automatic(PositionResidual{skeleton_, joint, observed}, cost);
      EXPECT_JACOBIAN(At(cost, cost.Blocks(state_)), automatic, 1e-9);
    }
  }
}

TEST_P(CostJacobian, OfJointVelocity) {
  for (int joint = 0; joint < kJointsOfBent; ++joint) {
    const JointVelocityCost cost(state_, 0, joint, kWeight);
    const int above = static_cast<int>(state_.path(joint).size());
    const auto automatic = Automatic(VelocityResidual{skeleton_, joint, above}, cost);
    EXPECT_JACOBIAN(At(cost, cost.Blocks(state_)), automatic, 1e-9);
  }
}

/// Log(target^T G) of the chain's active joints from the root to the joint inclusive.
struct RecordedResidual {
  int blocks_above;
  Quaterniond target;
  template <class T>
  bool operator()(T const* const* blocks, T* residuals) const {
    T turned[4] = {T(target.w()), T(-target.x()), T(-target.y()), T(-target.z())};
    for (int b = 0; b < blocks_above; ++b) {
      T own[4];
      T product[4];
      ceres::AngleAxisToQuaternion(blocks[b], own);
      ceres::QuaternionProduct(turned, own, product);
      std::copy(product, product + 4, turned);
    }
    ceres::QuaternionToAngleAxis(turned, residuals);
    for (int i = 0; i < 3; ++i) residuals[i] *= kWeight;
    return true;
  }
};

TEST_P(CostJacobian, OfJointRotation) {
  for (int joint = 0; joint < kJointsOfBent; ++joint) {
    const Quaterniond here(state_.global(0, joint));
    for (const Vector3d& away : {Vector3d(0.3, -0.2, 0.5), Vector3d(1.5, 0.4, -1.0)}) {
      const JointRotationCost cost(state_, 0, joint, here * ExpQuaternion(away), kWeight);
      const auto blocks = cost.Blocks(state_);
      const auto automatic =
          Automatic(RecordedResidual{static_cast<int>(blocks.size()), here * ExpQuaternion(away)}, cost);
      EXPECT_JACOBIAN(At(cost, blocks), automatic, 1e-9);
    }
  }
}

struct TurnResidual {
  template <class T>
  bool operator()(const T* first, const T* next, T* residuals) const {
    const T back[3] = {-first[0], -first[1], -first[2]};
    T a[4];
    T b[4];
    T turn[4];
    ceres::AngleAxisToQuaternion(back, a);
    ceres::AngleAxisToQuaternion(next, b);
    ceres::QuaternionProduct(a, b, turn);
    ceres::QuaternionToAngleAxis(turn, residuals);
    for (int i = 0; i < 3; ++i) residuals[i] *= kWeight;
    return true;
  }
};

TEST_P(CostJacobian, OfAKnownPose) {
  PoseGaussian pose;
  pose.joints = {0, 1, 3};
  pose.translation = state_.position(0, 0) + Vector3d(0.1, 0.2, -0.1);
  for (const int j : pose.joints) pose.rotation.push_back(state_.local(0, j) * ExpMatrix(Vector3d(0.3 * j, -0.2, 0.4)));
  pose.whitening = Eigen::MatrixXd::Zero(12, 12);
  for (int r = 0; r < 12; ++r) {
    for (int c = 0; c <= r; ++c) pose.whitening(r, c) = r == c ? 3.0 + r : 0.1 * (r - 2 * c);
  }
  const PoseGaussianCost cost(state_, 0, pose);
  const CostAt at = At(cost, cost.Blocks(state_));
  Jacobians analytic;
  ResidualsOf(at, &analytic);
  EXPECT_TRUE(SameJacobians(analytic, NumericJacobians(at, 1e-4), 1e-8, "numeric"));
}

TEST_P(CostJacobian, OfRotationSmoothness) {
  const ceres::AutoDiffCostFunction<TurnResidual, 3, 3, 3> automatic(new TurnResidual);
  const RotationSmoothnessCost cost(state_, 0, 1, kWeight);
  const std::vector<double*> blocks{state_.rotation(0, 1), state_.rotation(1, 1)};
  EXPECT_JACOBIAN(At(cost, blocks), automatic, 1e-8);
  // Residual exactly zero: the next frame is this one.
  Eigen::Map<Vector3d>(blocks[1]).noalias() = Eigen::Map<const Vector3d>(blocks[0]);
  EXPECT_JACOBIAN(At(cost, blocks), automatic, 1e-8);
  // Nearly 180 degrees between the two.
  Eigen::Map<Vector3d>(blocks[1]).noalias() =
      LogQuaternion(ExpQuaternion(Eigen::Map<const Vector3d>(blocks[0])) * ExpQuaternion(Vector3d(3.0, 0.5, -0.3)));
  EXPECT_JACOBIAN(At(cost, blocks), automatic, 1e-7);
}

struct ScaledDifference {
  Vector3d centre;
  double weight;
  template <class T>
  bool operator()(const T* w, T* residuals) const {
    for (int i = 0; i < 3; ++i) residuals[i] = weight * (w[i] - centre[i]);
    return true;
  }
};

TEST_P(CostJacobian, OfRestPrior) {
  const RestPriorCost cost(0.5);
  const ceres::AutoDiffCostFunction<ScaledDifference, 3, 3> automatic(new ScaledDifference{Vector3d::Zero(), 2.0});
  EXPECT_JACOBIAN(At(cost, {state_.rotation(0, 1)}), automatic, 1e-9);
}

struct OneSided {
  JointLimits limits;
  double weight;
  template <class T>
  bool operator()(const T* w, T* residuals) const {
    for (int i = 0; i < 3; ++i) {
      residuals[i] = T(0.0);
      if (w[i] > limits.max[i]) residuals[i] = weight * (w[i] - limits.max[i]);
      if (w[i] < limits.min[i]) residuals[i] = weight * (w[i] - limits.min[i]);
    }
    return true;
  }
};

TEST_P(CostJacobian, OfJointLimits) {
  JointLimits limits;
  limits.min = Vector3d(-0.2, -0.4, 0.1);  // the third component is outside at the identity
  limits.max = Vector3d(0.3, 0.2, 0.5);
  const JointLimitCost cost(limits, 0.1);
  const ceres::AutoDiffCostFunction<OneSided, 3, 3> automatic(new OneSided{limits, 10.0});
  EXPECT_JACOBIAN(At(cost, {state_.rotation(0, 1)}), automatic, 1e-8);
}

TEST_P(CostJacobian, OfHinges) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const std::vector<std::optional<Hinge>> hinges = HingesOf(*skeleton);
  int count = 0;
  for (const std::optional<Hinge>& hinge : hinges) {
    if (!hinge) continue;
    ++count;
    const HingeCost cost(*hinge, 0.2);
    Jacobians jacobians;
    ResidualsOf(At(cost, {state_.rotation(0, 1)}), &jacobians);
    EXPECT_TRUE(SameJacobians(jacobians, NumericJacobians(At(cost, {state_.rotation(0, 1)}), 1e-6), 1e-6, "numeric"));
  }
  EXPECT_EQ(count, 4) << "knees and elbows";
}

TEST(Hinges, AllowOneBendingDirectionAndTwist) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const std::vector<std::optional<Hinge>> hinges = HingesOf(*skeleton);
  const auto off = [&](const char* joint, const Vector3d& bend, double twist) {
    const Hinge& hinge = *hinges[static_cast<std::size_t>(*skeleton->FindJoint(joint))];
    return OffHinge(hinge, ExpMatrix(bend) * ExpMatrix(twist * hinge.bone));
  };
  for (const double twist : {-1.5, 0.0, 1.0}) {
    for (const double bend : {0.0, 0.7, 1.5, 2.5}) {
      EXPECT_NEAR(off("left_elbow", {0.0, -bend, 0.0}, twist).norm(), 0.0, 1e-9) << bend;
      EXPECT_NEAR(off("right_elbow", {0.0, bend, 0.0}, twist).norm(), 0.0, 1e-9) << bend;
      EXPECT_LT(off("left_knee", {bend, 0.0, 0.0}, twist).norm(), 0.05) << bend;
      EXPECT_LT(off("right_knee", {bend, 0.0, 0.0}, twist).norm(), 0.05) << bend;
    }
    EXPECT_NEAR(off("left_elbow", {0.0, 0.8, 0.0}, twist)[1], 0.2 - std::sin(0.8), 1e-9) << "bent backwards";
    EXPECT_NEAR(std::abs(off("left_elbow", {0.0, 0.0, 0.6}, twist)[0]), std::sin(0.6), 1e-9) << "to the side";
    EXPECT_LT(off("right_knee", {-0.8, 0.0, 0.0}, twist)[1], -0.4);
  }
}

TEST(JointLimits, HaveZeroCostInside) {
  const JointLimitCost cost(JointLimits{}, 0.1);
  double w[3] = {0.5, -1.0, 2.0};
  EXPECT_EQ(ResidualsOf({&cost, {w}}), (std::vector<double>{0.0, 0.0, 0.0}));
}

TEST(RotationSmoothness, IsIndependentOfTheBranchOfTheLogarithm) {
  const Skeleton skeleton = BentChain();
  PoseState state(skeleton, 2, skeleton.RestBoneLengths(), std::vector<bool>(kJointsOfBent, true));
  const Vector3d axis = Vector3d(1.0, 2.0, -1.0).normalized();
  Eigen::Map<Vector3d>(state.rotation(0, 1)).noalias() = 0.5 * axis;
  Eigen::Map<Vector3d>(state.rotation(1, 1)).noalias() = (0.6 - 2.0 * EIGEN_PI) * axis;
  state.Update(0, 2, true);
  const RotationSmoothnessCost cost(state, 0, 1, 1.0);
  const std::vector<double> residual = ResidualsOf({&cost, {state.rotation(0, 1), state.rotation(1, 1)}});
  EXPECT_NEAR(Eigen::Map<const Vector3d>(residual.data()).norm(), 0.1, 1e-12);
}

}  // namespace
}  // namespace mocurate
