// How deep the limbs of a person lie inside the person.
#include "tests/body/self_penetration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/pi.h"
#include "core/base/random.h"
#include "core/body/bone_capsules.h"
#include "core/body/capsule_body.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "tests/body/stick_figure.h"

namespace mocurate {
namespace {

int JointOf(const Skeleton& skeleton, const char* name) { return skeleton.FindJoint(name).value(); }

/// A person of smpl24 whose joints are in the rest pose, `frames` long.
Motion AtRest(int frames, double size = 1.0) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  std::vector<double> lengths = skeleton->RestBoneLengths();
  for (double& length : lengths) length *= size;
  const std::size_t count = static_cast<std::size_t>(frames) * skeleton->joints.size();
  return MakeMotion(skeleton, FrameRate{20, 1},
                    std::vector<Vector3d>(static_cast<std::size_t>(frames), Vector3d(0, 0.95, 0)),
                    std::vector<Quaterniond>(count, Quaterniond::Identity()), lengths);
}

/// The left upper arm hangs while the forearm turns from hanging to level, inwards, 6 degrees a frame: at last the hand
/// has gone through the trunk. Frame 0 is the rest pose.
Motion ArmThroughTrunk() {
  Motion motion = AtRest(16);
  for (int f = 1; f < motion.frame_count(); ++f) {
    motion.rotation_at(f, JointOf(*motion.skeleton, "left_shoulder")) = ExpQuaternion(Vector3d(0, 0, -0.5 * kPi));
    motion.rotation_at(f, JointOf(*motion.skeleton, "left_elbow")) = ExpQuaternion(Vector3d(0, 0, -f * kPi / 30));
  }
  ComputeJoints(motion);
  return motion;
}

/// Depth of the left forearm and hand in the rest of the body, by points along their axes, without the formula of two
/// segments.
double DepthByPoints(const Motion& motion, int frame) {
  const Skeleton& skeleton = *motion.skeleton;
  const CapsuleBody body = CapsuleBody::Make(motion.skeleton, 1.0);
  std::vector<Vector3d> joints(skeleton.joints.size());
  std::vector<Quaterniond> frames(skeleton.joints.size());
  ForwardKinematics(skeleton, motion.root_translation[static_cast<std::size_t>(frame)], &motion.rotation_at(frame, 0),
                    motion.bone_length, joints.data(), frames.data());
  const auto posed = PosedCapsules(body, joints.data(), frames.data());
  double deepest = 0.0;
  for (std::size_t a = 0; a < posed.size(); ++a) {
    const std::string& limb = skeleton.joints[static_cast<std::size_t>(body.capsules[a].frame)].name;
    if (limb != "left_elbow" && limb != "left_wrist") continue;
    for (std::size_t b = 0; b < posed.size(); ++b) {
      const std::string& other = skeleton.joints[static_cast<std::size_t>(body.capsules[b].frame)].name;
      if (other == "left_shoulder" || other == "left_elbow" || other == "left_wrist") continue;
      for (int k = 0; k <= 1000; ++k) {
        const Vector3d point = posed[a].begin + 0.001 * k * (posed[a].end - posed[a].begin);
        const double inside = -SignedDistance(posed[b].begin, posed[b].end, posed[b].radius, point);
        deepest = std::max(deepest, inside + posed[a].radius);
      }
    }
  }
  return deepest;
}

TEST(SegmentDistance, IsThatOfTheNearestPoints) {
  EXPECT_NEAR(SegmentDistance({0, 0, 0}, {1, 0, 0}, {0.5, -1, 0.3}, {0.5, 1, 0.3}), 0.3, 1e-15) << "crossing";
  EXPECT_NEAR(SegmentDistance({0, 0, 0}, {1, 0, 0}, {2, 0, 1}, {3, 0, 1}), std::sqrt(2.0), 1e-15) << "parallel, apart";
  EXPECT_NEAR(SegmentDistance({0, 0, 0}, {4, 0, 0}, {3, 0, 1}, {1, 0, 1}), 1.0, 1e-15) << "parallel, beside";
  EXPECT_NEAR(SegmentDistance({0, 0, 0}, {0, 0, 0}, {3, 4, 0}, {3, 4, 0}), 5.0, 1e-15) << "two points";
  EXPECT_NEAR(SegmentDistance({0, 0, 0}, {0, 0, 0}, {-1, 2, 0}, {1, 2, 0}), 2.0, 1e-15) << "a point and a segment";
  Random random(3, "segments");
  const auto draw = [&] { return Vector3d(random.Normal(), random.Normal(), random.Normal()); };
  for (int i = 0; i < 200; ++i) {
    const Vector3d a = draw(), b = draw(), c = draw(), d = draw();
    double sampled = HUGE_VAL;
    for (int k = 0; k <= 2000; ++k) sampled = std::min(sampled, SignedDistance(c, d, 0.0, a + k / 2000.0 * (b - a)));
    EXPECT_LE(SegmentDistance(a, b, c, d), sampled + 1e-12);
    EXPECT_NEAR(SegmentDistance(a, b, c, d), sampled, 1e-3 * (b - a).norm());
    EXPECT_NEAR(SegmentDistance(a, b, c, d), SegmentDistance(d, c, a, b), 1e-12);
  }
}

TEST(SelfPenetration, IsZeroInTheRestPoseOfAPersonOfAnySize) {
  for (const double size : {0.8, 1.0, 1.2}) {
    const auto measured = MeasureSelfPenetration(AtRest(3, size));
    ASSERT_TRUE(measured);
    ASSERT_EQ(measured->depth.size(), 3u);
    for (const double depth : measured->depth) EXPECT_LT(depth, 1e-12);
    EXPECT_EQ(measured->penetrating_share, 0.0);
  }
}

TEST(SelfPenetration, IsTheSumOfRadiiLessTheDistanceOfTheAxes) {
  // Joints only: a hand of radius 0.035 is held level, 0.06 before the axis between pelvis and spine1 of radius 0.12.
  Motion motion = MakeJointsOnly(AtRest(1).skeleton, FrameRate{20, 1}, AtRest(1).joints);
  const Skeleton& skeleton = *motion.skeleton;
  const auto place = [&](const char* name) { return motion.joints.at(0, JointOf(skeleton, name)); };
  place("spine1") = place("pelvis") + Vector3d(0, 0.08, 0);
  const Vector3d at = place("pelvis") + Vector3d(0, 0.04, 0.06);
  place("left_wrist") = at + Vector3d(0.05, 0, 0);
  place("left_hand") = at - Vector3d(0.05, 0, 0);
  std::vector<Vector3d> joints;
  for (int j = 0; j < motion.joint_count(); ++j) joints.push_back(motion.joints.at(0, j));
  const double scale = BodyScale(skeleton, BoneLengths(skeleton, joints.data()));  // moved joints stretch bones
  const auto measured = MeasureSelfPenetration(motion);
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->depth[0], scale * (0.12 + 0.035) - 0.06, 1e-9);
}

TEST(SelfPenetration, OfAHandPushedIntoTheTrunkMatchesTheGeometry) {
  const Motion motion = ArmThroughTrunk();
  const auto measured = MeasureSelfPenetration(motion);
  ASSERT_TRUE(measured);
  EXPECT_EQ(measured->depth.front(), 0.0) << "arms to the sides touch nothing";
  int deep = 0;
  for (int f = 0; f < motion.frame_count(); ++f) {
    EXPECT_NEAR(measured->depth[static_cast<std::size_t>(f)], DepthByPoints(motion, f), 1e-4) << "frame " << f;
    deep += DepthByPoints(motion, f) > 0.03 ? 1 : 0;
  }
  EXPECT_GT(measured->max_depth(), 0.05);
  EXPECT_GT(deep, 0);
  EXPECT_NEAR(measured->penetrating_share, static_cast<double>(deep) / motion.frame_count(), 1e-12);
  EXPECT_EQ(MeasureSelfPenetration(motion, {0.5})->penetrating_share, 0.0) << "no frame is half a metre deep";
  EXPECT_LE(MeasureSelfPenetration(motion, {0.05})->penetrating_share, measured->penetrating_share);
}

TEST(SelfPenetration, OfCrossedShinsIsThatOfTheLegs) {
  Motion motion = AtRest(2);
  const Skeleton& skeleton = *motion.skeleton;
  motion.rotation_at(1, JointOf(skeleton, "left_hip")) = ExpQuaternion(Vector3d(0, 0, -0.2));
  motion.rotation_at(1, JointOf(skeleton, "right_hip")) = ExpQuaternion(Vector3d(0, 0, 0.2));
  ComputeJoints(motion);
  const auto measured = MeasureSelfPenetration(motion);
  ASSERT_TRUE(measured);
  EXPECT_EQ(measured->depth[0], 0.0);
  EXPECT_GT(measured->depth[1], 0.05);
  EXPECT_EQ(skeleton.joints[static_cast<std::size_t>(measured->joints[1][0])].mirror, measured->joints[1][1]);
}

TEST(SelfPenetration, IsTheSameForTheMirrorImageAndAnywhereInTheWorld) {
  Clip clip;
  clip.motion = ArmThroughTrunk();
  const SelfPenetration own = MeasureSelfPenetration(*clip.motion).value();
  const Clip mirrored = Mirror(clip);
  Clip moved = clip;
  Transform({ExpQuaternion(Vector3d(0.4, -1.3, 0.8)), Vector3d(3, -2, 5)}, moved);
  Clip joints_only = clip;
  joints_only.motion = MakeJointsOnly(clip.motion->skeleton, clip.motion->rate, clip.motion->joints);
  const SelfPenetration on_bones = MeasureSelfPenetration(*joints_only.motion).value();
  EXPECT_GT(on_bones.max_depth(), 0.03) << "bones have volume too";
  Clip joints_moved = joints_only;
  Transform({ExpQuaternion(Vector3d(0.4, -1.3, 0.8)), Vector3d(3, -2, 5)}, joints_moved);
  for (std::size_t f = 0; f < own.depth.size(); ++f) {
    EXPECT_NEAR(MeasureSelfPenetration(*mirrored.motion)->depth[f], own.depth[f], 1e-9);
    EXPECT_NEAR(MeasureSelfPenetration(*moved.motion)->depth[f], own.depth[f], 1e-9);
    EXPECT_NEAR(MeasureSelfPenetration(*Mirror(joints_only).motion)->depth[f], on_bones.depth[f], 1e-9);
    EXPECT_NEAR(MeasureSelfPenetration(*joints_moved.motion)->depth[f], on_bones.depth[f], 1e-9);
  }
}

TEST(SelfPenetration, IsAbsentForASkeletonWithoutLimbs) {
  const test::StickFigure figure = test::MakeStickFigure();
  JointPositions joints(1, 4);
  for (int j = 0; j < 4; ++j) joints.at(0, j) = figure.joints[static_cast<std::size_t>(j)];
  EXPECT_FALSE(MeasureSelfPenetration(MakeJointsOnly(figure.skeleton, FrameRate{20, 1}, joints)));
}

}  // namespace
}  // namespace mocurate
