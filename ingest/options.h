#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/formats/file_rules.h"
#include "core/quality/padding.h"
#include "ingest/checks/finding_table.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// What the rotation and the translation of a calibration mean, where its format does not declare it.
enum class CameraPose { kMeasured, kWorldToCamera, kCentre, kCameraToWorld };
/// What to do with files of the folder that the pattern does not match.
enum class OtherFiles { kIgnore, kFinding, kError };
/// How a joint table says that a joint was not seen.
enum class MissingValue { kNone, kZero, kNan };
/// A label for all texts that a pattern is found in, such as a description of what is performed.
struct LabelRule {
  std::string pattern;  ///< regular expression (ECMAScript), letter case aside
  std::string label;

  void Declare(OptionVisitor& v);
};

/// A marker on the body, where a source declares those of its files.
struct MarkerPlace {
  std::string point;                          ///< its name in the files
  std::string joint;                          ///< of the fitted skeleton, that it moves with
  std::vector<double> offset{0.0, 0.0, 0.0};  ///< in that joint's frame, rest pose, metres
  double spread = 0.02;                       ///< standard deviation of that per axis, metres

  void Declare(OptionVisitor& v);
};

/// What becomes of a file whose label is not listed under `labels`.
enum class OtherLabels { kError, kLeaveOut, kKeep };
/// The rule that separates the people of a file from other tracks.
enum class TrackRule {
  kMotion,    ///< those there in half as many frames as the longest, by how much they move; then the others by length
  kOfficial,  ///< NTU's: by the summed variance of the joints, however short they are there
  kPresence,  ///< by how long they are there
  kNearest,   ///< by how near they stand to the sensor (median distance of their middle)
  kUestcReleased,   ///< VIBE's tracks of UESTC as ACTOR's released preprocessing picks them (people/uestc.h)
  kUestcCorrected,  ///< the same with its faults corrected
};
/// Whether the rule reads the boxes of people in a video.
inline bool ByBoxes(TrackRule rule) { return rule == TrackRule::kUestcReleased || rule == TrackRule::kUestcCorrected; }
/// Where the root of VIBE's tracks is.
enum class RootTranslation {
  kPublished,  ///< as the papers' codes have it: uestc moves by the camera, vibe_tracks (NTU-13) stays
  kStill,
  kCamera,  ///< by the weak-perspective camera of the image: (tx, ty, 500 / (270 sx)) minus that of the first frame
};

/// Who of those that a tracker followed is a clip.
struct PeopleOptions {
  TrackRule rule = TrackRule::kMotion;
  std::vector<double> start_px{480.0, 270.0};
  bool stitch = true;
  bool false_tracks = true;
  double max_lost_s = 2.0;

  void Declare(OptionVisitor& v);
};

/// Several sensors that saw one performance, each in a file of its own.
struct ViewOptions {
  bool multi_view = false;           ///< files that give one item and differ in `view` alone are one clip
  std::vector<std::string> cameras;  ///< `view` of each that belongs to a capture; empty: whichever are there
  std::vector<double> intrinsics;    ///< fx, fy, cx, cy of the depth images, pixels
  std::vector<double> image_size;    ///< width, height, pixels
  double max_offset_s = 1.0;
  double max_disagreement = 0.1;

  void Declare(OptionVisitor& v);
};

/// What becomes of a clip that a list of known issues names.
enum class KnownIssueAction { kDrop, kReport, kIgnore };
/// What a contradiction between declaration and motion does to a clip.
enum class OnContradiction { kFlag, kRefuse };

/// Declares one source of captures: everything its files do not say themselves. Texts with {fields} take the parts of
/// the file name, {file} is the path without its ending with '/' as '.', {body} is empty or, where a file holds several
/// people, a, b, ... of each.
struct SourceOptions {
  std::string name;
  std::string format = "none";
  std::string files;  ///< pattern of the path below the folder: "a{action}_s{person}.txt", "{id:4}.npy" (exact width)
  std::string container;    ///< the one file that holds all clips; `files` is then the pattern of their names in it
  std::string label_table;  ///< csv below the folder, "motion, label" after a header; `label` then says nothing
  OtherFiles other_files = OtherFiles::kFinding;
  std::string licence;

  std::string units;  ///< "m", "cm", "mm", "inch", or a length such as "2.2222222222222 inch"
  std::string axes;   ///< AxisConvention
  std::optional<double> rate_hz;
  std::string skeleton;
  std::vector<std::string> joints;                  ///< names in the order of the file; "-" is passed over
  std::int64_t rows_per_frame = 0;                  ///< joint_table; 0: one row a joint, with `layout` one a frame
  std::vector<std::string> columns{"x", "y", "z"};  ///< joint_table, per joint: x y z confidence frame time_ms skip
  std::string layout;    ///< joint_table, instead of `columns`: all numbers of a frame, as ParseJointLayout reads them
  std::string end_word;  ///< joint_table: line that closes the table, where there is one
  std::map<std::string, std::string> bodies;  ///< ntu_skeleton: label text -> people in the file, "2"; others have one
  PeopleOptions people;                       ///< ntu_skeleton, vibe_tracks, uestc: which of those that were followed
  ViewOptions views;                          ///< ntu_skeleton: cameras that saw one performance
  double inferred_confidence = 0.3;           ///< ntu_skeleton: of a joint that the sensor inferred; tracked is 1
  std::string skeleton_files;                 ///< asf_amc: "{subject}.asf", filled from the fields of the motion's name
  std::string track = "1";                    ///< vibe_tracks: key of the person in a file; empty: people.rule says
  RootTranslation root_translation = RootTranslation::kPublished;  ///< vibe_tracks, uestc
  std::vector<std::string> annotations;                            ///< amass: BABEL files below the folder
  std::map<std::string, std::string> annotation_roles;             ///< amass: file of annotations -> role of its clips
  std::vector<MarkerPlace> markers;  ///< c3d, trc: points that are markers; none: points are joints
  double least_confidence = 0.0;     ///< joint_table: of a joint that has a position
  DamagedRows damaged_rows = DamagedRows::kReport;
  MissingValue missing = MissingValue::kNone;
  std::vector<double> lie_bone_lengths;  ///< npy: (J) in the file's unit; the array holds Lie parameters
  double max_slide = 0.002;              ///< bvh: metres a bone may change its length before the clip is refused
  std::string
      depth_files;  ///< depth_sequence: "depth/{view}_{frame}.png"; ntu_skeleton with views.multi_view; openpose
  double depth_unit = 0.001;  ///< of those: metres per step of a depth value
  std::string mask_files;     ///< depth_views: "views/{camera}_mask.jpg"; the person in the image of the same fields
  std::vector<std::string> calibration;  ///< openpose, depth_views: below the folder; {camera}: one per camera
  CameraPose camera_pose = CameraPose::kMeasured;  ///< openpose, depth_views
  std::map<std::string, std::string> cameras;      ///< {camera} of a file's name -> the calibration's name for it
  std::map<std::string, std::string> first_frame;  ///< camera -> its frame when the others begin
  std::string keypoints = "measured";              ///< openpose: a layout's name, or "measured"
  std::int64_t subjects = 1;                       ///< openpose, panoptic: people of a recording, a clip each

  std::string person = "{person}";
  std::string recording = "{file}";  ///< {file}: the path without its ending, '/' as '.'
  std::string label = "{action}";
  std::string fine_label;  ///< finer than `label`: "{action}{fine}"; empty: there is none
  std::string session;
  std::string view;
  std::string style;
  std::map<std::string, std::string> labels;       ///< label text -> name
  std::vector<LabelRule> label_rules;              ///< of texts that `labels` does not list; the first that fits
  std::map<std::string, std::string> fine_labels;  ///< fine label text -> name
  OtherLabels other_labels = OtherLabels::kError;
  std::map<std::string, std::string> roles;    ///< person -> role
  std::map<std::string, std::string> exclude;  ///< recording -> why its file is excluded
  std::vector<std::string> known_issue_lists;  ///< of configs/known_issues, or paths
  KnownIssueAction known_issues = KnownIssueAction::kReport;
  std::string frames_in_name;  ///< "{first}-{last}": frames that the name speaks of, both ends included
  OnContradiction on_contradiction = OnContradiction::kFlag;
  double max_gap_s = 0.5;    ///< kMaxGap_s (core/motion/gaps.h)
  double max_missing = 0.5;  ///< share of the frames between the first and the last observation
  CheckOptions checks;

  void Declare(OptionVisitor& v);
};

/// The studio's capture: what is performed, and how bad the tracker is.
struct SyntheticOptions {
  bool enabled = false;
  std::int64_t seed = 1;
  std::vector<std::string> actions{"wave", "punch", "kick", "squat", "walk", "jump"};
  std::int64_t subjects = 4;
  std::int64_t repetitions = 6;
  double duration_s = 3.0;
  double rate_hz = 30.0;
  TrackerOptions tracker;  ///< its options stand among these

  void Declare(OptionVisitor& v);
};

struct IngestOptions {
  std::filesystem::path
      path;  ///< folder of the source, or one of its files; empty with synthetic.enabled: the capture's folder
  std::filesystem::path truth;  ///< folder of truth files, or one; the error of fits against it is reported
  std::string obtain;           ///< where the set comes from and what has to be signed
  std::map<std::string, std::string> expected;  ///< path below the folder -> what lies there, beside source.files
  SourceOptions source;
  SyntheticOptions synthetic;

  void Declare(OptionVisitor& v);
};

/// How files become one set of motions: options of the stage `motions`.
struct MotionsOptions {
  IngestOptions ingest;
  std::vector<std::string> classes;  ///< a motion without a label takes the class that its name begins with
  PaddingAction padding = PaddingAction::kNone;
  std::vector<std::string> tolerate = {};  ///< codes of findings that refuse no clip

  void Declare(OptionVisitor& v);
};

/// Whether clips of the source have keypoints and depth views beside them.
bool HasDepthBeside(const SourceOptions& source);

/// Adds a name that `format` may have.
void AddSourceFormat(const std::string& name);

/// Rules that go beyond single values: what the format needs and does not say itself. Error kConfig naming the option.
Status CheckSource(const SourceOptions& source);

/// The people of a file: counts under `bodies`, and names that tell them apart. Error kConfig.
Status CheckBodies(const SourceOptions& source);

/// Text that stands where a value has to be written: "FILL_IN: why it is not known". Refused by CheckSource.
inline constexpr const char* kFillIn = "FILL_IN";

/// Whether a joint table has a column of times, which states the rate. False for a broken layout.
bool HasTimes(const SourceOptions& source);

/// People in a file whose label text, before renaming, is `label`; `subjects` where `bodies` says nothing.
int BodiesOf(const SourceOptions& source, const std::string& label);

/// Metres per unit of `units`. Error kConfig.
Expected<double> MetresPerUnit(const std::string& units);

}  // namespace mocurate
