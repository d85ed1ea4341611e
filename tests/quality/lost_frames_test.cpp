// Files that omit frames without notice: a moving person continues through them, a standing one does not.

#include <gtest/gtest.h>

#include "core/quality/checks.h"

namespace mocurate {
namespace {

constexpr int kFrames = 60, kPoints = 5;

/// Five points that move `step` metres per frame, and `jump` more before frame 30.
std::vector<Finding> JumpsOf(double step, double jump, int lost_frames) {
  JointPositions positions(kFrames, kPoints);
  std::vector<double> time_s;
  for (int f = 0; f < kFrames; ++f) {
    time_s.push_back(f / 30.0);
    for (int k = 0; k < kPoints; ++k) positions.at(f, k) = Vector3d(step * f + (f < 30 ? 0.0 : jump), 0.3 * k, 0.0);
  }
  PositionJumpLimits limits;
  limits.lost_frames = lost_frames;
  return FindPositionJumps({positions, {}, time_s}, limits);
}

TEST(LostFrames, ARunnerContinuesThroughThem) {
  EXPECT_EQ(JumpsOf(0.14, 1.5, 0).size(), 1u) << "where no frame is missing";
  EXPECT_TRUE(JumpsOf(0.14, 1.5, 15).empty());
  EXPECT_EQ(JumpsOf(0.14, 4.0, 15).size(), 1u) << "farther than possible at that speed";
}

TEST(LostFrames, AStandingPersonHasNotMoved) { EXPECT_EQ(JumpsOf(0.002, 1.0, 15).size(), 1u); }

TEST(LostFrames, TwoAlternatingPeopleAreNotOneFastPerson) {
  JointPositions positions(kFrames, kPoints);
  std::vector<double> time_s;
  for (int f = 0; f < kFrames; ++f) {
    time_s.push_back(f / 30.0);
    for (int k = 0; k < kPoints; ++k) positions.at(f, k) = Vector3d(f % 2 == 0 ? 0.0 : 2.0, 0.3 * k, 0.01 * f);
  }
  PositionJumpLimits limits;
  limits.lost_frames = 15;
  EXPECT_FALSE(FindPositionJumps({positions, {}, time_s}, limits).empty());
}

}  // namespace
}  // namespace mocurate
