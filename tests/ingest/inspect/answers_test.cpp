// Codes, places, values and exit codes of `inspect` and of the stage `ingest` for recorded, synthetic and damaged
// clips; messages are not compared. `answers.txt` keeps a digest per clip. MOCURATE_REGENERATE=1 writes it;
// MOCURATE_ANSWERS=FOLDER writes the full lines, to review a change.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/base/sha256.h"
#include "core/base/text.h"
#include "ingest/checks/finding_table.h"
#include "ingest/inspect/inspect.h"
#include "ingest/synthetic/studio_layouts.h"
#include "tests/ingest/runs.h"
#include "tests/ingest/schema_check.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

/// Checks a severity against the table of findings.
void CheckSeverity(const std::string& code, const std::string& severity) {
  const FindingKind* kind = FindFindingKind(code);
  if (kind == nullptr) return;
  EXPECT_NE(std::string(kind->severity).find(severity), std::string::npos) << code << " has severity " << severity;
}

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path kAnswers = fs::path(kSourceFolder) / "tests" / "ingest" / "inspect" / "answers.txt";

/// Four digits: detects changes and agrees between compilers.
std::string Number(double value) { return RoundedText(value, 4); }

std::string Word(const Json& value) {
  if (value.is_number()) return Number(value.get<double>());
  if (value.is_object() && value.contains("value"))
    return Word(value.at("value")) + "?" + value.at("from").dump().substr(1, 1);
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Lines of an answer, by title.
class Book {
 public:
  void Open(const std::string& title) { lines_ = &pages_[title]; }
  void Add(const std::string& line) { lines_->push_back(line); }
  const std::map<std::string, std::vector<std::string>>& pages() const { return pages_; }

 private:
  std::map<std::string, std::vector<std::string>> pages_;
  std::vector<std::string>* lines_ = nullptr;
};

/// A place without the temporary folder.
std::string Placed(std::string where, const fs::path& folder) {
  const std::string whole = folder.string();
  for (std::size_t at = where.find(whole); at != std::string::npos; at = where.find(whole))
    where.erase(at, whole.size());
  return where;
}

void AddInspection(const fs::path& path, const std::optional<SourceOptions>& source, Book& book) {
  const Json inspection = InspectPath(path, source);
  static SchemaCheck schema;
  EXPECT_THAT(schema.Faults(inspection), ::testing::IsEmpty()) << path;
  book.Add("format " + inspection.at("format").get<std::string>());
  for (const Json& clip : inspection.at("clips")) {
    std::string line = "clip " + clip.at("id").get<std::string>() + " " + Word(clip.at("format"));
    for (const char* field : {"frames", "joints", "people", "skeleton", "units", "up", "handedness", "facing", "axes",
                              "rate_hz", "missing_share"})
      line += " " + Word(clip.at(field));
    for (const char* field : {"item", "person", "label"})
      line += clip.contains(field) ? " " + Word(clip.at(field)) : "";
    book.Add(line);
  }
  for (const Json& camera : inspection.at("cameras")) {
    std::string line = "camera " + Word(camera.at("id")) + " " + Word(camera.at("format"));
    for (const char* field : {"units", "reading", "up", "image_size"}) line += " " + Word(camera.at(field));
    for (const Json& at : camera.at("centre_m")) line += " " + Word(at);
    book.Add(line);
  }
  for (const Json& cloud : inspection.at("clouds"))
    book.Add("cloud " + Word(cloud.at("id")) + " " + Word(cloud.at("points")) + " " + Word(cloud.at("triangles")) +
             " " + Word(cloud.at("units")));
  for (const Json& beside : inspection.at("companions"))
    book.Add("beside " + Word(beside.at("file")) + " " + Word(beside.at("format")));
  std::vector<std::string> findings;
  for (const Json& finding : inspection.at("findings")) {
    CheckSeverity(finding.at("code"), finding.at("severity"));
    findings.push_back(Word(finding.at("severity")) + " " + Word(finding.at("code")) + " " +
                       Placed(Word(finding.at("where")), path) + " " + Word(finding.at("value")));
  }
  std::sort(findings.begin(), findings.end());
  for (const std::string& finding : findings) book.Add(finding);
}

/// The rounded numbers of a clip.
std::string NumbersOf(const Clip& clip) {
  std::string text = clip.id() + " " + clip.label + " " + clip.role + " " + Number(clip.rate.hz());
  const auto add = [&](const double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) text += " " + std::to_string(std::llround(1e5 * values[i]));
  };
  if (clip.evidence.tracks) {
    const JointTracks& tracks = *clip.evidence.tracks;
    for (const std::string& name : tracks.names) text += " " + name;
    add(tracks.positions.xyz.data(), tracks.positions.xyz.size());
    add(tracks.confidence.data(), tracks.confidence.size());
    add(tracks.rotation_confidence.data(), tracks.rotation_confidence.size());
    for (const Quaterniond& rotation : tracks.rotation) add(rotation.toRotationMatrix().data(), 9);
  }
  if (clip.motion) {
    text += " " + clip.motion->skeleton->name;
    for (const Joint& joint : clip.motion->skeleton->joints) text += " " + joint.name;
    add(clip.motion->joints.xyz.data(), clip.motion->joints.xyz.size());
    add(clip.motion->bone_length.data(), clip.motion->bone_length.size());
    for (const Quaterniond& rotation : clip.motion->rotation) add(rotation.toRotationMatrix().data(), 9);
    for (const JointState state : clip.motion->state) text += std::to_string(static_cast<int>(state));
  }
  for (const DepthView& view : clip.evidence.depth_views) {
    text += " " + view.camera.name;
    for (const fs::path& file : view.files) text += " " + file.string();
    add(view.time_s.data(), view.time_s.size());
    add(view.camera.camera_from_world.translation.data(), 3);
  }
  for (const KeypointView& view : clip.evidence.keypoint_views) {
    text += " " + view.camera.name;
    add(view.values.data(), view.values.size());
    add(view.camera.camera_from_world.translation.data(), 3);
  }
  for (const Segment& segment : clip.segments)
    text += " " + segment.label + " " + Number(segment.begin_s) + " " + Number(segment.end_s);
  for (const auto& [key, unused] : clip.provenance) text += " " + key;
  return text;
}

std::string FindingLine(const Finding& finding) {
  CheckSeverity(finding.code, std::string(Name(finding.severity)));
  return std::string(Name(finding.severity)) + " " + finding.code + " " + std::to_string(finding.frame_begin) + "-" +
         std::to_string(finding.frame_end) + " " + finding.joint + " " + Number(finding.value);
}

void AddOutcome(const std::string& item, const Expected<Outcome>& outcome, const fs::path& artifact,
                const fs::path& folder, Book& book) {
  if (!outcome) {
    book.Add("run " + item + " error " + std::string(Name(outcome.error().code)) + " at " +
             Placed(outcome.error().where, folder));
    return;
  }
  std::string line = "run " + item + " " + std::to_string(static_cast<int>(outcome->kind));
  if (!HasArtifact(outcome->kind)) line += " " + std::string(Name(outcome->error.code));
  if (!artifact.empty() && HasArtifact(outcome->kind)) {
    const auto clip = ReadEvidence(artifact);
    line += clip ? " " + Sha256Hex(NumbersOf(*clip)).substr(0, 12) : " no artifact";
  }
  book.Add(line);
  std::vector<std::string> findings;
  for (const Finding& finding : outcome->findings) findings.push_back(" of " + item + " " + FindingLine(finding));
  std::sort(findings.begin(), findings.end());
  for (const std::string& finding : findings) book.Add(finding);
}

void AddRun(const SourceRun& run, const fs::path& folder, Book& book) {
  if (!run.discovery)
    return book.Add("run error " + std::string(Name(run.discovery.error().code)) + " at " +
                    Placed(run.discovery.error().where, folder));
  for (const Finding& finding : run.discovery->findings) book.Add("set " + FindingLine(finding));
  for (const ItemResult& excluded : run.discovery->excluded)
    AddOutcome(excluded.item, excluded.outcome, {}, folder, book);
  for (std::size_t i = 0; i < run.outcomes.size(); ++i)
    AddOutcome(run.discovery->items[i].item, run.outcomes[i], run.Artifact(i), folder, book);
}

/// Sources of configs/sources with files in the test data.
const std::vector<std::string> kRecorded = {
    "kard",          "msr_action3d", "utkinect",        "florence3d",      "cad60",
    "ntu",           "bandai1",      "bandai2",         "cmu_amc",         "cmu_expmap",
    "hdm05",         "panoptic",     "pose2sim_single", "pose2sim_static", "pose2sim_two",
    "rendered_body", "rendered_seq", "rgbd100"};

const std::vector<std::string> kFolders = {"amass_babel", "bvh",        "cameras", "clouds", "cmu",
                                           "hdm05",       "humanact12", "kinect",  "ntu",    "pose2sim",
                                           "rgbd100",     "c3d_trc",    "body_cc0"};

void AddRecorded(Book& book) {
  const fs::path data(TestData());
  for (const std::string& folder : kFolders) {
    book.Open("inspect " + folder);
    AddInspection(data / folder, std::nullopt, book);
  }
  for (const std::string& name : kRecorded) {
    const IngestOptions options = Declared(name);
    book.Open("inspect --source " + name);
    AddInspection(options.path, options.source, book);
    book.Open("run " + name);
    AddRun(RunOnce(options), options.path, book);
  }
  const IngestOptions amass =
      Declared("amass", {"ingest.path=" + (data / "amass_babel").string(), "ingest.source.annotations=[]"});
  book.Open("run amass");
  AddRun(RunOnce(amass), amass.path, book);
}

void AddStudio(Book& book) {
  for (const StudioLayout layout :
       {StudioLayout::kHumanAct12, StudioLayout::kPhspd, StudioLayout::kNtu, StudioLayout::kKard, StudioLayout::kUestc,
        StudioLayout::kUestcVibe, StudioLayout::kNtuVibe, StudioLayout::kTracks, StudioLayout::kOpenPose,
        StudioLayout::kAmass, StudioLayout::kCmu8}) {
    StudioOptions options;
    options.layout = layout;
    options.subjects = 1;
    options.depth.enabled = false;
    options.false_track_share = 0.3;
    options.keypoints.bystander_share = 0.05;
    const std::string name = StudioLayoutName(layout);
    const fs::path folder = FreshFolder("answers_" + name);
    fs::remove_all(folder);
    const auto written = WriteStudioLayout(options, folder, 1);
    ASSERT_TRUE(written) << written.error().Message();
    for (const WrittenSource& source : SourcesOf(layout, false)) {
      const IngestOptions declared = Declared(source.name, {"ingest.path=" + (folder / source.folder).string()});
      book.Open("studio " + name + ", inspect " + source.folder);
      AddInspection(folder / source.folder, std::nullopt, book);
      book.Open("studio " + name + ", inspect --source " + source.name);
      AddInspection(folder / source.folder, declared.source, book);
      book.Open("studio " + name + ", run " + source.name);
      AddRun(SourceRun(declared), declared.path, book);
    }
    fs::remove_all(folder);
  }
}

// Damage. A text file is lines of words; `first` is the first line with numbers.

struct Text {
  std::vector<std::string> lines;
  std::size_t first = 0;

  explicit Text(const std::string& bytes) {
    for (const std::string_view line : SplitText(bytes, '\n')) lines.emplace_back(line);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (lines[i].rfind("Frame Time", 0) == 0 || lines[i].rfind(":DEGREES", 0) == 0) first = i + 1;
    }
  }
  std::size_t Middle(double share = 0.5) const {
    return first + static_cast<std::size_t>(share * static_cast<double>(lines.size() - first));
  }
  std::string Bytes() const {
    std::string bytes;
    for (std::size_t i = 0; i < lines.size(); ++i) bytes += (i > 0 ? "\n" : "") + lines[i];
    return bytes;
  }
};

bool IsSeparator(char c) { return c == ' ' || c == ',' || c == '\t' || c == '\r'; }

/// Applies `change` to every number of a line, with its index.
std::string ChangedNumbers(const std::string& line, const std::function<double(std::size_t, double)>& change) {
  std::string out, word;
  std::size_t place = 0;
  const auto flush = [&]() {
    const auto value = ParseDouble(word);
    out += value ? FormatDouble(change(place++, *value)) : word;
    word.clear();
  };
  for (const char c : line) {
    if (!IsSeparator(c)) {
      word += c;
      continue;
    }
    if (!word.empty()) flush();
    out += c;
  }
  if (!word.empty()) flush();
  return out;
}

std::string WithWord(const std::string& line, const std::string& word) {
  const std::size_t begin = line.find_first_not_of(" ,\t");
  if (begin == std::string::npos) return word;
  const std::size_t end = std::min(line.find_first_of(" ,\t\r", begin), line.size());
  return line.substr(0, begin) + word + line.substr(end);
}

using Damage = std::function<std::string(const std::string&)>;

std::vector<std::pair<std::string, Damage>> Damages() {
  const auto lines = [](const std::function<void(Text&)>& change) {
    return [change](const std::string& bytes) {
      Text text(bytes);
      change(text);
      return text.Bytes();
    };
  };
  const auto numbers = [&](double from, double to, const std::function<double(std::size_t, double)>& change) {
    return lines([from, to, change](Text& text) {
      for (std::size_t i = text.Middle(from); i < text.Middle(to); ++i)
        text.lines[i] = ChangedNumbers(text.lines[i], change);
    });
  };
  return {
      {"cut at 60 %", [](const std::string& bytes) { return bytes.substr(0, bytes.size() * 3 / 5); }},
      {"last bytes lost",
       [](const std::string& bytes) { return bytes.substr(0, bytes.size() - std::min<std::size_t>(9, bytes.size())); }},
      {"empty", [](const std::string&) { return std::string(); }},
      {"blank", [](const std::string&) { return std::string(" \n\n"); }},
      {"junk behind", [](const std::string& bytes) { return bytes + "\njunk behind it\n"; }},
      {"junk before", [](const std::string& bytes) { return "junk before it\n" + bytes; }},
      {"a byte changed",
       [](std::string bytes) {
         bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x15);
         return bytes;
       }},
      {"a line lost",
       lines([](Text& text) { text.lines.erase(text.lines.begin() + static_cast<std::ptrdiff_t>(text.Middle())); })},
      {"a line twice", lines([](Text& text) {
         const auto at = text.lines.begin() + static_cast<std::ptrdiff_t>(text.Middle());
         text.lines.insert(at, *at);
       })},
      {"a blank line", lines([](Text& text) {
         text.lines.insert(text.lines.begin() + static_cast<std::ptrdiff_t>(text.Middle()), "");
       })},
      {"a word", lines([](Text& text) { text.lines[text.Middle()] = WithWord(text.lines[text.Middle()], "x?"); })},
      {"nan", lines([](Text& text) { text.lines[text.Middle()] = WithWord(text.lines[text.Middle()], "nan"); })},
      {"1e30", lines([](Text& text) { text.lines[text.Middle()] = WithWord(text.lines[text.Middle()], "1e30"); })},
      {"a number more", lines([](Text& text) { text.lines[text.Middle()] += " 1"; })},
      {"decimal commas",
       [](std::string bytes) {
         std::replace(bytes.begin(), bytes.end(), '.', ',');
         return bytes;
       }},
      {"line ends of Windows",
       [](const std::string& bytes) {
         std::string out;
         for (const char c : bytes) {
           if (c == '\n') out += '\r';
           out += c;
         }
         return out;
       }},
      {"times 100", numbers(0.0, 1.0, [](std::size_t, double x) { return 100.0 * x; })},
      {"half times 1000", numbers(0.5, 1.0, [](std::size_t, double x) { return 1000.0 * x; })},
      {"mirrored", numbers(0.0, 1.0, [](std::size_t i, double x) { return i % 3 == 0 ? -x : x; })},
      {"a fifth zero", numbers(0.4, 0.6, [](std::size_t, double) { return 0.0; })},
      {"all zero", numbers(0.0, 1.0, [](std::size_t, double) { return 0.0; })},
      {"a fifth frozen", lines([](Text& text) {
         const std::size_t from = text.Middle(0.4) / 60 * 60 + text.first % 60, to = text.Middle(0.6);
         for (std::size_t i = from + 60; i < to; ++i) text.lines[i] = text.lines[i - 60];
       })},
      {"a stretch far away", numbers(0.4, 0.45, [](std::size_t, double x) { return x + 1e5; })},
      {"a stretch twice", lines([](Text& text) {
         const auto at = text.lines.begin();
         const std::vector<std::string> part(
             at + static_cast<std::ptrdiff_t>(text.first),
             at + static_cast<std::ptrdiff_t>(text.first + (text.Middle() - text.first) / 60 * 60));
         text.lines.insert(text.lines.begin() + static_cast<std::ptrdiff_t>(text.first), part.begin(), part.end());
       })},
  };
}

struct DamagedFile {
  std::string source;  ///< of configs/sources
  std::string file;    ///< below its folder
  std::vector<std::string> beside = {};
  std::vector<std::string> assignments = {};
  std::string folder = "";  ///< below the data; empty: the declared one
};

const std::vector<DamagedFile> kDamaged = {
    {"kard", "a09_s01_e01_realworld.txt"},
    {"msr_action3d", "a06_s01_e01_skeleton3D.txt"},
    {"utkinect", "walk_s01_e01.txt"},
    {"florence3d", "a01_s1_id1.txt"},
    {"cad60", "0512165327.txt"},
    {"ntu", "S001C001P001R001A011.skeleton"},
    {"bandai2",
     "dataset-2_walk-turn-left_active_001.bvh",
     {"dataset-2_walk-turn-left_active_001.json", "content_label.txt", "style_label.txt"}},
    {"hdm05", "01/HDM_bd_depositFloorR_001_120.amc", {"HDM_bd.asf"}},
    {"hdm05", "HDM_bd.asf", {"01/HDM_bd_depositFloorR_001_120.amc"}},
    {"cmu_expmap", "train/walking/walking_4.txt"},
    {"amass",
     "amass_sample.npz",
     {},
     {"ingest.source.annotations=[]", "ingest.source.annotation_roles={}", "ingest.source.files='{recording}.npz'",
      "ingest.source.recording='{recording}'", "ingest.source.person=x", "ingest.source.session=''"},
     "amass_babel"},
    {"humanact12_npy",
     "012314_joints.npy",
     {},
     {"ingest.source.files='{recording}.npy'", "ingest.source.recording='{recording}'", "ingest.source.person=x",
      "ingest.source.session=''", "ingest.source.label=''", "ingest.source.fine_label=''",
      "ingest.source.frames_in_name=''", "ingest.source.other_labels=keep", "ingest.source.axes='+x +y +z'",
      "ingest.source.skeleton=smpl24",
      "ingest.source.joints=[pelvis, left_hip, right_hip, spine1, left_knee, right_knee, spine2, left_ankle, "
      "right_ankle, spine3, left_foot, right_foot, neck, left_collar, right_collar, head, left_shoulder, "
      "right_shoulder, left_elbow, right_elbow, left_wrist, right_wrist]"},
     "humanact12/humanml3d_sample"},
    {"rendered_seq", "seq_male.json"},
    {"panoptic", "160906_band1/body3DScene_00000175.json"},
    {"pose2sim_single", "Calib_converted.toml"},
    {"pose2sim_single", "Calib.qca.txt"},
    {"", "cameras/opencv_yml/intri.yml", {"cameras/opencv_yml/extri.yml"}},
    {"", "cameras/human36m/camera-parameters.json"},
    {"", "cameras/campus_shelf/calibration_campus.json"},
    {"", "cameras/panoptic/calibration_160906_band1.json"},
    {"", "cameras/phspd/CamParams0906.pkl"},
    {"", "amass_babel/babel/featp_2_fps.json"},
    {"", "clouds/handheld_head/Mesh_DepthOnly__A_hat1__every_10th_14frames.ply"},
    {"", "clouds/rendered_seq/depth/d2_0042.png"},
    {"", "pose2sim/opensim_ik_body25b.mot"}};

void AddDamaged(Book& book) {
  const fs::path data(TestData());
  for (const DamagedFile& of : kDamaged) {
    const IngestOptions declared = of.source.empty() ? IngestOptions() : Declared(of.source, of.assignments);
    const fs::path from = !of.folder.empty() ? data / of.folder : of.source.empty() ? data : declared.path;
    const auto bytes = ReadFile(from / of.file);
    if (!bytes) {
      ADD_FAILURE() << bytes.error().Message();
      continue;
    }
    for (const auto& [damage, change] : Damages()) {
      const fs::path folder = FreshFolder("answers_damaged");
      Put(folder / of.file, change(*bytes));
      for (const std::string& name : of.beside) Put(folder / name, ReadFile(from / name).value_or(""));
      book.Open("damaged " + of.source + " " + of.file + ", " + damage);
      book.Add("- inspect");
      AddInspection(folder / of.file, std::nullopt, book);
      if (of.source.empty()) continue;
      book.Add("- inspect --source");
      AddInspection(folder / of.file, declared.source, book);
      book.Add("- run");
      IngestOptions there = declared;
      there.path = folder;
      AddRun(SourceRun(there), there.path, book);
      fs::remove_all(folder);
    }
  }
}

/// One line per page; large pages have one line per clip.
std::string Kept(const Book& book) {
  std::string text;
  for (const auto& [title, lines] : book.pages()) {
    std::map<std::string, std::size_t> codes;
    std::string all;
    for (const std::string& line : lines) {
      all += line + "\n";
      std::istringstream words(line);
      for (std::string word; words >> word;) {
        if (word != "info" && word != "warning" && word != "error") continue;
        std::string code;
        words >> code;
        ++codes[code];
        EXPECT_NE(FindFindingKind(code), nullptr) << code << " is not in the table of findings";
        break;
      }
    }
    text += title + " | " + std::to_string(lines.size()) + " lines " + Sha256Hex(all).substr(0, 12);
    for (const auto& [code, count] : codes) text += " " + code + ":" + std::to_string(count);
    text += "\n";
  }
  return text;
}

TEST_F(RecordedSets, MatchTheRecordedAnswers) {
  Book book;
  AddRecorded(book);
  AddStudio(book);
  AddDamaged(book);
  if (const char* folder = std::getenv("MOCURATE_ANSWERS")) {
    std::string all;
    for (const auto& [title, lines] : book.pages()) {
      all += "== " + title + "\n";
      for (const std::string& line : lines) all += line + "\n";
    }
    fs::create_directories(folder);
    ASSERT_TRUE(WriteFile(fs::path(folder) / "answers_in_full.txt", all));
  }
  const std::string kept = Kept(book);
  if (std::getenv("MOCURATE_REGENERATE") != nullptr) {
    ASSERT_TRUE(WriteFile(kAnswers, kept));
    return;
  }
  const auto written = ReadFile(kAnswers);
  ASSERT_TRUE(written) << written.error().Message();
  EXPECT_TRUE(*written == kept)
      << "MOCURATE_ANSWERS=FOLDER writes the current answers; MOCURATE_REGENERATE=1 accepts them";
}

}  // namespace
}  // namespace mocurate
