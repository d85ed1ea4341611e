#include "ingest/options.h"

namespace mocurate {

namespace {

std::vector<std::string>& FormatNames() {
  static std::vector<std::string> names = {
      "none",     "joint_table", "bvh",      "npy",         "depth_sequence", "ntu_skeleton",      "asf_amc",
      "amass",    "expmap",      "phspd",    "vibe_tracks", "uestc",          "humanact12_pickle", "motions",
      "openpose", "depth_views", "panoptic", "clouds"};
  return names;
}

}  // namespace

const std::vector<std::string>& SourceFormats() { return FormatNames(); }

void AddSourceFormat(const std::string& name) { FormatNames().push_back(name); }

void LabelRule::Declare(OptionVisitor& v) {
  v.Text("pattern", pattern, "regular expression that is looked for in the label's text, letter case aside");
  v.Text("label", label, "of the clips whose text has it");
}

void SourceOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "short name of the source; first part of every clip id");
  v.OneOf("format", format, SourceFormats(), "what the files are");
  v.Text("files", files,
         "pattern of the file names with {fields}; {field:4} is four characters wide, {field?/} a folder that may be "
         "missing; openpose, depth_views, panoptic, clouds: "
         "files that differ in {camera} and {frame} alone are one clip, {-} is passed over");
  v.Text("container", container,
         "humanact12_pickle, uestc, motions: the one file that holds all clips (uestc without it: a file of VIBE's "
         "tracks per "
         "video); `files` is the pattern of their names");
  v.Text("label_table", label_table,
         "table below the folder, a header and 'motion,label' lines, or 'motion', a tab and its text a line, others "
         "passed "
         "over: label of the file whose name without ending is the motion; `labels` and `label_rules` may rename");
  v.Choice("other_files", other_files,
           {{"ignore", OtherFiles::kIgnore}, {"finding", OtherFiles::kFinding}, {"error", OtherFiles::kError}},
           "what becomes of files whose name does not match");
  v.Text("licence", licence, "under which the captures may be used");
  v.Text("units", units, "unit of length of the files: m, cm, mm, inch, or a length such as '0.0564 m'");
  v.Text("axes", axes, "where +x +y +z of the source point in the canonical world (right-handed, y up, facing +z)");
  v.OptionalNumber("rate", rate_hz, Unit::kHertz, {1e-3, 1e5},
                   "frames per second; where the files say another rate, this one is used and that is a finding");
  v.Text("skeleton", skeleton, "skeleton that the joints belong to");
  v.Texts("joints", joints, "joint names in the order of the file; '-' is passed over");
  v.Integer("rows_per_frame", rows_per_frame, {0.0, 1e4},
            "joint_table: rows of one frame; 0 is one per joint, with `layout` one in all");
  v.Texts("columns", columns, "joint_table: numbers of one joint: x, y, z, confidence, skip");
  v.Text("layout", layout,
         "joint_table: all numbers of a frame instead of `columns`, e.g. 'frame 11*(rotation rotation_confidence x y z "
         "confidence) 4*(x y z confidence)'");
  v.Text("end_word", end_word, "joint_table: word on the line that closes the table, where there is one");
  v.Choice("damaged_rows", damaged_rows, {{"refuse", DamagedRows::kRefuse}, {"report", DamagedRows::kReport}},
           "joint_table, ntu_skeleton, asf_amc, phspd, expmap, amass, npy: a row of a wrong length or without numbers "
           "refuses the file, or "
           "what it "
           "holds is missing, in its place; bvh, ntu_skeleton: a count of frames that is not that of the rows, or a "
           "last frame that is cut off, refuses it, or the whole rows decide. Each is a finding, as in `inspect`");
  v.TextMap(
      "bodies", bodies,
      "ntu_skeleton: label as in the file's name -> people in such a file, 1 to 6; where nothing is said there is one");
  v.Group("people", people, "ntu_skeleton, vibe_tracks, uestc: which of those that the tracker followed");
  v.Group("views", views, "ntu_skeleton: files of several cameras that saw one performance");
  v.Number("inferred_confidence", inferred_confidence, Unit::kNone, {0.0, 1.0},
           "ntu_skeleton: confidence of a joint that the sensor inferred; one that it tracked has 1, any other 0");
  v.Text("skeleton_files", skeleton_files,
         "asf_amc: name of the .asf of a motion, from the fields of the motion's name, e.g. '{person}.asf'");
  v.Text("track", track,
         "vibe_tracks: which of a file's tracks is the person; empty: the one that `people.rule` chooses");
  v.Choice("root_translation", root_translation,
           {{"published", RootTranslation::kPublished},
            {"still", RootTranslation::kStill},
            {"camera", RootTranslation::kCamera}},
           "vibe_tracks, uestc: how the root moves: camera (by the weak-perspective camera), still, or published (as "
           "the papers' codes: uestc by the camera, vibe_tracks still)");
  v.Texts("annotations", annotations,
          "amass: BABEL's .json files below the folder; where two speak of one motion, the first");
  v.TextMap("annotation_roles", annotation_roles,
            "amass: file of annotations -> train, validation or test: the role of its motions");
  v.Choice("missing", missing,
           {{"none", MissingValue::kNone}, {"zero", MissingValue::kZero}, {"nan", MissingValue::kNan}},
           "joint_table: what a joint that was not seen looks like");
  v.Number(
      "least_confidence", least_confidence, Unit::kNone, {0.0, 1.0},
      "joint_table: a joint that has a position counts at least so much, where the file says 0 of followed joints");
  v.Numbers("lie_bone_lengths", lie_bone_lengths, Unit::kNone, {0.0, 1e6},
            "npy: bone length of each joint, 0 for the root, in the file's unit: the array holds Action2Motion's Lie "
            "parameters (root translation, then a rotation vector per joint) instead of positions");
  v.Number("max_slide", max_slide, Unit::kMetre, {0.0, 1.0},
           "bvh: most that a joint may slide along its bone; more is refused");
  v.Text("depth_files", depth_files,
         "pattern of the depth images: depth_sequence with {view} and, unless there is but one each, {frame}; "
         "ntu_skeleton whose views are together "
         "with {frame}, counted from 1, and fields of `files`; openpose with {camera} and {frame}, numbered as the "
         "keypoints are, and fields of `files`: the clip has keypoints and depth views");
  v.Number("depth_unit", depth_unit, Unit::kMetre, {1e-6, 1.0}, "length of one step of a depth value");
  v.Text("mask_files", mask_files,
         "depth_views: pattern of the images (PNG, JPEG) that are white where the person is, one per depth image");
  v.Texts(
      "calibration", calibration,
      "openpose, depth_views: calibration file below the folder, from the fields of the clip's names, of all cameras; "
      "OpenCV's intri and extri as two; with {camera} one file per camera");
  v.Choice("camera_pose", camera_pose,
           {{"measured", CameraPose::kMeasured},
            {"world_to_camera", CameraPose::kWorldToCamera},
            {"centre", CameraPose::kCentre},
            {"camera_to_world", CameraPose::kCameraToWorld}},
           "what rotation and translation of a calibration mean whose format does not say it");
  v.TextMap(
      "cameras", cameras,
      "{camera} of the files' names -> its name in the calibration, where they are not alike in letters and digits");
  v.Text("keypoints", keypoints,
         "openpose: order of the detector's points: BODY_25, BODY_25B, COCO_17, COCO_18, or measured by bone lengths");
  v.Integer("subjects", subjects, {1.0, 26.0},
            "openpose, panoptic: people of a recording who are a clip each, the most present first");
  v.Text("person", person, "who performs, from the fields of the name; {body} tells several people of a file apart");
  v.Text("recording", recording, "name of the recording; {file} is the path without its ending");
  v.Text("label", label, "what is performed, from the fields of the name");
  v.Text("fine_label", fine_label, "the same in finer classes, or nothing");
  v.Text("session", session, "recording session, from the fields of the name");
  v.Text("view", view, "camera or view, from the fields of the name");
  v.Text("style", style, "style of the performance, from the fields of the name");
  v.TextMap("labels", labels, "names of the labels");
  v.List("label_rules", label_rules,
         "labels by patterns, for texts that `labels` does not list, such as descriptions; the first that fits");
  v.TextMap("fine_labels", fine_labels, "names of the fine labels; one that is not listed keeps its text");
  v.Choice("other_labels", other_labels,
           {{"error", OtherLabels::kError}, {"exclude", OtherLabels::kLeaveOut}, {"keep", OtherLabels::kKeep}},
           "what becomes of a file whose label is not listed under `labels`; keep: its label is as the text says");
  v.TextMap("roles", roles, "person -> train, validation or test, where the source prescribes it");
  v.TextMap("exclude", exclude,
            "recordings that are excluded, each with the reason; with views.multi_view files, without ending");
  v.Choice("on_contradiction", on_contradiction,
           {{"flag", OnContradiction::kFlag}, {"refuse", OnContradiction::kRefuse}},
           "what becomes of clips whose motion contradicts the declared units, axes or order of joints; where enough "
           "clips of a "
           "source agree, of the whole source");
  v.Texts(
      "known_issue_lists", known_issue_lists,
      "lists of clips that others found something wrong with: names in configs/known_issues, or files of that form");
  v.Choice(
      "known_issues", known_issues,
      {{"drop", KnownIssueAction::kDrop}, {"report", KnownIssueAction::kReport}, {"ignore", KnownIssueAction::kIgnore}},
      "what becomes of the clips that those lists name");
  v.Text("frames_in_name", frames_in_name,
         "first and last frame that the name speaks of, e.g. '{first}-{last}': a clip that is longer is a finding");
  v.Group("checks", checks, "limits of what is found wrong in a clip, and what is done about it");
}

void PeopleOptions::Declare(OptionVisitor& v) {
  v.Choice("rule", rule,
           {{"motion", TrackRule::kMotion},
            {"official", TrackRule::kOfficial},
            {"presence", TrackRule::kPresence},
            {"nearest", TrackRule::kNearest},
            {"uestc_released", TrackRule::kUestcReleased},
            {"uestc_corrected", TrackRule::kUestcCorrected}},
           "who is taken: motion (who moves most of those there for half as long as the longest), official (NTU's: "
           "largest summed variance, neither stitched nor freed of false tracks), presence (longest), nearest (to the "
           "sensor), "
           "uestc_released and uestc_corrected (VIBE's tracks by their boxes, as ACTOR's code does and with its faults "
           "corrected)");
  v.Numbers("start", start_px, Unit::kPixel, {},
            "uestc_released, uestc_corrected: where the performer is in the first frame of the video; ACTOR reads it "
            "from the sensor's skeletons");
  v.Bool("stitch", stitch, "join ids that are one person: lost and found again with the same bones, or interleaved");
  v.Bool("false_tracks", false_tracks, "exclude false tracks: short, frozen, furniture, a second body in one place");
  v.Number("max_gap", max_gap_s, Unit::kSecond, {0.0, 600.0}, "longest time over which ids are joined");
  v.Number("max_speed", max_speed, Unit::kMetrePerSecond, {0.0, 100.0},
           "of a person between two joined tracks, at most");
  v.Number("max_signature", max_signature, Unit::kNone, {0.0, 10.0},
           "mean difference of log bone lengths of what may be one person");
}

void ViewOptions::Declare(OptionVisitor& v) {
  v.Bool("multi_view", multi_view,
         "files that give the same person and recording and differ in `view` are one clip: their joints are brought "
         "into the world of one of them and merged, their depth images are its views");
  v.Texts("cameras", cameras, "`view` of every camera of a capture; one that is not there is a finding");
  v.Numbers("intrinsics", intrinsics, Unit::kPixel, {},
            "fx, fy, cx, cy of the depth images, where a file's joints do not tell them; fx is negative for images "
            "that are mirrored, as Kinects write them");
  v.Numbers("image_size", image_size, Unit::kPixel, {1.0, 20000.0}, "width and height of the depth images");
  v.Number("max_offset", max_offset_s, Unit::kSecond, {0.0, 60.0}, "most that the cameras' clocks may be off");
  v.Number("max_disagreement", max_disagreement, Unit::kMetre, {0.001, 10.0},
           "median distance of the same joints in two views, aligned, beyond which they do not show the same");
}

void SyntheticOptions::Declare(OptionVisitor& v) {
  v.Bool("enabled", enabled, "make a synthetic capture instead of reading a folder");
  v.Integer("seed", seed, {}, "of everything random in the capture");
  v.Texts("actions", actions, "what the subjects perform");
  v.Integer("subjects", subjects, {1.0, 1000.0}, "number of people, each with a body of its own");
  v.Integer("repetitions", repetitions, {1.0, 1000.0}, "takes of each action by each subject");
  v.Number("duration", duration_s, Unit::kSecond, {0.2, 600.0}, "mean length of a take");
  v.Number("rate", rate_hz, Unit::kHertz, {1.0, 1000.0}, "frames per second of the tracker");
  tracker.Declare(v);
}

void IngestOptions::Declare(OptionVisitor& v) {
  v.Path("path", path, "folder with the captures");
  v.Path(
      "truth", truth,
      "what really happened, as `mocurate synthesize` writes it beside a capture: its folder truth, or a file of it; "
      "the error of the fits against it is reported");
  v.Text("obtain", obtain, "where the captures come from and what has to be signed; shown by `doctor --source`");
  v.TextMap("expected", expected,
            "path below the folder -> what lies there, beside the files of the pattern; shown by `doctor --source`");
  v.Group("source", source, "what the captures are");
  v.Group("synthetic", synthetic, "a capture made by the program itself");
}

void MotionsOptions::Declare(OptionVisitor& v) {
  v.Group("ingest", ingest, "where the motions are and what they are");
  v.Texts("classes", classes, "a motion without a label takes the one that its file's or folder's name begins with");
}

StageDeclaration IngestDeclaration() { return {"ingest", 41, "mocurate-annotate", ClipLimits()}; }
StageDeclaration MotionsDeclaration() { return {"motions", 4, "mocurate-annotate", WholeSetLimits()}; }
StageDeclaration DuplicatesDeclaration() { return {"duplicates", 8, "mocurate-annotate", WholeSetLimits()}; }
StageDeclaration TruthDeclaration() { return {"truth", 2, "mocurate-annotate", ClipLimits()}; }
StageDeclaration CaptureDeclaration() { return {"capture", 2, "mocurate-annotate", WholeSetLimits()}; }

}  // namespace mocurate
