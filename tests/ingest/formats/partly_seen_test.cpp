// Whatever the format, a clip has no more frames than the time in which the person was seen, and no frame is stated as
// observed that was not.

#include "tests/support/partly_seen_files.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/motion/gaps.h"
#include "ingest/formats/driver.h"
#include "ingest/synthetic/studio_layouts.h"
#include "tests/ingest/sources.h"

namespace mocurate::variants {

const fs::path& Studio(const std::string& layout, const std::vector<std::string>& options) {
  static std::map<std::string, fs::path> made;
  const auto [at, fresh] = made.try_emplace(layout, SharedScratch("partly_seen_studio_" + layout));
  if (!fresh) return at->second;
  const fs::path file = SharedScratch("partly_seen_studio.yaml");
  Place(file, "layout: " + layout + "\nseed: 7\n");
  const auto node = LoadConfig(file, options);
  EXPECT_TRUE(node) << node.error().Message();
  const auto studio = OptionsFromConfig<StudioOptions>(*node);
  EXPECT_TRUE(studio) << studio.error().Message();
  const auto counts = WriteStudioLayout(*studio, at->second, 2);
  EXPECT_TRUE(counts) << counts.error().Message();
  return at->second;
}

namespace {

using Builder = std::string (*)(const fs::path& folder, const Seen& seen);

/// A builder of each format. Tables have two: frames are missing by their number, or by what their row holds.
const std::vector<std::pair<std::string, Builder>>& Builders() {
  static const std::vector<std::pair<std::string, Builder>> builders = {
      {"joint_table", ZeroTable},
      {"joint_table", [](const fs::path& folder, const Seen& seen) { return NumberedTable(folder, seen, 440); }},
      {"bvh", BvhFile},
      {"npy", ArrayFile},
      {"depth_sequence", DepthSequenceFiles},
      {"ntu_skeleton", NtuFile},
      {"asf_amc", AmcFile},
      {"amass", AmassFile},
      {"expmap", ExpmapFile},
      {"phspd", PhspdFile},
      {"vibe_tracks", VibeFile},
      {"uestc", [](const fs::path& folder, const Seen& seen) { return UestcFile(folder, seen); }},
      {"humanact12_pickle", HumanAct12File},
      {"motions", StoredFile},
      {"openpose", OpenPoseWhole},
      {"depth_views", DepthViewFiles},
      {"panoptic", PanopticFiles},
      {"clouds", CloudFiles},
      {"c3d", C3dMarkers},
      {"trc", [](const fs::path& folder, const Seen& seen) { return TrcMarkers(folder, seen, false); }},
      {"trc", [](const fs::path& folder, const Seen& seen) { return TrcMarkers(folder, seen, true); }}};
  return builders;
}

/// Frames with up to three gaps of any length, also at the ends. At least three are seen.
Seen RandomlySeen(const std::string& item) {
  Random random(56, "partly seen", item);
  Seen seen;
  do {
    seen.assign(40 + random.Below(50), true);
    for (std::uint64_t gaps = random.Below(4); gaps > 0; --gaps) {
      const auto length = 1 + random.Below(random.Below(2) == 0 ? 14 : 40);
      const auto begin = random.Below(seen.size());
      const auto end = std::min<std::uint64_t>(seen.size(), begin + length);
      std::fill(seen.begin() + static_cast<std::ptrdiff_t>(begin), seen.begin() + static_cast<std::ptrdiff_t>(end),
                false);
    }
    if (random.Below(4) == 0) std::reverse(seen.begin(), seen.end());
  } while (std::count(seen.begin(), seen.end(), true) < 3);
  return seen;
}

std::string TextOf(const Seen& seen) {
  std::string text;
  for (const bool one : seen) text += one ? '#' : '.';
  return text;
}

/// For each frame of the clip whether its evidence or its motion states that something was observed.
Seen StatedOf(const Clip& clip) {
  const Evidence& evidence = clip.evidence;
  Seen stated;
  const auto note = [&](int frame) {
    if (frame >= static_cast<int>(stated.size())) stated.resize(static_cast<std::size_t>(frame) + 1, false);
    stated[static_cast<std::size_t>(frame)] = true;
  };
  const auto at_time = [&](double time_s) { return static_cast<int>(std::lround(time_s * clip.rate.hz())); };
  if (evidence.tracks) {
    const JointTracks& tracks = *evidence.tracks;
    const auto joints = static_cast<std::size_t>(tracks.positions.joints);
    stated.resize(std::max(stated.size(), static_cast<std::size_t>(tracks.positions.frames)), false);
    for (std::size_t i = 0; i < tracks.confidence.size(); ++i) {
      if (tracks.confidence[i] > 0.0) note(static_cast<int>(i / joints));
    }
  }
  for (const KeypointView& view : evidence.keypoint_views) {
    stated.resize(std::max(stated.size(), static_cast<std::size_t>(view.frames())), false);
    for (int f = 0; f < view.frames(); ++f) {
      for (int p = 0; p < view.people; ++p) {
        for (int k = 0; k < view.points(); ++k) {
          if (view.at(f, p, k)[2] > 0.0) note(f);
        }
      }
    }
  }
  for (const DepthView& view : evidence.depth_views) {
    for (std::size_t i = 0; i < view.files.size(); ++i) {
      if (!view.files[i].empty()) note(at_time(view.time_s[i]));
    }
  }
  if (evidence.clouds) {
    stated.resize(std::max(stated.size(), evidence.clouds->files.size()), false);
    for (std::size_t f = 0; f < evidence.clouds->files.size(); ++f) {
      if (!evidence.clouds->files[f].empty()) note(static_cast<int>(f));
    }
  }
  if (clip.motion) {
    const Motion& motion = *clip.motion;
    const auto joints = static_cast<std::size_t>(motion.joint_count());
    stated.resize(std::max(stated.size(), static_cast<std::size_t>(motion.frame_count())), false);
    for (std::size_t i = 0; i < static_cast<std::size_t>(motion.frame_count()) * joints; ++i) {
      const JointState state = motion.state.empty() ? JointState::kObserved : motion.state[i];
      if (state == JointState::kObserved || state == JointState::kRepaired) note(static_cast<int>(i / joints));
    }
  }
  return stated;
}

/// Frames from the first to the last that show the person.
Seen WithoutEnds(const Seen& seen) {
  return Seen(std::find(seen.begin(), seen.end(), true), std::find(seen.rbegin(), seen.rend(), true).base());
}

/// Frames in gaps of more than half a second are inferred, in every joint.
void ExpectLongGapsInferred(const Motion& motion, const Seen& span) {
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  for (const FrameRun& gap : RunsWhere(span, false)) {
    if (motion.rate.FrameTime(gap.frames()) <= kMaxGap_s + 1e-6) continue;
    ASSERT_LE(gap.end, motion.frame_count());
    ASSERT_FALSE(motion.state.empty());
    for (std::size_t i = gap.begin * joints; i < gap.end * joints; ++i) {
      ASSERT_EQ(motion.state[i], JointState::kInferred) << "frame " << i / joints << ", joint " << i % joints;
    }
  }
}

/// `stored`: of a dataset, whose clips keep their frames.
void ExpectNothingInvented(const Clip& clip, const Seen& seen, bool stored) {
  const Seen span = stored ? seen : WithoutEnds(seen);
  EXPECT_LE(clip.identity.end_frame - clip.identity.begin_frame, static_cast<int>(span.size()));
  Seen stated = StatedOf(clip);
  ASSERT_LE(stated.size(), span.size());
  stated.resize(span.size(), false);
  EXPECT_EQ(TextOf(stated), TextOf(span)) << "frames that the clip states as observed, and those that show the person";
  if (clip.motion) ExpectLongGapsInferred(*clip.motion, span);
}

/// Reads the clip of a format with frames without a person. It is kept with nothing invented, or it is not kept.
bool ReadsWithoutInventing(const std::string& format, Builder build, const Seen& seen, const std::string& name) {
  const fs::path folder = FreshFolder("partly_seen");
  const fs::path job = FreshFolder("partly_seen_job") / "job.yaml";
  Place(job, build(folder, seen));
  const auto node = LoadConfig(job, {});
  EXPECT_TRUE(node) << node.error().Message();
  const ConfigNode* group = node ? node->Find("ingest") : nullptr;
  if (group == nullptr) return false;
  const auto options = OptionsFromConfig<IngestOptions>(*group);
  EXPECT_TRUE(options) << options.error().Message();
  if (!options) return false;
  EXPECT_EQ(options->source.format, format);
  const auto discovery = Discover(*options);
  EXPECT_TRUE(discovery) << discovery.error().Message();
  if (!discovery || discovery->items.size() != 1) return false;
  const ItemSpec& item = discovery->items[0];
  const fs::path artifact = SharedScratch("partly_seen_" + name + ".h5");
  fs::remove(artifact);
  const auto outcome = IngestStage({"ingest", item.item, item.options.Whole(), item.inputs, artifact, folder});
  if (!outcome || !HasArtifact(outcome->kind)) return false;
  const auto clip = ReadEvidence(artifact);
  EXPECT_TRUE(clip) << clip.error().Message();
  if (clip) ExpectNothingInvented(*clip, seen, DriverOf(format).stored);
  return true;
}

class PartlySeen : public ::testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override {
    if (format() == "asf_amc" && TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
  const std::string& format() const { return Builders()[GetParam()].first; }
  Builder build() const { return Builders()[GetParam()].second; }
};

TEST_P(PartlySeen, AWholeClipIsReadWhole) {
  EXPECT_TRUE(ReadsWithoutInventing(format(), build(), Seen(40, true), "whole_" + std::to_string(GetParam())))
      << "the clip is not kept";
}

/// Formats whose clips must have every frame: a damaged row, or a missing image, refuses the clip.
const std::set<std::string> kWholeOnly = {"humanact12_pickle", "depth_sequence", "depth_views"};

TEST_P(PartlySeen, NoFrameIsInventedWhateverIsMissing) {
  int kept_with_gap = 0;
  for (int trial = 0; trial < 8; ++trial) {
    const std::string name = std::to_string(GetParam()) + "_" + std::to_string(trial);
    Seen seen = trial > 0 ? RandomlySeen(format() + name) : Seen(60, true);
    if (trial == 0) std::fill(seen.begin() + 20, seen.begin() + 38, false);  // a long gap
    SCOPED_TRACE(format() + " " + std::to_string(trial) + ": " + TextOf(seen));
    const Seen span = WithoutEnds(seen);
    const bool gap = std::count(span.begin(), span.end(), false) > 0;
    const bool kept = ReadsWithoutInventing(format(), build(), seen, name);
    kept_with_gap += kept && gap ? 1 : 0;
  }
  EXPECT_EQ(kept_with_gap > 0, kWholeOnly.count(format()) == 0) << kept_with_gap;
}

INSTANTIATE_TEST_SUITE_P(Formats, PartlySeen, ::testing::Range<std::size_t>(0, Builders().size()),
                         [](const ::testing::TestParamInfo<std::size_t>& tested) {
                           return Builders()[tested.param].first + "_" + std::to_string(tested.param);
                         });

TEST(PartlySeenFormats, AreAllFormats) {
  std::set<std::string> built;
  for (const auto& [format, build] : Builders()) built.insert(format);
  for (const FormatDriver& driver : FormatDrivers()) {
    const std::set<std::string> added = {"none", "toy", "pose_csv"};  // by other tests
    if (added.count(driver.name) != 0) continue;
    EXPECT_EQ(built.count(driver.name), 1u) << driver.name << " has no builder";
  }
}

}  // namespace
}  // namespace mocurate::variants
