#include "ingest/checks/finding_table.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mocurate {
namespace {

constexpr const char* kKinects = "KARD, MSR-Action3D, UTKinect, Florence3D";

CheckLimit Frames(double value, const char* help, const char* source, double least = 2.0) {
  return {"frames", value, Unit::kNone, {least, 1e6}, help, source, true};
}

std::string LimitKey(const FindingKind& kind, const CheckLimit& limit) {
  return std::string(kind.code) + '.' + limit.name;
}

/// What may be done about a finding, by name.
std::vector<std::pair<std::string, OnFinding>> ActionsOf(Checked check) {
  std::vector<std::pair<std::string, OnFinding>> actions = {{"ignore", OnFinding::kIgnore},
                                                            {"report", OnFinding::kReport}};
  if (check == Checked::kSamples) actions.emplace_back("missing", OnFinding::kMissing);
  actions.emplace_back("drop", OnFinding::kDrop);
  if (check == Checked::kSamples || check == Checked::kClip)
    actions.emplace_back("drop_recorded", OnFinding::kDropRecorded);
  return actions;
}

/// Keeps what differs from the table.
template <class T>
void Keep(std::map<std::string, T>& said, const std::string& key, T value, T by_default) {
  if (value == by_default)
    said.erase(key);
  else
    said[key] = value;
}

}  // namespace

const std::vector<FindingKind>& FindingKinds() {
  static const std::vector<FindingKind> kinds = {
      // Checks of a clip.
      {"zero_frames",
       "warning; info where it is nearly the whole clip",
       "frames whose joints are all at 0 0 0, missing in tracks; value: frames",
       Checked::kSamples,
       {},
       OnFinding::kMissing},
      {"zero_joint", "warning", "a joint at 0 0 0 while others are elsewhere; value: frames", Checked::kSamples},
      {"joint_never_seen", "info", "joints that are missing in every frame; value: their number", Checked::kClip},
      {"collapsed_frames", "warning; info where it is nearly the whole clip",
       "frames whose joints coincide in one point; value: frames", Checked::kSamples},
      {"frozen_frames",
       "warning; info where it is nearly the whole clip",
       "consecutive frames with equal coordinates, to the last digit; value: frames",
       Checked::kSamples,
       {Frames(2.0, "consecutive equal frames", kKinects)}},
      {"repeated_frames", "warning", "each frame is repeated; value: repetitions", Checked::kSamples},
      {"repeated_value",
       "warning",
       "a joint whose position repeats to the last digit while others move; value: frames",
       Checked::kSamples,
       {Frames(3.0, "consecutive frames with equal positions of one joint", kKinects)}},
      {"position_jump",
       "warning",
       "frames in which the whole body is displaced; value: metres",
       Checked::kSamples,
       {{"distance",
         0.3,
         Unit::kMetre,
         {0.0, 1e3},
         "largest step of a body beyond its speed",
         "the largest steps of standing bodies in KARD, MSR-Action3D, UTKinect, Florence3D"}}},
      {"unrecovered_jump",
       "warning",
       "a step of the whole body without return; value: metres",
       Checked::kSamples,
       {{"speed", 12.0, Unit::kMetrePerSecond, {0.1, 1e4}, "largest speed of a body", "the fastest sprint, 12.4 m/s"}}},
      {"joint_far",
       "warning",
       "a joint far from its body; value: metres",
       Checked::kSamples,
       {{"distance",
         2.5,
         Unit::kMetre,
         {0.5, 1e3},
         "largest distance of a joint from the middle of its body",
         "beyond human reach"}}},
      {"swapped_sides",
       "warning",
       "left and right are exchanged; value: ratio of squared steps",
       Checked::kSamples,
       {{"ratio",
         0.35,
         Unit::kNone,
         {0.0, 1.0},
         "squared steps with exchanged sides, divided by those without",
         kKinects},
        {"step", 0.1, Unit::kMetre, {0.0, 10.0}, "smallest step of a limb that counts as evidence", kKinects}}},
      {"rate_suspect", "warning; error where the source declares the rate, or for a whole source or folder",
       "steps, falls and limbs contradict the rate; value: the nearest rate, Hz, or the share of clips",
       Checked::kClip},
      {"not_joint_positions",
       "error",
       "an array of the right shape whose values form no body; value: factor or variation",
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
         "relative variation of bone lengths over time",
         "recorded bodies vary less"}},
       OnFinding::kDrop},
      {"single_frame", "info", "a clip with one frame", Checked::kClip},
      {"motionless_clip",
       "error",
       "no person, or no motion, in nearly all frames; value: their share",
       Checked::kClip,
       {{"share",
         0.95,
         Unit::kNone,
         {0.0, 1.0},
         "frames that are zero, collapsed or frozen",
         "empty recordings of MSR-Action3D"}},
       OnFinding::kDropRecorded},
      {"name_contradiction", "warning", "the name declares fewer frames than the file holds (`frames_in_name`)",
       Checked::kClip},
      {"duplicate",
       "warning",
       "equal to another clip, frame by frame",
       Checked::kClips,
       {{"distance",
         0.005,
         Unit::kMetre,
         {0.0, 1.0},
         "largest RMS difference of duplicates, near duplicates and mirrored duplicates",
         "copies differ by rounding alone"}}},
      {"near_duplicate", "warning", "nearly equal to another clip; value: metres", Checked::kClips},
      {"mirrored_duplicate", "warning", "the mirror image of another clip; value: metres", Checked::kClips},
      {"shared_frames",
       "warning",
       "frames shared with another clip; value: their number",
       Checked::kClips,
       {Frames(4.0, "equal poses of two recordings", "two recordings share fewer by chance", 1.0)}},
      // Files.
      {"not_found", "error", "there is no such file or folder"},
      {"unreadable", "error", "the file cannot be read"},
      {"empty_file", "error", "the file has no bytes, or only blanks"},
      {"malformed", "error", "the bytes do not follow their format"},
      {"inconsistent", "error", "parts of the input contradict each other"},
      {"unsupported", "error", "valid, but not supported"},
      {"unknown_format", "error; info in a folder", "the content is of no known format"},
      {"no_motion", "error", "the file holds no supported motion"},
      {"too_large", "error", "a file of more than 1 GiB"},
      {"unsafe_pickle", "error; warning beside members that are read",
       "a pickle that names more than plain data: it is not read, and nothing of it is executed"},
      {"no_clips", "error", "the folder has no file of a known format"},
      {"no_regular_file", "warning; error where it is asked for", "a pipe, a device or a broken link"},
      {"other_files", "info", "files of no known format, with the most common reason; value: their number"},
      {"count_contradiction", "error; warning where the data tell the count",
       "a header announces `value` items, the file holds another count"},
      {"cut_off", "error", "the file ends within a frame: the whole frames before it are kept"},
      {"ids_stitched", "info", "tracks of one person with several ids, joined; value: lost frames"},
      {"other_person", "warning", "tracks of other people than the actor, skipped; value: px to the actor"},
      {"segment_times", "warning; error where they are impossible", "times of a label lie outside its clip"},
      {"row_length", "warning", "a row with another count of numbers: its frame is set to missing"},
      {"not_a_number", "warning; info of a header", "words or non-finite numbers among numbers"},
      {"number_too_large", "warning", "numbers outside the range of coordinates"},
      {"unnamed_points", "info", "points of a marker file without a name are left out; value: their number"},
      {"label_repeated", "warning", "points of a marker file with one label: the later ones get a number"},
      {"decimal_comma", "info", "numbers with a decimal comma between semicolons or tabs, which is read as a point"},
      {"frame_number", "warning", "a frame's number or time does not follow the one before"},
      {"time_gap", "warning", "frame numbers or times have gaps: those frames are set to missing"},
      {"bone_missing", "warning", "a frame of an AMC lacks a bone that most frames have"},
      {"bone_unknown", "warning", "a bone of an AMC that its skeleton lacks"},
      {"bone_twice", "warning", "a bone occurs twice in a frame"},
      {"bone_id_twice", "info", "two bones of an ASF with one id"},
      {"joint_twice", "warning", "two joints of a BVH with one name; value: the second of them, from 0"},
      {"root_axis_missing", "warning; error where its orientation is not 0", "an ASF whose root declares no axis"},
      {"frames_filled", "info", "frames missing in a track of VIBE, interpolated; value: frames"},
      {"not_a_rotation", "warning", "invalid recorded rotations: set to missing"},
      {"bone_slides", "warning", "a bone of a BVH changes its length; value: metres"},
      {"scene_root", "info",
       "joints of a BVH above the one that carries the translation: no joints of the motion; value: metres from it"},
      {"root_moved", "warning",
       "the declared skeleton puts the root of a BVH elsewhere than the file does; value: metres, at most"},
      // Content.
      {"no_joint_seen", "warning; error for all frames", "frames without a valid joint; value: frames"},
      {"unobserved_ends", "info", "frames before the first and after the last observation, cut; value: frames"},
      {"long_gap", "warning", "a gap longer than `max_gap`: its frames are inferred; value: seconds"},
      {"mostly_missing", "error", "a clip with more than `max_missing` of its frames missing; value: the share"},
      {"many_missing", "warning", "more than a fifth of the samples are missing; value: their share"},
      {"inferred_joints", "info; warning above 0.3", "joints that the sensor inferred; value: their share"},
      {"layout_unknown", "warning", "a table whose joint order is unknown; value: roughness"},
      {"layout_ambiguous", "warning", "a table whose joint order, or the column that counts its frames, is ambiguous"},
      {"confidence_guessed", "info", "the number after x, y, z may be a confidence; value: share of joints at 0"},
      {"rate_implausible", "error", "a rate of 1 Hz or less, or of more than 2000 Hz"},
      {"angle_unit_contradiction", "error", "angles of another unit than the file declares; value: the largest"},
      {"length_unit_contradiction", "error", "an ASF whose rest pose does not fit a person; value: metres"},
      {"bone_length", "error", "a bone of an ASF of length 0, while its partner or all others have one; value: 0"},
      {"frozen_pose", "warning; error from half of the clip on", "rotations that repeat while the body moves"},
      {"path_missing", "warning", "the root is at 0 0 0 in every frame while the body rotates; value: frames"},
      {"joints_displaced", "info", "recorded joints are displaced from those of the rotations; value: median, metres"},
      {"bones_not_the_subjects", "info", "bone lengths are the skeleton's: the file does not declare the body's shape"},
      // Declarations against data.
      {"units_contradiction", "error",
       "the size of the body or of its path contradicts the declared unit; value: metres, or the factor"},
      {"up_contradiction", "error", "the declared up contradicts the body; value: confidence"},
      {"handedness_contradiction", "error",
       "left and right of the body contradict the declared handedness; value: confidence"},
      {"rate_contradiction", "error", "the file declares another rate, or has times of another one, Hz"},
      {"layout_contradiction", "error",
       "an array or a table has another layout than declared: a clock is no frame number"},
      {"joints_contradiction", "error", "the joint tree differs from the declared skeleton"},
      {"joint_order_contradiction", "error", "joints in another order than declared; value: misfit of the bones"},
      {"format_contradiction", "error", "the files have another format than declared"},
      {"units_unknown", "error", "the declared unit is invalid"},
      {"unknown_skeleton", "error", "the declared skeleton does not exist"},
      {"config", "error", "the declaration is invalid"},
      {"name_mismatch", "warning; info of one file that is read under another name",
       "the name does not match the source's pattern"},
      {"name_ambiguous", "error", "a file name that fits the pattern in two ways, which make different clips"},
      {"name_unmatched", "warning", "the declaration names a recording or label that does not exist"},
      {"label_unknown", "error", "the label of the name is not listed"},
      {"label_excluded", "info", "the label is not listed, and such files are excluded by rule"},
      {"other_joints", "info", "an array with another number of joints than declared"},
      {"excluded", "info", "the declaration excludes the recording"},
      {"known_issue", "warning; info where it is excluded", "a list of known issues names the recording"},
      {"folder_not_read", "warning", "files in folders that the pattern does not read; value: their number"},
      {"unreadable_file", "error", "a declared file cannot be read"},
      // People.
      {"bodies_skipped", "warning", "people of a file beyond those declared"},
      {"people_missing", "warning; error of a file of one person", "fewer people than declared"},
      {"second_person", "warning", "another person is present nearly as long"},
      {"false_track", "warning", "a false track: short, still, furniture, or a second one of the same person"},
      // Cameras, keypoints, depth.
      {"frames_missing", "warning", "frame numbers without a file"},
      {"unreadable_frames", "warning", "unreadable frame files; the first is named"},
      {"empty_person", "info", "people without keypoints"},
      {"keypoint_far", "warning",
       "a keypoint 20 times farther from the image corner than 90 % of the keypoints; value: px"},
      {"keypoint_count", "warning", "people with another number of keypoints: set to missing"},
      {"keypoints_not_finite", "warning", "non-finite keypoints: set to missing; value: their number"},
      {"keypoints_not_pixels", "error", "keypoints relative to the image size; value: the largest"},
      {"confidence_range", "error; warning of single points", "confidences beyond 1.5; value: the largest"},
      {"uncertain_points", "warning",
       "keypoints with coordinates and confidence 0: set to missing; value: their number"},
      {"keypoints_contradiction", "error", "bones fit another keypoint order; value: confidence"},
      {"calibration_contradiction", "warning, error", "the numbers contradict the calibration's convention"},
      {"calibration_missing", "error", "the declared calibration does not exist"},
      {"camera_not_calibrated", "warning", "files of an uncalibrated camera: excluded"},
      {"camera_without_files", "warning", "a calibrated camera without files: excluded"},
      {"camera_missing", "warning", "a camera of the capture has no file"},
      {"view_numbering", "error; warning without a declaration",
       "a camera whose frames are numbered, or recorded, apart from those of the others; value: frames"},
      {"no_person_in_view", "warning", "a camera without a visible person"},
      {"view_excluded", "warning", "a camera whose joints contradict all others: excluded"},
      {"clock_offset", "info; warning when large", "a camera's clock offset, corrected; value: ms"},
      {"depth_excluded", "warning", "a camera lacks depth images of some frames: excluded"},
      {"depth_images_missing", "info, warning", "frames without a depth image"},
      {"intrinsics_contradiction", "warning", "pixels of joints contradict the declared intrinsics"},
      {"points_without_depth", "warning",
       "points of a cloud at 0 0 0, where no depth was measured: dropped; value: their largest share"},
      {"point_far", "warning, error", "a point of a cloud far from its middle; value: file units"},
      // Skeletons and annotations.
      {"skeleton_missing", "warning", "a motion without its skeleton file: lengths stay unknown"},
      {"skeleton_file_missing", "error", "the skeleton file of a motion is not in the folder"},
      {"babel_times", "warning", "a segment of BABEL with impossible times"},
      {"annotation_duration", "warning", "a sequence of BABEL differs in duration from its motion; value: seconds"},
      {"motion_missing", "warning, info", "a sequence of BABEL whose motion does not exist"},
      {"not_annotated", "info", "the motion has no annotation"},
      {"category_unknown", "info", "labels outside BABEL's 150 frequent categories"},
      {"label_withheld", "info", "labels of BABEL without a name"},
      {"clip_refused", "error", "a clip of a set that cannot be used"},
      {"padding_cut", "info",
       "zeros or repeats of the last pose at the end of a motion, cut to be scored; value: frames"},
  };
  return kinds;
}

const FindingKind* FindFindingKind(const std::string& code) {
  const auto& kinds = FindingKinds();
  const auto own = std::find_if(kinds.begin(), kinds.end(), [&](const FindingKind& kind) { return code == kind.code; });
  return own == kinds.end() ? nullptr : &*own;
}

const std::vector<std::string>& CheckCodes() {
  static const std::vector<std::string> codes = [] {
    std::vector<std::string> checks;
    for (const FindingKind& kind : FindingKinds()) {
      if (kind.check != Checked::kNothing) checks.emplace_back(kind.code);
    }
    return checks;
  }();
  return codes;
}

void CheckOptions::Declare(OptionVisitor& v) {
  for (const FindingKind& kind : FindingKinds()) {
    if (kind.check == Checked::kNothing) continue;
    v.BeginGroup(kind.code, kind.help);
    for (const CheckLimit& limit : kind.limits) {
      double value = Limit(kind.code, limit.name);
      if (limit.whole) {
        std::int64_t whole = std::llround(value);
        v.Integer(limit.name, whole, limit.range, limit.help);
        value = static_cast<double>(whole);
      } else {
        v.Number(limit.name, value, limit.unit, limit.range, limit.help);
      }
      Keep(limits, LimitKey(kind, limit), value, limit.value);
    }
    OnFinding action = ActionFor(kind.code);
    v.Choice("action", action, ActionsOf(kind.check),
             "ignore it, report it, set the samples of tracks to missing, drop the clip, or drop clips of tracks only");
    Keep(actions, std::string(kind.code), action, kind.by_default);
    v.EndGroup();
  }
}

OnFinding CheckOptions::ActionFor(const std::string& code) const {
  if (const auto said = actions.find(code); said != actions.end()) return said->second;
  const FindingKind* kind = FindFindingKind(code);
  return kind == nullptr ? OnFinding::kReport : kind->by_default;
}

bool CheckOptions::IgnoresAll() const {
  const auto& codes = CheckCodes();
  return std::all_of(codes.begin(), codes.end(),
                     [&](const std::string& code) { return ActionFor(code) == OnFinding::kIgnore; });
}

void CheckOptions::IgnoreAll() {
  for (const std::string& code : CheckCodes()) actions[code] = OnFinding::kIgnore;
}

double CheckOptions::Limit(const std::string& code, const std::string& name) const {
  const FindingKind* kind = FindFindingKind(code);
  for (std::size_t i = 0; kind != nullptr && i < kind->limits.size(); ++i) {
    const CheckLimit& limit = kind->limits[i];
    if (limit.name != name) continue;
    const auto said = limits.find(LimitKey(*kind, limit));
    return said == limits.end() ? limit.value : said->second;
  }
  throw std::logic_error("the check '" + code + "' has no limit '" + name + "'");
}

double CheckOptions::Threshold(const std::string& code) const {
  const FindingKind* kind = FindFindingKind(code);
  return kind == nullptr || kind->limits.empty() ? 0.0 : Limit(code, kind->limits[0].name);
}

}  // namespace mocurate
