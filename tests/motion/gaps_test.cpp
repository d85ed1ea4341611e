#include "core/motion/gaps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/motion/operations.h"
#include "tests/motion/builders.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

constexpr auto kSeen = JointState::kObserved, kFilled = JointState::kInterpolated, kNot = JointState::kInferred;

std::vector<double> Times(int frames, double step) {
  std::vector<double> times;
  for (int f = 0; f < frames; ++f) times.push_back(f * step);
  return times;
}

TEST(Gaps, OfAtMostHalfASecondAreInterpolatedLongerOnesInferred) {
  const std::vector<bool> observed = {true, false, false, true, false, false, false, true};
  EXPECT_THAT(GapStates(observed, Times(8, 0.25), 0.25, 0.5),
              ElementsAre(kSeen, kFilled, kFilled, kSeen, kNot, kNot, kNot, kSeen));
}

TEST(Gaps, LastByTheClockNotByTheNumberOfFrames) {
  EXPECT_THAT(GapStates({true, false, true}, {0.0, 0.1, 3.0}, 0.1, 0.5), ElementsAre(kSeen, kNot, kSeen));
}

TEST(Gaps, AtBothEndsAreHeldForAsLong) {
  const std::vector<bool> observed = {false, true, false, false, false};
  EXPECT_THAT(GapStates(observed, Times(5, 0.25), 0.25, 0.5), ElementsAre(kFilled, kSeen, kNot, kNot, kNot));
}

TEST(Gaps, AreAllThereIsWhereNothingWasObserved) {
  EXPECT_THAT(GapStates({false, false}, Times(2, 0.1), 0.1, 0.5), ElementsAre(kNot, kNot));
}

/// Whatever the pattern: observed samples stay, and a sample is interpolated only within a short gap.
TEST(Gaps, KeepEveryObservation) {
  for (int seed = 0; seed < 200; ++seed) {
    Random random(static_cast<std::uint64_t>(seed), "gaps", "");
    std::vector<bool> observed;
    for (int f = 0; f < 60; ++f) observed.push_back(random.Uniform() < 0.3);
    const auto states = GapStates(observed, Times(60, 0.1), 0.1, 0.5);
    for (const FrameRun& run : RunsWhere(observed, false)) {
      for (int f = run.begin; f < run.end; ++f) EXPECT_EQ(states[f], run.frames() <= 5 ? kFilled : kNot) << seed;
    }
    for (const FrameRun& run : RunsWhere(observed, true)) {
      for (int f = run.begin; f < run.end; ++f) EXPECT_EQ(states[f], kSeen) << seed;
    }
  }
}

Clip WithGap(int frames, FrameRun gap) {
  Clip clip;
  clip.motion = test::SwingingPerson(test::Built("kinect20"), frames);
  const auto joints = static_cast<std::ptrdiff_t>(clip.motion->joint_count());
  std::fill(clip.motion->state.begin(), clip.motion->state.end(), kSeen);
  std::fill(clip.motion->state.begin() + gap.begin * joints, clip.motion->state.begin() + gap.end * joints, kNot);
  clip.identity.end_frame = frames;
  return clip;
}

TEST(Gaps, OfAMotionLeaveItsLongestStretch) {
  const auto shorter = WithoutInferred(WithGap(40, {10, 18}));
  ASSERT_TRUE(shorter && *shorter);
  EXPECT_EQ((*shorter)->motion->frame_count(), 22);
  EXPECT_EQ((*shorter)->identity.begin_frame, 18);
  EXPECT_FALSE(*WithoutInferred(WithGap(40, {0, 0})));
  EXPECT_FALSE(WithoutInferred(WithGap(40, {0, 40})));
  EXPECT_TRUE(IsAllInferred(*WithGap(40, {0, 40}).motion));
  EXPECT_FALSE(IsAllInferred(*WithGap(40, {0, 39}).motion));
}

TEST(Gaps, OfAMotionThatAreShortBecomeInterpolated) {
  Motion motion = *WithGap(60, {10, 25}).motion;
  MarkShortGaps(0.5, motion);
  EXPECT_EQ(motion.state[10 * 20], kFilled);
  motion = *WithGap(60, {10, 26}).motion;
  MarkShortGaps(0.5, motion);
  EXPECT_EQ(motion.state[10 * 20], kNot);
}

TEST(Tracks, OfAJointThatIsLostForLongAreInferredThere) {
  const SkeletonPtr skeleton = test::Built("kinect20");
  JointTracks tracks;
  for (const Joint& joint : skeleton->joints) tracks.names.push_back(joint.name);
  tracks.positions = JointPositions(60, 20);
  tracks.time_s = Times(60, 1.0 / 30.0);
  tracks.confidence.assign(60 * 20, 1.0);
  for (int f = 10; f < 40; ++f) tracks.confidence[f * 20 + 5] = 0.0;
  const auto motion = MotionFromTracks(tracks, skeleton, FrameRate{30, 1}, 0.5);
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->state[20 * 20 + 5], kNot);
  EXPECT_EQ(motion->state[20 * 20 + 6], kSeen);
  EXPECT_FALSE(InferredFrames(*motion)[20]) << "other joints are there";
}

}  // namespace
}  // namespace mocurate
