#include "fitting/clouds/capsule_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fitting/clouds/cloud_body.h"

namespace mocurate {
namespace {

/// PoseCost of a body with these rotation vectors of hips and knees (radians), against four points on its chest.
double CostOfLegs(const Vector3d& hip, const Vector3d& knee) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const CapsuleBody body = CapsuleBody::Make(skeleton, 1.0, 1.0);
  PoseState state(*skeleton, 1, skeleton->RestBoneLengths(), body.MovingJoints());
  for (const char* side : {"left_", "right_"}) {
    Eigen::Map<Vector3d>(state.rotation(0, *skeleton->FindJoint(std::string(side) + "hip"))) = hip;
    Eigen::Map<Vector3d>(state.rotation(0, *skeleton->FindJoint(std::string(side) + "knee"))) = knee;
  }
  state.Update(0, 1, false);
  FusedCloud cloud;
  const int chest = *skeleton->FindJoint("spine3");
  cloud.points = Eigen::Matrix3Xd(3, 4);
  cloud.normals = Eigen::Matrix3Xd(3, 4);
  for (int i = 0; i < 4; ++i) {
    cloud.points.col(i) = state.position(0, chest) + Vector3d(0.03 * i, 0.05, 0.12);
    cloud.normals.col(i) = Vector3d::UnitZ();
  }
  return PoseCost(body, cloud, state, 0, PointCloudOptions());
}

TEST(PoseCost, RisesWhereLegsIntersectTheUpperBody) {
  const double standing = CostOfLegs(Vector3d::Zero(), Vector3d::Zero());
  EXPECT_NEAR(CostOfLegs({-1.5, 0.0, 0.0}, {1.5, 0.0, 0.0}), standing, 10.0) << "seated";
  EXPECT_NEAR(CostOfLegs({-1.9, 0.0, 0.0}, {2.4, 0.0, 0.0}), standing, 20.0) << "squatting";
  EXPECT_GT(CostOfLegs({-3.1, 0.0, 0.0}, Vector3d::Zero()), standing + 90.0) << "thighs and shins up in the chest";
}

TEST(BodyRotations, AreErrorsOfBoneEndsOverBoneLengths) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const std::vector<double> length = skeleton->RestBoneLengths();
  const std::vector<Vector3d> variance = BodyRotations(*skeleton, length, std::vector<double>(24, 0.01));
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
