#include "core/quality/measures.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace mocurate {
namespace {

/// Root, and one leg that ends in a foot.
Skeleton Leg() {
  Skeleton skeleton;
  skeleton.name = "leg";
  const char* names[3] = {"pelvis", "left_knee", "left_ankle"};
  for (int j = 0; j < 3; ++j) {
    Joint joint;
    joint.name = names[j];
    joint.parent = j - 1;
    joint.mirror = j;
    joint.rest_offset = Vector3d(0, j == 0 ? 0.0 : -0.4, 0);
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

struct Recording {
  JointPositions joints;
  std::vector<double> time_s;
};

/// Standing leg; `move` displaces a joint of a frame.
template <class Move>
Recording Record(int frames, double rate_hz, Move move) {
  Recording recording{JointPositions(frames, 3), {}};
  for (int f = 0; f < frames; ++f) {
    recording.time_s.push_back(f / rate_hz);
    for (int j = 0; j < 3; ++j) recording.joints.at(f, j) = Vector3d(0, 0.8 - 0.4 * j, 0) + move(f / rate_hz, j);
  }
  return recording;
}

MotionMeasures Measure(const Recording& recording, const std::vector<double>& confidence = {}) {
  return MeasureJoints(Leg(), recording.joints, confidence, recording.time_s);
}

TEST(Measures, AStatueIsFrozenAndRigid) {
  const MotionMeasures measures = Measure(Record(10, 30.0, [](double, int) { return Vector3d(Vector3d::Zero()); }));
  EXPECT_EQ(measures.frames, 10);
  EXPECT_EQ(measures.frozen_frames, 9);
  EXPECT_NEAR(measures.bone_spread_mm, 0.0, 1e-9);
  EXPECT_NEAR(measures.jerk, 0.0, 1e-9);
  EXPECT_NEAR(measures.foot_skate, 0.0, 1e-12);
}

TEST(Measures, ABoneThatGrowsAndShrinksHasItsSpread) {
  // The ankle alternates 10 mm below and above: that bone has 10 mm standard deviation, the other none.
  const MotionMeasures measures = Measure(Record(100, 30.0, [](double t, int j) {
    return Vector3d(0, j == 2 ? (static_cast<int>(std::lround(t * 30.0)) % 2 == 0 ? 0.01 : -0.01) : 0.0, 0);
  }));
  EXPECT_NEAR(measures.bone_spreads_mm[2], 10.0, 1e-9);
  EXPECT_NEAR(measures.bone_spreads_mm[1], 0.0, 1e-9);
  EXPECT_NEAR(measures.bone_spread_mm, 5.0, 1e-9);
}

TEST(Measures, JerkIsTheThirdDerivativeWhateverTheRate) {
  const auto cubic = [](double t, int) { return Vector3d(t * t * t, 0, 0); };  // 6 m/s^3
  EXPECT_NEAR(Measure(Record(40, 30.0, cubic)).jerk, 6.0, 1e-6);
  EXPECT_NEAR(Measure(Record(40, 120.0, cubic)).jerk, 6.0, 1e-4);
  Recording uneven = Record(40, 30.0, cubic);
  for (int f = 0; f < 40; ++f) {
    uneven.time_s[f] += (f % 3) * 0.007;
    const double t = uneven.time_s[f];
    for (int j = 0; j < 3; ++j) uneven.joints.at(f, j).x() = t * t * t;
  }
  EXPECT_NEAR(Measure(uneven).jerk, 6.0, 1e-6);
}

TEST(Measures, MissingSamplesAreCountedAndNeverRead) {
  Recording recording = Record(20, 30.0, [](double t, int) { return Vector3d(0.1 * t, 0, 0); });
  std::vector<double> confidence(60, 1.0);
  for (int f = 0; f < 20; ++f) confidence[3 * f] = 0.0;  // the pelvis is never seen: not missing but absent
  for (int f = 5; f < 10; ++f) confidence[3 * f + 2] = 0.0;
  for (std::size_t i = 0; i < 60; ++i) {
    if (confidence[i] > 0.0) continue;
    for (int k = 0; k < 3; ++k) recording.joints.xyz[3 * i + k] = std::numeric_limits<double>::quiet_NaN();
  }
  const MotionMeasures measures = Measure(recording, confidence);
  EXPECT_NEAR(measures.missing_share, 5.0 / 40.0, 1e-12);
  EXPECT_TRUE(std::isfinite(measures.jerk));
  EXPECT_TRUE(std::isfinite(measures.bone_spread_mm));
}

TEST(Measures, AFootThatSlidesOnTheFloorSkates) {
  const MotionMeasures slides = Measure(Record(30, 30.0, [](double t, int) { return Vector3d(0.5 * t, 0, 0); }));
  EXPECT_NEAR(slides.foot_skate, 0.5, 1e-9);
  // Lifted while it moves: only the frames near the floor count.
  const MotionMeasures steps = Measure(
      Record(30, 30.0, [](double t, int) { return t < 0.5 ? Vector3d(0, 0, 0) : Vector3d(2.0 * (t - 0.5), 0.3, 0); }));
  EXPECT_NEAR(steps.foot_skate, 0.0, 1e-9);
}

TEST(Measures, AreWrittenUnderTheirNames) {
  const MotionMeasures measures = Measure(Record(5, 30.0, [](double, int) { return Vector3d(Vector3d::Zero()); }));
  const nlohmann::json json = MeasuresJson(measures, Leg());
  EXPECT_EQ(json["frames"], 5);
  EXPECT_EQ(json["bone_spreads_mm"].size(), 2u);
  for (const char* key : {"bone_spread_mm", "jerk", "missing_share", "frozen_frames", "foot_skate"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
}

}  // namespace
}  // namespace mocurate
