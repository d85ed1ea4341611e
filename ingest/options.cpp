#include "ingest/options.h"

#include "core/motion/rate_limits.h"
#include "ingest/stages.h"

namespace mocurate {

namespace {

/// Names that `format` may have, "none" first.
std::vector<std::string>& FormatNames() {
  static std::vector<std::string> names = {
      "none",     "joint_table", "bvh",         "npy",   "depth_sequence",    "ntu_skeleton", "asf_amc",  "amass",
      "expmap",   "phspd",       "vibe_tracks", "uestc", "humanact12_pickle", "motions",      "openpose", "depth_views",
      "panoptic", "clouds",      "c3d",         "trc"};
  return names;
}

}  // namespace

void AddSourceFormat(const std::string& name) { FormatNames().push_back(name); }

void LabelRule::Declare(OptionVisitor& v) {
  v.Text("pattern", pattern, "regular expression searched in the label's text; case is ignored");
  v.Text("label", label, "of the clips whose text has it");
}

void MarkerPlace::Declare(OptionVisitor& v) {
  v.Text("point", point, "name of the marker in the files");
  v.Text("joint", joint, "joint of the fitted skeleton that it moves with");
  v.Numbers("offset", offset, Unit::kMetre, {-2.0, 2.0}, "in that joint's frame, in the rest pose");
  v.Number("spread", spread, Unit::kMetre, {0.001, 0.5}, "standard deviation of that place per axis, among people");
}

void SourceOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "short name of the source; first part of every clip id");
  v.OneOf("format", format, FormatNames(), "what the files are");
  v.Text("files", files,
         "pattern of the file names with {fields}; {field:4} is four characters wide, {field?/} a folder that may be "
         "missing; openpose, depth_views, panoptic, clouds: "
         "files that differ only in {camera} and {frame} are one clip; {-} matches any text");
  v.Text("container", container,
         "humanact12_pickle, uestc, motions: the file with all clips (uestc without it: one file of VIBE's tracks per "
         "video); `files` is then the pattern of the clips' names");
  v.Text("label_table", label_table,
         "table of labels below the folder: a header and lines 'motion,label', or lines of motion, tab and text. "
         "`motion` is the file's name without ending; `labels` and `label_rules` may rename");
  v.Choice("other_files", other_files,
           {{"ignore", OtherFiles::kIgnore}, {"finding", OtherFiles::kFinding}, {"error", OtherFiles::kError}},
           "action for files whose name does not match `files`");
  v.Text("licence", licence, "licence of the captures");
  v.Text(
      "units", units,
      "unit of length of the files: m, cm, mm, inch, or a length such as '0.05 m' or '2.2222222222222 inch' (1 / 0.45, "
      "of the CMU database)");
  v.Text("axes", axes, "directions of the source's x, y and z in the canonical world (right-handed, y up, facing +z)");
  v.OptionalNumber("rate", rate_hz, Unit::kHertz, {kSlowestRate_hz, kFastestRate_hz},
                   "frames per second; overrides another rate that the files declare, with a finding");
  v.Text("skeleton", skeleton, "skeleton that the joints belong to");
  v.Texts("joints", joints, "joint names in the order of the file; '-' skips a joint");
  v.Integer("rows_per_frame", rows_per_frame, {0.0, 1e4},
            "joint_table: rows per frame; 0: one row per joint, or with `layout` one row per frame");
  v.Texts("columns", columns,
          "joint_table: numbers of one joint: x, y, z, confidence, skip, and, where each row has them, frame or "
          "time_s, time_ms, time_us, time_100ns, time_ns");
  v.Text("layout", layout,
         "joint_table: all numbers of a frame instead of `columns`, e.g. 'frame 11*(rotation rotation_confidence x y z "
         "confidence) 4*(x y z confidence)'. `frame` is the number of the frame; time_s, time_ms, time_us, time_100ns "
         "or time_ns its time, by which frames are laid out and which states the rate");
  v.Text("end_word", end_word, "joint_table: word on the line that ends the table, if any");
  v.Choice("damaged_rows", damaged_rows, {{"refuse", DamagedRows::kRefuse}, {"report", DamagedRows::kReport}},
           "damaged rows (wrong length, no numbers, truncated last frame, frame count that contradicts the rows): "
           "refuse the file, or report a finding and set the frame to missing. For joint_table, ntu_skeleton, asf_amc, "
           "phspd, expmap, amass, npy, bvh");
  v.TextMap("bodies", bodies,
            "ntu_skeleton: label in the file name -> number of people in such files, 1 to 6; default: 1");
  v.Group("people", people, "ntu_skeleton, vibe_tracks, uestc: choice of the tracks that are people of the clip");
  v.Group("views", views, "ntu_skeleton: merging of files that show one performance from several cameras");
  v.Number("inferred_confidence", inferred_confidence, Unit::kNone, {0.0, 1.0},
           "ntu_skeleton: confidence of inferred joints; tracked joints have 1, others 0");
  v.Text("skeleton_files", skeleton_files,
         "asf_amc: name of the .asf of a motion, from the fields of the motion's name, e.g. '{person}.asf'");
  v.Text("track", track, "vibe_tracks: id of the person's track; empty: chosen by `people.rule`");
  v.Choice("root_translation", root_translation,
           {{"published", RootTranslation::kPublished},
            {"still", RootTranslation::kStill},
            {"camera", RootTranslation::kCamera}},
           "vibe_tracks, uestc: root translation: from the weak-perspective camera, still, or as in the papers' codes "
           "(uestc: camera, vibe_tracks: still)");
  v.Texts("annotations", annotations,
          "amass: BABEL's .json files below the folder; the first that names a motion counts");
  v.TextMap("annotation_roles", annotation_roles,
            "amass: annotation file -> role of its motions: train, validation or test");
  v.Choice("missing", missing,
           {{"none", MissingValue::kNone}, {"zero", MissingValue::kZero}, {"nan", MissingValue::kNan}},
           "joint_table: values of an unobserved joint");
  v.Number("least_confidence", least_confidence, Unit::kNone, {0.0, 1.0},
           "joint_table: lower bound of the confidence of joints that have a position, for files that store 0 for "
           "tracked joints");
  v.Numbers("lie_bone_lengths", lie_bone_lengths, Unit::kNone, {0.0, 1e6},
            "npy: bone length of each joint, 0 for the root, in the file's unit: the array holds Action2Motion's Lie "
            "parameters (root translation, then a rotation vector per joint) instead of positions");
  v.Number("max_slide", max_slide, Unit::kMetre, {0.0, 1.0},
           "bvh: largest change of a bone's length; files with more are refused");
  v.Text("depth_files", depth_files,
         "pattern of the depth images: depth_sequence with {view} and, unless there is one image per view, {frame}; "
         "ntu_skeleton with views.multi_view: with {frame}, counted from 1, and fields of `files`; openpose with "
         "{camera} and {frame}, numbered as the "
         "keypoints are, and fields of `files`: the clip has keypoints and depth views");
  v.Number("depth_unit", depth_unit, Unit::kMetre, {1e-6, 1.0}, "length of one step of a depth value");
  v.Text("mask_files", mask_files,
         "depth_views: pattern of the masks (PNG, JPEG, white on the person), one per depth image");
  v.Texts("calibration", calibration,
          "openpose, depth_views: calibration file below the folder, with fields of the clip's name; OpenCV's intri "
          "and extri are two files; with {camera} one file per camera");
  v.Choice("camera_pose", camera_pose,
           {{"measured", CameraPose::kMeasured},
            {"world_to_camera", CameraPose::kWorldToCamera},
            {"centre", CameraPose::kCentre},
            {"camera_to_world", CameraPose::kCameraToWorld}},
           "convention of rotation and translation in calibrations whose format does not declare it");
  v.TextMap("cameras", cameras, "{camera} of the file names -> camera name in the calibration, where they differ");
  v.TextMap("first_frame", first_frame,
            "camera -> number of its frame at the moment when the cameras that are not named here begin (less than its "
            "first one where it begins later). openpose, depth_views: {camera} of the file names, and the number of "
            "the file; ntu_skeleton with views.multi_view: `view`, and frames counted from 1");
  v.Text("keypoints", keypoints,
         "openpose: order of the detector's points: BODY_25, BODY_25B, COCO_17, COCO_18, or measured by bone lengths");
  v.Integer("subjects", subjects, {1.0, 26.0},
            "openpose, panoptic: number of people per recording; one clip each, longest presence first");
  v.Text("person", person,
         "name of the person, made of {fields} of the file name; {body} numbers the people of a file");
  v.Text("recording", recording,
         "name of the recording, made of {fields} of the file name; {file} is the path without its ending");
  v.Text("label", label, "action label, made of {fields} of the file name");
  v.Text("fine_label", fine_label, "label of a finer class, or empty");
  v.Text("session", session, "recording session, made of {fields} of the file name");
  v.Text("view", view, "camera or view, made of {fields} of the file name");
  v.Text("style", style, "style of the performance, made of {fields} of the file name");
  v.TextMap("labels", labels, "names of the labels");
  v.List("markers", markers,
         "c3d, trc: points that are markers on the skin, e.g. of configs/markers; the fit learns where a person wears "
         "them, and leaves out other points. None: points are joints");
  v.List("label_rules", label_rules,
         "labels by patterns, for texts missing in `labels`, such as descriptions; the first match counts");
  v.TextMap("fine_labels", fine_labels, "names of the fine labels; others keep their text");
  v.Choice("other_labels", other_labels,
           {{"error", OtherLabels::kError}, {"exclude", OtherLabels::kLeaveOut}, {"keep", OtherLabels::kKeep}},
           "action for a file whose label is not under `labels`; keep: its own label is used");
  v.TextMap("roles", roles, "person -> train, validation or test, where the source prescribes it");
  v.TextMap("exclude", exclude,
            "recording -> reason for excluding it; with views.multi_view the file name without ending");
  v.Choice("on_contradiction", on_contradiction,
           {{"flag", OnContradiction::kFlag}, {"refuse", OnContradiction::kRefuse}},
           "action for clips whose motion contradicts the declared units, axes or joint order; for the whole source "
           "where enough clips agree");
  v.Texts("known_issue_lists", known_issue_lists,
          "lists of clips with published errors: names in configs/known_issues, or files of that form");
  v.Choice(
      "known_issues", known_issues,
      {{"drop", KnownIssueAction::kDrop}, {"report", KnownIssueAction::kReport}, {"ignore", KnownIssueAction::kIgnore}},
      "action for clips on those lists");
  v.Text("frames_in_name", frames_in_name,
         "first and last frame in the file name, e.g. '{first}-{last}'; a longer clip is a finding");
  v.Number("max_gap", max_gap_s, Unit::kSecond, {0.0, 600.0},
           "longest gap without an observation that may be interpolated; frames of a longer one are inferred: nothing "
           "is trained on them or scored");
  v.Number("max_missing", max_missing, Unit::kNone, {0.0, 1.0},
           "clips with a larger share of frames without an observation, between the first and the last one, are "
           "excluded");
  v.Group("checks", checks, "limits and actions of the checks of a clip");
}

void PeopleOptions::Declare(OptionVisitor& v) {
  v.Choice("rule", rule,
           {{"motion", TrackRule::kMotion},
            {"official", TrackRule::kOfficial},
            {"presence", TrackRule::kPresence},
            {"nearest", TrackRule::kNearest},
            {"uestc_released", TrackRule::kUestcReleased},
            {"uestc_corrected", TrackRule::kUestcCorrected}},
           "selection: motion (largest motion among tracks at least half as long as the longest), official (NTU's: "
           "largest summed variance, without stitching and false-track removal), presence (longest), nearest (to the "
           "sensor), uestc_released and uestc_corrected (VIBE's tracks by their boxes, as in ACTOR's code, and with "
           "its errors corrected)");
  v.Numbers("start", start_px, Unit::kPixel, {},
            "uestc_released, uestc_corrected: position of the performer in the first video frame; ACTOR takes it from "
            "the sensor's skeletons");
  v.Bool("stitch", stitch,
         "join tracks of one person under several ids: lost and found again with the same bones, or interleaved");
  v.Bool("false_tracks", false_tracks, "exclude false tracks: short, frozen, furniture, a second body in one place");
  v.Number("max_lost", max_lost_s, Unit::kSecond, {0.0, 600.0}, "longest time over which ids are joined");
}

void ViewOptions::Declare(OptionVisitor& v) {
  v.Bool("multi_view", multi_view,
         "files with the same person and recording that differ in `view` are one clip: their joints are aligned to one "
         "camera and merged, their depth images become its views");
  v.Texts("cameras", cameras, "`view` of every camera of a capture; a missing one is a finding");
  v.Numbers("intrinsics", intrinsics, Unit::kPixel, {},
            "fx, fy, cx, cy of the depth images, where they cannot be estimated from the joints; fx is negative for "
            "mirrored images, as Kinects write them");
  v.Numbers("image_size", image_size, Unit::kPixel, {1.0, 20000.0}, "width and height of the depth images");
  v.Number("max_offset", max_offset_s, Unit::kSecond, {0.0, 60.0}, "largest clock offset between cameras");
  v.Number("max_disagreement", max_disagreement, Unit::kMetre, {0.001, 10.0},
           "largest median distance of joints in two aligned views of the same performance");
}

void SyntheticOptions::Declare(OptionVisitor& v) {
  v.Bool("enabled", enabled, "make a synthetic capture instead of reading a folder");
  v.Integer("seed", seed, {}, "random seed of the capture");
  v.Texts("actions", actions, "actions of the subjects");
  v.Integer("subjects", subjects, {1.0, 99.0}, "number of people, each with an own body");
  v.Integer("repetitions", repetitions, {1.0, 1000.0}, "takes of each action by each subject");
  v.Number("duration", duration_s, Unit::kSecond, {0.2, 600.0}, "mean length of a take");
  v.Number("rate", rate_hz, Unit::kHertz, {1.0, 1000.0}, "frames per second of the tracker");
  tracker.Declare(v);
}

void IngestOptions::Declare(OptionVisitor& v) {
  v.Path("path", path, "folder with the captures");
  v.Path("truth", truth,
         "true motion, as written by `mocurate synthesize`: the folder `truth` or a file in it; errors of the fits "
         "against it are reported");
  v.Text("obtain", obtain, "origin of the captures and agreements to sign; shown by `doctor --source`");
  v.TextMap("expected", expected,
            "path below the folder -> its content, in addition to `files`; shown by `doctor --source`");
  v.Group("source", source, "declaration of the captures");
  v.Group("synthetic", synthetic, "a capture made by the synthetic studio");
}

void MotionsOptions::Declare(OptionVisitor& v) {
  v.Group("ingest", ingest, "place and declaration of the motions");
  v.Texts("classes", classes,
          "classes; a motion without a label gets the class that its file or folder name begins with");
  DeclarePadding(padding, v);
  v.Texts("tolerate", tolerate, "codes of findings for which a run refuses or excludes clips: such clips are read");
}

StageDeclaration IngestDeclaration() { return {"ingest", 45, "mocurate-annotate", ClipLimits()}; }
StageDeclaration MotionsDeclaration() { return {"motions", 9, "mocurate-annotate", WholeSetLimits()}; }
StageDeclaration DuplicatesDeclaration() { return {"duplicates", 8, "mocurate-annotate", WholeSetLimits()}; }
StageDeclaration TruthDeclaration() { return {"truth", 2, "mocurate-annotate", ClipLimits()}; }
StageDeclaration CaptureDeclaration() { return {"capture", 2, "mocurate-annotate", WholeSetLimits()}; }

}  // namespace mocurate
