// One answer about a file: what an inspection says without a declaration, and what a run reads by the declaration that
// it proposes; what every verb reads of each format.

#include <gmock/gmock.h>

#include <set>

#include "core/base/config.h"
#include "core/base/text.h"
#include "core/store/store.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/source_declaration.h"
#include "ingest/read_motions.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/sources.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// The source that an inspection proposes; what it leaves open is filled in with any value.
SourceOptions Proposed(const fs::path& path, const fs::path& scratch, IngestOptions& options) {
  const auto written = DeclareSource(InspectPath(path, std::nullopt), path, "mine");
  if (!written) {
    ADD_FAILURE() << written.error().Message();
    return {};
  }
  std::string yaml;
  for (const std::string_view line : SplitText(written->yaml, '\n')) {
    std::string text(line);
    const std::size_t open = text.find("\"FILL_IN");
    const auto is = [&](const char* option) { return Trim(text).rfind(option, 0) == 0; };
    if (open != std::string::npos && !is("#")) text.erase(open);
    if (open != std::string::npos && !is("#")) {
      text += is("rate:") ? "30 Hz" : is("units:") ? "m" : is("axes:") ? "\"+x +y +z\"" : "\"\"";
    }
    for (std::size_t at = 0; (at = text.find("FILL_IN")) != std::string::npos && !is("#");) text.replace(at, 7, "skip");
    yaml += text + "\n";
  }
  Put(scratch / "proposed.yaml", yaml);
  const auto node = LoadConfig(scratch / "proposed.yaml", {});
  const ConfigNode* group = node ? node->Find("ingest") : nullptr;
  const auto read = group != nullptr ? OptionsFromConfig<IngestOptions>(*group)
                                     : Expected<IngestOptions>(tl::unexpected<Error>(Error()));
  if (!read) {
    ADD_FAILURE() << (node ? read.error().Message() : node.error().Message()) << yaml;
    return {};
  }
  options = *read;
  return read->source;
}

/// Errors about the file; what is declared for the test may be wrong.
std::multiset<std::string> Faults(const Json& inspection) {
  std::multiset<std::string> faults;
  for (const Json& finding : inspection.at("findings")) {
    const std::string code = finding.at("code");
    const bool declared = EndsWith(code, "_contradiction") || code == "rate_suspect" || code == "rate_implausible";
    if (finding.at("severity") == "error" && !declared) faults.insert(code);
  }
  return faults;
}

class OneReader : public RecordedFormats, public ::testing::WithParamInterface<const char*> {};

TEST_P(OneReader, InspectionAndRunReadTheSame) {
  const ScratchFolder scratch;
  const fs::path file = fs::path(TestData()) / GetParam();
  IngestOptions options;
  const SourceOptions source = Proposed(file, scratch / "", options);
  ASSERT_FALSE(source.format.empty());
  const Json undeclared = InspectPath(file, std::nullopt), declared = InspectPath(file, source);
  ASSERT_EQ(undeclared.at("clips").size(), declared.at("clips").size()) << declared.at("findings").dump(1);
  for (std::size_t c = 0; c < undeclared.at("clips").size(); ++c) {
    const Json &one = undeclared.at("clips")[c], &other = declared.at("clips")[c];
    EXPECT_EQ(Value(one, "frames"), Value(other, "frames"));
    if (one.at("format") != "amass") {  // whose 52 joints are read on the skeleton's 24
      EXPECT_EQ(Value(one, "joints"), Value(other, "joints"));
    }
    EXPECT_EQ(Value(one, "people"), Value(other, "people"));
  }
  EXPECT_EQ(Faults(undeclared), Faults(declared));
  options.path = file;
  const auto read = ReadAllMotions({options, {}});
  ASSERT_TRUE(read) << read.error().Message();
  ASSERT_EQ(read->set.clips.size() + read->refused.size(), declared.at("clips").size());
  if (declared.at("clips").size() == 1) {
    EXPECT_EQ(read->set.clips.at(0).motion->frame_count(), Value(declared.at("clips")[0], "frames"));
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, OneReader,
                         ::testing::Values("kinect/kard/a09_s01_e01_realworld.txt",
                                           "kinect/msr_action3d/a06_s01_e01_skeleton3D.txt",
                                           "kinect/utkinect/walk_s01_e01.txt", "kinect/florence3d/a01_s1_id1.txt",
                                           "kinect/cad60/0512165327.txt", "ntu/S001C001P001R001A011.skeleton",
                                           "amass_babel/amass_sample.npz", "bvh/bandai1/dataset-1_bow_active_001.bvh",
                                           "bvh/misc/chenzunh23_walk_noitom_yxz.bvh", "cmu/asf_amc/01_01.bvh"));

/// Files of one format and their declaration.
struct Sample {
  const char* format;
  const char* source;                       ///< of configs/sources; empty: proposed
  const char* place = "";                   ///< below the recorded data, or below the studio's folder
  std::optional<StudioLayout> studio = {};  ///< that writes them
  std::vector<std::string> actions = {};
  bool same_undeclared = true;        ///< without a declaration all clips are seen too, with the same frames
  std::set<std::string> others = {};  ///< findings of inspections about other files, or that need no declaration
};

void PrintTo(const Sample& sample, std::ostream* out) { *out << sample.format; }

const std::vector<Sample>& Samples() {
  static const std::vector<Sample> samples = {
      {"joint_table", "kard", "kinect/kard/a09_s01_e01_realworld.txt"},
      {"bvh", "bandai1", "bvh/bandai1/dataset-1_bow_active_001.bvh"},
      {"npy", "humanact12_npy", "HumanAct12", StudioLayout::kHumanAct12, {"throw"}},
      {"depth_sequence", "rendered_seq", "clouds/rendered_seq"},
      {"ntu_skeleton", "ntu", "nturgb+d_skeletons", StudioLayout::kNtu, {"throw"}},
      {"asf_amc", "cmu_amc", "cmu/asf_amc/01_01.amc"},
      {"amass", "amass", "amass", StudioLayout::kAmass, {"jump", "run"}},
      {"expmap", "cmu_expmap", "cmu/expmap"},
      {"phspd", "phspd", "phspd", StudioLayout::kPhspd},
      // Views of one person, of whom a run takes the tracks that are one.
      {"vibe_tracks", "ntu13_vibe", "ntu13", StudioLayout::kNtuVibe, {}, false},
      // The studio's joints have a point at their origin; a run reads the rotations.
      {"uestc", "uestc", "uestc", StudioLayout::kUestc, {"punching"}, true, {"zero_joint"}},
      {"humanact12_pickle", "humanact12_poses", "humanact12poses.pkl", StudioLayout::kHumanAct12, {"throw"}},
      {"motions", "", ""},
      // Clips are cameras without a declaration, recordings with one.
      {"openpose", "studio_keypoints", "openpose", StudioLayout::kOpenPose, {"throw"}, false},
      {"depth_views", "rgbd100", "rgbd100", {}, {}, false, {"point_far"}},
      {"panoptic", "panoptic", "cameras/panoptic"},
      {"clouds", "", "", {}, {}, false},
      {"c3d", "", "c3d_trc/pose2sim_coco.c3d"},
      {"trc", "", "c3d_trc/pose2sim_coco.trc"}};
  return samples;
}

/// What a verb says of the clips of a source.
struct Answer {
  std::multiset<int> frames;
  std::multiset<std::string> findings;  ///< codes of warnings and errors
};

void PrintTo(const Answer& answer, std::ostream* out) {
  *out << "frames";
  for (const int frames : answer.frames) *out << " " << frames;
  for (const std::string& code : answer.findings) *out << " " << code;
}

bool operator==(const Answer& a, const Answer& b) { return a.frames == b.frames && a.findings == b.findings; }

void Add(const std::vector<Finding>& findings, Answer& answer) {
  for (const Finding& finding : findings) {
    if (finding.severity != Severity::kInfo) answer.findings.insert(finding.code);
  }
}

/// `run` and `fit`: the stage ingest, a clip after the other.
Answer OfRun(const IngestOptions& options) {
  Answer answer;
  const auto discovery = Discover(options);
  if (!discovery) ADD_FAILURE() << discovery.error().Message();
  for (const ItemSpec& item : discovery ? discovery->items : std::vector<ItemSpec>()) {
    const auto read = ReadSourceItem({"ingest", item.item, item.options.Whole(), item.inputs, {}, {}});
    if (!read) answer.findings.insert(FaultCode(read.error(), options.source.format));
    if (!read || !HasArtifact(read->outcome.kind)) continue;
    answer.frames.insert(FrameCount(read->clip));
    Add(read->outcome.findings, answer);
  }
  return answer;
}

Answer OfInspection(const Json& inspection, const Sample& sample) {
  Answer answer;
  for (const Json& clip : inspection.at("clips")) {
    if (clip.at("format") == DriverOf(sample.format).clip_format())
      answer.frames.insert(Value(clip, "frames").get<int>());
  }
  for (const Json& finding : inspection.at("findings")) {
    const std::string code = finding.at("code");
    const bool of_several = EndsWith(code, "duplicate") || code == "shared_frames" || code == "rate_suspect";
    if (finding.at("severity") != "info" && !of_several && sample.others.count(code) == 0) answer.findings.insert(code);
  }
  return answer;
}

class EveryFormat : public RecordedFormats, public ::testing::WithParamInterface<Sample> {
 protected:
  /// The declaration of the sample's files, which are written where they are not recorded.
  IngestOptions Options(const Sample& sample) const {
    if (std::string_view(sample.format) == "motions") {
      IngestOptions bvh = Declared("bandai1");
      bvh.path = bvh.path / "dataset-1_bow_active_001.bvh";
      const auto read = ReadAllMotions({bvh, {}});
      EXPECT_TRUE(read && WriteDataset(read->set, scratch_ / "motions.h5"));
      IngestOptions options;
      options.path = scratch_ / "motions.h5";
      options.source.name = "motions";
      options.source.format = "motions";
      options.source.container = "motions.h5";
      options.source.files = "{source}/{person}/{recording}#{begin}-{end}";
      options.source.axes = "+x +y +z";
      return options;
    }
    if (std::string_view(sample.format) == "clouds") {
      IngestOptions options;
      options.path = scratch_ / "scans";
      for (int f = 0; f < 3; ++f) {
        std::string ply =
            "ply\nformat ascii 1.0\nelement vertex 40\nproperty float x\nproperty float y\n"
            "property float z\nend_header\n";
        for (int k = 0; k < 40; ++k)
          ply += std::to_string(0.1 * (k % 4)) + " " + std::to_string(0.1 + 0.04 * k) + " " + std::to_string(0.01 * f) +
                 "\n";
        Put(options.path / ("take_" + std::to_string(f) + ".ply"), ply);
      }
      options.source.name = "scans";
      options.source.format = "clouds";
      options.source.files = "take_{frame}.ply";
      options.source.recording = "take";
      options.source.units = "m";
      options.source.axes = "+x +y +z";
      options.source.rate_hz = 30.0;
      return options;
    }
    fs::path path = fs::path(TestData()) / sample.place;
    if (path.extension() == ".c3d" || path.extension() == ".trc") {
      IngestOptions options;
      options.path = path;
      options.source.name = "markers";
      options.source.format = sample.format;
      options.source.files = "{recording}" + path.extension().string();
      options.source.person = "one";
      options.source.label = "";
      options.source.units = path.extension() == ".c3d" ? "mm" : "m";
      options.source.axes = "+x +y +z";
      return options;
    }
    if (sample.studio) {
      StudioOptions studio = Perfect(*sample.studio);
      studio.actions = sample.actions;
      studio.subjects = 1;
      EXPECT_TRUE(WriteStudioLayout(studio, scratch_ / "studio", 2));
      path = scratch_ / "studio" / sample.place;
    }
    return Declared(sample.source, {"ingest.path=" + path.string()});
  }

  const ScratchFolder scratch_;
};

TEST_P(EveryFormat, IsReadAlikeByEveryVerb) {
  const IngestOptions options = Options(GetParam());
  ASSERT_EQ(options.source.format, GetParam().format);
  const Answer run = OfRun(options);
  EXPECT_FALSE(run.frames.empty());
  EXPECT_EQ(OfInspection(InspectPath(options.path, options.source), GetParam()), run) << "inspect --source";
  const EvidenceKind gives = EvidenceKindOf(options.source);
  const bool tracks = gives == EvidenceKind::kJointTracks && !options.source.skeleton.empty();
  if (gives == EvidenceKind::kMotion || tracks) {
    const auto read = ReadAllMotions({options, {}});
    ASSERT_TRUE(read) << read.error().Message();
    Answer verbs;
    for (const Clip& clip : read->set.clips) verbs.frames.insert(clip.motion->frame_count());
    Add(read->set.findings, verbs);
    EXPECT_EQ(verbs, run) << "export, draw, eval";
  }
  Answer undeclared = run;
  undeclared.findings.erase("long_gap");  // in seconds: no file of these states its rate
  if (!GetParam().same_undeclared || DriverOf(GetParam().format).stored) return;
  EXPECT_EQ(OfInspection(InspectPath(options.path, std::nullopt), GetParam()), undeclared) << "inspect";
}

/// A file of which the end is lost: kept with a finding, or refused, by every verb alike.
TEST_P(EveryFormat, IsReadAlikeByEveryVerbWhereItIsCutOff) {
  const std::set<std::string> single = {"joint_table", "bvh",    "npy",   "ntu_skeleton", "asf_amc",
                                        "amass",       "expmap", "phspd", "c3d",          "trc"};
  if (single.count(GetParam().format) == 0) return;
  IngestOptions options = Options(GetParam());
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const ItemSpec& item = discovery->items.front();
  options.source.annotations.clear();
  for (const StageInput& input : item.inputs) {
    const std::string bytes = *ReadFile(input.path);
    Put(scratch_ / "cut" / input.name, bytes.substr(0, input.role == "source" ? bytes.size() * 3 / 5 : bytes.size()));
  }
  options.path = scratch_ / "cut";
  const Answer run = OfRun(options);
  Answer declared = OfInspection(InspectPath(options.path, options.source), GetParam());
  EXPECT_EQ(declared.frames, run.frames) << "inspect --source";
  const bool refused = GetParam().format == std::string("npy") || GetParam().format == std::string("amass");
  EXPECT_EQ(run.frames.empty(), refused) << "whole frames of rows are kept; an archive is not";
  const auto read = ReadAllMotions({options, {}});
  EXPECT_EQ(read.has_value(), !refused && !options.source.skeleton.empty());
  Answer verbs;
  for (const Clip& clip : read ? read->set.clips : std::vector<Clip>()) verbs.frames.insert(clip.motion->frame_count());
  if (read) {
    Add(read->set.findings, verbs);
    EXPECT_EQ(verbs, run) << "export, draw, eval";
  }
  Answer undeclared = OfInspection(InspectPath(options.path, std::nullopt), GetParam());
  EXPECT_EQ(undeclared.frames, run.frames) << "inspect";
  for (const char* code : {"long_gap", "no_clips"}) undeclared.findings.erase(code);
  for (const char* code : {"long_gap", "no_clips"}) declared.findings.erase(code);
  EXPECT_EQ(undeclared.findings, declared.findings) << "inspect";
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat, ::testing::ValuesIn(Samples()),
                         [](const auto& sample) { return std::string(sample.param.format); });

TEST(EveryFormatOfTheRegistry, HasASample) {
  for (const FormatDriver& driver : FormatDrivers()) {
    const auto is_of = [&](const Sample& sample) { return std::string_view(sample.format) == driver.name; };
    const bool builtin = driver.to_clip != nullptr && std::string_view(driver.name).find("toy") == std::string::npos;
    EXPECT_TRUE(!builtin || std::any_of(Samples().begin(), Samples().end(), is_of)) << driver.name;
  }
}

}  // namespace
}  // namespace mocurate
