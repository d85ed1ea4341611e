// A few marked spans of an action find the others in long recordings.

#include "canon/trim/by_example.h"

#include <gtest/gtest.h>

#include "core/motion/operations.h"
#include "tests/canon/moving_clips.h"
#include "tests/canon/studio_recordings.h"

namespace mocurate {
namespace {

Clip ExampleClip(const Motion& motion) {
  Clip clip;
  clip.identity = {"test", "p", "r", "", "", "", 0, motion.frame_count()};
  clip.rate = motion.rate;
  clip.motion = motion;
  return clip;
}

Motion CutOut(const Motion& motion, const Segment& segment) {
  const auto cut = Cut(ExampleClip(motion), static_cast<int>(std::lround(segment.begin_s * motion.rate.hz())),
                       static_cast<int>(std::lround(segment.end_s * motion.rate.hz())));
  return *cut->motion;
}

/// Of `category`, with the recordings that they are in.
std::vector<std::pair<std::size_t, Segment>> Occurrences(const std::vector<LongRecording>& recordings,
                                                         const std::string& category) {
  std::vector<std::pair<std::size_t, Segment>> found;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    for (const Segment& segment : recordings[r].segments) {
      if (segment.category == category) found.emplace_back(r, segment);
    }
  }
  return found;
}

bool HalfOverlaps(const KeptSpan& span, const Segment& segment, FrameRate rate) {
  const double begin_s = rate.FrameTime(span.begin), end_s = rate.FrameTime(span.end);
  const double both = std::min(end_s, segment.end_s) - std::max(begin_s, segment.begin_s);
  return both > 0.5 * (std::max(end_s, segment.end_s) - std::min(begin_s, segment.begin_s));
}

TEST(ByExample, ThreeExamplesFindTheOtherOccurrences) {
  const auto recordings = StudioRecordings(61, 3, 6, FrameRate{30, 1});
  int found_right = 0, found_all = 0, truth = 0;
  for (const char* category : {"drink_right", "boxing_left_right", "jump_vertical", "warm_up_bow_left"}) {
    const auto occurrences = Occurrences(recordings, category);
    if (occurrences.size() < 4) continue;
    std::vector<Motion> examples;
    for (std::size_t e = 0; e < 3; ++e) {
      examples.push_back(CutOut(recordings[occurrences[e].first].motion, occurrences[e].second));
    }
    for (std::size_t r = occurrences[2].first + 1; r < recordings.size(); ++r) {
      const auto found = FindByExample({}, examples, recordings[r].motion);
      ASSERT_TRUE(found) << found.error().Message();
      found_all += static_cast<int>(found->size());
      for (const auto& [at, segment] : occurrences) {
        if (at != r) continue;
        ++truth;
        for (const KeptSpan& span : *found) found_right += HalfOverlaps(span, segment, FrameRate{30, 1}) ? 1 : 0;
      }
      for (std::size_t i = 0; i < found->size(); ++i) {
        EXPECT_GE((*found)[i].confidence, ByExampleOptions().min_confidence);
        EXPECT_LE((*found)[i].confidence, 1.0);
        if (i > 0) {
          EXPECT_GE((*found)[i].begin, (*found)[i - 1].end);
        }
      }
    }
  }
  ASSERT_GE(truth, 5);
  EXPECT_GE(found_right, 0.75 * truth) << found_right << " of " << truth;
  EXPECT_GE(found_right, 0.75 * found_all) << found_right << " of " << found_all;
}

TEST(ByExample, AnExampleIsFoundInItsOwnRecordingTurnedAndAtAnotherRate) {
  const LongRecording recording = StudioRecordings(62, 1, 1, FrameRate{60, 1}).front();
  const Segment& segment = recording.segments[1];
  const Motion example = CutOut(recording.motion, segment);
  Clip turned = ExampleClip(recording.motion);
  Transform({Quaterniond(Eigen::AngleAxisd(1.3, Vector3d::UnitY())), Vector3d(2.0, 0.0, 1.0)}, turned);
  const Clip slow = Resample(turned, FrameRate{30, 1});
  const auto found = FindByExample({}, {example}, *slow.motion);
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_TRUE(std::any_of(found->begin(), found->end(), [&](const KeptSpan& span) {
    return span.confidence > 0.9 && std::abs(span.begin / 30.0 - segment.begin_s) < 0.2 &&
           std::abs(span.end / 30.0 - segment.end_s) < 0.2;
  }));
}

TEST(ByExample, OfTwoLabelsTheMoreConfidentStays) {
  const LongRecording recording = StudioRecordings(63, 1, 1, FrameRate{30, 1}).front();
  const Motion first = CutOut(recording.motion, recording.segments[0]);
  const Motion second = CutOut(recording.motion, recording.segments[1]);
  const auto spans = SpansByExample({}, {{"one", {first}}, {"two", {second}}}, recording.motion);
  ASSERT_TRUE(spans) << spans.error().Message();
  for (std::size_t i = 1; i < spans->size(); ++i) EXPECT_GE((*spans)[i].begin, (*spans)[i - 1].end);
  for (const auto& [label, segment] : {std::pair("one", recording.segments[0]), {"two", recording.segments[1]}}) {
    const double middle = 15.0 * (segment.begin_s + segment.end_s);
    EXPECT_TRUE(std::any_of(spans->begin(), spans->end(), [&](const KeptSpan& span) {
      return span.label == label && span.begin < middle && span.end > middle;
    })) << label;
  }
}

TEST(ByExample, RefusesNoExampleAndAnotherSkeletonAndFindsNothingInNothing) {
  const Motion standing = *ClipMoving("p", "a", 60, 10, 50, 1.0).motion;
  EXPECT_EQ(FindByExample({}, {}, standing).error().code, ErrorCode::kUsage);
  const Motion studio = StudioExercise(64, "kick", 0, 0).motion;
  EXPECT_EQ(FindByExample({}, {studio}, standing).error().code, ErrorCode::kInconsistent);
  const auto none = FindByExample({}, {standing}, *ClipMoving("p", "a", 0, 0, 1, 0.0).motion);
  ASSERT_TRUE(none) << none.error().Message();
  EXPECT_TRUE(none->empty());
}

}  // namespace
}  // namespace mocurate
