#include "fitting/clouds/cloud_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mocurate {
namespace {

/// Of two joints in one frame: the first is determined, the second hardly.
CloudUncertainty OfTwoJoints() {
  CloudUncertainty uncertainty;
  uncertainty.position.assign(2, 1e-4 * Matrix3d::Identity());
  uncertainty.prior = {0.25, 0.25};
  uncertainty.rotation = {Vector3d::Constant(0.01), Vector3d::Constant(0.2)};
  return uncertainty;
}

TEST(UncertainMotion, RotationsAreAtMostAsUncertainAsThePriorAndObservedAccordingly) {
  const std::vector<Vector3d> of_body(2, Vector3d::Constant(0.09));
  for (const bool replaced : {false, true}) {
    UncertainMotion uncertain(1, 2);
    if (replaced)
      uncertain.Replace(0, OfTwoJoints(), {true, true}, of_body);
    else
      uncertain.Set(0, OfTwoJoints(), {0.0, 0.0}, of_body);
    Motion motion;
    uncertain.Write(motion);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(motion.rotation_sigma[i], std::sqrt(0.1), 1e-6);
      EXPECT_NEAR(motion.rotation_observed[i], 0.6, 1e-6);
      EXPECT_NEAR(motion.rotation_sigma[3 + i], 0.5, 1e-6) << "the sum of 0.29 is capped";
      EXPECT_NEAR(motion.rotation_observed[3 + i], 0.0, 1e-6);
    }
  }
}

TEST(UncertainMotion, JointsThatDoNotMoveKeepTheirRotation) {
  UncertainMotion uncertain(1, 2);
  uncertain.Set(0, OfTwoJoints(), {0.0, 0.0}, {Vector3d::Zero(), Vector3d::Zero()});
  CloudUncertainty other = OfTwoJoints();
  other.rotation.assign(2, Vector3d::Constant(0.04));
  uncertain.Replace(0, other, {true, false}, {Vector3d::Zero(), Vector3d::Zero()});
  Motion motion;
  uncertain.Write(motion);
  EXPECT_NEAR(motion.rotation_sigma[0], 0.2, 1e-6);
  EXPECT_NEAR(motion.rotation_sigma[3], std::sqrt(0.2), 1e-6);
}

}  // namespace
}  // namespace mocurate
