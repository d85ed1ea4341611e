// A recording is cut where the action changes, independent of the person's position and the rate.

#include <gtest/gtest.h>

#include "canon/trim/trim.h"
#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "tests/canon/moving_clips.h"
#include "tests/canon/studio_recordings.h"
#include "tests/support/boundary_score.h"

namespace mocurate {
namespace {

std::vector<double> InnerBoundaries(const std::vector<ProposedSegment>& segments, FrameRate rate) {
  std::vector<double> times;
  for (std::size_t i = 1; i < segments.size(); ++i) times.push_back(rate.FrameTime(segments[i].begin));
  return times;
}

Clip ClipOfRecording(const Motion& motion) {
  Clip clip;
  clip.identity = {"test", "p", "r", "", "", "", 0, motion.frame_count()};
  clip.rate = motion.rate;
  clip.motion = motion;
  return clip;
}

TEST(ChangePoints, FindBeginsAndEndsOfActionsOfTheStudio) {
  BoundaryScore half, quarter;
  for (const LongRecording& recording : StudioRecordings(41, 2, 4, FrameRate{30, 1})) {
    const auto found = InnerBoundaries(ProposeSegments({}, recording.motion), recording.motion.rate);
    half.Add(ScoreBoundaries(found, recording.truth_s, 0.5));
    quarter.Add(ScoreBoundaries(found, recording.truth_s, 0.25));
  }
  ASSERT_GE(half.truth, 50);
  EXPECT_GE(half.f1(), 0.85);
  EXPECT_GE(quarter.f1(), 0.75);
  EXPECT_LE(half.median_s(), 0.12);
}

TEST(ChangePoints, SegmentsCoverTheRecordingInOrderWithConfidencesInRange) {
  for (const LongRecording& recording : StudioRecordings(42, 1, 3, FrameRate{30, 1})) {
    const auto segments = ProposeSegments({}, recording.motion);
    ASSERT_FALSE(segments.empty());
    EXPECT_EQ(segments.front().begin, 0);
    EXPECT_EQ(segments.back().end, recording.motion.frame_count());
    for (std::size_t i = 0; i < segments.size(); ++i) {
      EXPECT_LT(segments[i].begin, segments[i].end);
      if (i > 0) {
        EXPECT_EQ(segments[i].begin, segments[i - 1].end);
      }
      EXPECT_GE(segments[i].confidence, 0.0);
      EXPECT_LE(segments[i].confidence, 1.0);
    }
  }
}

TEST(ChangePoints, DoNotDependOnPlaceOrHeading) {
  const LongRecording recording = StudioRecordings(43, 1, 1, FrameRate{30, 1}).front();
  Clip moved = ClipOfRecording(recording.motion);
  Transform({Quaterniond(Eigen::AngleAxisd(2.1, Vector3d::UnitY())), Vector3d(3.0, 0.4, -7.0)}, moved);
  const auto before = ProposeSegments({}, recording.motion), after = ProposeSegments({}, *moved.motion);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(before[i].begin, after[i].begin);
    EXPECT_EQ(before[i].rest, after[i].rest);
    EXPECT_NEAR(before[i].confidence, after[i].confidence, 1e-6);
  }
}

TEST(ChangePoints, DoNotDependOnTheFrameRate) {
  BoundaryScore agreement;
  for (const LongRecording& recording : StudioRecordings(44, 1, 4, FrameRate{60, 1})) {
    const Clip slow = Resample(ClipOfRecording(recording.motion), FrameRate{30, 1});
    agreement.Add(ScoreBoundaries(InnerBoundaries(ProposeSegments({}, *slow.motion), FrameRate{30, 1}),
                                  InnerBoundaries(ProposeSegments({}, recording.motion), FrameRate{60, 1}), 0.1));
  }
  EXPECT_GE(agreement.f1(), 0.95);
}

TEST(ChangePoints, HardlyAnythingChangesWithATrackersNoise) {
  BoundaryScore score;
  for (LongRecording& recording : StudioRecordings(45, 1, 4, FrameRate{30, 1})) {
    Random random(5, "tracker noise", recording.name);
    JointPositions joints = recording.motion.joints;
    for (double& value : joints.xyz) value += 0.01 * random.Normal();
    const Motion noisy = MakeJointsOnly(recording.motion.skeleton, recording.motion.rate, joints);
    score.Add(ScoreBoundaries(InnerBoundaries(ProposeSegments({}, noisy), noisy.rate), recording.truth_s, 0.5));
  }
  EXPECT_GE(score.f1(), 0.8);
}

TEST(ChangePoints, AMotionWithoutFramesHasNoSegmentAndAStillOneIsOneRest) {
  EXPECT_TRUE(ProposeSegments({}, *ClipMoving("p", "a", 0, 0, 1, 0.0).motion).empty());
  const auto one = ProposeSegments({}, *ClipMoving("p", "a", 1, 0, 1, 0.0).motion);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].end, 1);
  const auto still = ProposeSegments({}, *ClipMoving("p", "a", 3600, 0, 3600, 0.0).motion);  // longer than `longest`
  ASSERT_EQ(still.size(), 1u);
  EXPECT_TRUE(still[0].rest);
  EXPECT_EQ(still[0].end, 3600);
}

TEST(ChangePoints, ARuleDropsRestsAndWritesTheConfidenceOfTheLessConfidentEnd) {
  Clip clip = ClipOfRecording(StudioRecordings(46, 1, 1, FrameRate{30, 1}).front().motion);
  TrimOptions options;
  options.rule = TrimRule::kChangePoints;
  std::vector<Finding> findings;
  const auto actions = FindSpans(options, clip, findings);
  options.change_points.keep_rests = true;
  std::vector<Finding> none;
  const auto all = FindSpans(options, clip, none);
  ASSERT_FALSE(actions.empty());
  EXPECT_EQ(all.size(), actions.size() + findings.size());
  EXPECT_TRUE(none.empty());
  for (const Finding& finding : findings) EXPECT_EQ(finding.code, "rest");
  const auto segments = ProposeSegments(options.change_points, *clip.motion);
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    EXPECT_EQ(all[i].confidence, std::min(segments[i].confidence, segments[i + 1].confidence));
  }
  options.change_points.min_confidence = 1.0;
  EXPECT_EQ(FindSpans(options, clip, none).size(), 1u);
}

}  // namespace
}  // namespace mocurate
