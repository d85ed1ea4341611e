#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "ingest/synthetic/tracker_options.h"

namespace mocurate {

/// Whose files the studio writes.
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

/// What is performed in long sequences, and in whose words: HumanAct12's variants, or short actions as BABEL has them.
enum class StudioVocabulary { kHumanAct12, kBabel };

/// Cameras around the subject.
enum class RigKind { kOwn, kPhspd, kHuman36m, kRing };

/// Which cameras see the subject in openpose and rendered_seq; other layouts have rigs of their own.
struct RigOptions {
  RigKind kind = RigKind::kOwn;
  std::int64_t cameras = 4;     ///< ring: so many, evenly spaced
  double radius = 3.2;          ///< ring: metres from the subject
  double height = 1.2;          ///< ring: metres above the floor
  double focal_px = 0.0;        ///< ring; 0: 1150, of depth cameras 365
  std::int64_t width = 0;       ///< ring: pixels; 0: 1280, of depth cameras 512
  std::int64_t height_px = 0;   ///< ring: pixels; 0: 960, of depth cameras 424
  double clock_offset_s = 0.0;  ///< each camera's clock is off by up to so much, either way
  double moved = 0.0;           ///< metres by which one camera was moved after it was calibrated

  void Declare(OptionVisitor& v);
};

/// What a depth sensor makes of true depth.
struct DepthSensorOptions {
  bool enabled = true;               ///< write depth images
  bool room = true;                  ///< floor and wall behind the subject, where the layout has a background
  double noise = 0.0015;             ///< metres, standard deviation at 1 m; grows with the square of the distance
  double quantisation = 0.001;       ///< metres, step of the depth values at 1 m
  double quantisation_growth = 0.0;  ///< of the step: exponent of the distance
  double flying_share = 0.35;        ///< pixels at an edge that lie between both sides
  double hole_share = 0.002;         ///< pixels without a value, besides those seen at a grazing angle
  double grazing = 0.12;             ///< cosine of the angle of incidence below which nothing comes back
  std::int64_t every = 1;            ///< only each so-many-th frame gets images

  void Declare(OptionVisitor& v);
};

/// How a 2D keypoint detector errs.
struct KeypointOptions {
  double noise = 3.0;         ///< pixels per axis at full confidence
  double miss_share = 0.03;   ///< visible keypoints that are not found
  double wrong_share = 0.01;  ///< keypoints found in another place
  double wrong_px = 60.0;
  double hidden_share = 0.6;     ///< hidden keypoints that are found all the same, with less confidence
  double bystander_share = 0.0;  ///< images with somebody else's keypoints besides

  void Declare(OptionVisitor& v);
};

/// A folder that the studio writes in the layout of a real set, with the truth beside it.
struct StudioOptions {
  StudioLayout layout = StudioLayout::kHumanAct12;
  std::int64_t seed = 1;
  std::int64_t subjects = 2;         ///< 0: as many as the set has
  std::int64_t clips = 1;            ///< of each action by each subject; 0: as many as the set has
  std::vector<std::string> actions;  ///< labels or actions; empty: all of the set's
  StudioVocabulary vocabulary = StudioVocabulary::kHumanAct12;  ///< amass
  std::filesystem::path body;                                   ///< body_cc0.h5; empty: a body of capsules
  double tilt = 0.0;                                            ///< radians that the sensor looks down; kard, tracks
  double missing_share = 0.0225;                                ///< HumanAct12, PHSPD: frames without annotation
  double ghost_share = 0.0;  ///< ntu: files with a second body that is nobody; uestc_vibe: with a bystander
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
