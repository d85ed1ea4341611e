// Kinds of input that were once read wrongly without a word, in other formats than those they were reported of: frames
// without an observation, clocks taken for frame numbers, cameras with numbers of their own, padding scored as motion,
// names with two readings, splits by names that no clip has. Each is read as it is, or refused with its reason.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/formats/pickle_writer.h"
#include "tests/app/variants.h"
#include "tests/support/partly_seen_files.h"

namespace mocurate::variants {

const fs::path& Studio(const std::string& layout, const std::vector<std::string>& options) {
  static const ScratchFolder folder;
  static std::map<std::string, fs::path> made;
  const auto [at, fresh] = made.try_emplace(layout, folder / layout);
  if (!fresh) return at->second;
  std::vector<std::string> arguments = {"synthesize", "--layout", layout, "-o", at->second.string(), "--seed", "7"};
  for (const std::string& option : options) arguments.insert(arguments.end(), {"--set", option});
  const program::Result result = program::RunProgram(folder, arguments);
  EXPECT_EQ(result.exit_code, 0) << layout << ": " << result.err;
  return at->second;
}

namespace {

using program::Result;
using program::RunProgram;
using End = Ending::End;

template <class Variant>
std::string IdOf(const ::testing::TestParamInfo<Variant>& tested) {
  return tested.param.id;
}

// Gaps, at 30 Hz. `max_gap` is 0.5 s, `max_missing` half of the frames that remain without the unobserved ends.

using GapBuilder = std::string (*)(const fs::path& folder, const Seen& seen);

constexpr int kFrames = 120;
const Seen kWhole(kFrames, true);
const Seen kShort = Without(kFrames, {{50, 60}});                             // 0.33 s
const Seen kLong = Without(kFrames, {{50, 80}});                              // 1 s
const Seen kMostly = Without(kFrames, {{20, 100}});                           // two thirds
const Seen kEnds = Without(kFrames, {{0, 20}, {105, 120}});                   // 85 frames remain
const Seen kEndsAndMost = Without(kFrames, {{0, 30}, {100, 120}, {40, 90}});  // 50 of the 70 frames that remain

const Ending kAll{End::kKept, kFrames, {}, {}, {}, {"long_gap", "unobserved_ends", "mostly_missing"}};
const Ending kBridged{End::kKept, kFrames, Frames{50, 60}, {}, {}, {"long_gap", "unobserved_ends", "mostly_missing"}};
const Ending kMarked{End::kKept, kFrames, {}, Frames{50, 80}, {"long_gap"}, {"unobserved_ends", "mostly_missing"}};
const Ending kExcluded{End::kExcluded, 0, {}, {}, {"mostly_missing"}, {}};
const Ending kCut{End::kKept, 85, {}, {}, {"unobserved_ends"}, {"long_gap", "mostly_missing"}};

struct Gap {
  const char* id;
  GapBuilder build;
  Seen seen;
  Ending expected;
  bool recorded = false;  ///< needs MOCURATE_DATA
};

void PrintTo(const Gap& gap, std::ostream* out) { *out << gap.id; }

class Gaps : public ::testing::TestWithParam<Gap> {};

TEST_P(Gaps, NoFrameIsInvented) {
  const Gap& gap = GetParam();
  if (gap.recorded && std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const ScratchFolder folder;
  Judge(RunJob(folder, gap.build(folder / "d", gap.seen)), gap.expected);
}

std::string Numbered(const fs::path& folder, const Seen& seen) { return NumberedTable(folder, seen); }

/// Files of a frame each whose clip ends with the ingest: findings and outcome alone are judged.
class CloudGaps : public ::testing::Test {
 protected:
  Verdict Ingest(const Seen& seen) { return RunJob(folder_, CloudFiles(folder_ / "d", seen), "ingest"); }
  ScratchFolder folder_;
};

// The same builders without a gap are accepted: what fails below fails by its gap.
INSTANTIATE_TEST_SUITE_P(
    Whole, Gaps,
    ::testing::Values(Gap{"NtuSkeleton", NtuFile, kWhole, kAll}, Gap{"Amass", AmassFile, kWhole, kAll},
                      Gap{"Bvh", BvhFile, kWhole, kAll}, Gap{"Amc", AmcFile, kWhole, kAll, true},
                      Gap{"OpenPose", OpenPoseWhole, kWhole, kAll}, Gap{"ZeroRows", ZeroTable, kWhole, kAll},
                      Gap{"NumberedRows", Numbered, kWhole, kAll}, Gap{"Panoptic", PanopticFiles, kWhole, kAll},
                      Gap{"Npy", ArrayFile, kWhole, kAll}, Gap{"Vibe", VibeFile, kWhole, kAll}),
    IdOf<Gap>);

INSTANTIATE_TEST_SUITE_P(
    Variants, Gaps,
    ::testing::Values(
        // NTU .skeleton: 10 frames without bodies, interpolated.
        Gap{"NtuSkeletonShort", NtuFile, kShort, kBridged},
        // NTU .skeleton: a second without bodies, marked as inferred, kept.
        Gap{"NtuSkeletonLong", NtuFile, kLong, kMarked},
        // NTU .skeleton: lead-in and lead-out without bodies, cut.
        Gap{"NtuSkeletonEnds", NtuFile, kEnds, kCut},
        // AMASS: a second of NaN, marked as inferred, kept.
        Gap{"AmassLong", AmassFile, kLong, kMarked},
        // AMASS: two thirds NaN, excluded with its reason.
        Gap{"AmassMostly", AmassFile, kMostly, kExcluded},
        // BVH: 10 damaged rows, interpolated.
        Gap{"BvhShort", BvhFile, kShort, kBridged},
        // BVH: 30 damaged rows, marked as inferred, kept.
        Gap{"BvhLong", BvhFile, kLong, kMarked},
        // AMC at 120 Hz: the numbers jump by 40 frames, a third of a second: the gap stands in time, interpolated.
        Gap{"AmcShort", AmcFile, Without(240, {{100, 140}}),
            Ending{End::kKept, 240, Frames{100, 140}, {}, {}, {"long_gap"}}, true},
        // AMC at 120 Hz: the numbers jump by 100 frames, five sixths of a second: marked as inferred, kept.
        Gap{"AmcLong", AmcFile, Without(240, {{70, 170}}),
            Ending{End::kKept, 240, {}, Frames{70, 170}, {"long_gap"}, {"mostly_missing"}}, true},
        // OpenPose: no person in any view for a second, marked as inferred, kept.
        Gap{"OpenPoseLong", OpenPoseWhole, kLong, kMarked},
        // OpenPose: no person in any view at both ends, cut.
        Gap{"OpenPoseEnds", OpenPoseWhole, kEnds, kCut},
        // A joint table with all-zero rows (missing: zero) for a second, marked as inferred, kept.
        Gap{"ZeroRowsLong", ZeroTable, kLong, kMarked},
        // A joint table whose only rows that are not zero are a third, excluded.
        Gap{"ZeroRowsMostly", ZeroTable, kMostly, kExcluded},
        // Zero rows at both ends, cut before `max_missing` is judged: 50 of the remaining 70 are missing, excluded.
        Gap{"ZeroRowsEndsAndMostly", ZeroTable, kEndsAndMost, kExcluded},
        // A `frame` column that jumps by 10, interpolated.
        Gap{"NumberedRowsShort", Numbered, kShort, kBridged},
        // A `frame` column that jumps by 30, marked as inferred, kept.
        Gap{"NumberedRowsLong", Numbered, kLong, kMarked},
        // Panoptic: a second without bodies, marked as inferred, kept.
        Gap{"PanopticLong", PanopticFiles, kLong, kMarked},
        // Panoptic: lead-in and lead-out without bodies, cut.
        Gap{"PanopticEnds", PanopticFiles, kEnds, kCut},
        // npy: a second of NaN, marked as inferred, kept.
        Gap{"NpyLong", ArrayFile, kLong, kMarked},
        // npy: 10 frames of NaN, interpolated.
        Gap{"NpyShort", ArrayFile, kShort, kBridged},
        // VIBE: `frame_ids` jump by a second, marked as inferred, kept.
        Gap{"VibeLong", VibeFile, kLong, kMarked}),
    IdOf<Gap>);

// UESTC by ACTOR's released rule, which fills every gap: exempt, and says so.
TEST(GapsOfTheReleasedUestc, AreFilledWithAFinding) {
  const ScratchFolder folder;
  const Verdict verdict = RunJob(folder, UestcFile(folder / "d", kMostly, "uestc_released"));
  EXPECT_EQ(verdict.exit_code, 0) << verdict.text;
  EXPECT_TRUE(verdict.Has("frames_filled")) << verdict.text;
  EXPECT_FALSE(verdict.Has("mostly_missing")) << verdict.text;
  ASSERT_TRUE(verdict.dataset && verdict.dataset->clips.size() == 1) << verdict.text;
  EXPECT_EQ(verdict.dataset->clips[0].motion->frame_count(), kFrames);
}

// The same by the corrected rule: two thirds are missing, excluded.
TEST(GapsOfTheCorrectedUestc, AreJudgedAsAllGaps) {
  const ScratchFolder folder;
  Judge(RunJob(folder, UestcFile(folder / "d", kMostly)), kExcluded);
}

TEST_F(CloudGaps, ASecondWithoutCloudsIsALongGap) {
  const Verdict verdict = Ingest(kLong);
  EXPECT_EQ(verdict.exit_code, 0) << verdict.text;
  EXPECT_TRUE(verdict.Has("long_gap")) << verdict.text;
  EXPECT_FALSE(verdict.Has("mostly_missing")) << verdict.text;
}

TEST_F(CloudGaps, AClipOfWhichTwoThirdsHaveNoCloudIsExcluded) {
  const Verdict verdict = Ingest(kMostly);
  EXPECT_TRUE(verdict.Has("mostly_missing")) << verdict.text;
  EXPECT_EQ(verdict.Decided("excluded"), 1u) << verdict.text;
}

TEST_F(CloudGaps, AllCloudsAreNone) {
  const Verdict verdict = Ingest(Seen(60, true));
  EXPECT_EQ(verdict.exit_code, 0) << verdict.text;
  EXPECT_FALSE(verdict.Has("long_gap")) << verdict.text;
  EXPECT_FALSE(verdict.Has("frames_missing")) << verdict.text;
}

// Clocks. 60 frames at 30 Hz of a Kinect v2 with a first column without a name.

/// A clock of a frame in units of a second, as real ones jitter: whole units of at least `step`.
std::function<std::string(int)> Jittering(double per_second, double begin_s, double step = 1.0) {
  return [=](int frame) {
    const double jitter_s = 0.0012 * std::sin(12.9898 * frame) + 0.0007 * std::cos(78.233 * frame);
    const double units = (begin_s + frame / 30.0 + jitter_s) * per_second;
    return std::to_string(static_cast<long long>(std::llround(units / step) * static_cast<long long>(step)));
  };
}

std::string SecondsText(int frame) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4f", 1699.25 + frame / 30.0 + 0.0012 * std::sin(12.9898 * frame));
  return text;
}

constexpr int kClockFrames = 60;

/// The layout that `config init` writes for the files of a folder; empty where it writes none.
std::string WrittenLayout(const ScratchFolder& folder, Result& result) {
  result = RunProgram(folder, {"config", "init", (folder / "d").string()});
  const std::string key = "    layout: \"";
  const std::size_t at = result.out.find(key);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + key.size();
  return result.out.substr(begin, result.out.find('"', begin) - begin);
}

struct Clock {
  const char* id;
  std::function<std::string(int)> column;
  bool known;  ///< `config init` knows what the column is; otherwise it asks
  std::vector<bool> seen = Seen(kClockFrames, true);
  Ending expected = {End::kKept, kClockFrames, {}, {}, {}, {"long_gap", "layout_contradiction"}};
};

void PrintTo(const Clock& clock, std::ostream* out) { *out << clock.id; }

class Clocks : public ::testing::TestWithParam<Clock> {};

TEST_P(Clocks, AreReadAsTimeOrAskedFor) {
  const Clock& clock = GetParam();
  const ScratchFolder folder;
  KinectTable(folder / "d", clock.seen, clock.column, "frame 25*(x y z)");
  Result init;
  const std::string layout = WrittenLayout(folder, init);
  ASSERT_FALSE(layout.empty()) << init.out << init.err;
  EXPECT_EQ(layout.find("FILL_IN") == std::string::npos, clock.known) << layout;
  Judge(RunJob(folder, KinectTable(folder / "d", clock.seen, clock.column, layout)), clock.expected);
}

const Ending kDropped{End::kKept, 90, {}, Frames{30, 60}, {"long_gap"}, {}};
const Ending kAsked{End::kRefused, 0, {}, {}, {}, {}};

INSTANTIATE_TEST_SUITE_P(
    Variants, Clocks,
    ::testing::Values(
        // Nanoseconds: 60 frames.
        Clock{"Nanoseconds", Jittering(1e9, 1700000.0), true},
        // Ticks of 100 ns, as the Kinect v2 writes: 60 frames.
        Clock{"Ticks", Jittering(1e7, 86400.0), true},
        // Microseconds: 60 frames.
        Clock{"Microseconds", Jittering(1e6, 512.0), true},
        // Milliseconds: 60 frames.
        Clock{"Milliseconds", Jittering(1e3, 8981.0), true},
        // Seconds with decimals: 60 frames.
        Clock{"Seconds", SecondsText, true},
        // A second of dropped rows: they are a gap of 30 frames in time, inferred.
        Clock{"MillisecondsDropped", Jittering(1e3, 8981.0), true, Without(90, {{30, 60}}), kDropped},
        Clock{"NanosecondsDropped", Jittering(1e9, 1700000.0), true, Without(90, {{30, 60}}), kDropped},
        Clock{"SecondsDropped", SecondsText, true, Without(90, {{30, 60}}), kDropped},
        // 0, 33, 66, ...: a clock or every 33rd frame: config init asks, a run of what it wrote is refused.
        Clock{"EqualSteps", [](int frame) { return std::to_string(33 * frame); }, false, Seen(kClockFrames, true),
              kAsked},
        // Frame numbers from 440 on: 60 frames.
        Clock{"NumbersFrom440", [](int frame) { return std::to_string(440 + frame); }, true}),
    IdOf<Clock>);

/// A clock under the declaration `frame`, in these units a second.
class DeclaredFrames : public ::testing::TestWithParam<double> {};

TEST_P(DeclaredFrames, AClockContradictsThem) {
  const ScratchFolder folder;
  const Seen seen(kClockFrames, true);
  Judge(RunJob(folder, KinectTable(folder / "d", seen, Jittering(GetParam(), 8981.0), "frame 25*(x y z)")),
        {End::kRefused, 0, {}, {}, {"layout_contradiction"}, {}});
}

INSTANTIATE_TEST_SUITE_P(Variants, DeclaredFrames, ::testing::Values(1e3, 1e6, 1e7, 1e9));

TEST(DeclaredFramesFrom440, AreFrames) {
  const ScratchFolder folder;
  Judge(RunJob(folder, KinectTable(
                           folder / "d", Seen(kClockFrames, true),
                           [](int frame) { return std::to_string(440 + frame); }, "frame 25*(x y z)")),
        {End::kKept, kClockFrames, {}, {}, {}, {"long_gap", "layout_contradiction"}});
}

// Cameras.

constexpr int kViewFrames = 40;

/// Findings of an inspection.
std::set<std::string> Inspected(const ScratchFolder& folder, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"inspect", (folder / "d").string(), "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  std::set<std::string> codes;
  CollectCodes(nlohmann::json::parse(RunProgram(folder, arguments).out, nullptr, false), codes);
  return codes;
}

TEST(CameraNumbersOfOpenPose, AllFromZeroAreOneClip) {
  const ScratchFolder folder;
  Judge(RunJob(folder, OpenPoseFiles(folder / "d", Seen(kViewFrames, true))),
        {End::kKept, kViewFrames, {}, {}, {}, {"view_numbering", "long_gap"}});
}

// OpenPose: one camera's files begin at 440, the others' at 0: refused, also by `inspect`.
TEST(CameraNumbersOfOpenPose, NumbersThatNoOtherCameraHasRefuseTheClip) {
  const ScratchFolder folder;
  const std::string job = OpenPoseFiles(folder / "d", Seen(kViewFrames, true), {1, 440, 0});
  Judge(RunJob(folder, job), {End::kRefused, 0, {}, {}, {"view_numbering"}, {}});
  EXPECT_EQ(Inspected(folder).count("view_numbering"), 1u);
}

// OpenPose: the same with `first_frame` declared: 40 frames, no gap.
TEST(CameraNumbersOfOpenPose, ADeclaredFirstFrameAlignsTheCamera) {
  const ScratchFolder folder;
  std::string job = OpenPoseFiles(folder / "d", Seen(kViewFrames, true), {1, 440, 0});
  job.replace(job.find("  source:\n"), 10, "  source:\n    first_frame: {" + Cameras().at(1) + ": 440}\n");
  Judge(RunJob(folder, job), {End::kKept, kViewFrames, {}, {}, {}, {"view_numbering", "long_gap"}});
}

// OpenPose: one camera begins 8 frames later, numbered as the others: accepted, 40 frames.
TEST(CameraNumbersOfOpenPose, ACameraThatBeginsALittleLaterIsAccepted) {
  const ScratchFolder folder;
  Judge(RunJob(folder, OpenPoseFiles(folder / "d", Seen(kViewFrames, true), {1, 0, 8})),
        {End::kKept, kViewFrames, {}, {}, {}, {"view_numbering", "long_gap"}});
}

// Clouds: a frame numbered from 440 on is no later frame of those from 0 on: two halves of 15 files 440 numbers apart
// are not 470 frames. Excluded, as hardly any frame of the span is observed.
TEST(CameraNumbersOfClouds, AStretchNumberedFarAwayIsNoGapToFill) {
  const ScratchFolder folder;
  Seen seen(470, false);
  for (int f = 0; f < 15; ++f) seen[static_cast<std::size_t>(f)] = seen[static_cast<std::size_t>(455 + f)] = true;
  const Verdict verdict = RunJob(folder, CloudFiles(folder / "d", seen), "ingest");
  EXPECT_EQ(verdict.Decided("kept") + verdict.Decided("undecided"), 0u) << verdict.text;
  EXPECT_TRUE(verdict.Has("mostly_missing") || verdict.Has("view_numbering")) << verdict.text;
}

// Three Kinects of NTU: one that stops a fifth earlier is accepted, and adds no frame.
TEST(CameraNumbersOfNtu, ASensorThatStopsEarlierIsAccepted) {
  const ScratchFolder folder;
  constexpr int kLength = 60;
  for (int camera = 1; camera <= 3; ++camera) {
    Place(folder / ("d/nturgb+d_skeletons/S001C00" + std::to_string(camera) + "P001R001A023.skeleton"),
          WriteNtuSkeleton(NtuTake(camera == 3 ? kLength - 12 : kLength, camera)));
  }
  const Verdict verdict = RunJob(folder, JobOf("ntu_views", folder / "d", "ntu25", {"depth_files: \"\""}));
  EXPECT_EQ(verdict.exit_code, 0) << verdict.text;
  ASSERT_TRUE(verdict.dataset && verdict.dataset->clips.size() == 1) << verdict.text;
  EXPECT_LE(verdict.dataset->clips[0].motion->frame_count(), kLength + 1);
  EXPECT_FALSE(verdict.Has("view_numbering"));
}

// Padding. Published motions of HumanAct12's generators, scored by the published recogniser.

class Padding : public ::testing::Test {
 protected:
  static constexpr std::size_t kMotions = 20, kLength = 60, kWide = 72, kCutTo = 40;

  void SetUp() override {
    if (std::getenv("MOCURATE_GOLDENS") == nullptr) GTEST_SKIP() << "MOCURATE_GOLDENS is unset";
    const std::string bytes = Contents(Weights() / "humanact12/vanila_vae_tf/motion_joints500000.npy");
    const auto published = ParseNpy(bytes, "joints");
    ASSERT_TRUE(published);
    motions_ = *published;
    motions_.shape = {kMotions, kLength, kWide};
    motions_.dtype = "<f4";
    ASSERT_EQ(motions_.values.size(), kMotions * kLength * kWide);
  }
  static fs::path Weights() { return fs::path(std::getenv("MOCURATE_GOLDENS")) / "published"; }

  /// Frames from `begin` on of every second motion are zero, or repeat the frame before.
  NpyArray Padded(bool zeros, std::size_t begin = kCutTo, std::size_t end = kLength) const {
    NpyArray padded = motions_;
    for (std::size_t m = 0; m < kMotions; m += 2) {
      double* motion = padded.values.data() + m * kLength * kWide;
      for (std::size_t f = begin; f < end; ++f) {
        for (std::size_t k = 0; k < kWide; ++k) motion[f * kWide + k] = zeros ? 0.0 : motion[(begin - 1) * kWide + k];
      }
    }
    return padded;
  }

  Result Eval(const NpyArray& motions, std::vector<std::string> more = {}) {
    Place(folder_ / "set.npy", WriteNpy(motions));
    return EvalOf(folder_ / "set.npy", std::move(more));
  }
  Result EvalOf(const fs::path& set, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"eval",   "--protocol",  "a2m-humanact12",
                                          "--json", "--generated", set.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    program::Surroundings surroundings;
    surroundings.before_start = [] { setenv("MOCURATE_WEIGHTS", Weights().c_str(), 1); };
    return RunProgram(folder_, arguments, surroundings);
  }
  static double Jerk(const Result& result) {
    const nlohmann::json json = nlohmann::json::parse(result.out, nullptr, false);
    if (!json.is_object() || json.value("rows", nlohmann::json()).empty()) return -1.0;
    return json["rows"][0]["metrics"]["jerk"]["value"].get<double>();
  }
  /// The warnings of a code.
  static std::vector<nlohmann::json> Warnings(const Result& result, const std::string& code) {
    std::vector<nlohmann::json> found;
    const nlohmann::json json = nlohmann::json::parse(result.out, nullptr, false);
    if (!json.is_object() || !json.contains("warnings")) return found;
    for (const nlohmann::json& warning : json["warnings"]) {
      if (warning.value("code", std::string()) == code) found.push_back(warning);
    }
    return found;
  }
  /// Whether a warning of the code has the number among its fields.
  static bool Warns(const Result& result, const std::string& code, double number) {
    for (const nlohmann::json& warning : Warnings(result, code)) {
      for (const nlohmann::json& field : warning) {
        if (field.is_number() && field.get<double>() == number) return true;
      }
    }
    return false;
  }

  NpyArray motions_;
  const ScratchFolder folder_;
};

TEST_F(Padding, WholeMotionsAreScoredWhole) {
  const Result whole = Eval(motions_);
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_TRUE(Warnings(whole, "padding_cut").empty()) << whole.out;
  EXPECT_GT(Jerk(whole), 0.0);
}

// One array of all motions: zero frames at the end of ten of them are cut; the jerk stays that of the motions.
TEST_F(Padding, ZeroFramesOfAnArrayAreCut) {
  const Result padded = Eval(Padded(true));
  ASSERT_EQ(padded.exit_code, 0) << padded.err;
  EXPECT_TRUE(Warns(padded, "padding_cut", 10)) << padded.out;
  EXPECT_LT(Jerk(padded), 1.5 * Jerk(Eval(motions_)));
}

// A folder of one motion a file, as HumanML3D's programs write: zero frames are cut.
TEST_F(Padding, ZeroFramesOfAFolderOfFilesAreCut) {
  const NpyArray padded = Padded(true);
  for (std::size_t m = 0; m < kMotions; ++m) {
    NpyArray one;
    one.shape = {kLength, 24, 3};
    one.dtype = "<f4";
    const auto begin = padded.values.begin() + static_cast<std::ptrdiff_t>(m * kLength * kWide);
    one.values.assign(begin, begin + static_cast<std::ptrdiff_t>(kLength * kWide));
    Place(folder_ / ("set/walk_" + Digits(static_cast<int>(m), 2) + ".npy"), WriteNpy(one));
  }
  const Result result = EvalOf(folder_ / "set");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(Warns(result, "padding_cut", 10)) << result.out;
}

// Repeats of the last pose, to the last digit: 20 frames of ten motions are cut.
TEST_F(Padding, RepeatsOfTheLastPoseAreCut) {
  const Result repeated = Eval(Padded(false));
  ASSERT_EQ(repeated.exit_code, 0) << repeated.err;
  EXPECT_TRUE(Warns(repeated, "padding_cut", 10)) << repeated.out;
}

/// MDM's results.npy of the motions, with the frames of each that count.
std::string MdmFile(const NpyArray& motions, std::size_t length, const std::vector<double>& lengths) {
  NpyArray njct = motions;
  njct.shape = {motions.shape[0], 24, 3, length};
  for (std::size_t i = 0; i < motions.values.size(); ++i) {
    const std::size_t motion = i / (72 * length), frame = i / 72 % length, number = i % 72;
    njct.values[(motion * 72 + number) * length + frame] = motions.values[i];
  }
  NpyArray counts;
  counts.dtype = "<i8";
  counts.shape = {lengths.size()};
  counts.values = lengths;
  PickleWriter writer;
  writer.BeginDict();
  writer.Text("motion");
  writer.Array(njct);
  writer.Text("lengths");
  writer.Array(counts);
  writer.End();
  std::string header = "{'descr': '|O', 'fortran_order': False, 'shape': (), }";
  header += std::string(117 - header.size(), ' ') + "\n";
  return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + writer.Finish("results.npy").value();
}

// MDM's results.npy: repeats within the stated lengths are cut; with true lengths nothing is left to cut.
TEST_F(Padding, MdmResultsAreCutBeyondTheirLengthsAndWithinThem) {
  std::vector<double> lengths(kMotions, static_cast<double>(kLength));
  Place(folder_ / "results.npy", MdmFile(Padded(false), kLength, lengths));
  const Result whole = EvalOf(folder_ / "results.npy");
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_TRUE(Warns(whole, "padding_cut", 10)) << whole.out;
  for (std::size_t m = 0; m < kMotions; m += 2) lengths[m] = static_cast<double>(kCutTo);
  Place(folder_ / "results.npy", MdmFile(Padded(false), kLength, lengths));
  const Result stated = EvalOf(folder_ / "results.npy");
  ASSERT_EQ(stated.exit_code, 0) << stated.err;
  EXPECT_TRUE(Warnings(stated, "padding_cut").empty()) << stated.out;
  EXPECT_NEAR(Jerk(stated), Jerk(whole), 1e-9);
}

// Fewer than five equal frames at the end are a person who stands still.
TEST_F(Padding, AFewRepeatsAreMotion) {
  const Result result = Eval(Padded(false, kLength - 3));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(Warnings(result, "padding_cut").empty()) << result.out;
}

// A motion that never moves is no padding, however bad it is.
TEST_F(Padding, AMotionlessMotionIsNotCut) {
  const Result result = Eval(Padded(false, 1));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(Warnings(result, "padding_cut").empty()) << result.out;
}

// Lengths that the user states: as if the frames behind them were cut.
TEST_F(Padding, StatedLengthsCutTheMotions) {
  std::string lengths;
  for (std::size_t m = 0; m < kMotions; ++m) lengths += std::to_string(m % 2 == 0 ? kCutTo : kLength) + "\n";
  Place(folder_ / "lengths.txt", lengths);
  const Result stated = Eval(Padded(true), {"--lengths", (folder_ / "lengths.txt").string()});
  ASSERT_EQ(stated.exit_code, 0) << stated.err;
  EXPECT_NEAR(Jerk(stated), Jerk(Eval(Padded(true))), 1e-9);
  Place(folder_ / "lengths.txt", "40\n60\n");
  EXPECT_NE(Eval(Padded(true), {"--lengths", (folder_ / "lengths.txt").string()}).exit_code, 0) << "2 of 20 lengths";
}

// `--padding keep`: scored as given, and said so.
TEST_F(Padding, KeptPaddingIsScoredWithAWarning) {
  const Result kept = Eval(Padded(true), {"--padding", "keep"});
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_TRUE(Warns(kept, "padding_kept", 10)) << kept.out;
  EXPECT_TRUE(Warnings(kept, "padding_cut").empty()) << kept.out;
  EXPECT_GT(Jerk(kept), 2.0 * Jerk(Eval(motions_)));
}

// The program's own MotionSet states its frames: repeats are motion there.
TEST_F(Padding, RepeatsOfAMotionSetAreNotCut) {
  const NpyArray repeated = Padded(false);
  Dataset set;
  set.joints_only = true;
  set.created_by = "a test";
  set.skeleton = LoadSkeleton("smpl24").value();
  set.labels = {"walk"};
  for (std::size_t m = 0; m < kMotions; ++m) {
    JointPositions joints(static_cast<int>(kLength), 24);
    const auto begin = repeated.values.begin() + static_cast<std::ptrdiff_t>(m * kLength * kWide);
    joints.xyz.assign(begin, begin + static_cast<std::ptrdiff_t>(kLength * kWide));
    for (std::size_t i = 0; i < joints.xyz.size(); i += 3) {  // from y down to y up
      joints.xyz[i + 1] = -joints.xyz[i + 1];
      joints.xyz[i + 2] = -joints.xyz[i + 2];
    }
    Clip clip;
    clip.identity = {"made", "p", "take" + Digits(static_cast<int>(m), 2), "", "", "", 0, static_cast<int>(kLength)};
    clip.label = "walk";
    clip.rate = FrameRate{20, 1};
    clip.motion = MakeJointsOnly(set.skeleton, clip.rate, std::move(joints));
    set.clips.push_back(std::move(clip));
  }
  ASSERT_TRUE(WriteDataset(set, folder_ / "set.h5"));
  const Result result = EvalOf(folder_ / "set.h5");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(Warnings(result, "padding_cut").empty()) << result.out;
}

// Names.

struct Names {
  const char* id;
  std::vector<std::string> files;   ///< names, without the ending
  std::string pattern;              ///< of the names
  std::vector<std::string> fields;  ///< lines of the declaration
  enum class Format { kBvh, kTable, kNpy, kAmass } format = Format::kBvh;
  bool ambiguous = true;                 ///< the first name has two readings
  std::set<std::string> people, labels;  ///< of clips that are kept: these at most
};

void PrintTo(const Names& names, std::ostream* out) { *out << names.id; }

constexpr int kNameFrames = 45;

/// A job over files of these names; each holds another motion.
std::string NamedFiles(const fs::path& folder, const Names& names) {
  const Seen seen(kNameFrames, true);
  std::vector<std::string> source;
  switch (names.format) {
    case Names::Format::kBvh:
      source = BvhSource(names.pattern + ".bvh");
      break;
    case Names::Format::kTable:
      source = {"format: joint_table",
                "files: \"" + names.pattern + ".txt\"",
                "units: m",
                "axes: \"+x +y +z\"",
                "rate: 30 Hz",
                "skeleton: smpl24",
                "layout: \"24*(x y z)\"",
                "joints: " + List(JointNamesOf(*Takes().at(0).skeleton))};
      break;
    case Names::Format::kNpy:
      source = ArraySource(names.pattern + ".npy");
      break;
    case Names::Format::kAmass:
      source = AmassSource(names.pattern + "_poses.npz");
      break;
  }
  for (std::size_t i = 0; i < names.files.size(); ++i) {
    const Motion motion = Take(kNameFrames, i % Takes().size());
    const std::string& name = names.files[i];
    if (names.format == Names::Format::kBvh) Place(folder / (name + ".bvh"), BvhText(motion, seen));
    if (names.format == Names::Format::kNpy) Place(folder / (name + ".npy"), ArrayBytes(motion, seen));
    if (names.format == Names::Format::kAmass) Place(folder / (name + "_poses.npz"), AmassBytes(motion, seen));
    if (names.format != Names::Format::kTable) continue;
    std::string text;
    for (int f = 0; f < kNameFrames; ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) text += Row(motion.joints.at(f, j));
      text += "\n";
    }
    Place(folder / (name + ".txt"), text);
  }
  source.insert(source.end(), names.fields.begin(), names.fields.end());
  const bool rotations = names.format == Names::Format::kBvh || names.format == Names::Format::kAmass;
  return Job(folder, names.format == Names::Format::kBvh ? "" : "smpl24", source, rotations ? kGiven : "");
}

class FileNames : public ::testing::TestWithParam<Names> {};

TEST_P(FileNames, WithTwoReadingsAreRefusedAndOthersKept) {
  const Names& names = GetParam();
  const ScratchFolder folder;
  const Verdict verdict = RunJob(folder, NamedFiles(folder / "d", names));
  EXPECT_EQ(verdict.Has("name_ambiguous"), names.ambiguous) << verdict.text;
  EXPECT_EQ(verdict.exit_code != 0, names.ambiguous) << verdict.text;
  if (!names.ambiguous) {
    ASSERT_TRUE(verdict.dataset) << verdict.text;
  }
  if (!verdict.dataset) return;
  std::set<std::string> people, labels;
  for (const Clip& clip : verdict.dataset->clips) {
    people.insert(clip.identity.person);
    labels.insert(clip.label);
  }
  EXPECT_EQ(verdict.dataset->clips.size(), names.files.size() - (names.ambiguous ? 1 : 0)) << verdict.text;
  EXPECT_THAT(people, ::testing::IsSubsetOf(names.people));
  EXPECT_THAT(labels, ::testing::IsSubsetOf(names.labels));
  if (!names.ambiguous) {
    EXPECT_EQ(people, names.people);
    EXPECT_EQ(labels, names.labels);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Variants, FileNames,
    ::testing::Values(
        // BVH, action_person_take: side_kick_anna_1 is `side` of kick_anna, or `side_kick` of anna. Refused.
        Names{"BvhActionPerson",
              {"side_kick_anna_1", "walk_anna_1", "walk_bob_1", "run_bob_1"},
              "{action}_{person}_{take}",
              {"person: \"{person}\"", "label: \"{action}\""},
              Names::Format::kBvh,
              true,
              {"anna", "bob"},
              {"walk", "run"}},
        // A joint table, person_action: old_man_walk is `man_walk` of old, or `walk` of old_man. Refused.
        Names{"TablePersonAction",
              {"old_man_walk", "anna_walk", "bob_run"},
              "{person}_{action}",
              {"person: \"{person}\"", "label: \"{action}\""},
              Names::Format::kTable,
              true,
              {"anna", "bob"},
              {"walk", "run"}},
        // npy, action-person: push-up-p1. Refused.
        Names{"NpyActionPerson",
              {"push-up-p1", "walk-p1", "walk-p2"},
              "{action}-{person}",
              {"person: \"{person}\"", "label: \"{action}\""},
              Names::Format::kNpy,
              true,
              {"p1", "p2"},
              {"walk"}},
        // AMASS, person_take: rub_1_02 is take 1_02 of rub, or 02 of rub_1. Refused.
        Names{"AmassPersonTake",
              {"rub_1_02", "anna_01", "bob_02"},
              "{person}_{take}",
              {"person: \"{person}\"", "label: \"\""},
              Names::Format::kAmass,
              true,
              {"anna", "bob"},
              {"", "unlabelled"}},
        // The person's two characters leave one reading: kept.
        Names{"BvhWithWidths",
              {"climb_stairs_s01_e01", "walk_s01_e01", "walk_s02_e01"},
              "{action}_s{person:2}_e{take}",
              {"person: \"P{person}\"", "label: \"{action}\""},
              Names::Format::kBvh,
              false,
              {"P01", "P02"},
              {"climb_stairs", "walk"}},
        // Two readings that name the same person and label: kept.
        Names{"BvhSameReading",
              {"walk_x_y_z", "walk_u_v", "walk_v_w"},
              "{action:4}_{a}_{b}",
              {"person: \"p\"", "label: \"{action}\""},
              Names::Format::kBvh,
              false,
              {"p"},
              {"walk"}}),
    IdOf<Names>);

// `labels` names one of both readings: that one, or a refusal; not the other.
TEST(FileNamesWithLabels, AreReadAsTheListSaysOrRefused) {
  const Names names{
      "BvhListed",
      {"climb_stairs_s01_e01", "walk_s01_e01", "walk_s02_e01"},
      "{action}_s{person}_e{take}",
      {"person: \"P{person}\"", "label: \"{action}\"", "labels: {climb_stairs: climb_stairs, walk: walk}"},
      Names::Format::kBvh,
      true,
      {},
      {}};
  const ScratchFolder folder;
  const Verdict verdict = RunJob(folder, NamedFiles(folder / "d", names));
  if (!verdict.dataset || verdict.exit_code != 0) {
    EXPECT_NE(verdict.exit_code, 0);
    EXPECT_TRUE(verdict.Has("name_ambiguous")) << verdict.text;
  }
  if (!verdict.dataset) return;
  for (const Clip& clip : verdict.dataset->clips) {
    EXPECT_THAT(clip.label, ::testing::AnyOf("climb_stairs", "walk"));
    EXPECT_THAT(clip.identity.person, ::testing::AnyOf("P01", "P02"));
  }
}

// Splits. Two people, two styles; P01 and P02, calm and lively.

/// A job with the split, whose options are written as YAML.
std::string SplitJob(const fs::path& folder, const std::string& split, const std::string& roles = "") {
  const std::vector<std::string> files = {"walk-s01-calm",   "walk-s01-lively", "sit-s01-calm",  "walk-s02-calm",
                                          "walk-s02-lively", "sit-s02-calm",    "sit-s02-lively"};
  const Names names{"Splits",
                    files,
                    "{action}-s{person}-{style}",
                    {"person: \"P{person}\"", "label: \"{action}\"", "style: \"{style}\""},
                    Names::Format::kBvh,
                    false,
                    {},
                    {}};
  std::string job = NamedFiles(folder, names);
  if (!roles.empty()) job += "    roles: " + roles + "\n";
  return job + "assemble:\n  splits: [{name: official, " + split + "}]\n";
}

struct SplitVariant {
  const char* id;
  const char* split;
  const char* roles;
  bool refused;
  std::set<std::string> tested;  ///< people or styles of the test part, of a split that is made; empty: any, but some
};

void PrintTo(const SplitVariant& variant, std::ostream* out) { *out << variant.id; }

class SplitsByName : public ::testing::TestWithParam<SplitVariant> {};

TEST_P(SplitsByName, AreMadeOfNamesThatClipsHave) {
  const SplitVariant& variant = GetParam();
  const ScratchFolder folder;
  const Verdict verdict = RunJob(folder, SplitJob(folder / "d", variant.split, variant.roles));
  if (variant.refused) {
    EXPECT_NE(verdict.exit_code, 0) << verdict.text;
    EXPECT_FALSE(verdict.dataset) << verdict.text;
    return;
  }
  EXPECT_EQ(verdict.exit_code, 0) << verdict.text;
  ASSERT_TRUE(verdict.dataset) << verdict.text;
  const Split* split = verdict.dataset->FindSplit("official");
  ASSERT_NE(split, nullptr);
  EXPECT_FALSE(split->test.empty());
  EXPECT_FALSE(split->train.empty());
  std::set<std::string> tested;
  const bool by_style = std::string(variant.split).find("by: style") != std::string::npos;
  for (const int row : split->test) {
    const ClipIdentity& identity = verdict.dataset->clips[static_cast<std::size_t>(row)].identity;
    const std::string& file = identity.recording;
    tested.insert(by_style ? file.substr(file.rfind('-') + 1) : identity.person);
  }
  if (!variant.tested.empty()) {
    EXPECT_EQ(tested, variant.tested);
  }
  EXPECT_EQ(tested.size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(
    Variants, SplitsByName,
    ::testing::Values(
        // A person that the set has: made.
        SplitVariant{"Person", "by: person, test: [P01]", "", false, {"P01"}},
        // P1, where the set has P01: refused.
        SplitVariant{"AbsentPerson", "by: person, test: [P1]", "", true, {}},
        // A style that the set has: made.
        SplitVariant{"Style", "by: style, test: [lively]", "", false, {"lively"}},
        // A misspelt style: refused.
        SplitVariant{"AbsentStyle", "by: style, test: [livly]", "", true, {}},
        // A validation part of a person whom no clip has: refused.
        SplitVariant{"AbsentValidation", "by: person, test: [P01], validation: [P3]", "", true, {}},
        // A training part of a person whom no clip has: refused.
        SplitVariant{"AbsentTraining", "by: person, train: [P7]", "", true, {}},
        // One of two names is there: the other would be missing from the test part without a word. Refused.
        SplitVariant{"PartlyPresent", "by: person, test: [P01, P9]", "", true, {}},
        // `absent: draw` says that others are to be drawn: made, with one of the people.
        SplitVariant{"AbsentDrawn", "by: person, absent: draw, test: [P1]", "", false, {}},
        // Roles of people of the set: made.
        SplitVariant{"Role", "by: role", "{P01: test, P02: train}", false, {"P01"}},
        // Roles of people whom no clip has: refused.
        SplitVariant{"AbsentRole", "by: role", "{P1: test, P02: train}", true, {}}),
    IdOf<SplitVariant>);

}  // namespace
}  // namespace mocurate::variants
