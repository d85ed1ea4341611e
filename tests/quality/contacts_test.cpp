// Foot contacts, floor penetration, and rotations beyond joint limits.

#include "core/quality/contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/rotation.h"
#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

constexpr double kRate = 30.0;

/// A person upright in the rest pose of smpl24, the left ankle 0.1 m high; `lift` moves the knee, ankle and foot of a
/// leg (side: 0 left) up.
template <class Lift>
Motion Standing(int frames, Lift lift) {
  const SkeletonPtr skeleton = LoadSkeleton("smpl24").value();
  const int joints = skeleton->joint_count();
  const std::vector<Quaterniond> rotation(static_cast<std::size_t>(joints), Quaterniond::Identity());
  std::vector<Vector3d> rest(static_cast<std::size_t>(joints));
  ForwardKinematics(*skeleton, Vector3d::Zero(), rotation.data(), {}, rest.data());
  const Vector3d floor(0, 0.1 - rest[static_cast<std::size_t>(*skeleton->FindJoint("left_ankle"))].y(), 0);
  JointPositions places(frames, joints);
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < joints; ++j) {
      const std::string& name = skeleton->joints[static_cast<std::size_t>(j)].name;
      const bool leg = name.find("knee") != std::string::npos || name.find("ankle") != std::string::npos ||
                       name.find("foot") != std::string::npos;
      const double up = leg ? lift(f, name.rfind("left", 0) == 0 ? 0 : 1) : 0.0;
      places.at(f, j) = rest[static_cast<std::size_t>(j)] + floor + Vector3d(0, up, 0);
    }
  }
  return MakeJointsOnly(skeleton, FrameRate::FromHz(kRate), std::move(places));
}

int Foot(const Motion& motion, const char* name) { return *motion.skeleton->FindJoint(name); }

TEST(Contacts, AreWhereAFootIsLowAndSlow) {
  // The left foot rises by 0.3 m in the frames 20 to 39 and comes down again.
  const Motion motion = Standing(60, [](int f, int side) {
    return side == 0 && f >= 20 && f < 40 ? 0.3 * std::sin(M_PI * (f - 20) / 20.0) : 0.0;
  });
  const std::vector<bool> left = JointContacts(motion, Foot(motion, "left_foot"), {}),
                          right = JointContacts(motion, Foot(motion, "right_foot"), {});
  ASSERT_EQ(left.size(), 60u);
  EXPECT_EQ(std::count(right.begin(), right.end(), true), 60);
  for (const int f : {5, 15, 45, 55}) EXPECT_TRUE(left[static_cast<std::size_t>(f)]) << f;
  for (int f = 24; f < 36; ++f) EXPECT_FALSE(left[static_cast<std::size_t>(f)]) << f;
  const auto runs = RunsWhere(left, true);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].begin, 0);
  EXPECT_EQ(runs[1].end, 60);
}

TEST(Contacts, ShortOnesAreDroppedAndShortGapsClosed) {
  ContactLimits limits;
  limits.min_time_s = 0.0;
  // Two frames down in the middle of a flight.
  const Motion motion =
      Standing(60, [](int f, int side) { return side == 0 && f >= 10 && f < 50 && f != 30 && f != 31 ? 0.3 : 0.0; });
  const auto at_once = RunsWhere(JointContacts(motion, Foot(motion, "left_foot"), limits), true);
  limits.min_time_s = 0.2;
  const auto lasting = RunsWhere(JointContacts(motion, Foot(motion, "left_foot"), limits), true);
  EXPECT_GE(at_once.size(), lasting.size());
  EXPECT_EQ(lasting.size(), 2u);
}

TEST(Penetration, IsTheMeanDepthBelowTheFloorOfTheContacts) {
  EXPECT_NEAR(*FloorPenetration(Standing(60, [](int, int) { return 0.0; })), 0.0, 1e-9);
  // Both feet are in contact; in a tenth of the frames the right leg is 0.04 m lower.
  const Motion motion = Standing(60, [](int f, int side) { return side == 1 && f % 10 == 9 ? -0.04 : 0.0; });
  EXPECT_NEAR(*FloorPenetration(motion), 0.004, 1e-9);
}

TEST(Penetration, IsEmptyWithoutContacts) {
  // A person who rises at 2 m/s: no foot is ever slow.
  EXPECT_FALSE(FloorPenetration(Standing(60, [](int f, int) { return 2.0 * f / kRate; })).has_value());
}

TEST(LimitViolations, AreTheShareOfRotationsBeyondTheirLimits) {
  const Motion no_rotations = Standing(10, [](int, int) { return 0.0; });
  EXPECT_FALSE(LimitViolations(no_rotations).has_value());
  const SkeletonPtr skeleton = no_rotations.skeleton;
  const int joints = skeleton->joint_count();
  int limited = 0;
  for (const Joint& joint : skeleton->joints) limited += joint.limits ? 1 : 0;
  ASSERT_GT(limited, 0);
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(10) * joints, Quaterniond::Identity());
  const auto violations = [&] {
    return *LimitViolations(MakeMotion(skeleton, FrameRate::FromHz(kRate), std::vector<Vector3d>(10, Vector3d::Zero()),
                                       rotation, skeleton->RestBoneLengths()));
  };
  EXPECT_DOUBLE_EQ(violations(), 0.0);
  // The left knee bends backwards in three of the ten frames.
  const int knee = *skeleton->FindJoint("left_knee");
  const JointLimits limits = *skeleton->joints[static_cast<std::size_t>(knee)].limits;
  for (const int f : {1, 4, 5}) {
    rotation[static_cast<std::size_t>(f * joints + knee)] = ExpQuaternion(Vector3d(limits.min.x() - 0.2, 0, 0));
  }
  EXPECT_DOUBLE_EQ(violations(), 3.0 / (10.0 * limited));
}

}  // namespace
}  // namespace mocurate
