#include "core/motion/kinematics.h"

#include "tests/motion/builders.h"
#include "tests/motion/lie_inverse.h"

namespace mocurate {
namespace {

using test::Built;
using test::RandomVector;
using test::SwingingPerson;

const char* const kLie[] = {"smpl24",   "humanact12", "ntu18", "cmu20",   "kinect20",
                            "openni15", "openni16",   "a2m21", "bandai22"};

TEST(TreeKinematics, WithoutRotationsGivesTheRestPose) {
  const SkeletonPtr skeleton = Built("smpl24");
  const std::vector<Quaterniond> identity(24, Quaterniond::Identity());
  std::vector<Vector3d> joints(24);
  ForwardKinematics(*skeleton, Vector3d(1, 2, 3), identity.data(), {}, joints.data());
  for (int j = 1; j < 24; ++j) {
    const Vector3d bone = joints[j] - joints[skeleton->joints[j].parent];
    EXPECT_LT((bone - skeleton->joints[j].rest_offset).norm(), 1e-14);
  }
  EXPECT_EQ(joints[0], Vector3d(1, 2, 3));
}

TEST(TreeKinematics, AJointRotatesItsChildrenAndNotItself) {
  const SkeletonPtr skeleton = Built("openni16");
  std::vector<Quaterniond> rotation(16, Quaterniond::Identity());
  const int knee = *skeleton->FindJoint("left_knee"), ankle = *skeleton->FindJoint("left_ankle");
  rotation[knee] = ExpQuaternion(Vector3d(M_PI / 2, 0, 0));
  std::vector<Vector3d> joints(16);
  ForwardKinematics(*skeleton, Vector3d::Zero(), rotation.data(), {}, joints.data());
  const Vector3d shin = joints[ankle] - joints[knee];
  EXPECT_LT((shin - Vector3d(0, 0, -0.41)).norm(), 1e-12) << "a knee bends backwards about +x";
}

TEST(TreeKinematics, BonesHaveThePersonsLengths) {
  const Motion motion = SwingingPerson(Built("smpl24"), 3);
  for (int j = 1; j < 24; ++j) {
    const double length = (motion.joints.at(2, j) - motion.joints.at(2, motion.skeleton->joints[j].parent)).norm();
    EXPECT_NEAR(length, motion.bone_length[j], 1e-12);
  }
}

TEST(LieKinematics, InverseUndoesForwardInPositions) {
  for (const char* name : kLie) {
    const SkeletonPtr skeleton = Built(name);
    const int count = skeleton->joint_count();
    Random random(1, "lie", name);
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<Vector3d> joints(count), again(count);
      for (Vector3d& joint : joints) joint = RandomVector(random, 0.5);
      std::vector<double> parameters(3 * count);
      LieInverse(*skeleton, joints.data(), parameters.data());
      LieForward(*skeleton, parameters.data(), BoneLengths(*skeleton, joints.data()), LieExp::kExact, again.data());
      for (int j = 0; j < count; ++j) EXPECT_LT((joints[j] - again[j]).norm(), 1e-12) << name;
    }
  }
}

TEST(LieKinematics, BonesAlongAndAgainstTheirRawOffsetsAreExact) {
  const SkeletonPtr skeleton = Built("humanact12");
  for (const double sign : {1.0, -1.0}) {
    std::vector<Vector3d> joints(24, Vector3d::Zero()), again(24);
    const std::vector<int> parents = skeleton->LieParents();
    for (int j = 1; j < 24; ++j) joints[j] = joints[parents[j]] + sign * 0.3 * skeleton->lie->raw_offsets[j];
    std::vector<double> parameters(72);
    LieInverse(*skeleton, joints.data(), parameters.data());
    LieForward(*skeleton, parameters.data(), BoneLengths(*skeleton, joints.data()), LieExp::kExact, again.data());
    for (int j = 0; j < 24; ++j) EXPECT_LT((joints[j] - again[j]).norm(), 1e-12) << j;
    if (sign < 0) continue;
    for (const double parameter : parameters) EXPECT_EQ(parameter, 0.0) << "the rest pose has no rotations";
  }
}

TEST(LieKinematics, TreeRotationsConvertWithoutLossOfPositions) {
  for (const char* name : kLie) {
    const Motion motion = SwingingPerson(Built(name), 5);
    const int count = motion.joint_count();
    std::vector<double> parameters(3 * count);
    std::vector<Vector3d> joints(count);
    for (int f = 0; f < 5; ++f) {
      LieFromTree(motion, f, parameters.data());
      LieForward(*motion.skeleton, parameters.data(), motion.bone_length, LieExp::kExact, joints.data());
      for (int j = 0; j < count; ++j) EXPECT_LT((joints[j] - motion.joints.at(f, j)).norm(), 1e-12) << name;
    }
  }
}

}  // namespace
}  // namespace mocurate
