// MultiAct's samples: two actions and the transition between them, cut as the released code cuts them.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "canon/recipes/action_triples.h"
#include "core/motion/kinematics.h"
#include "tests/support/golden.h"

namespace mocurate {
namespace {

struct ExpectedTriple {
  int previous, transition, current, last;
};

std::vector<ActionTriple> TriplesAt(double hz, int frames, const std::vector<Segment>& segments,
                                    std::vector<Finding>* found = nullptr) {
  std::vector<Finding> findings;
  auto triples = FindTriples({}, segments, FrameRate::FromHz(hz), frames, findings);
  if (found != nullptr) *found = std::move(findings);
  return triples;
}

/// The worked examples of multiact.md A.3, measured with the released class.
TEST(Triples, OfTheWrittenExamplesAreTheWrittenNumbers) {
  const std::vector<Segment> labelled = {{0, 2, "stand", "", ""}, {2, 3, "transition", "", ""}, {3, 5, "walk", "", ""}};
  const std::vector<Segment> pair = {{0, 2, "stand", "", ""}, {2, 4.5, "walk", "", ""}};
  const std::vector<Segment> odd = {
      {0, 2.106, "stand", "", ""}, {2.106, 2.845, "transition", "", ""}, {2.845, 5, "walk", "", ""}};
  const std::vector<Segment> brief = {
      {0, .3, "stand", "", ""}, {.3, .6, "transition", "", ""}, {.6, 3, "walk", "", ""}};
  const std::vector<Segment> lengthy = {
      {0, 3, "stand", "", ""}, {3, 4, "transition", "", ""}, {4, 6.2, "walk", "", ""}};
  const std::vector<Segment> overlap = {
      {0, 2, "stand", "", ""}, {1.95, 3, "transition", "", ""}, {3, 5, "walk", "", ""}};
  const std::vector<std::tuple<double, int, std::vector<Segment>, ExpectedTriple>> examples = {
      {120, 1200, labelled, {37, 28, 38, 612}}, {120, 601, labelled, {37, 28, 35, 594}},
      {120, 1200, pair, {33, 18, 42, 552}},     {250, 2500, labelled, {38, 29, 41, 1284}},
      {100, 1000, odd, {38, 24, 41, 510}},      {120, 2000, brief, {6, 7, 50, 372}}};
  for (const auto& [hz, frames, segments, expected] : examples) {
    const auto triples = TriplesAt(hz, frames, segments);
    ASSERT_EQ(triples.size(), 1u) << hz << " Hz, " << frames;
    EXPECT_EQ(triples[0].previous_frames, expected.previous);
    EXPECT_EQ(triples[0].transition_frames, expected.transition);
    EXPECT_EQ(triples[0].current_frames, expected.current);
    EXPECT_EQ(triples[0].end_frame() - 1, expected.last);
    EXPECT_EQ(triples[0].current, "walk");
  }
  std::vector<Finding> found;
  EXPECT_TRUE(TriplesAt(120, 2000, lengthy, &found).empty());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].code, "triple_too_long");
  EXPECT_TRUE(TriplesAt(120, 2000, overlap).empty());
}

/// samples: motion, first frame, last frame, step, count, three lengths, three label ids (4: transition).
TEST(Triples, AreThoseOfTheReleasedCode) {
  if (golden::Folder() == nullptr) GTEST_SKIP() << "MOCURATE_GOLDENS is unset";
  const golden::File file(golden::PathOf("clip_preparation.h5"));
  const auto motions = file.Integers("babel/motions");
  const auto annotation = file.Integers("babel/annotation");
  const auto samples = file.Integers("babel/samples");
  const auto name_of = [](std::int64_t id) { return id == 4 ? std::string("transition") : std::to_string(id); };
  std::set<std::vector<std::int64_t>> theirs, ours;
  for (std::size_t i = 0; i < samples.rows(); ++i) theirs.emplace(samples.row(i), samples.row(i) + samples.row_size());
  for (std::size_t m = 0; m < motions.rows(); ++m) {
    const auto hz = static_cast<double>(motions.row(m)[0]);
    std::vector<Segment> segments;
    for (std::size_t i = 0; i < annotation.rows(); ++i) {
      const std::int64_t* row = annotation.row(i);
      if (row[0] != static_cast<std::int64_t>(m)) continue;
      // A quarter of a frame later: times that are truncated to these frames.
      segments.push_back({(static_cast<double>(row[2]) + 0.25) / hz, (static_cast<double>(row[3]) + 0.25) / hz,
                          name_of(row[1]), "", ""});
    }
    for (const ActionTriple& t : TriplesAt(hz, static_cast<int>(motions.row(m)[1]), segments)) {
      ours.insert({static_cast<std::int64_t>(m), t.first_frame, t.end_frame() - 1, t.step, t.frames(),
                   t.previous_frames, t.transition_frames, t.current_frames, std::stoll(t.previous), 4,
                   std::stoll(t.current)});
    }
  }
  EXPECT_EQ(ours, theirs);
}

TEST(Triples, OfSpansListedInFramesAreThoseOfTheirSecondsAtEveryRate) {
  for (const double hz : {24.0, 29.97002997, 30.0, 59.94005994, 100.0, 120.0, 250.0}) {
    const FrameRate rate = FrameRate::FromHz(hz);
    for (int shift = 0; shift < 40; ++shift) {
      const int a = static_cast<int>(1.7 * hz) + shift, b = a + static_cast<int>(0.8 * hz),
                c = b + static_cast<int>(1.9 * hz);
      const auto segments = [&](double offset) {
        std::vector<Segment> of;
        const auto add = [&](int begin, int end, const char* label) {
          of.push_back({(begin + offset) / rate.hz(), (end + offset) / rate.hz(), label, "", "listed"});
        };
        add(shift, a, "stand");
        add(a, b, "transition");
        add(b, c, "walk");
        return of;
      };
      std::vector<Finding> findings;
      const auto exact = FindTriples({}, segments(0.0), rate, 2000, findings);
      const auto inside = FindTriples({}, segments(0.25), rate, 2000, findings);
      ASSERT_EQ(exact.size(), inside.size()) << hz << " " << shift;
      for (std::size_t i = 0; i < exact.size(); ++i) {
        EXPECT_EQ(exact[i].first_frame, inside[i].first_frame);
        EXPECT_EQ(exact[i].previous_frames, inside[i].previous_frames);
        EXPECT_EQ(exact[i].transition_frames, inside[i].transition_frames);
        EXPECT_EQ(exact[i].frames(), inside[i].frames());
      }
    }
  }
}

TEST(Triples, AsAClipHoldTheRecordedFramesAndThreeSegments) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const int frames = 1200;
  std::vector<Vector3d> root;
  for (int f = 0; f < frames; ++f) root.emplace_back(0.001 * f, 1.0, 0.0);
  const std::vector<Quaterniond> rotation(static_cast<std::size_t>(frames * skeleton->joint_count()),
                                          Quaterniond::Identity());
  Clip clip;
  clip.identity = {"babel", "p1", "r1", "", "", "", 0, frames};
  clip.rate = FrameRate{120, 1};
  clip.motion = MakeMotion(skeleton, clip.rate, root, rotation, skeleton->RestBoneLengths());
  clip.segments = {{0, 2, "stand", "", ""}, {2, 3, "transition", "", ""}, {3, 5, "walk", "", ""}};
  const auto triples = TriplesAt(120, frames, clip.segments);
  ASSERT_EQ(triples.size(), 1u);
  const auto sample = TakeTriple({}, triples[0], clip);
  ASSERT_TRUE(sample) << sample.error().Message();
  ASSERT_EQ(sample->motion->frame_count(), triples[0].frames());
  EXPECT_EQ(sample->motion->rate, (FrameRate{20, 1}));
  EXPECT_EQ(sample->label, "walk");
  for (int f = 0; f < sample->motion->frame_count(); ++f) {
    EXPECT_EQ(sample->motion->root_translation[static_cast<std::size_t>(f)].x(),
              root[static_cast<std::size_t>(6 * f)].x());
  }
  ASSERT_EQ(sample->segments.size(), 3u);
  EXPECT_NEAR(sample->segments[1].begin_s * 20.0, triples[0].previous_frames, 1e-9);
  EXPECT_NEAR(sample->segments[2].begin_s * 20.0, triples[0].previous_frames + triples[0].transition_frames, 1e-9);
  EXPECT_EQ(sample->segments[0].label, "stand");
  EXPECT_EQ(sample->id(), "babel/p1/r1#0-613");
}

}  // namespace
}  // namespace mocurate
