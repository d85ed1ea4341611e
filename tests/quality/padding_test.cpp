// Frames that programs append so that all motions of a file are equally long.

#include "core/quality/padding.h"

#include <gtest/gtest.h>

#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

constexpr int kMoving = 12;

/// Joints that move for kMoving frames; then `repeats` copies of the last pose, then `zeros`.
Motion PaddedJoints(int repeats, int zeros, int moving = kMoving) {
  const SkeletonPtr skeleton = LoadSkeleton("smpl24").value();
  JointPositions joints(moving + repeats + zeros, skeleton->joint_count());
  for (int f = 0; f < moving + repeats; ++f) {
    for (int j = 0; j < joints.joints; ++j) joints.at(f, j) = Vector3d(0.1 * std::min(f, moving - 1), 0.05 * j, 1.0);
  }
  return MakeJointsOnly(skeleton, FrameRate{30, 1}, std::move(joints));
}

/// Rotations that change for kMoving frames; then `rest` frames at rest with the root at `root`.
Motion PaddedRotations(int rest, const Vector3d& root) {
  const SkeletonPtr skeleton = LoadSkeleton("smpl24").value();
  const int frames = kMoving + rest, joints = skeleton->joint_count();
  std::vector<Vector3d> places;
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(frames * joints), Quaterniond::Identity());
  for (int f = 0; f < frames; ++f) {
    places.push_back(f < kMoving ? Vector3d(0.1 * f, 0.9, 0.0) : root);
    rotation[static_cast<std::size_t>(f * joints)] = ExpQuaternion(Vector3d(-1.5, 0.0, 0.0));  // of z up
    if (f < kMoving) rotation[static_cast<std::size_t>(f * joints + 3)] = ExpQuaternion(Vector3d(0.1, 0.02 * f, 0.0));
  }
  return MakeMotion(skeleton, FrameRate{30, 1}, std::move(places), std::move(rotation), {});
}

TEST(Padding, OfZerosIsFoundInAnyFile) {
  for (const bool repeats : {false, true}) {
    EXPECT_EQ(FramesWithoutPadding(PaddedJoints(0, 0), repeats), kMoving);
    EXPECT_EQ(FramesWithoutPadding(PaddedJoints(0, 1), repeats), kMoving);
    EXPECT_EQ(FramesWithoutPadding(PaddedJoints(0, 20), repeats), kMoving);
    EXPECT_EQ(FramesWithoutPadding(PaddedJoints(0, 20, 0), repeats), 0) << "nothing but zeros";
    EXPECT_EQ(FramesWithoutPadding(PaddedRotations(1, Vector3d::Zero()), repeats), kMoving);
  }
}

TEST(Padding, OfRepeatsIsFiveAndMoreAndOnlyOfOtherPrograms) {
  EXPECT_EQ(FramesWithoutPadding(PaddedJoints(kPaddingRepeats, 0), true), kMoving);
  EXPECT_EQ(FramesWithoutPadding(PaddedJoints(20, 7), true), kMoving) << "repeats, then zeros";
  EXPECT_EQ(FramesWithoutPadding(PaddedJoints(kPaddingRepeats - 1, 0), true), kMoving + kPaddingRepeats - 1);
  EXPECT_EQ(FramesWithoutPadding(PaddedJoints(20, 0), false), kMoving + 20);
  EXPECT_EQ(FramesWithoutPadding(PaddedJoints(20, 0, 1), true), 21) << "one pose all the time";
  Motion still = PaddedJoints(20, 0);
  for (int f = kMoving; f < still.frame_count(); ++f) still.joints.at(f, 3).x() += 1e-9 * f;
  EXPECT_EQ(FramesWithoutPadding(still, true), kMoving + 20) << "a person who stands still";
}

TEST(Padding, OfTheRestPoseIsNoLastPose) {
  const Vector3d root(0.3, 0.9, 0.0);
  EXPECT_EQ(FramesWithoutPadding(PaddedRotations(kPaddingRepeats + 1, root), true), kMoving);
  EXPECT_EQ(FramesWithoutPadding(PaddedRotations(kPaddingRepeats + 1, root), false), kMoving + kPaddingRepeats + 1);
}

}  // namespace
}  // namespace mocurate
