#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/options.h"

namespace mocurate {

/// The set whose layout the studio writes.
enum class StudioLayout {
  kHumanAct12,
  kPhspd,
  kNtu,
  kKard,
  kUestc,
  kUestcVibe,
  kNtuVibe,
  kTracks,
  kOpenPose,
  kOpenPoseDepth,
  kAmass,
  kDepthSequence,
  kCmu8
};

/// The actions and labels of long sequences: HumanAct12's variants, or short actions as in BABEL.
enum class StudioVocabulary { kHumanAct12, kBabel };

/// Cameras around the subject.
enum class RigKind { kOwn, kPhspd, kHuman36m, kRing };

/// The cameras of openpose and rendered_seq; other layouts have rigs of their own.
struct RigOptions {
  RigKind kind = RigKind::kOwn;
  std::int64_t cameras = 4;     ///< ring: number, evenly spaced
  double radius = 3.2;          ///< ring: metres from the subject
  double height = 1.2;          ///< ring: metres above the floor
  double focal_px = 0.0;        ///< ring; 0: 1150, of depth cameras 365
  std::int64_t width = 0;       ///< ring: pixels; 0: 1280, of depth cameras 512
  std::int64_t height_px = 0;   ///< ring: pixels; 0: 960, of depth cameras 424
  double clock_offset_s = 0.0;  ///< largest clock offset of each camera, either sign
  double moved = 0.0;           ///< metres by which one camera is moved after its calibration

  void Declare(OptionVisitor& v);
};

/// Errors of a depth sensor.
struct DepthSensorOptions {
  bool enabled = true;               ///< write depth images
  bool room = true;                  ///< floor and wall behind the subject, where the layout has a background
  double noise = 0.0015;             ///< metres, standard deviation at 1 m; grows with the square of the distance
  double quantisation = 0.001;       ///< metres, step of the depth values at 1 m
  double quantisation_growth = 0.0;  ///< of the step: exponent of the distance
  double flying_share = 0.35;        ///< pixels at an edge with a depth between both sides
  double hole_share = 0.002;         ///< pixels without a value, besides those seen at a grazing angle
  double grazing = 0.12;             ///< cosine of the angle of incidence below which there is no value
  std::int64_t every = 1;            ///< every n-th frame gets images

  void Declare(OptionVisitor& v);
};

/// Errors of a 2D keypoint detector.
struct KeypointOptions {
  double noise = 3.0;         ///< pixels per axis at full confidence
  double miss_share = 0.03;   ///< visible keypoints that are not found
  double wrong_share = 0.01;  ///< keypoints found at another position
  double wrong_px = 60.0;
  double hidden_share = 0.6;     ///< hidden keypoints that are found, with lower confidence
  double bystander_share = 0.0;  ///< images with a bystander's keypoints

  void Declare(OptionVisitor& v);
};

/// Errors of a joint tracker. They are independent, and each draws from its own generator: enabling one does not change
/// the others.
struct TrackerOptions {
  double noise = 0.030;            ///< metres, root mean square in 3D, white
  double bias = 0.0;               ///< metres, root mean square in 3D, constant for a joint
  double dropout_share = 0.05;     ///< joints not seen
  double dropout_frames = 4.0;     ///< mean length of a gap
  double outlier_share = 0.02;     ///< outliers among the joints
  double outlier_nearest = 0.15;   ///< metres
  double outlier_farthest = 0.50;  ///< metres
  double swap_share = 0.2;         ///< takes in which limbs are exchanged once
  std::int64_t swap_frames = 2;
  double swapped_share = 0.0;  ///< frames in which they are, repeatedly, for swap_frames on average
  double frozen_share = 0.0;   ///< joints that repeat an earlier value
  double frozen_frames = 8.0;
  double wander = 0.0;          ///< metres, root mean square in 3D, of a slowly changing error
  double wander_frames = 10.0;  ///< its correlation time

  void Declare(OptionVisitor& v);
};

/// Errors of the size of Kinect trackers: their joints drift slowly rather than jitter. README.md compares them with
/// KARD.
TrackerOptions KinectTracker();

/// A folder that the studio writes in the layout of a real set, with the truth beside it.
struct StudioOptions {
  StudioLayout layout = StudioLayout::kHumanAct12;
  std::int64_t seed = 1;
  std::int64_t subjects = 2;         ///< 0: as many as in the set
  std::int64_t clips = 1;            ///< of each action by each subject; 0: as many as in the set
  std::vector<std::string> actions;  ///< labels or actions; empty: all of the set's
  StudioVocabulary vocabulary = StudioVocabulary::kHumanAct12;  ///< amass
  std::filesystem::path body;                                   ///< body_cc0.h5; empty: a body of capsules
  double tilt = 0.0;                                            ///< downward tilt of the sensor, radians; kard, tracks
  double missing_share = 0.0225;                                ///< HumanAct12, PHSPD: frames without annotation
  double false_track_share = 0.0;            ///< ntu: files with a false track; uestc_vibe: with a bystander
  TrackerOptions tracker = KinectTracker();  ///< tracks, ntu, kard, uestc, uestc_vibe, ntu_vibe
  RigOptions rig;             ///< openpose, openpose_depth, rendered_seq; clocks and the moved camera also phspd, ntu
  DepthSensorOptions depth;   ///< phspd, ntu, rendered_seq, openpose_depth
  KeypointOptions keypoints;  ///< openpose, openpose_depth

  void Declare(OptionVisitor& v);
};

/// "humanact12", ...
std::vector<std::string> StudioLayoutNames();

std::string StudioLayoutName(StudioLayout layout);

/// Names of the layouts that use an option ("tracker.noise"); empty: all do.
std::vector<std::string> LayoutsUsing(const std::string& option);

}  // namespace mocurate
