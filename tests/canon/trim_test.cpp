// Trimming: kept and dropped spans, with reasons.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canon/options.h"
#include "canon/trim/trim.h"
#include "core/base/random.h"
#include "core/motion/operations.h"
#include "tests/canon/moving_clips.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

TEST(Trim, CutsStillFramesFromBothEndsAndKeepsTheMargin) {
  TrimOptions options;
  options.rule = TrimRule::kMotionEnergy;
  options.margin_s = 0.1;
  std::vector<Finding> findings;
  const auto spans = FindSpans(options, ClipMoving("p", "a", 120, 40, 80, 1.0), findings);
  ASSERT_EQ(spans.size(), 1u);
  EXPECT_NEAR(spans[0].begin, 34, 4);  // frame 40 less the margin, less at most half a speed window
  EXPECT_LE(spans[0].begin, 37);
  EXPECT_NEAR(spans[0].end, 87, 4);
  EXPECT_GE(spans[0].end, 84);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].action, FindingAction::kDropped);
}

TEST(Trim, AClipThatNeverMovesIsDroppedWithItsFastestSpeed) {
  TrimOptions options;
  options.rule = TrimRule::kMotionEnergy;
  std::vector<Finding> findings;
  EXPECT_TRUE(FindSpans(options, ClipMoving("p", "a", 60, 10, 50, 0.0), findings).empty());
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "never_moves");
  EXPECT_THAT(findings[0].message, HasSubstr("trim.still_speed"));
}

/// The clip with white noise of `sigma` metres on every coordinate.
Clip Jittered(Clip clip, double sigma) {
  Random random(5, "jitter");
  JointPositions joints = clip.motion->joints;
  for (int f = 0; f < joints.frames; ++f) {
    for (int j = 0; j < joints.joints; ++j) {
      joints.at(f, j) += sigma * Vector3d(random.Normal(), random.Normal(), random.Normal());
    }
  }
  clip.motion = MakeJointsOnly(clip.motion->skeleton, clip.rate, joints);
  return clip;
}

TEST(Trim, TenMillimetresOfJitterDoNotKeepAStillLeadIn) {
  TrimOptions options;
  options.rule = TrimRule::kMotionEnergy;
  options.margin_s = 0.0;
  std::vector<Finding> findings;
  const auto spans = FindSpans(options, Jittered(ClipMoving("p", "a", 150, 60, 90, 1.0), 0.010), findings);
  ASSERT_EQ(spans.size(), 1u);
  EXPECT_GE(spans[0].begin, 60 - 6);
  EXPECT_LE(spans[0].begin, 60);
  EXPECT_GE(spans[0].end, 90);
  EXPECT_LE(spans[0].end, 90 + 7);
  EXPECT_TRUE(FindSpans(options, Jittered(ClipMoving("p", "a", 150, 60, 90, 0.0), 0.010), findings).empty());
}

TEST(Trim, AnArmThatRisesSlowlyWhileAllElseRestsIsNotCut) {
  const SkeletonPtr skeleton = Skeleton15();
  Clip clip = ClipMoving("p", "a", 120, 0, 120, 0.0);
  const int hand = *skeleton->FindJoint("left_wrist");
  for (int f = 0; f < 120; ++f) clip.motion->joints.at(f, hand).y() += 0.2 * clip.rate.FrameTime(f);
  TrimOptions options;
  options.rule = TrimRule::kMotionEnergy;
  options.margin_s = 0.0;
  std::vector<Finding> findings;
  const auto spans = FindSpans(options, clip, findings);
  ASSERT_EQ(spans.size(), 1u);
  EXPECT_EQ(spans[0].begin, 0);
  EXPECT_EQ(spans[0].end, 120);
  EXPECT_TRUE(findings.empty());
}

/// Joints on a line at these speeds, m/s, 30 Hz.
Clip ClipAtSpeeds(const std::vector<double>& speeds) {
  Clip clip = ClipMoving("p", "a", static_cast<int>(speeds.size()), 0, 1, 0.0);
  double place = 0.0;
  for (int f = 0; f < clip.motion->frame_count(); ++f) {
    place += speeds[static_cast<std::size_t>(f)] / 30.0;
    for (int j = 0; j < clip.motion->joint_count(); ++j) clip.motion->joints.at(f, j).z() += place;
  }
  return clip;
}

TEST(Trim, AMovementBeginsWhereItLeavesStillnessAndCountsOnlyIfItGetsFast) {
  // Still, a slow sway of a second, still, a movement that starts slowly, still.
  std::vector<double> speeds(240, 0.0);
  std::fill(speeds.begin() + 30, speeds.begin() + 60, 0.3);
  for (int f = 120; f < 180; ++f) speeds[static_cast<std::size_t>(f)] = f < 150 ? 0.3 : 1.0;
  const Clip clip = ClipAtSpeeds(speeds);
  TrimOptions options;
  options.rule = TrimRule::kMotionEnergy;
  options.margin_s = 0.0;
  std::vector<Finding> findings;
  const auto alike = FindSpans(options, clip, findings);
  ASSERT_EQ(alike.size(), 1u);
  EXPECT_NEAR(alike[0].begin, 30, 4);
  options.moving_speed = 0.5;
  const auto fast = FindSpans(options, clip, findings);
  ASSERT_EQ(fast.size(), 1u);
  EXPECT_NEAR(fast[0].begin, 120, 4);
  EXPECT_NEAR(fast[0].end, 180, 6);
  options.moving_speed = 2.0;
  findings.clear();
  EXPECT_TRUE(FindSpans(options, clip, findings).empty());
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "never_moves");
  EXPECT_EQ(LimitOfTrim(options, "never_moves"), 2.0);
}

TEST(Trim, SpeedsDoNotDependOnTheFrameRate) {
  Clip slow = ClipMoving("p", "a", 60, 0, 60, 3.0);
  Clip fast = ClipMoving("p", "a", 240, 0, 240, 3.0);
  fast.rate = FrameRate{120, 1};
  fast.motion = MakeJointsOnly(fast.motion->skeleton, fast.rate, fast.motion->joints);
  EXPECT_NEAR(FrameSpeeds(*slow.motion, 0.4)[30], 1.5, 1e-9);
  EXPECT_NEAR(FrameSpeeds(*fast.motion, 0.4)[120], 1.5, 1e-9);
  EXPECT_NEAR(FrameSpeeds(*fast.motion, 0.0)[0], 1.5, 1e-9);
}

TEST(Trim, AnnotatedSegmentsBecomeClipsAndUnwantedLabelsAreExcluded) {
  Clip clip = ClipMoving("p", "a", 90, 10, 50, 1.0);
  clip.segments = {
      {0.0, 1.0, "idle", "", "annotated"}, {1.0, 2.0, "wave", "", "annotated"}, {2.0, 2.05, "jump", "", "annotated"}};
  TrimOptions options;
  options.rule = TrimRule::kAnnotated;
  options.drop_labels = {"idle"};
  std::vector<Finding> findings;
  const auto spans = FindSpans(options, clip, findings);
  ASSERT_EQ(spans.size(), 1u);
  EXPECT_EQ(spans[0].label, "wave");
  EXPECT_EQ(spans[0].begin, 30);
  EXPECT_EQ(spans[0].end, 60);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[1].code, "too_short");
}

TEST(Trim, AFrameOfMoreThanAHundredSegmentsIsRefused) {
  Clip clip = ClipMoving("p", "a", 90, 10, 50, 1.0);
  clip.segments.assign(100, {0.5, 1.0, "wave", "", "annotated"});
  clip.segments.push_back({1.0, 9.0, "walk", "", "annotated"});
  EXPECT_TRUE(CheckOverlap(clip, "spans.csv"));
  clip.segments.push_back({0.9999, 1.0, "walk", "", "annotated"});
  const Status refused = CheckOverlap(clip, "spans.csv");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInconsistent);
  EXPECT_EQ(refused.error().where, "spans.csv");
  clip.segments.clear();
  EXPECT_TRUE(CheckOverlap(clip, "spans.csv"));
}

TEST(Trim, AStillStaysOnlyWhereNoLengthIsAskedFor) {
  Clip clip = ClipMoving("p", "a", 90, 10, 50, 1.0);
  clip.segments = {{1.0, 1.0 + 1.0 / 30.0, "pose", "", "annotated"}, {2.0, 2.0, "nothing", "", "annotated"}};
  TrimOptions options;
  options.rule = TrimRule::kAnnotated;
  std::vector<Finding> findings;
  EXPECT_TRUE(FindSpans(options, clip, findings).empty());
  ASSERT_FALSE(findings.empty());
  EXPECT_THAT(findings[0].message, testing::HasSubstr("one frame of 'pose'"));
  options.min_length_s = 0.0;
  const auto spans = FindSpans(options, clip, findings);
  ASSERT_EQ(spans.size(), 1u) << "a span without a frame never stays";
  EXPECT_EQ(spans[0].begin, 30);
  EXPECT_EQ(spans[0].end, 31);
}

TEST(Tracks, MissingObservationsAreInterpolatedAndMarkedAndNeverRead) {
  const SkeletonPtr skeleton = Skeleton15();
  JointTracks tracks;
  tracks.positions = JointPositions(3, skeleton->joint_count());
  tracks.time_s = {0.0, 1.0, 2.0};
  tracks.confidence.assign(3 * skeleton->joint_count(), 1.0);
  for (const Joint& joint : skeleton->joints) tracks.names.push_back(joint.name);
  tracks.positions.at(0, 2) = Vector3d(0, 0, 0);
  tracks.positions.at(1, 2) = Vector3d(std::nan(""), 1e9, 0);
  tracks.positions.at(2, 2) = Vector3d(2, 0, 0);
  tracks.confidence[skeleton->joint_count() + 2] = 0.0;
  const auto motion = MotionFromTracks(tracks, skeleton, FrameRate{1, 1}, 10.0);
  ASSERT_TRUE(motion) << motion.error().Message();
  EXPECT_EQ(Vector3d(motion->joints.at(1, 2)), Vector3d(1, 0, 0));
  EXPECT_EQ(motion->state[skeleton->joint_count() + 2], JointState::kInterpolated);
}

TEST(Tracks, AJointThatNoPersonTracksIsNamed) {
  JointTracks tracks;
  tracks.names = {"head"};
  tracks.positions = JointPositions(2, 1);
  tracks.time_s = {0, 1};
  tracks.confidence = {1, 1};
  const auto motion = MotionFromTracks(tracks, Skeleton15(), FrameRate{1, 1}, 10.0);
  ASSERT_FALSE(motion);
  EXPECT_THAT(motion.error().what, HasSubstr("left_knee"));
}

}  // namespace
}  // namespace mocurate
