#include "fitting/clouds/capsule_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fitting/clouds/cloud_uncertainty.h"

namespace mocurate {
namespace {

TEST(BodyRotations, AreErrorsOfBoneEndsOverBoneLengths) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const std::vector<double> length = skeleton->RestBoneLengths();
  const std::vector<Vector3d> variance = BodyRotations(*skeleton, length, std::vector<double>(24, 0.01), {});
  const int knee = *skeleton->FindJoint("left_knee"), ankle = *skeleton->FindJoint("left_ankle");
  const double across = std::sqrt(2.0) * 0.01 / length[static_cast<std::size_t>(ankle)];
  EXPECT_NEAR(std::sqrt(variance[static_cast<std::size_t>(knee)].x()), across, 1e-9);
  EXPECT_NEAR(std::sqrt(variance[static_cast<std::size_t>(knee)].z()), across, 1e-9);
  EXPECT_NEAR(variance[static_cast<std::size_t>(knee)].y(), 0.0, 1e-12)
      << "no bone determines the rotation about the shin";
  for (int i = 0; i < 3; ++i) EXPECT_GT(variance[0][i], 0.0) << "several bones start at the pelvis";
}

}  // namespace
}  // namespace mocurate
