// Listed spans cut recordings: whatever the clip's rate, wherever it begins in its recording.

#include <gtest/gtest.h>

#include "canon/recipes/spans_file.h"
#include "canon/trim/trim.h"
#include "tests/canon/moving_clips.h"

namespace mocurate {
namespace {

ListedSpan Listed(const std::string& clip, double begin, double end, bool in_frames = false) {
  ListedSpan span;
  span.clip = clip;
  span.begin = begin;
  span.end = end;
  span.in_frames = in_frames;
  span.label = "walk";
  return span;
}

TEST(ListedSpans, ReplaceTheSegmentsOfTheClipsThatTheyName) {
  Clip clip = ClipMoving("p1", "a", 90, 30, 60, 1.0);
  clip.segments = {{0.0, 1.0, "old", "", "annotated"}};
  std::vector<Finding> findings;
  for (const std::string& name : {clip.identity.recording, "test/p1/" + clip.identity.recording, clip.id()}) {
    Clip marked = clip;
    ApplySpans({Listed(name, 0.5, 1.5)}, marked, findings);
    ASSERT_EQ(marked.segments.size(), 1u);
    EXPECT_EQ(marked.segments[0].label, "walk");
    EXPECT_NEAR(marked.segments[0].begin_s, 0.5, 1e-12);
  }
  Clip other = clip;
  ApplySpans({Listed("elsewhere", 0, 1)}, other, findings);
  EXPECT_EQ(other.segments[0].label, "old");
  EXPECT_TRUE(findings.empty());
}

TEST(ListedSpans, CountFromTheFirstFrameOfTheRecording) {
  Clip clip = ClipMoving("p1", "a", 90, 30, 60, 1.0);
  clip.identity.begin_frame = 60;
  clip.identity.end_frame = 150;
  std::vector<Finding> findings;
  Clip by_seconds = clip, by_frames = clip;
  ApplySpans({Listed("a90_30", 2.5, 3.5)}, by_seconds, findings);
  EXPECT_NEAR(by_seconds.segments.at(0).begin_s, 0.5, 1e-12);
  by_frames.provenance["first_frame"] = "100";  // of a file whose numbers begin there
  ApplySpans({Listed("a90_30", 175, 205, true)}, by_frames, findings);
  EXPECT_NEAR(by_frames.segments.at(0).begin_s, 0.5, 1e-12);
  EXPECT_NEAR(by_frames.segments.at(0).end_s, 1.5, 1e-12);
}

TEST(ListedSpans, OutsideTheClipAreCutOrDroppedAndReported) {
  Clip clip = ClipMoving("p1", "a", 90, 30, 60, 1.0);
  std::vector<Finding> findings;
  ApplySpans({Listed("a90_30", 2.0, 4.0), Listed("a90_30", 5.0, 6.0)}, clip, findings);
  ASSERT_EQ(clip.segments.size(), 1u);
  EXPECT_NEAR(clip.segments[0].end_s, 3.0, 1e-12);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].code, "span_outside");
  EXPECT_EQ(findings[0].severity, Severity::kWarning);
  EXPECT_EQ(findings[1].severity, Severity::kError);
  EXPECT_EQ(findings[1].action, FindingAction::kDropped);
}

TEST(ListedSpans, WithFineLabelsGiveClassAndFineClass) {
  Clip clip = ClipMoving("p1", "a", 90, 30, 60, 1.0);
  ListedSpan span = Listed("a90_30", 0.0, 2.0);
  span.fine_label = "walk_slowly";
  std::vector<Finding> findings;
  ApplySpans({span}, clip, findings);
  TrimOptions options;
  options.rule = TrimRule::kAnnotated;
  const auto kept = FindSpans(options, clip, findings);
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].label, "walk");
  EXPECT_EQ(kept[0].fine_label, "walk_slowly");
}

}  // namespace
}  // namespace mocurate
