// A section that appears twice in a clip is found frame for frame; authored loops are not reported.

#include <gtest/gtest.h>

#include "core/quality/checks.h"
#include "core/quality/repeated_stretches.h"
#include "tests/quality/people.h"

namespace mocurate::test {
namespace {

void CopyFrame(const Take& from, int frame, Take& to, int f) {
  for (int k = 0; k < to.positions.joints; ++k) to.positions.at(f, k) = from.positions.at(frame, k).eval();
}

Take WalkOf(std::uint64_t seed, int frames, double noise = 0.005) {
  TakeOptions options;
  options.frames = frames;
  options.noise = noise;
  return Perform(seed, options);
}

TEST(RepeatedStretches, FramesCopiedOverOthersAreFoundFrameForFrame) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Take take = WalkOf(seed, 160, seed % 2 == 0 ? 0.005 : 0.0);
    const Take sound = take;
    EXPECT_TRUE(FindRepeatedStretches(take.view()).empty()) << seed;
    const int length = 8 + 2 * static_cast<int>(seed);
    for (int f = 0; f < length; ++f) CopyFrame(sound, 40 + f, take, 100 + f);
    const std::vector<Finding> found = FindRepeatedStretches(take.view());
    ASSERT_EQ(found.size(), 1u) << seed;
    EXPECT_EQ(found[0].code, "repeated_stretch");
    EXPECT_EQ(found[0].severity, Severity::kWarning);
    EXPECT_EQ(found[0].frame_begin, 100);
    EXPECT_EQ(found[0].frame_end, 100 + length);
    EXPECT_EQ(found[0].value, length);
  }
}

TEST(RepeatedStretches, AnAppendedSectionIsReportedAmongAllChecks) {
  Take take = WalkOf(3, 90);
  const Take sound = take;
  for (int f = 60; f < 90; ++f) CopyFrame(sound, f - 45, take, f);
  int reported = 0;
  for (const Finding& finding : CheckPoints(take.view(), 30.0)) reported += finding.code == "repeated_stretch" ? 1 : 0;
  EXPECT_EQ(reported, 1);
}

/// A buffer written twice, of a person who hardly moves: steps at its ends are not larger than others.
TEST(RepeatedStretches, ASensorsNoiseRepeatsNowhereEvenWithoutAJump) {
  TakeOptions still;
  still.walk = 0.0;
  still.noise = 0.02;
  Take take = Perform(5, still);
  const Take sound = take;
  for (int f = 0; f < 20; ++f) CopyFrame(sound, 30 + f, take, 50 + f);
  ASSERT_EQ(FindRepeatedStretches(take.view()).size(), 1u);
}

TEST(RepeatedStretches, AnAuthoredLoopIsNotReported) {
  Take take = WalkOf(0, 120, 0.0);
  for (int f = 0; f < 120; ++f) {
    for (int k = 0; k < take.positions.joints; ++k) {
      const double turn = 2.0 * 3.14159265358979 * (f % 24) / 24.0;
      take.positions.at(f, k) =
          Vector3d(0.1 * k + 0.2 * std::sin(turn), 0.3 * std::cos(turn + k), 0.05 * k * std::cos(turn));
    }
  }
  EXPECT_TRUE(FindRepeatedStretches(take.view()).empty());
  const Take loop = take;
  for (int f = 0; f < 10; ++f) CopyFrame(loop, f + 5, take, 60 + f);
  EXPECT_FALSE(FindRepeatedStretches(take.view()).empty()) << "a loop with a cut is not a loop";
}

/// Back and forth at constant speed, as in an exporter's example: it reverses within a frame, but does not jump.
TEST(RepeatedStretches, AMotionThatReversesIsNotReported) {
  Take take = WalkOf(0, 120, 0.0);
  for (int f = 0; f < 120; ++f) {
    const int there = f < 60 ? f : 120 - f;  // and on past the start
    for (int k = 0; k < take.positions.joints; ++k)
      take.positions.at(f, k) = Vector3d(0.01 * (k + std::abs(there - 20)), 0.1 * k, 0.0);
  }
  EXPECT_TRUE(FindRepeatedStretches(take.view()).empty());
}

TEST(RepeatedStretches, AFrozenStreamAndAFewAlternatingPosesAreNotARepeatedSection) {
  Take take = WalkOf(2, 120);
  const Take sound = take;
  for (int f = 30; f < 60; ++f) CopyFrame(sound, 30, take, f);
  for (int f = 60; f < 100; ++f) CopyFrame(sound, 60 + f % 7, take, f);
  EXPECT_TRUE(FindRepeatedStretches(take.view()).empty());
}

TEST(RepeatedStretches, MissingJointsAreIgnoredButFramesWithOtherMissingJointsDiffer) {
  Take take = WalkOf(4, 120);
  const Take sound = take;
  for (int f = 0; f < 30; ++f) CopyFrame(sound, 10 + f, take, 80 + f);
  const auto wide = static_cast<std::size_t>(take.positions.joints);
  take.confidence.assign(120 * wide, 1.0);
  for (int f = 0; f < 120; ++f) {  // values of a missing joint are never read
    take.confidence[static_cast<std::size_t>(f) * wide + 3] = 0.0;
    take.positions.at(f, 3) = Vector3d(f, 0, 0);
  }
  ASSERT_EQ(FindRepeatedStretches(take.view()).size(), 1u);
  take.confidence[95 * wide + 5] = 0.0;
  EXPECT_EQ(FindRepeatedStretches(take.view()).size(), 2u) << "one joint is observed in only one of the two";
}

}  // namespace
}  // namespace mocurate::test
