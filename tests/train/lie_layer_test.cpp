#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "tests/train/chains.h"
#include "train/data/batches.h"
#include "train/layers/lie_kinematics.h"

namespace mocurate {
namespace {

// Central differences of <g, Forward(y)> in float32 against the analytic derivative, near a pose of size `angle`.
void CheckDerivative(const LieChains& chains, LieExp exp, double angle, double step, double tolerance) {
  const LieLayer layer(chains, exp);
  const std::size_t J = static_cast<std::size_t>(layer.joint_count());
  Random random(3, "lie_layer");
  std::vector<float> y(3 * J), g(3 * J), length(J), p(3 * J), gradient(3 * J);
  for (float& v : y) v = static_cast<float>(angle * random.Normal());
  for (float& v : g) v = static_cast<float>(random.Normal());
  for (float& v : length) v = static_cast<float>(random.Uniform(0.1, 0.5));
  layer.Backward(y.data(), length.data(), g.data(), 1, gradient.data());
  const auto value = [&](std::size_t k, double change) {
    std::vector<float> moved = y;
    moved[k] += static_cast<float>(change);
    layer.Forward(moved.data(), length.data(), 1, p.data());
    double sum = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += static_cast<double>(g[i]) * p[i];
    return std::pair<double, double>(sum, moved[k]);
  };
  for (std::size_t k = 0; k < y.size(); ++k) {
    const auto [high, at_high] = value(k, step);
    const auto [low, at_low] = value(k, -step);
    EXPECT_NEAR(gradient[k], (high - low) / (at_high - at_low), tolerance) << k << " at angles of " << angle;
  }
}

TEST(LieLayer, TheDerivativeAgreesWithDifferences) {
  for (const LieExp exp : {LieExp::kReleased, LieExp::kExact}) {
    for (const double angle : {0.1, 0.7, 2.0}) CheckDerivative(HumanAct12Chains(), exp, angle, 2e-3, 3e-3);
  }
  CheckDerivative(HumanAct12Chains(), LieExp::kExact, 1e-3, 2e-3, 3e-3);
  CheckDerivative(HumanAct12Chains(), LieExp::kExact, 0.0, 2e-3, 3e-3);
}

TEST(LieLayer, JointsEqualTheKinematicsOfTheCore) {
  Skeleton skeleton;
  skeleton.name = "humanact12";
  skeleton.lie = HumanAct12Chains();
  skeleton.joints.resize(24);
  const LieLayer layer(*skeleton.lie, LieExp::kReleased);
  for (std::size_t j = 0; j < 24; ++j) skeleton.joints[j].parent = j == 0 ? -1 : layer.parents()[j];
  Random random(5, "lie_layer");
  std::vector<float> y(72), length(24), p(72);
  for (float& v : y) v = static_cast<float>(random.Normal());
  for (float& v : length) v = static_cast<float>(random.Uniform(0.1, 0.5));
  layer.Forward(y.data(), length.data(), 1, p.data());
  const std::vector<double> parameters(y.begin(), y.end()), bones(length.begin(), length.end());
  std::vector<Vector3d> joints(24);
  LieForward(skeleton, parameters.data(), bones, LieExp::kReleased, joints.data());
  for (std::size_t j = 0; j < 24; ++j) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(p[3 * j + k], joints[j][k], 1e-6) << j;
  }
}

TEST(LieLayer, ChainsOfATreeWithoutAnyCoverEveryJointOnce) {
  const LieChains chains = ChainsOf(*SmallSkeleton());
  ASSERT_EQ(chains.chains.size(), 2u);
  EXPECT_EQ(chains.chains[0], (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(chains.chains[1], (std::vector<int>{0, 3, 4}));
  EXPECT_NEAR((chains.raw_offsets[4] - Vector3d(0, -1, 0)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace mocurate
