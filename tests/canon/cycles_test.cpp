// An exercise is cut into its repetitions; what is not repeated stays whole.

#include <gtest/gtest.h>

#include "canon/trim/trim.h"
#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "tests/canon/moving_clips.h"
#include "tests/canon/studio_recordings.h"

namespace mocurate {
namespace {

TEST(Cycles, CountRepetitionsOfTheStudiosExercises) {
  int right = 0, all = 0;
  for (const char* action : {"jump_vertical", "lift_dumbbell_left", "boxing_left_right", "run_on_the_spot",
                             "warm_up_bow_left", "warm_up_pectoral", "lift_dumbbell_overhead", "jump_hands_up"}) {
    for (int cycles = 1; cycles <= 7; cycles += 2) {
      const LongRecording exercise = StudioExercise(51, action, cycles % 4, cycles);
      right += static_cast<int>(FindCycles({}, exercise.motion).size()) == cycles ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GE(right, 0.9 * all) << right << " of " << all;
}

TEST(Cycles, WhatIsDoneOnceIsOne) {
  for (const char* action : {"kick", "throw", "sit", "pick_up", "salute", "side_kick"}) {
    EXPECT_EQ(FindCycles({}, StudioExercise(52, action, 1, 0).motion).size(), 1u) << action;
  }
}

TEST(Cycles, BoundariesOfCurlsAreWhereTheArmHangs) {
  const LongRecording curls = StudioExercise(53, "lift_dumbbell_both", 2, 5);
  const auto repetitions = FindCycles({}, curls.motion);
  ASSERT_EQ(repetitions.size(), 5u);
  const double begin_s = curls.segments[0].begin_s, length_s = curls.segments[0].end_s - begin_s;
  for (std::size_t k = 0; k < repetitions.size(); ++k) {
    EXPECT_NEAR(curls.motion.rate.FrameTime(repetitions[k].begin), begin_s + length_s * static_cast<double>(k) / 5.0,
                0.2);
    if (k > 0) {
      EXPECT_EQ(repetitions[k].begin, repetitions[k - 1].end);
    }
    EXPECT_GE(repetitions[k].confidence, 0.7);
    EXPECT_LE(repetitions[k].confidence, 1.0);
  }
}

TEST(Cycles, DependOnNeitherHeadingNorFrameRateNorNoise) {
  const LongRecording fast = StudioExercise(54, "jump_hands_up", 0, 4, FrameRate{60, 1});
  Clip clip;
  clip.rate = fast.motion.rate;
  clip.motion = fast.motion;
  const auto expected = FindCycles({}, fast.motion);
  ASSERT_EQ(expected.size(), 4u);
  Transform({Quaterniond(Eigen::AngleAxisd(-1.2, Vector3d::UnitY())), Vector3d(1.0, 0.0, 2.0)}, clip);
  const Clip slow = Resample(clip, FrameRate{30, 1});
  const auto turned = FindCycles({}, *clip.motion), resampled = FindCycles({}, *slow.motion);
  ASSERT_EQ(turned.size(), 4u);
  ASSERT_EQ(resampled.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(turned[k].begin, expected[k].begin);
    EXPECT_NEAR(resampled[k].begin / 30.0, expected[k].begin / 60.0, 0.1);
  }
  JointPositions joints = slow.motion->joints;
  Random random(6, "tracker noise");
  for (double& value : joints.xyz) value += 0.01 * random.Normal();
  EXPECT_EQ(FindCycles({}, MakeJointsOnly(slow.motion->skeleton, slow.rate, joints)).size(), 4u);
}

TEST(Cycles, WhoNeverMovesRepeatsNothing) {
  EXPECT_TRUE(FindCycles({}, *ClipMoving("p", "a", 0, 0, 1, 0.0).motion).empty());
  EXPECT_TRUE(FindCycles({}, *ClipMoving("p", "a", 1, 0, 1, 0.0).motion).empty());
  TrimOptions options;
  options.rule = TrimRule::kCycles;
  std::vector<Finding> findings;
  EXPECT_TRUE(FindSpans(options, ClipMoving("p", "a", 90, 10, 50, 0.0), findings).empty());
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "no_repetition");
}

}  // namespace
}  // namespace mocurate
