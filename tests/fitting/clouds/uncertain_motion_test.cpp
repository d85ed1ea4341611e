#include "fitting/clouds/cloud_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mocurate {
namespace {

/// Of two joints in one frame: the first is determined, the second hardly.
PosePosterior OfTwoJoints() {
  PosePosterior posterior;
  posterior.position.assign(2, 1e-4 * Matrix3d::Identity());
  posterior.prior.assign(2, Vector3d::Constant(0.25));
  posterior.rotation = {Vector3d::Constant(0.01), Vector3d::Constant(0.2)};
  return posterior;
}

TEST(UncertainMotion, RotationsAreAtMostAsUncertainAsThePriorAndObservedAccordingly) {
  UncertainMotion uncertain(1, {Vector3d::Constant(kUnknownAngle), Vector3d::Constant(0.04)});
  uncertain.Set(0, OfTwoJoints(), 0.1);
  Motion motion;
  uncertain.Write(motion);
  EXPECT_NEAR(motion.position_cov[0], 0.0101, 1e-6);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(motion.rotation_sigma[i], std::sqrt(0.01 + 0.16), 1e-6) << "0.1 m at the end of 0.25 m";
    EXPECT_NEAR(motion.rotation_observed[i], 1.0 - 0.17 / 0.25, 1e-6);
    EXPECT_NEAR(motion.rotation_sigma[3 + i], 0.5, 1e-6) << "the sum of 0.36 is capped";
    EXPECT_NEAR(motion.rotation_observed[3 + i], 0.0, 1e-6);
  }
}

TEST(UncertainMotion, JointsThatDoNotMoveKeepTheirRotation) {
  UncertainMotion uncertain(1, {Vector3d::Constant(kUnknownAngle), Vector3d::Constant(0.04)});
  uncertain.Set(0, OfTwoJoints());
  PosePosterior other = OfTwoJoints();
  other.rotation.assign(2, Vector3d::Constant(0.04));
  uncertain.Replace(0, other, {true, false});
  Motion motion;
  uncertain.Write(motion);
  EXPECT_NEAR(motion.rotation_sigma[0], 0.2, 1e-6);
  EXPECT_NEAR(motion.rotation_sigma[3], std::sqrt(0.2), 1e-6);
}

TEST(WidenRotation, IsAtMostThePriorAndLowersWhatIsObserved) {
  float sigma = 0.2F, observed = 0.84F;  // of a prior of 0.25 rad^2
  WidenRotation(0.06, sigma, observed);
  EXPECT_NEAR(sigma * sigma, 0.1, 1e-6);
  EXPECT_NEAR(observed, 0.6, 1e-6);
  WidenRotation(4.0, sigma, observed);
  EXPECT_NEAR(sigma, 0.5, 1e-6);
  EXPECT_NEAR(observed, 0.0, 1e-6);
  WidenRotation(4.0, sigma, observed);
  EXPECT_NEAR(sigma, 0.5, 1e-6) << "nothing is left to lose";
}

}  // namespace
}  // namespace mocurate
