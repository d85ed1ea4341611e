#include <ceres/jet.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "core/base/random.h"
#include "fitting/clouds/cloud_problem.h"

namespace mocurate {
namespace {

constexpr int kJointsOfBranched = 5;
constexpr int kParameters = 3 + 3 * kJointsOfBranched;  ///< translation, rotation vectors
const std::array<double, kJointsOfBranched> kBones = {0.0, 0.3, 0.35, 0.4, 0.45};
using Jet = ceres::Jet<double, kParameters>;

/// A chain 0-1-2-3 with joint 4 beside joint 2.
Skeleton BranchedChain() {
  Skeleton skeleton;
  const std::array<int, kJointsOfBranched> parents = {-1, 0, 1, 2, 1};
  const std::array<Vector3d, kJointsOfBranched> offsets = {Vector3d::Zero(), Vector3d(0.1, 0.3, 0.0),
                                                           Vector3d(0.0, -0.4, 0.1), Vector3d(0.2, 0.1, 0.0),
                                                           Vector3d(-0.3, 0.0, 0.1)};
  for (int j = 0; j < kJointsOfBranched; ++j) {
    Joint joint;
    joint.name = "j" + std::to_string(j);
    joint.parent = parents[j];
    joint.rest_offset = offsets[j];
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

template <class T>
std::array<T, 3> InWorld(const Skeleton& skeleton, const T* parameters, int joint, std::array<T, 3> x) {
  for (int j = joint; j >= 0; j = skeleton.joints[j].parent) {
    std::array<T, 3> turned;
    ceres::AngleAxisRotatePoint(parameters + 3 + 3 * j, x.data(), turned.data());
    const Vector3d along = skeleton.joints[j].rest_offset.stableNormalized();
    for (int i = 0; i < 3; ++i) x[i] = turned[i] + kBones[j] * along[i];
  }
  for (int i = 0; i < 3; ++i) x[i] += parameters[i];
  return x;
}

/// Independent implementation of the residual, for any number type.
template <class T>
T Residual(const Skeleton& skeleton, const BodyCapsule& capsule, const Vector3d& point, double weight,
           const T* parameters) {
  std::array<T, 3> begin{T(capsule.begin_offset.x()), T(capsule.begin_offset.y()), T(capsule.begin_offset.z())};
  std::array<T, 3> end{T(capsule.end_offset.x()), T(capsule.end_offset.y()), T(capsule.end_offset.z())};
  if (capsule.end_joint != capsule.frame) {
    const Vector3d along = skeleton.joints[capsule.end_joint].rest_offset.normalized();
    for (int i = 0; i < 3; ++i) end[i] += kBones[capsule.end_joint] * along[i];
  }
  begin = InWorld(skeleton, parameters, capsule.frame, begin);
  end = InWorld(skeleton, parameters, capsule.frame, end);
  T along(0.0), square(0.0), distance(0.0);
  for (int i = 0; i < 3; ++i) {
    along += (point[i] - begin[i]) * (end[i] - begin[i]);
    square += (end[i] - begin[i]) * (end[i] - begin[i]);
  }
  T place = along / square;
  if (place < T(0.0)) place = T(0.0);
  if (place > T(1.0)) place = T(1.0);
  for (int i = 0; i < 3; ++i) {
    const T away = point[i] - begin[i] - place * (end[i] - begin[i]);
    distance += away * away;
  }
  return weight * (sqrt(distance) - capsule.radius);
}

/// One random pose, capsule and point.
struct CapsuleCase {
  Skeleton skeleton = BranchedChain();
  BodyCapsule capsule;
  Vector3d point;
  std::array<double, kParameters> parameters;
  double weight = 7.0;

  explicit CapsuleCase(std::uint64_t item) {
    Random random = Random(20240607, "capsule_cost", std::to_string(item));
    const auto vector = [&](double scale) {
      return Vector3d(scale * random.Normal(), scale * random.Normal(), scale * random.Normal());
    };
    const bool is_bone = item % 2 == 0;
    capsule.frame = is_bone ? 2 : 4;
    capsule.end_joint = is_bone ? 3 : 4;
    capsule.begin_offset = vector(0.03);
    capsule.end_offset = vector(0.08);
    capsule.radius = 0.05;
    for (double& value : parameters) value = 0.6 * random.Normal();
    point = vector(0.7);
  }
};

/// The cost's own residual; its Jacobian is scattered over all parameters.
double Evaluate(const CapsuleCase& given, std::array<double, kParameters>& gradient) {
  PoseState state(given.skeleton, 1, {kBones.begin(), kBones.end()}, std::vector<bool>(kJointsOfBranched, true));
  std::copy(given.parameters.begin(), given.parameters.end(), state.translation(0));
  state.Update(0, 1, true);
  const CapsuleDistanceCost cost(state, 0, given.capsule, given.point, given.weight);
  const std::vector<double*> blocks = cost.Blocks(state);
  EXPECT_EQ(blocks.size(), cost.parameter_block_sizes().size());
  std::vector<std::array<double, 3>> values(blocks.size());
  std::vector<double*> jacobians;
  for (auto& value : values) jacobians.push_back(value.data());
  double residual = 0.0;
  EXPECT_TRUE(cost.Evaluate(blocks.data(), &residual, jacobians.data()));
  gradient.fill(0.0);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (int i = 0; i < cost.parameter_block_sizes()[b]; ++i) {
      gradient[static_cast<std::size_t>(blocks[b] - state.translation(0)) + i] = values[b][i];
    }
  }
  return residual;
}

TEST(CapsuleDistanceCost, ResidualIsTheWeightedDistanceToTheSurface) {
  for (std::uint64_t item = 0; item < 40; ++item) {
    const CapsuleCase given(item);
    std::array<double, kParameters> gradient;
    const double expected = Residual(given.skeleton, given.capsule, given.point, given.weight, given.parameters.data());
    EXPECT_NEAR(Evaluate(given, gradient), expected, 1e-12);
  }
}

TEST(CapsuleDistanceCost, JacobianMatchesAutomaticDifferentiation) {
  for (std::uint64_t item = 0; item < 40; ++item) {
    const CapsuleCase given(item);
    std::array<double, kParameters> gradient;
    Evaluate(given, gradient);
    std::array<Jet, kParameters> jets;
    for (int i = 0; i < kParameters; ++i) jets[i] = Jet(given.parameters[i], i);
    const Jet expected = Residual(given.skeleton, given.capsule, given.point, given.weight, jets.data());
    for (int i = 0; i < kParameters; ++i) EXPECT_NEAR(gradient[i], expected.v[i], 1e-10) << item << " " << i;
  }
}

TEST(CapsuleDistanceCost, JacobianMatchesNumericDifferences) {
  constexpr double kStep = 1e-6;
  for (std::uint64_t item = 0; item < 10; ++item) {
    CapsuleCase given(item);
    std::array<double, kParameters> gradient;
    std::array<double, kParameters> ignored;
    Evaluate(given, gradient);
    for (int i = 0; i < kParameters; ++i) {
      const double value = given.parameters[i];
      given.parameters[i] = value + kStep;
      const double above = Evaluate(given, ignored);
      given.parameters[i] = value - kStep;
      const double below = Evaluate(given, ignored);
      given.parameters[i] = value;
      EXPECT_NEAR(gradient[i], (above - below) / (2.0 * kStep), 1e-6) << item << " " << i;
    }
  }
}

}  // namespace
}  // namespace mocurate
