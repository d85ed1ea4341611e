// Two trackers of one person: their relative pose and clock offset are estimated from the joints alone.

#include <gtest/gtest.h>

#include <cmath>

#include "core/quality/view_alignment.h"
#include "tests/quality/people.h"

namespace mocurate {
namespace {

using test::Perform;
using test::Take;
using test::TakeOptions;

constexpr int kFine = 8;  // steps of the finer take per frame

/// The view of a tracker of 30 Hz whose first frame is `begin` eighths of a frame after the start of the performance.
Take Tracked(std::uint64_t person, int begin, int frames, double noise, const RigidTransform& tracker_from_world,
             double walk = 0.4) {
  TakeOptions options;
  options.rate_hz = 30.0 * kFine;
  options.frames = begin + kFine * frames;
  options.noise = 0.0;
  options.walk = walk;
  const Take fine = Perform(person, options);
  Take take = fine;
  take.positions = JointPositions(frames, fine.positions.joints);
  take.confidence.assign(static_cast<std::size_t>(frames) * fine.names.size(), 1.0);
  take.time_s.clear();
  Random random(person, "tracker", std::to_string(begin) + std::to_string(tracker_from_world.translation.x()));
  for (int f = 0; f < frames; ++f) {
    take.time_s.push_back(f / 30.0);
    for (int k = 0; k < fine.positions.joints; ++k) {
      const Vector3d place = tracker_from_world * Vector3d(fine.positions.at(begin + kFine * f, k));
      take.positions.at(f, k) = place + noise * Vector3d(random.Normal(), random.Normal(), random.Normal());
    }
  }
  return take;
}

RigidTransform Aside() { return {ExpQuaternion(Vector3d(0.05, 0.8, -0.02)), Vector3d(1.5, 0.1, 3.0)}; }

TEST(ClockOffset, IsFoundToAFractionOfAFrame) {
  for (const int eighths : {0, 3, 12, 37}) {
    SCOPED_TRACE(eighths);
    const Take a = Tracked(3, 40, 90, 0.005, {}), b = Tracked(3, 40 + eighths, 80, 0.005, Aside());
    const auto view = AlignViews(a.view(), b.view(), 0.5);
    ASSERT_TRUE(view);
    EXPECT_TRUE(view->offset_known);
    EXPECT_NEAR(view->offset_s, eighths / 240.0, 0.002);
    EXPECT_LT(view->offset_sigma_s, 0.004);
    const RigidTransform off = view->a_from_b * Aside();
    EXPECT_LT(off.translation.norm(), 0.004);
    EXPECT_LT(AngleBetween(off.rotation, Quaterniond::Identity()), 0.004);
    EXPECT_FALSE(view->Mirrored());
  }
}

TEST(ClockOffset, OfAPeriodicMotionIsDecidedByThePosition) {
  // A walk repeats every second; only the walker's position distinguishes the steps.
  const Take a = Tracked(5, 100, 150, 0.003, {}, 1.0), b = Tracked(5, 180, 140, 0.003, {}, 1.0);
  const auto speeds = CorrelateSpeeds(a.view(), b.view(), 2.0);
  ASSERT_GE(speeds.size(), 2u) << "speeds alone allow several offsets";
  const auto view = AlignViews(a.view(), b.view(), 2.0);
  ASSERT_TRUE(view);
  EXPECT_NEAR(std::remainder(view->offset_s - 80.0 / 240.0, 2.0), 0.0, 0.01);
}

TEST(ClockOffset, OfAMotionlessPersonIsUnknown) {
  Take a = Tracked(7, 0, 60, 0.0, {}), b = a;
  Random random(7, "still");
  for (int f = 0; f < 60; ++f) {
    for (int k = 0; k < a.positions.joints; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        const double still = a.positions.at(0, k)[axis];
        a.positions.at(f, k)[axis] = still + 0.005 * random.Normal();
        b.positions.at(f, k)[axis] = still + 0.005 * random.Normal();
      }
    }
  }
  const auto view = AlignViews(a.view(), b.view(), 0.5);
  ASSERT_TRUE(view);
  EXPECT_FALSE(view->offset_known);
  EXPECT_EQ(view->offset_s, 0.0);
  EXPECT_LT(view->median, 0.02);
}

TEST(ViewAlignment, OutliersAndInferredJointsOfOneTrackerDoNotChangeIt) {
  const Take a = Tracked(9, 40, 90, 0.005, {});
  Take b = Tracked(9, 40, 90, 0.005, Aside());
  Random random(9, "gross");
  for (int f = 0; f < 90; ++f) {
    for (const char* name : {"left_wrist", "left_hand", "left_elbow", "left_knee"}) {
      b.positions.at(f, b.Joint(name)) += Vector3d(0.4 + 0.1 * random.Normal(), -0.2, 0.2);
    }
    for (const char* name : {"right_wrist", "right_hand"}) {
      b.positions.at(f, b.Joint(name)).setConstant(5.0);
      b.confidence[static_cast<std::size_t>(f) * b.names.size() + static_cast<std::size_t>(b.Joint(name))] = 0.3;
    }
  }
  const auto view = AlignViews(a.view(), b.view(), 0.5);
  ASSERT_TRUE(view);
  const RigidTransform off = view->a_from_b * Aside();
  EXPECT_LT(off.translation.norm(), 0.02);
  EXPECT_NEAR(view->offset_s, 0.0, 0.004);
}

TEST(ViewAlignment, AMirroredTrackerIsDetected) {
  const Take a = Tracked(11, 40, 90, 0.005, {});
  Take b = Tracked(11, 40, 90, 0.005, Aside());
  for (int f = 0; f < 90; ++f) {
    for (int k = 0; k < b.positions.joints; ++k) b.positions.at(f, k).x() *= -1.0;
  }
  const auto view = AlignViews(a.view(), b.view(), 0.5);
  ASSERT_TRUE(view);
  EXPECT_TRUE(view->Mirrored()) << view->median << " against " << view->mirrored_median;
}

TEST(ViewAlignment, IsEmptyWithTooLittleOverlap) {
  const Take a = Tracked(13, 40, 60, 0.005, {});
  Take b = a;
  for (std::size_t i = 0; i < b.confidence.size(); ++i) {
    if (i / b.names.size() >= 5) b.confidence[i] = 0.0;
  }
  EXPECT_FALSE(AlignViews(a.view(), b.view(), 0.1));
}

}  // namespace
}  // namespace mocurate
