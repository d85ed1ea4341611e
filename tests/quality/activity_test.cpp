#include "core/quality/activity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

namespace mocurate {
namespace {

/// A chain of joints whose tenth and eleventh are the feet, at 30 Hz.
Motion Made(int frames, int joints, const std::function<Vector3d(int frame, int joint)>& place) {
  auto skeleton = std::make_shared<Skeleton>();
  for (int j = 0; j < joints; ++j) {
    Joint joint;
    joint.name = j == 10 ? "left_foot" : j == 11 ? "right_foot" : "joint" + std::to_string(j);
    joint.parent = j - 1;
    joint.mirror = j;
    skeleton->joints.push_back(joint);
  }
  Motion motion;
  motion.skeleton = skeleton;
  motion.rate = {30, 1};
  motion.joints = JointPositions(frames, joints);
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < joints; ++j) motion.joints.at(f, j) = place(f, j);
  }
  return motion;
}

TEST(Activity, OfAConstantVelocityIsTheSpeedWithoutJerk) {
  const Motion motion = Made(20, 3, [](int f, int j) { return Vector3d(0.1 * f, 0.3 * j, 0); });
  const auto activity = ActivityOf(motion);
  ASSERT_TRUE(activity);
  EXPECT_NEAR(activity->movement, 3.0, 1e-9);
  EXPECT_NEAR(activity->peak_jerk, 0.0, 1e-6);
  EXPECT_FALSE(ActivityOf(Made(1, 3, [](int, int) { return Vector3d(0, 0, 0); })));
}

TEST(Activity, JerkIsThatOfTheMostSuddenJoint) {
  // x = t^3 has the third derivative 6; of seven frames four differences, 30 Hz.
  const Motion motion = Made(7, 3, [](int f, int j) { return Vector3d(j == 1 ? std::pow(f / 30.0, 3) : 0.0, 0, 0); });
  EXPECT_NEAR(ActivityOf(motion)->peak_jerk, 6.0, 1e-6);
  EXPECT_NEAR(ActivityOf(motion)->jerk_area, 6.0 * 4.0 / 30.0, 1e-6);
}

/// A motion with feet in contact, in the air, with the root and against it; `kind` 0 to 3.
Vector3d PlaceOf(int kind, int f, int j) {
  const bool foot = j == 10 || j == 11;
  const double travel[] = {0.004, 0.02, 0.012, 0.03};
  Vector3d place(travel[kind] * f + (kind == 3 && foot ? 0.0 : 0.05 * std::sin(0.13 * f + 0.7 * j)),
                 foot ? 0.06 + 0.06 * std::sin(0.21 * f + 2.0 * j) : 0.9 - 0.03 * j + 0.01 * std::sin(0.3 * f + j),
                 0.05 * std::cos(0.17 * f + 0.3 * j));
  if (!foot) return place;
  if (kind == 2) place += Vector3d(0.05 * std::sin(1.9 * f), 0.2, 0.06 * std::cos(2.3 * f));
  if (kind == 2 && f < 6) place.y() = 0.0;
  if (kind == 3) place = Vector3d(place.x(), f > 3 ? 0.3 + 0.001 * f : 0.0, 0.0);
  return place;
}

/// Numbers of Motius (50cf750's compute_physical_metrics) for the same motions. Of the last it has floating 1.911: the
/// left foot's path is straight, and it takes the float32 rounding of the angle along it for turns.
TEST(MBench, EqualsMotiusOnMadeMotions) {
  struct Expected {
    double jitter, dynamic, floating, slide;
  };
  const Expected expected[] = {{3.070, 18.545, 0.366667, 6.963},
                               {3.070, 31.058, 0.227778, 20.080},
                               {32.529, 38.378, 0.994444, 80.814},
                               {4.002, 40.412, 0.955556, 30.0}};
  for (int kind = 0; kind < 4; ++kind) {
    const auto measures = MBenchOf(Made(90, 22, [kind](int f, int j) { return PlaceOf(kind, f, j); }));
    ASSERT_TRUE(measures);
    EXPECT_NEAR(measures->jitter, expected[kind].jitter, 1e-3) << kind;
    EXPECT_NEAR(measures->dynamic, expected[kind].dynamic, 1e-3) << kind;
    EXPECT_NEAR(measures->floating, expected[kind].floating, 1e-6) << kind;
    EXPECT_NEAR(measures->slide, expected[kind].slide, 1e-3) << kind;
  }
}

TEST(MBench, NeedsFeetAndFourFrames) {
  const auto rest = [](int, int j) { return Vector3d(0, 1.0 - 0.1 * j, 0); };
  EXPECT_FALSE(MBenchOf(Made(90, 5, rest)));
  EXPECT_FALSE(MBenchOf(Made(3, 22, rest)));
  EXPECT_EQ(MBenchOf(Made(9, 22, rest))->penetration, 0.0) << "Motius's floor is the lowest foot";
}

}  // namespace
}  // namespace mocurate
