#include <algorithm>
#include <cmath>

#include "core/base/problem_list.h"
#include "core/base/text.h"
#include "core/formats/joint_layout.h"
#include "core/formats/openpose.h"
#include "ingest/options.h"
#include "ingest/sources/pattern.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

const std::vector<std::pair<std::string, double>>& Units() {
  static const std::vector<std::pair<std::string, double>> units = {
      {"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"inch", 0.0254}};
  return units;
}

std::string OptionPlace(const char* option) { return std::string("ingest.source.") + option; }

Status CheckSourceUnits(const SourceOptions& s) {
  const bool by_definition = s.format == SourceFormat::kNtuSkeleton || s.format == SourceFormat::kAmass ||
                             s.format == SourceFormat::kPhspd || s.format == SourceFormat::kVibeTracks ||
                             s.format == SourceFormat::kUestc || s.format == SourceFormat::kHumanAct12Pickle ||
                             s.format == SourceFormat::kMotions;
  if (by_definition && !s.units.empty() && s.units != "m") {
    return Fail(ErrorCode::kConfig, "units are '" + s.units + "', but " + FormatName(s.format) + " files are in metres",
                OptionPlace("units"), "take `units` out");
  }
  if (s.format == SourceFormat::kPanoptic && !s.units.empty() && s.units != "cm") {
    return Fail(ErrorCode::kConfig, "units are '" + s.units + "', but panoptic files are in centimetres",
                OptionPlace("units"), "take `units` out");
  }
  const bool by_calibration = IsGathered(s.format) || s.format == SourceFormat::kDepthSequence;
  if (s.units.empty() && !by_calibration && !by_definition) {
    return Fail(
        ErrorCode::kConfig,
        "source '" + s.name + "' does not say its unit of length, and " + FormatName(s.format) + " files do not either",
        OptionPlace("units"), "write `units: m` (or cm, mm, inch) under ingest.source");
  }
  if (s.units.empty()) return {};
  const Expected<double> scale = MetresPerUnit(s.units);
  if (!scale) return Forward(scale);
  return {};
}

void CheckColumns(const SourceOptions& s, ProblemList& problems) {
  const std::vector<std::string> known = {"x", "y", "z", "confidence", "skip"};
  for (const std::string& column : s.columns) {
    if (std::find(known.begin(), known.end(), column) != known.end()) continue;
    problems.Add(OptionPlace("columns"), "unknown column '" + column + "'", "columns are x, y, z, confidence and skip");
  }
  for (const char* needed : {"x", "y", "z"}) {
    if (std::count(s.columns.begin(), s.columns.end(), needed) == 1) continue;
    problems.Add(OptionPlace("columns"), std::string("column '") + needed + "' must stand exactly once");
  }
}

/// The names of columns and joints, all that are wrong at once.
Status CheckTableNames(const SourceOptions& s) {
  ProblemList problems;
  if (s.layout.empty()) CheckColumns(s, problems);
  const Expected<SkeletonPtr> skeleton = s.skeleton.empty() ? SkeletonPtr() : LoadSkeleton(s.skeleton);
  if (skeleton && *skeleton) CheckJointNames(s, **skeleton, problems);
  return problems.Result();
}

Status CheckTable(const SourceOptions& s) {
  if (s.joints.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not name its joints", OptionPlace("joints"),
                "list the joints in the order of the rows of a frame");
  }
  const bool by_columns = s.columns != SourceOptions().columns;
  if (!s.layout.empty() && by_columns) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' declares both `layout` and `columns`",
                OptionPlace("layout"), "`layout` says all that `columns` says; take one out");
  }
  if (Status names = CheckTableNames(s); !names) return names;
  const Expected<JointLayout> layout = TableLayout(s);
  if (!layout) return Forward(layout);
  const int joints = static_cast<int>(s.joints.size());
  if (layout->Joints() != joints) {
    return Fail(ErrorCode::kConfig,
                "the layout has " + std::to_string(layout->Joints()) + " joints, " + std::to_string(joints) +
                    " are named under ingest.source.joints",
                OptionPlace("layout"), "name each joint of the layout, in its order");
  }
  const int rows = RowsPerFrame(s);
  if (s.layout.empty() && joints % rows != 0) {
    return Fail(ErrorCode::kConfig,
                std::to_string(joints) + " joints do not fill " + std::to_string(rows) + " rows per frame",
                OptionPlace("rows_per_frame"), "each row holds the same number of joints");
  }
  if (layout->NumbersPerFrame() % rows != 0) {
    return Fail(ErrorCode::kConfig,
                std::to_string(layout->NumbersPerFrame()) + " numbers of the layout do not fill " +
                    std::to_string(rows) + " rows per frame",
                OptionPlace("rows_per_frame"), "each row holds the same count of numbers");
  }
  return {};
}

/// A declaration that was written by `config init` says by name what is still to be filled in.
Status CheckFilledIn(const SourceOptions& s) {
  const auto open = [](const std::string& text) { return text.rfind(kFillIn, 0) == 0; };
  const std::pair<const char*, const std::string*> texts[] = {{"files", &s.files},
                                                              {"units", &s.units},
                                                              {"axes", &s.axes},
                                                              {"skeleton", &s.skeleton},
                                                              {"skeleton_files", &s.skeleton_files},
                                                              {"depth_files", &s.depth_files},
                                                              {"mask_files", &s.mask_files},
                                                              {"recording", &s.recording}};
  ProblemList problems;
  for (const auto& [option, text] : texts) {
    if (!open(*text)) continue;
    problems.Add(OptionPlace(option), "'" + *text + "' is still to be filled in",
                 "nothing in the files tells it: write what the set's documentation says");
  }
  for (const std::string& file : s.calibration) {
    if (!open(file)) continue;
    problems.Add(OptionPlace("calibration"), "'" + file + "' is still to be filled in",
                 "write where the calibration of the cameras lies below the folder");
  }
  for (const std::string& joint : s.joints) {
    if (!open(joint)) continue;
    problems.Add(OptionPlace("joints"), "'" + joint + "' is still to be filled in",
                 "name the joints in the order of the file, '-' for one that is none");
  }
  return problems.Result();
}

constexpr long long kMostBodies = 6;  // what a Kinect follows
constexpr long long kMostBodiesTogether = 3;

Status CheckBodies(const SourceOptions& s) {
  for (const auto& [label, text] : s.bodies) {
    const std::optional<long long> count = ParseInteger(text);
    if (!count || *count < 1 || *count > kMostBodies) {
      return Fail(ErrorCode::kConfig, "label '" + label + "' has '" + text + "' people", OptionPlace("bodies"),
                  "write a whole number from 1 to 6");
    }
  }
  const bool told_apart =
      s.person.find("{body}") != std::string::npos || s.recording.find("{body}") != std::string::npos;
  if ((!s.bodies.empty() || s.subjects > 1) && !told_apart) {
    return Fail(ErrorCode::kConfig, "several people of one file would be one clip", OptionPlace("bodies"),
                "write {body} into ingest.source.person, e.g. person: 'P{person}{body}'");
  }
  return {};
}

/// A clip of many files: which fields tell its files apart, and what else is needed.
Status CheckGathered(const SourceOptions& s) {
  const std::vector<std::string> fields = FieldsOf(s.files);
  const auto has = [](const std::vector<std::string>& list, const char* field) {
    return std::find(list.begin(), list.end(), field) != list.end();
  };
  const bool views = s.format != SourceFormat::kPanoptic;
  if ((views && !has(fields, "camera")) || (s.format != SourceFormat::kDepthViews && !has(fields, "frame"))) {
    return Fail(
        ErrorCode::kConfig, "'" + s.files + "' does not say which camera and which frame a file is of",
        OptionPlace("files"),
        views ? "e.g. '{recording}/{camera}_json/{camera}.{frame}.json'" : "e.g. '{recording}/body_{frame}.json'");
  }
  if (!views && has(fields, "camera")) {
    return Fail(ErrorCode::kConfig, "'" + s.files + "' names {camera}, but panoptic files are of all cameras together",
                OptionPlace("files"),
                "one file per frame; what else differs in their names is e.g. {recording}, or {-}");
  }
  const std::pair<const char*, const std::string*> texts[] = {{"recording", &s.recording}, {"person", &s.person},
                                                              {"label", &s.label},         {"session", &s.session},
                                                              {"view", &s.view},           {"style", &s.style}};
  for (const auto& [option, text] : texts) {
    for (const char* field : {"camera", "frame", "file"}) {
      if (!has(FieldsOf(*text), field)) continue;
      return Fail(
          ErrorCode::kConfig, "'" + *text + "' names {" + field + "}, which differs between the files of one clip",
          OptionPlace(option), "name what the files of a clip have in common, e.g. {recording}, or write a fixed name");
    }
  }
  if (views && s.calibration.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not say where the cameras stand",
                OptionPlace("calibration"), "e.g. 'Calib.toml', or [intri.yml, extri.yml]");
  }
  const Expected<NamePattern> depth = NamePattern::Parse(s.depth_files, OptionPlace("depth_files"));
  if (!depth) return Forward(depth);
  const std::vector<std::string> of_depth = depth->FieldNames();
  if (HasDepthBeside(s) && (!has(of_depth, "camera") || !has(of_depth, "frame"))) {
    return Fail(ErrorCode::kConfig, "'" + s.depth_files + "' does not say which camera and which frame an image is of",
                OptionPlace("depth_files"), "e.g. '{recording}/depth/{camera}_{frame}.png'");
  }
  bool known = s.keypoints == "measured";
  std::string names;
  for (const KeypointLayout& layout : KeypointLayouts()) {
    known = known || layout.name == s.keypoints;
    names += layout.name + ", ";
  }
  if (!known) {
    return Fail(ErrorCode::kConfig, "'" + s.keypoints + "' is no known layout of keypoints", OptionPlace("keypoints"),
                "known are " + names + "and measured");
  }
  return CheckBodies(s);
}

Status CheckPeople(const SourceOptions& s) {
  const bool by_boxes = s.people.rule == TrackRule::kUestcReleased || s.people.rule == TrackRule::kUestcCorrected;
  if (!by_boxes) return {};
  if (s.format != SourceFormat::kVibeTracks && s.format != SourceFormat::kUestc) {
    return Fail(ErrorCode::kConfig, "UESTC's rule reads boxes in an image, which " + FormatName(s.format) + " has not",
                OptionPlace("people.rule"), "motion, official, presence or nearest");
  }
  if (s.people.start_px.size() == 2) return {};
  return Fail(ErrorCode::kConfig,
              "the performer's first place has " + std::to_string(s.people.start_px.size()) + " numbers",
              OptionPlace("people.start"), "two: pixels across and down");
}

Status CheckViews(const SourceOptions& s) {
  const ViewOptions& views = s.views;
  if (!views.together) return {};
  if (s.format != SourceFormat::kNtuSkeleton) {
    return Fail(ErrorCode::kConfig, FormatName(s.format) + " files are not brought together",
                OptionPlace("views.together"), "ntu_skeleton is the format of which several cameras can be one clip");
  }
  if (s.view.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not say which camera a file is of",
                OptionPlace("view"), "e.g. view: 'C{camera}'");
  }
  for (const auto& [label, text] : s.bodies) {
    if (ParseInteger(text).value_or(0) <= kMostBodiesTogether) continue;
    return Fail(ErrorCode::kConfig, "label '" + label + "' has '" + text + "' people", OptionPlace("bodies"),
                "at most 3 are told apart between several cameras");
  }
  if (s.depth_files.empty()) return {};
  if (views.intrinsics.size() != 4 || views.intrinsics[0] == 0.0 || views.intrinsics[1] == 0.0) {
    return Fail(ErrorCode::kConfig, "the depth images have no intrinsics", OptionPlace("views.intrinsics"),
                "four numbers, fx, fy, cx and cy; a Kinect v2 has about [-366, 366, 256, 208] px");
  }
  if (views.image_size.size() != 2) {
    return Fail(ErrorCode::kConfig, "the depth images have no size", OptionPlace("views.image_size"),
                "width and height; a Kinect v2 has [512, 424] px");
  }
  return {};
}

}  // namespace

bool IsGathered(SourceFormat format) {
  return format == SourceFormat::kOpenPose || format == SourceFormat::kDepthViews || format == SourceFormat::kPanoptic;
}

bool HasDepthBeside(const SourceOptions& source) {
  return source.format == SourceFormat::kOpenPose && !source.depth_files.empty();
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
  return Fail(ErrorCode::kConfig, "'" + units + "' is no unit of length", OptionPlace("units"),
              near ? "did you mean '" + *near + "'?" : "write m, cm, mm, inch, or a length such as '0.0564 m'");
}

int BodiesOf(const SourceOptions& s, const std::string& label) {
  const auto bodies = s.bodies.find(label);
  if (bodies == s.bodies.end()) return static_cast<int>(s.subjects);
  return static_cast<int>(std::clamp(ParseInteger(bodies->second).value_or(1), 1LL, kMostBodies));
}

int RowsPerFrame(const SourceOptions& s) {
  if (s.rows_per_frame > 0) return static_cast<int>(s.rows_per_frame);
  return s.layout.empty() ? static_cast<int>(s.joints.size()) : 1;
}

Expected<JointLayout> TableLayout(const SourceOptions& s) {
  if (!s.layout.empty()) return ParseJointLayout(s.layout, OptionPlace("layout"));
  ProblemList problems;
  CheckColumns(s, problems);
  if (Status known = problems.Result(); !known) return Forward(known);
  JointGroup group;
  group.count = static_cast<int>(s.joints.size());
  for (const std::string& column : s.columns) {
    group.columns.push_back(column == "x"            ? JointColumn::kX
                            : column == "y"          ? JointColumn::kY
                            : column == "z"          ? JointColumn::kZ
                            : column == "confidence" ? JointColumn::kConfidence
                                                     : JointColumn::kSkip);
  }
  JointLayout layout;
  layout.groups.push_back(std::move(group));
  return layout;
}

Status CheckSource(const SourceOptions& s) {
  if (Status written = CheckFilledIn(s); !written) return written;
  if (s.name.empty()) return Fail(ErrorCode::kConfig, "the source has no name", OptionPlace("name"));
  if (s.name.find_first_of("/#") != std::string::npos) {
    return Fail(ErrorCode::kConfig, "the name '" + s.name + "' holds '/' or '#'", OptionPlace("name"));
  }
  if (s.format == SourceFormat::kNone) {
    return Fail(
        ErrorCode::kConfig, "source '" + s.name + "' does not say its format", OptionPlace("format"),
        "joint_table, bvh, npy, depth_sequence, ntu_skeleton, asf_amc, amass, expmap, phspd, vibe_tracks, uestc, "
        "humanact12_pickle, motions, openpose, depth_views or panoptic");
  }
  if (s.files.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' has no pattern of file names", OptionPlace("files"),
                "e.g. 'a{action}_s{person}_e{repetition}.txt'");
  }
  if (s.axes.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not say its axes", OptionPlace("axes"),
                "write where its x, y and z point, e.g. axes: '+x +y +z' (right-handed, y up, a person faces +z)");
  }
  if (Status units = CheckSourceUnits(s); !units) return units;
  const bool rate_known = s.format == SourceFormat::kBvh || s.format == SourceFormat::kDepthSequence ||
                          s.format == SourceFormat::kAmass || s.format == SourceFormat::kMotions;
  if (!rate_known && !s.rate_hz) {
    return Fail(
        ErrorCode::kConfig,
        "source '" + s.name + "' does not say its frame rate, and " + FormatName(s.format) + " files do not either",
        OptionPlace("rate"), "write e.g. `rate: 30 Hz`");
  }
  if (s.format == SourceFormat::kJointTable) {
    if (Status table = CheckTable(s); !table) return table;
  }
  if (IsGathered(s.format)) {
    if (Status gathered = CheckGathered(s); !gathered) return gathered;
  }
  if (s.format == SourceFormat::kNtuSkeleton) {
    if (Status bodies = CheckBodies(s); !bodies) return bodies;
  }
  if (Status views = CheckViews(s); !views) return views;
  if (Status people = CheckPeople(s); !people) return people;
  if (Status actions = CheckActions(s.checks); !actions) return actions;
  if (s.format == SourceFormat::kAsfAmc && s.skeleton_files.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not say which .asf belongs to an .amc",
                OptionPlace("skeleton_files"), "e.g. '{subject}.asf' where files are '{subject}_{take}.amc'");
  }
  const bool names_no_joint = s.format == SourceFormat::kNpy || s.format == SourceFormat::kExpmap ||
                              s.format == SourceFormat::kVibeTracks || s.format == SourceFormat::kUestc ||
                              s.format == SourceFormat::kHumanAct12Pickle;
  if (names_no_joint && s.skeleton.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not say its skeleton", OptionPlace("skeleton"),
                "an array needs one, e.g. humanact12");
  }
  const bool all_in_one = s.format == SourceFormat::kHumanAct12Pickle || s.format == SourceFormat::kMotions;
  if (all_in_one != !s.container.empty() && s.format != SourceFormat::kUestc) {
    return Fail(ErrorCode::kConfig,
                all_in_one ? "source '" + s.name + "' does not say which file holds its clips"
                           : FormatName(s.format) + " files hold one clip each, not all in '" + s.container + "'",
                OptionPlace("container"), all_in_one ? "e.g. 'humanact12poses.pkl'" : "take `container` out");
  }
  if (s.format == SourceFormat::kDepthSequence && s.depth_files.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not say where its depth images are",
                OptionPlace("depth_files"), "e.g. 'depth/{view}_{frame:4}.png'");
  }
  return {};
}

}  // namespace mocurate
