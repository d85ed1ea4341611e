#include "ingest/checks/finding_table.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/base/units.h"

namespace mocurate {
namespace {

constexpr const char* kKinects = "KARD, MSR-Action3D, UTKinect, Florence3D";

CheckLimit Frames(double value, const char* help, const char* source, double least = 2.0) {
  return {"frames", value, Unit::kNone, {least, 1e6}, help, source, true};
}

const char* ActionText(OnFinding action) {
  if (action == OnFinding::kDrop) return "drop";
  return action == OnFinding::kDropRecorded ? "drop_recorded" : "report";
}

}  // namespace

const std::vector<FindingKind>& FindingKinds() {
  static const std::vector<FindingKind> kinds = {
      // Checks of a clip.
      {"zero_frames", "warning; info where it is nearly the whole clip",
       "frames whose joints are all at 0 0 0; value: frames", Checked::kSamples},
      {"zero_joint", "warning", "a joint at 0 0 0 among others that are not; value: frames", Checked::kSamples},
      {"joint_never_seen", "info", "joints that are missing in every frame; value: how many", Checked::kClip},
      {"collapsed_frames", "warning; info where it is nearly the whole clip",
       "frames whose joints lie in one point; value: frames", Checked::kSamples},
      {"frozen_frames",
       "warning; info where it is nearly the whole clip",
       "frames equal to the last digit; value: frames",
       Checked::kSamples,
       {Frames(2.0, "equal frames on end", kKinects)}},
      {"repeated_frames", "warning", "each frame several times; value: how often", Checked::kSamples},
      {"repeated_stretch", "warning", "a section that stands in the clip twice; value: frames", Checked::kSamples},
      {"repeated_value",
       "warning",
       "a joint that stands still to the last digit while others move; value: frames",
       Checked::kSamples,
       {Frames(3.0, "on end in which one joint stands exactly still", kKinects)}},
      {"units_change", "error", "frames of a body 10, 100 or 1000 times as large or small; value: the factor",
       Checked::kSamples},
      {"axes_change", "error", "frames turned to other axes, and staying so; value: 1 turned, -1 mirrored",
       Checked::kSamples},
      {"frozen_view", "warning", "a camera repeats its frames while others see motion; value: frames", Checked::kView},
      {"position_jump",
       "warning",
       "frames in which the person is elsewhere; value: metres",
       Checked::kSamples,
       {{"distance",
         0.3,
         Unit::kMetre,
         {0.0, 1e3},
         "that a body may jump beside its speed",
         "the largest jumps of bodies that stand in KARD, MSR-Action3D, UTKinect, Florence3D"}}},
      {"unrecovered_jump",
       "warning",
       "a step of the whole body that it does not take back; value: metres",
       Checked::kSamples,
       {{"speed", 12.0, Unit::kMetrePerSecond, {0.1, 1e4}, "of a body", "the fastest sprint, 12.4 m/s"}}},
      {"joint_far",
       "warning",
       "a joint far from its body; value: metres",
       Checked::kSamples,
       {{"distance",
         2.5,
         Unit::kMetre,
         {0.5, 1e3},
         "of a joint from the middle of its body",
         "farther than anybody reaches"}}},
      {"swapped_sides",
       "warning",
       "left and right are exchanged; value: ratio of squared steps",
       Checked::kSamples,
       {{"ratio", 0.35, Unit::kNone, {0.0, 1.0}, "squared steps with exchanged sides over those without", kKinects},
        {"step", 0.1, Unit::kMetre, {0.0, 10.0}, "smallest step of limbs that says anything about that", kKinects}}},
      {"rate_suspect", "warning; error where the source declares the rate, and of a whole source or folder",
       "bodies fall or tip otherwise than at that rate; value: the nearest rate, Hz, or the share of clips",
       Checked::kClip},
      {"not_joint_positions",
       "error",
       "numbers of the right shape that are no body; value: factor or spread",
       Checked::kClip,
       {{"proportion",
         0.33,
         Unit::kNone,
         {0.0, 10.0},
         "mean distance of log bone lengths from the skeleton's",
         "recorded bodies are within 1.3, other numbers beyond 1.5"},
        {"spread",
         0.35,
         Unit::kNone,
         {0.0, 10.0},
         "relative spread of bone lengths over time",
         "recorded bodies vary less"}},
       OnFinding::kDrop},
      {"flat_body", "error", "all joints of all frames lie in a plane; value: thickness over width", Checked::kClip},
      {"single_frame", "info", "a clip of one frame: a pose", Checked::kClip},
      {"motionless_clip",
       "error",
       "no person, or no motion, in nearly all frames; value: their share",
       Checked::kClip,
       {{"share",
         0.95,
         Unit::kNone,
         {0.0, 1.0},
         "of frames that are zero, collapsed or frozen",
         "empty recordings of MSR-Action3D"}},
       OnFinding::kDropRecorded},
      {"name_contradiction", "warning", "the name declares fewer frames than the file holds (`frames_in_name`)",
       Checked::kClip},
      {"duplicate",
       "warning",
       "the content of another clip, frame for frame",
       Checked::kClips,
       {{"distance",
         0.005,
         Unit::kMetre,
         {0.0, 1.0},
         "root mean square of two motions that are one; of near and mirrored duplicates too",
         "copies differ by rounding alone"}}},
      {"near_duplicate", "warning", "another clip's motion; value: metres", Checked::kClips},
      {"mirrored_duplicate", "warning", "another clip's mirror image; value: metres", Checked::kClips},
      {"shared_frames",
       "warning",
       "frames of another clip; value: how many",
       Checked::kClips,
       {Frames(4.0, "equal poses of two recordings", "two recordings share fewer by chance", 1.0)}},
      // What a file is.
      {"not_found", "error", "there is no such file or folder"},
      {"unreadable", "error", "the file cannot be read"},
      {"empty_file", "error", "no byte, or blanks alone"},
      {"malformed", "error", "the bytes do not follow their format"},
      {"inconsistent", "error", "parts of the input contradict each other"},
      {"unsupported", "error", "valid, but outside what is read"},
      {"unknown_format", "error; info in a folder", "the content is of no known format"},
      {"no_motion", "error", "the file holds no motion that is read"},
      {"too_large", "error", "a file of more than 1 GiB"},
      {"unsafe_pickle", "error; warning beside members that are read",
       "a pickle that names more than plain data: it is not read, and nothing of it is executed"},
      {"no_clips", "error", "nothing in the folder is known"},
      {"no_regular_file", "warning; error where it is asked for", "a pipe, a device or a link that leads nowhere"},
      {"other_files", "info", "files of no known format, with the most common reason; value: how many"},
      {"count_contradiction", "error", "a header announces `value` items, the file holds another count"},
      {"cut_off", "error", "the file ends within a frame: the whole frames before it are kept"},
      {"ids_stitched", "info", "a person whose number changed on the way, put together; value: frames lost"},
      {"other_person", "warning", "tracks beside the actor, which are passed over; value: metres"},
      {"segment_times", "warning; error where they are impossible", "times of a label lie outside its clip"},
      {"row_length", "warning", "a row with another count of numbers: its frame is missing"},
      {"not_a_number", "warning; info of a header", "words, or numbers that are not finite, among numbers"},
      {"number_too_large", "warning", "numbers that are no coordinate of a person"},
      {"decimal_comma", "info", "numbers with a decimal comma, which is read as a point"},
      {"frame_number", "warning", "a frame's number does not follow the one before"},
      {"time_gap", "warning", "numbers or times of frames leave some out: they are missing, in their place"},
      {"bone_missing", "warning", "a frame of an AMC lacks a bone that most frames have"},
      {"bone_unknown", "warning", "a bone of an AMC that its skeleton does not have"},
      {"bone_twice", "warning", "a bone stands in a frame twice"},
      {"bone_id_twice", "info", "two bones of an ASF with one id"},
      {"joint_twice", "warning", "two joints of a BVH with one name; value: the second of them, from 0"},
      {"root_axis_missing", "warning; error where its orientation is not 0", "an ASF whose root declares no axis"},
      {"frames_filled", "info", "frames without a row in a track of VIBE, which are interpolated; value: frames"},
      {"markers_missing", "info", "samples of markers that are missing"},
      {"not_a_rotation", "warning", "recorded rotations that are none: taken for missing"},
      {"bone_slides", "warning", "a bone of a BVH changes its length; value: metres"},
      // What numbers say of themselves.
      {"no_joint_seen", "warning; error for all frames", "frames in which no joint is seen; value: frames"},
      {"many_missing", "warning", "more than a fifth of the samples are missing; value: their share"},
      {"inferred_joints", "info; warning above 0.3", "joints that the sensor inferred; value: their share"},
      {"layout_unknown", "warning", "a table in no known order of joints; value: roughness"},
      {"layout_ambiguous", "warning", "a table that can be read in several orders"},
      {"confidence_guessed", "info", "a number behind x, y, z taken as a confidence; value: share of joints at 0"},
      {"rate_implausible", "error", "a rate of 1 Hz or less, or of more than 2000 Hz"},
      {"angle_unit_contradiction", "error", "angles of another unit than the file declares; value: the largest"},
      {"length_unit_contradiction", "error", "an ASF whose rest pose is no person's; value: metres"},
      {"bone_length", "error", "a bone 1.5 times shorter than its partner, or of length 0; value: the ratio"},
      {"bone_direction", "error", "a bone that is no mirror image of its partner but for a sign; value: degrees"},
      {"pose_contradiction", "warning", "rotations and joints of one clip are not of one motion; value: degrees"},
      {"frozen_pose", "warning; error from half of the clip on", "rotations that are held while the body goes on"},
      {"path_missing", "warning", "the root is at 0 0 0 in every frame while the body turns; value: frames"},
      {"units_outlier", "error", "a clip a power of ten (value) of the others of its folder"},
      {"axes_outlier", "warning", "a person who is among the others of the folder with two axes exchanged alone"},
      {"handedness_outlier", "warning", "a clip of another handedness than its folder; value: how sure"},
      {"joints_displaced", "info", "joints recorded lie off those of the rotations; value: metres, median"},
      {"bones_not_the_subjects", "info", "bone lengths are the skeleton's: the body's shape is not in the file"},
      // Declarations against data.
      {"units_contradiction", "error", "the body, or its path, is of another unit; value: metres, or the factor"},
      {"up_contradiction", "error", "up is declared otherwise than the body stands; value: how sure"},
      {"handedness_contradiction", "error", "left and right are of a mirrored frame; value: how sure"},
      {"rate_contradiction", "error", "the file declares another rate, Hz"},
      {"layout_contradiction", "error", "an array or a table of another layout than declared"},
      {"joints_contradiction", "error", "the tree is not that of the declared skeleton"},
      {"joint_order_contradiction", "error", "joints in another order than declared; value: misfit of the bones"},
      {"format_contradiction", "error", "files are of another format than declared"},
      {"units_unknown", "error", "the declared unit is none"},
      {"unknown_skeleton", "error", "the declared skeleton does not exist"},
      {"config", "error", "the declaration cannot be used"},
      {"name_mismatch", "warning", "the name is not as the source's pattern has it"},
      {"name_ambiguous", "warning", "names that the pattern may cut in several ways; value: how many"},
      {"name_unmatched", "warning", "the declaration names a recording or label that there is not"},
      {"label_unknown", "error", "the label of the name is not listed"},
      {"label_excluded", "info", "the label is not listed, and such files are excluded by rule"},
      {"other_joints", "info", "an array of another number of joints than the source's"},
      {"excluded", "info", "the declaration leaves the recording out"},
      {"known_issue", "warning; info where it is excluded", "a list of known issues names the recording"},
      {"folder_not_read", "warning", "files where the pattern does not look; value: how many"},
      {"unreadable_file", "error", "a file that is declared cannot be read"},
      // People.
      {"bodies_skipped", "warning", "people of a file beyond those declared"},
      {"people_missing", "warning; error of a file of one person", "fewer people than are declared"},
      {"second_person", "warning", "another person is there nearly as long"},
      {"false_track", "warning", "a false track: short, still, furniture, or a second one of the same person"},
      // Cameras, keypoints, depth.
      {"frames_missing", "warning", "numbers of frames without a file"},
      {"unreadable_frames", "warning", "files of frames that cannot be read; the first is named"},
      {"empty_person", "info", "entries of people without keypoints"},
      {"keypoint_far", "warning", "a keypoint 20 times as far from the image's corner as nine in ten; value: px"},
      {"keypoint_count", "warning", "people with another number of keypoints: taken as not seen"},
      {"keypoints_not_finite", "warning", "keypoints that are no numbers: taken as not seen; value: how many"},
      {"keypoints_not_pixels", "error", "keypoints that are shares of the image; value: the largest"},
      {"confidence_range", "error; warning of single points", "confidences beyond 1.5; value: the largest"},
      {"uncertain_points", "warning", "keypoints with a place and confidence 0: taken as not seen; value: how many"},
      {"keypoints_contradiction", "error", "bones are of another order of keypoints; value: how sure"},
      {"calibration_contradiction", "warning, error", "a calibration that its numbers deny"},
      {"calibration_missing", "error", "the calibration that is declared is not there"},
      {"camera_not_calibrated", "warning", "files of a camera that no calibration names: excluded"},
      {"camera_without_files", "warning", "a calibrated camera without files: excluded"},
      {"camera_missing", "warning", "a camera of the capture has no file"},
      {"no_person_in_view", "warning", "a camera without a visible person"},
      {"view_excluded", "warning", "a camera whose joints fit no other"},
      {"views_disagree", "warning", "cameras that disagree; value: mm, median"},
      {"clock_offset", "info; warning when large", "a camera's clock is off, which is taken out; value: ms"},
      {"clock_offset_unknown", "info", "a camera's clock offset cannot be estimated from the motion"},
      {"depth_excluded", "warning", "a camera lacks depth images of some frames: excluded"},
      {"depth_images_missing", "info, warning", "frames without a depth image"},
      {"intrinsics_nominal", "info",
       "intrinsics of the depth camera cannot be estimated from the joints: taken as declared"},
      {"intrinsics_contradiction", "warning", "joints stand at pixels of another camera than declared"},
      {"point_far", "warning, error", "a point of a cloud far from its middle; value: file units"},
      // Skeletons and annotations.
      {"skeleton_missing", "warning", "a motion without its skeleton file: lengths stay unknown"},
      {"skeleton_file_missing", "error", "the skeleton file of a motion is not in the folder"},
      {"babel_times", "warning", "a segment of BABEL whose times cannot be"},
      {"annotation_duration", "warning", "a sequence of BABEL lasts otherwise than its motion; value: seconds"},
      {"motion_missing", "warning, info", "a sequence of BABEL whose motion is not there"},
      {"not_annotated", "info", "the motion has no annotation"},
      {"category_unknown", "info", "labels of a category beside BABEL's 150 frequent ones"},
      {"label_withheld", "info", "labels of BABEL without a name"},
      {"clip_refused", "error", "a clip of a set that cannot be taken"},
  };
  return kinds;
}

const FindingKind* FindFindingKind(const std::string& code) {
  const auto& kinds = FindingKinds();
  const auto own = std::find_if(kinds.begin(), kinds.end(), [&](const FindingKind& kind) { return code == kind.code; });
  return own == kinds.end() ? nullptr : &*own;
}

std::string FindingTables() {
  std::string checks =
      "| code | severity | meaning | limits, measured on | by default "
      "|\n|---|---|---|---|---|\n";
  std::string others = "| code | severity | meaning |\n|---|---|---|\n";
  for (const FindingKind& kind : FindingKinds()) {
    const std::string row = "| `" + std::string(kind.code) + "` | " + kind.severity + " | " + kind.help + " |";
    if (kind.check == Checked::kNothing) {
      others += row + "\n";
      continue;
    }
    std::string limits;
    for (const CheckLimit& limit : kind.limits) {
      const std::string unit(Name(limit.unit));
      limits += (limits.empty() ? "`" : "; `") + std::string(limit.name) + ": " + FormatDouble(limit.value) +
                (unit.empty() ? "" : " " + unit) + "` " + limit.help + ", " + limit.source;
    }
    checks += row + " " + limits + " | " + ActionText(kind.by_default) + " |\n";
  }
  return "What is wrong with a clip. In a source, `checks: {repeated_value: {frames: 5, action: missing}}` sets limits "
         "and "
         "what is"
         "\ndone: `ignore` it, `report` it, take the samples of tracks as `missing` (of findings of frames or joints), "
         "or `drop`"
         "\nthe clip; `drop_recorded` drops clips of tracks and reports given motion, which may stand still. A fit "
         "repairs tracks"
         "\nby rules of its own (`fitting.repair`), whatever is said here.\n\n" +
         checks + "\nAll else:\n\n" + others;
}

}  // namespace mocurate
