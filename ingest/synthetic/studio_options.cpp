#include "ingest/synthetic/studio_options.h"

namespace mocurate {
namespace {

const std::vector<std::pair<std::string, StudioLayout>>& Layouts() {
  static const std::vector<std::pair<std::string, StudioLayout>> layouts = {
      {"humanact12", StudioLayout::kHumanAct12},
      {"phspd", StudioLayout::kPhspd},
      {"ntu", StudioLayout::kNtu},
      {"kard", StudioLayout::kKard},
      {"uestc", StudioLayout::kUestc},
      {"uestc_vibe", StudioLayout::kUestcVibe},
      {"ntu_vibe", StudioLayout::kNtuVibe},
      {"tracks", StudioLayout::kTracks},
      {"openpose", StudioLayout::kOpenPose},
      {"openpose_depth", StudioLayout::kOpenPoseDepth},
      {"amass", StudioLayout::kAmass},
      {"rendered_seq", StudioLayout::kDepthSequence},
      {"cmu8", StudioLayout::kCmu8}};
  return layouts;
}

using LayoutList = std::vector<StudioLayout>;

/// Layouts that use an option, or all of a group; options that are not listed define people and actions.
struct Use {
  std::string option;
  LayoutList layouts;
};

const std::vector<Use>& Uses() {
  using L = StudioLayout;
  static const LayoutList rigs = {L::kOpenPose, L::kOpenPoseDepth, L::kDepthSequence};
  static const LayoutList clocks = {L::kPhspd, L::kNtu, L::kOpenPose, L::kOpenPoseDepth, L::kDepthSequence};
  static const LayoutList thinned = {L::kPhspd, L::kNtu, L::kOpenPoseDepth};
  // An option before its group.
  static const std::vector<Use> uses = {
      {"missing", {L::kHumanAct12, L::kPhspd}},
      {"vocabulary", {L::kAmass}},
      {"tilt", {L::kKard, L::kTracks}},
      {"false_track", {L::kNtu, L::kUestcVibe}},
      {"tracker", {L::kNtu, L::kKard, L::kUestc, L::kUestcVibe, L::kNtuVibe, L::kTracks}},
      {"rig.clock_offset", clocks},
      {"rig.moved", clocks},
      {"rig", rigs},
      {"depth.room", {L::kPhspd}},
      {"depth.enabled", thinned},
      {"depth.every", thinned},
      {"depth", {L::kPhspd, L::kNtu, L::kOpenPoseDepth, L::kDepthSequence}},
      {"keypoints", {L::kOpenPose, L::kOpenPoseDepth}}};
  return uses;
}

}  // namespace

std::vector<std::string> StudioLayoutNames() {
  std::vector<std::string> names;
  for (const auto& [name, layout] : Layouts()) names.push_back(name);
  return names;
}

std::string StudioLayoutName(StudioLayout wanted) {
  for (const auto& [name, layout] : Layouts()) {
    if (layout == wanted) return name;
  }
  return "";
}

void RigOptions::Declare(OptionVisitor& v) {
  v.Choice(
      "kind", kind,
      {{"own", RigKind::kOwn}, {"phspd", RigKind::kPhspd}, {"human36m", RigKind::kHuman36m}, {"ring", RigKind::kRing}},
      "openpose, openpose_depth (colour cameras; its depth cameras are PHSPD's), rendered_seq: PHSPD's three cameras, "
      "Human3.6M's four, or a ring; own: PHSPD's for depth, a ring for keypoints");
  v.Integer("cameras", cameras, {1.0, 64.0}, "ring: number of cameras");
  v.Number("radius", radius, Unit::kMetre, {0.5, 100.0}, "ring: distance of the cameras from the subject");
  v.Number("height", height, Unit::kMetre, {0.0, 20.0}, "ring: height of the cameras above the floor");
  v.Number("focal", focal_px, Unit::kPixel, {0.0, 20000.0}, "ring: focal length; 0: 1150 px (depth cameras: 365 px)");
  v.Integer("width", width, {0.0, 8192.0}, "ring: width of the images in pixels; 0: 1280 (depth cameras: 512)");
  v.Integer("image_height", height_px, {0.0, 8192.0},
            "ring: height of the images in pixels; 0: 960 (depth cameras: 424)");
  v.Number("clock_offset", clock_offset_s, Unit::kSecond, {0.0, 10.0},
           "largest clock offset of every camera but the first");
  v.Number("moved", moved, Unit::kMetre, {0.0, 10.0},
           "distance by which the last camera is moved after its calibration");
}

void DepthSensorOptions::Declare(OptionVisitor& v) {
  v.Bool("enabled", enabled, "write depth images");
  v.Bool("room", room, "a floor and a wall behind the subject where the images are not masked");
  v.Number("noise", noise, Unit::kMetre, {0.0, 1.0},
           "standard deviation of depth at 1 m; it grows with the square of the distance");
  v.Number("quantisation", quantisation, Unit::kMetre, {0.0, 1.0},
           "quantisation step of depth at 1 m; values are whole millimetres");
  v.Number(
      "quantisation_growth", quantisation_growth, Unit::kNone, {0.0, 4.0},
      "exponent of the distance in the quantisation step: 2 for structured light (Kinect v1), 0 for time of flight");
  v.Number("flying", flying_share, Unit::kNone, {0.0, 1.0},
           "flying pixels: share of the pixels at a depth edge whose depth lies between both sides");
  v.Number("hole", hole_share, Unit::kNone, {0.0, 1.0}, "share of pixels without a value");
  v.Number("grazing", grazing, Unit::kNone, {0.0, 1.0},
           "a surface has no depth where the cosine of the angle between its normal and the ray is below this");
  v.Integer("every", every, {1.0, 1e4}, "every n-th frame gets depth images");
}

void KeypointOptions::Declare(OptionVisitor& v) {
  v.Number("noise", noise, Unit::kPixel, {0.0, 500.0}, "standard deviation of a keypoint per axis at full confidence");
  v.Number("miss", miss_share, Unit::kNone, {0.0, 1.0}, "share of visible keypoints that are not found");
  v.Number("wrong", wrong_share, Unit::kNone, {0.0, 1.0}, "share of keypoints at a wrong position");
  v.Number("wrong_distance", wrong_px, Unit::kPixel, {0.0, 5000.0}, "largest distance of a wrong position");
  v.Number("hidden", hidden_share, Unit::kNone, {0.0, 1.0},
           "share of hidden keypoints that are found, with lower confidence");
  v.Number("bystander", bystander_share, Unit::kNone, {0.0, 1.0}, "share of images in which a bystander is found too");
}

void StudioOptions::Declare(OptionVisitor& v) {
  v.Choice("layout", layout, Layouts(), "the set whose files are written");
  v.Integer("seed", seed, {}, "random seed of the folder");
  v.Integer("subjects", subjects, {0.0, 1000.0}, "number of people, each with a body of its own; 0: as in the set");
  v.Integer("clips", clips, {0.0, 1000.0},
            "maximum clips per subject and action (humanact12: per variant, of which there are 34); 0: as in the set");
  v.Texts("actions", actions, "labels or actions to perform; empty: all of the set's");
  v.Choice("vocabulary", vocabulary,
           {{"humanact12", StudioVocabulary::kHumanAct12}, {"babel", StudioVocabulary::kBabel}},
           "amass: the actions: HumanAct12's variants, or short actions with BABEL's labels");
  v.Path("body", body, "skinned body (body_cc0.h5) for rendering depth; empty: capsules");
  v.Number("tilt", tilt, Unit::kRadian, {-0.8, 0.8}, "kard, tracks: downward tilt of the sensor");
  v.Number("missing", missing_share, Unit::kNone, {0.0, 0.9}, "humanact12, phspd: share of frames without annotation");
  v.Number("false_track", false_track_share, Unit::kNone, {0.0, 1.0},
           "ntu: share of files with a false track; uestc_vibe: share of videos with a "
           "bystander, in which the performer is lost and found again under another id");
  v.Group("tracker", tracker, "tracks, ntu, kard, uestc, uestc_vibe, ntu_vibe: errors of the joints");
  v.Group("rig", rig, "cameras");
  v.Group("depth", depth, "phspd, ntu, rendered_seq, openpose_depth: errors of the depth images");
  v.Group("keypoints", keypoints, "openpose, openpose_depth: errors of the keypoints");
}

void TrackerOptions::Declare(OptionVisitor& v) {
  v.Number("noise", noise, Unit::kMetre, {0.0, 1.0}, "root mean square error of a tracked joint");
  v.Number("bias", bias, Unit::kMetre, {0.0, 1.0}, "root mean square of a joint's constant offset");
  v.Number("dropout", dropout_share, Unit::kNone, {0.0, 0.9}, "share of joints that are not seen");
  v.Number("dropout_frames", dropout_frames, Unit::kNone, {1.0, 1e4}, "mean frames until a lost joint is found again");
  v.Number("outlier", outlier_share, Unit::kNone, {0.0, 0.9}, "share of outliers among the joints");
  v.Number("outlier_nearest", outlier_nearest, Unit::kMetre, {0.0, 10.0}, "smallest error of an outlier");
  v.Number("outlier_farthest", outlier_farthest, Unit::kMetre, {0.0, 10.0}, "largest error of an outlier");
  v.Number("swap", swap_share, Unit::kNone, {0.0, 1.0},
           "share of takes in which left and right arms or legs are exchanged once");
  v.Integer("swap_frames", swap_frames, {1.0, 1e4}, "frames for which limbs are exchanged");
  v.Number("swapped", swapped_share, Unit::kNone, {0.0, 0.9},
           "share of frames in which left and right arms, legs or both are exchanged, repeatedly, each time for "
           "swap_frames on average");
  v.Number("frozen", frozen_share, Unit::kNone, {0.0, 0.9}, "share of joints that repeat an earlier value exactly");
  v.Number("frozen_frames", frozen_frames, Unit::kNone, {1.0, 1e4}, "mean frames for which a joint is frozen");
  v.Number("wander", wander, Unit::kMetre, {0.0, 1.0}, "root mean square of a slowly changing error");
  v.Number("wander_frames", wander_frames, Unit::kNone, {1.0, 1e4}, "correlation time of the slow error in frames");
}

TrackerOptions KinectTracker() {
  TrackerOptions options;
  options.noise = 0.004;
  options.wander = 0.025;
  options.wander_frames = 8.0;
  options.dropout_share = 0.02;
  options.outlier_share = 0.002;
  options.swap_share = 0.01;
  return options;
}

std::vector<std::string> LayoutsUsing(const std::string& option) {
  for (const Use& use : Uses()) {
    if (option != use.option && option.rfind(use.option + ".", 0) != 0) continue;
    std::vector<std::string> names;
    for (const StudioLayout layout : use.layouts) names.push_back(StudioLayoutName(layout));
    return names;
  }
  return {};
}

}  // namespace mocurate
