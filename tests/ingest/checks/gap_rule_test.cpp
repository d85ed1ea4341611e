#include "ingest/sources/damaged_frames.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/random.h"
#include "core/motion/gaps.h"
#include "tests/motion/builders.h"

namespace mocurate {
namespace {

/// A clip at 30 Hz of each kind of evidence, observed in these frames alone.
enum class Kind { kTracks, kKeypoints, kClouds, kDepth, kMotion };
constexpr Kind kKinds[] = {Kind::kTracks, Kind::kKeypoints, Kind::kClouds, Kind::kDepth, Kind::kMotion};

IngestedClip ClipSeenIn(Kind kind, const std::vector<bool>& seen) {
  IngestedClip ingested;
  Clip& clip = ingested.clip;
  const auto frames = static_cast<int>(seen.size());
  clip.identity.end_frame = frames;
  std::vector<double> times;
  for (int f = 0; f < frames; ++f) times.push_back(clip.rate.FrameTime(f));
  if (kind == Kind::kMotion) {
    clip.motion = test::SwingingPerson(test::Built("kinect20"), frames);
    for (std::size_t at = 0; at < clip.motion->state.size(); ++at)
      clip.motion->state[at] = seen[at / 20] ? JointState::kObserved : JointState::kInterpolated;
  } else if (kind == Kind::kTracks) {
    JointTracks tracks;
    tracks.names = {"head", "neck"};
    tracks.positions = JointPositions(frames, 2);
    tracks.time_s = times;
    for (const bool one : seen) tracks.confidence.insert(tracks.confidence.end(), {one ? 1.0 : 0.0, 0.0});
    clip.evidence.tracks = tracks;
  } else if (kind == Kind::kClouds) {
    CloudFiles clouds;
    clouds.time_s = times;
    for (const bool one : seen) clouds.files.emplace_back(one ? "a.ply" : "");
    clouds.sha256.assign(seen.size(), "");
    clip.evidence.clouds = clouds;
  } else if (kind == Kind::kDepth) {
    DepthView view;
    view.time_s = times;
    for (const bool one : seen) view.files.emplace_back(one ? "a.png" : "");
    view.sha256.assign(seen.size(), "");
    clip.evidence.depth_views = {view, view};
  } else {
    clip.evidence.keypoint_names = {"nose"};
    KeypointView view;
    view.time_s = times;
    view.people = 2;
    for (const bool one : seen) view.values.insert(view.values.end(), {1.0, 1.0, 0.0, 1.0, 1.0, one ? 0.5 : 0.0});
    clip.evidence.keypoint_views = {view, view};
  }
  return ingested;
}

const Finding* FindingOf(const std::string& code, const IngestedClip& ingested) {
  const auto found = std::find_if(ingested.findings.begin(), ingested.findings.end(),
                                  [&](const Finding& finding) { return finding.code == code; });
  return found == ingested.findings.end() ? nullptr : &*found;
}

std::vector<bool> Seen(std::initializer_list<std::pair<int, bool>> runs) {
  std::vector<bool> seen;
  for (const auto& [count, value] : runs) seen.insert(seen.end(), static_cast<std::size_t>(count), value);
  return seen;
}

TEST(GapRule, CutsUnobservedEndsOfEveryKindOfEvidence) {
  for (const Kind kind : kKinds) {
    IngestedClip ingested = ClipSeenIn(kind, Seen({{7, false}, {20, true}, {5, false}}));
    ingested.findings.push_back(MakeFinding("whole", Severity::kInfo, 0.0, ""));
    ingested.findings.push_back(MakeFinding("cut", Severity::kInfo, 0.0, ""));
    ingested.findings.back().frame_end = 7;
    ingested.findings.push_back(MakeFinding("moved", Severity::kInfo, 0.0, ""));
    ingested.findings.back().frame_begin = 5;
    ingested.findings.back().frame_end = 10;
    EXPECT_FALSE(ApplyGapRule({}, ingested));
    EXPECT_EQ(FrameCount(ingested.clip), 20);
    EXPECT_EQ(ingested.clip.identity.begin_frame, 7);
    EXPECT_EQ(ingested.clip.identity.end_frame, 27);
    ASSERT_NE(FindingOf("unobserved_ends", ingested), nullptr);
    EXPECT_EQ(FindingOf("unobserved_ends", ingested)->value, 12.0);
    EXPECT_NE(FindingOf("whole", ingested), nullptr);
    ASSERT_NE(FindingOf("cut", ingested), nullptr);
    EXPECT_EQ(FindingOf("cut", ingested)->frame_end, 0) << "of the clip";
    ASSERT_NE(FindingOf("moved", ingested), nullptr);
    EXPECT_EQ(FindingOf("moved", ingested)->frame_begin, 0);
    EXPECT_EQ(FindingOf("moved", ingested)->frame_end, 3);
  }
}

TEST(GapRule, ReportsALongGapAndMarksItInAMotion) {
  for (const Kind kind : kKinds) {
    IngestedClip ingested = ClipSeenIn(kind, Seen({{30, true}, {15, false}, {30, true}, {16, false}, {30, true}}));
    EXPECT_FALSE(ApplyGapRule({}, ingested));
    EXPECT_EQ(std::count_if(ingested.findings.begin(), ingested.findings.end(),
                            [](const Finding& finding) { return finding.code == "long_gap"; }),
              1);
    EXPECT_EQ(FindingOf("long_gap", ingested)->frame_begin, 75);
    EXPECT_EQ(FindingOf("long_gap", ingested)->frame_end, 91);
    EXPECT_NEAR(FindingOf("long_gap", ingested)->value, 16.0 / 30.0, 1e-9);
    if (kind != Kind::kMotion) continue;
    EXPECT_EQ(ingested.clip.motion->state[30 * 20], JointState::kInterpolated);
    EXPECT_EQ(ingested.clip.motion->state[75 * 20], JointState::kInferred);
  }
}

TEST(GapRule, ExcludesAClipThatIsMostlyMissing) {
  for (const Kind kind : kKinds) {
    IngestedClip ingested = ClipSeenIn(kind, Seen({{30, false}, {20, true}, {41, false}, {20, true}}));
    const auto excluded = ApplyGapRule({}, ingested);
    ASSERT_TRUE(excluded);
    EXPECT_EQ(excluded->code, "mostly_missing");
    EXPECT_NEAR(excluded->value, 41.0 / 81.0, 1e-9);
    SourceOptions lenient;
    lenient.max_missing = 0.6;
    lenient.max_gap_s = 2.0;
    ingested = ClipSeenIn(kind, Seen({{20, true}, {41, false}, {20, true}}));
    EXPECT_FALSE(ApplyGapRule(lenient, ingested));
    EXPECT_EQ(FindingOf("long_gap", ingested), nullptr);
    EXPECT_EQ(MaxGapOf(ingested.clip), 2.0);
  }
}

TEST(GapRule, LeavesStoresAndTheReleasedCacheAsTheyAre) {
  SourceOptions stored, released;
  stored.format = "motions";
  released.people.rule = TrackRule::kUestcReleased;
  for (const SourceOptions& source : {stored, released}) {
    IngestedClip ingested = ClipSeenIn(Kind::kMotion, Seen({{7, false}, {5, true}, {90, false}, {5, true}}));
    EXPECT_FALSE(ApplyGapRule(source, ingested));
    EXPECT_EQ(ingested.clip.motion->frame_count(), 107);
    EXPECT_TRUE(ingested.findings.empty());
  }
}

/// Any pattern of observations: no more frames than from the first to the last of them.
TEST(GapRule, NeverLeavesMoreFramesThanWereObserved) {
  for (int seed = 0; seed < 50; ++seed) {
    Random random(static_cast<std::uint64_t>(seed), "gap rule", "");
    std::vector<bool> seen;
    const double share = random.Uniform();
    for (int f = 0; f < 90; ++f) seen.push_back(random.Uniform() < share);
    const auto first = std::find(seen.begin(), seen.end(), true);
    if (first == seen.end()) continue;
    const auto span = seen.rend() - std::find(seen.rbegin(), seen.rend(), true) - (first - seen.begin());
    for (const Kind kind : kKinds) {
      IngestedClip ingested = ClipSeenIn(kind, seen);
      ApplyGapRule({}, ingested);
      EXPECT_EQ(FrameCount(ingested.clip), span) << seed;
    }
  }
}

}  // namespace
}  // namespace mocurate
