#include "ingest/options.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"

namespace mocurate {
namespace {

const std::vector<std::pair<std::string, double>>& Units() {
  static const std::vector<std::pair<std::string, double>> units = {
      {"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"inch", 0.0254}};
  return units;
}

std::string Place(const char* option) { return std::string("ingest.source.") + option; }

std::string FormatName(SourceFormat format) {
  switch (format) {
    case SourceFormat::kJointTable:
      return "joint_table";
    case SourceFormat::kBvh:
      return "bvh";
    case SourceFormat::kNpy:
      return "npy";
    case SourceFormat::kDepthSequence:
      return "depth_sequence";
    case SourceFormat::kNone:
      break;
  }
  return "none";
}

Status CheckUnits(const SourceOptions& s) {
  if (s.units.empty() && s.format != SourceFormat::kDepthSequence) {
    return Fail(
        ErrorCode::kConfig,
        "source '" + s.name + "' does not say its unit of length, and " + FormatName(s.format) + " files do not either",
        Place("units"), "write `units: m` (or cm, mm, inch) under ingest.source");
  }
  if (s.units.empty()) return {};
  const Expected<double> scale = MetresPerUnit(s.units);
  if (!scale) return Forward(scale);
  return {};
}

Status CheckTable(const SourceOptions& s) {
  if (s.joints.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not name its joints", Place("joints"),
                "list the joints in the order of the rows of a frame");
  }
  for (const std::string& column : s.columns) {
    const bool known = column == "x" || column == "y" || column == "z" || column == "confidence" || column == "skip";
    if (!known) {
      return Fail(ErrorCode::kConfig, "unknown column '" + column + "'", Place("columns"),
                  "columns are x, y, z, confidence and skip");
    }
  }
  for (const char* needed : {"x", "y", "z"}) {
    if (std::count(s.columns.begin(), s.columns.end(), needed) != 1) {
      return Fail(ErrorCode::kConfig, std::string("column '") + needed + "' must stand exactly once", Place("columns"));
    }
  }
  const auto joints = static_cast<std::int64_t>(s.joints.size());
  if (s.rows_per_frame > 0 && joints % s.rows_per_frame != 0) {
    return Fail(ErrorCode::kConfig,
                std::to_string(joints) + " joints do not fill " + std::to_string(s.rows_per_frame) + " rows per frame",
                Place("rows_per_frame"), "each row holds the same number of joints");
  }
  return {};
}

}  // namespace

void SourceOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "short name of the source; first part of every clip id");
  v.Choice("format", format,
           {{"none", SourceFormat::kNone},
            {"joint_table", SourceFormat::kJointTable},
            {"bvh", SourceFormat::kBvh},
            {"npy", SourceFormat::kNpy},
            {"depth_sequence", SourceFormat::kDepthSequence}},
           "what the files are");
  v.Text("files", files, "pattern of the file names with {fields}; {field:4} is four characters wide");
  v.Choice("other_files", other_files,
           {{"ignore", OtherFiles::kIgnore}, {"finding", OtherFiles::kFinding}, {"error", OtherFiles::kError}},
           "what becomes of files whose name does not match");
  v.Text("licence", licence, "under which the captures may be used");
  v.Text("units", units, "unit of length of the files: m, cm, mm, inch, or a length such as '0.0564 m'");
  v.Text("axes", axes, "where +x +y +z of the source point in the canonical world (right-handed, y up, facing +z)");
  v.OptionalNumber("rate", rate_hz, Unit::kHertz, {1e-3, 1e5}, "frame rate, where the files do not say it");
  v.Text("skeleton", skeleton, "skeleton that the joints belong to");
  v.Texts("joints", joints, "joint names in the order of the file");
  v.Integer("rows_per_frame", rows_per_frame, {0.0, 1e4}, "joint_table: rows of one frame; 0 is one per joint");
  v.Texts("columns", columns, "joint_table: numbers of one joint: x, y, z, confidence, skip");
  v.Choice("missing", missing,
           {{"none", MissingValue::kNone}, {"zero", MissingValue::kZero}, {"nan", MissingValue::kNan}},
           "joint_table: what a joint that was not seen looks like");
  v.Number("max_slide", max_slide, Unit::kMetre, {0.0, 1.0},
           "bvh: most that a joint may slide along its bone; more is refused");
  v.Text("depth_files", depth_files, "depth_sequence: pattern of the depth images with {view} and {frame}");
  v.Number("depth_unit", depth_unit, Unit::kMetre, {1e-6, 1.0}, "depth_sequence: length of one step of a depth value");
  v.Text("truth_files", truth_files, "joint_table: pattern of BVH files that hold the truth of the same recording");
  v.Text("person", person, "who performs, from the fields of the name");
  v.Text("recording", recording, "name of the recording; {file} is the path without its ending");
  v.Text("label", label, "what is performed, from the fields of the name");
  v.Text("session", session, "recording session, from the fields of the name");
  v.Text("view", view, "camera or view, from the fields of the name");
  v.Text("style", style, "style of the performance, from the fields of the name");
  v.TextMap("labels", labels, "names of the labels; a label that is not listed is an error");
  v.TextMap("roles", roles, "person -> train, validation or test, where the source prescribes it");
  v.Choice("on_contradiction", on_contradiction,
           {{"flag", OnContradiction::kFlag}, {"refuse", OnContradiction::kRefuse}},
           "what becomes of a clip whose motion contradicts the declared axes");
}

void SyntheticOptions::Declare(OptionVisitor& v) {
  v.Bool("enabled", enabled, "make a synthetic capture instead of reading a folder");
  v.Integer("seed", seed, {}, "of everything random in the capture");
  v.Texts("actions", actions, "what the subjects perform");
  v.Integer("subjects", subjects, {1.0, 1000.0}, "number of people, each with a body of its own");
  v.Integer("repetitions", repetitions, {1.0, 1000.0}, "takes of each action by each subject");
  v.Number("duration", duration_s, Unit::kSecond, {0.2, 600.0}, "mean length of a take");
  v.Number("rate", rate_hz, Unit::kHertz, {1.0, 1000.0}, "frames per second of the tracker");
  v.Number("noise", noise, Unit::kMetre, {0.0, 1.0}, "root mean square error of a tracked joint");
  v.Number("dropout", dropout_share, Unit::kNone, {0.0, 0.9}, "share of joints that are not seen");
  v.Number("outlier", outlier_share, Unit::kNone, {0.0, 0.9}, "share of joints that are grossly wrong");
}

void IngestOptions::Declare(OptionVisitor& v) {
  v.Path("path", path, "folder with the captures");
  v.Group("source", source, "what the captures are");
  v.Group("synthetic", synthetic, "a capture made by the program itself");
}

Expected<double> MetresPerUnit(const std::string& units) {
  const std::vector<std::string_view> words = SplitBlanks(units);
  std::vector<std::string> names;
  for (const auto& [name, metres] : Units()) {
    names.push_back(name);
    if (words.size() == 1 && words[0] == name) return metres;
    if (words.size() != 2 || words[1] != name) continue;
    const std::optional<double> factor = ParseDouble(words[0]);
    if (factor && std::isfinite(*factor) && *factor > 0.0) return *factor * metres;
  }
  const std::optional<std::string> near = Nearest(units, names);
  return Fail(ErrorCode::kConfig, "'" + units + "' is no unit of length", Place("units"),
              near ? "did you mean '" + *near + "'?" : "write m, cm, mm, inch, or a length such as '0.0564 m'");
}

Status CheckSource(const SourceOptions& s) {
  if (s.name.empty()) return Fail(ErrorCode::kConfig, "the source has no name", Place("name"));
  if (s.name.find_first_of("/#") != std::string::npos) {
    return Fail(ErrorCode::kConfig, "the name '" + s.name + "' holds '/' or '#'", Place("name"));
  }
  if (s.format == SourceFormat::kNone) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not say its format", Place("format"),
                "joint_table, bvh, npy or depth_sequence");
  }
  if (s.files.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' has no pattern of file names", Place("files"),
                "e.g. 'a{action}_s{person}_e{repetition}.txt'");
  }
  if (s.axes.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not say its axes", Place("axes"),
                "write where its x, y and z point, e.g. axes: '+x +y +z' (right-handed, y up, a person faces +z)");
  }
  if (Status units = CheckUnits(s); !units) return units;
  const bool rate_unknown = s.format == SourceFormat::kJointTable || s.format == SourceFormat::kNpy;
  if (rate_unknown && !s.rate_hz) {
    return Fail(
        ErrorCode::kConfig,
        "source '" + s.name + "' does not say its frame rate, and " + FormatName(s.format) + " files do not either",
        Place("rate"), "write e.g. `rate: 30 Hz`");
  }
  if (s.format == SourceFormat::kJointTable) {
    if (Status table = CheckTable(s); !table) return table;
  }
  if (s.format == SourceFormat::kNpy && s.skeleton.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not say its skeleton", Place("skeleton"),
                "an array of positions needs one, e.g. humanact12");
  }
  if (s.format == SourceFormat::kDepthSequence && s.depth_files.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not say where its depth images are",
                Place("depth_files"), "e.g. 'depth/{view}_{frame:4}.png'");
  }
  return {};
}

StageDeclaration IngestDeclaration() { return {"ingest", 4, "mocurate-annotate", ClipLimits()}; }
StageDeclaration TruthDeclaration() { return {"truth", 1, "mocurate-annotate", ClipLimits()}; }
StageDeclaration CaptureDeclaration() { return {"capture", 1, "mocurate-annotate", WholeSetLimits()}; }

}  // namespace mocurate
