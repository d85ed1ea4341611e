#include "ingest/format_facts.h"

namespace mocurate {
namespace {

constexpr FormatFacts kFormats[] = {{SourceFormat::kNone, "none", Gives::kNothing, false},
                                    {SourceFormat::kJointTable, "joint_table", Gives::kJointTracks, false},
                                    {SourceFormat::kBvh, "bvh", Gives::kMotion, true},
                                    {SourceFormat::kNpy, "npy", Gives::kMotion, false},
                                    {SourceFormat::kDepthSequence, "depth_sequence", Gives::kDepthViews, false},
                                    {SourceFormat::kNtuSkeleton, "ntu_skeleton", Gives::kJointTracks, false},
                                    {SourceFormat::kAsfAmc, "asf_amc", Gives::kMotion, true},
                                    {SourceFormat::kAmass, "amass", Gives::kMotion, true},
                                    {SourceFormat::kExpmap, "expmap", Gives::kMotion, true},
                                    {SourceFormat::kPhspd, "phspd", Gives::kJointTracks, false},
                                    {SourceFormat::kVibeTracks, "vibe_tracks", Gives::kMotion, true},
                                    {SourceFormat::kUestc, "uestc", Gives::kMotion, true},
                                    {SourceFormat::kHumanAct12Pickle, "humanact12_pickle", Gives::kMotion, true},
                                    {SourceFormat::kMotions, "motions", Gives::kMotion, false},
                                    {SourceFormat::kOpenPose, "openpose", Gives::kKeypoints, false},
                                    {SourceFormat::kDepthViews, "depth_views", Gives::kDepthViews, false},
                                    {SourceFormat::kPanoptic, "panoptic", Gives::kJointTracks, false}};

struct InspectedFormat {
  SourceFormat format;
  std::string_view inspected;  ///< as `mocurate inspect` calls the content of a file
};

constexpr InspectedFormat kInspectedFormats[] = {{SourceFormat::kJointTable, "joint_table"},
                                                 {SourceFormat::kBvh, "bvh"},
                                                 {SourceFormat::kNpy, "npy"},
                                                 {SourceFormat::kNpy, "npz"},
                                                 {SourceFormat::kDepthSequence, "depth_sequence"},
                                                 {SourceFormat::kDepthSequence, "depth_still"},
                                                 {SourceFormat::kNtuSkeleton, "ntu_skeleton"},
                                                 {SourceFormat::kAsfAmc, "amc"},
                                                 {SourceFormat::kAmass, "amass"},
                                                 {SourceFormat::kExpmap, "expmap_table"},
                                                 {SourceFormat::kExpmap, "joint_table"},
                                                 {SourceFormat::kPhspd, "phspd_pose"},
                                                 {SourceFormat::kVibeTracks, "vibe_tracks"},
                                                 {SourceFormat::kUestc, "vibe_cache"},
                                                 {SourceFormat::kUestc, "vibe_tracks"},
                                                 {SourceFormat::kHumanAct12Pickle, "humanact12_pickle"},
                                                 {SourceFormat::kOpenPose, "openpose"},
                                                 {SourceFormat::kPanoptic, "panoptic_bodies"}};

}  // namespace

std::string InspectedAs(SourceFormat format) {
  for (const InspectedFormat& reading : kInspectedFormats) {
    if (reading.format == format) return std::string(reading.inspected);
  }
  return FactsOf(format).name;
}

const FormatFacts& FactsOf(SourceFormat format) {
  for (const FormatFacts& facts : kFormats) {
    if (facts.format == format) return facts;
  }
  return kFormats[0];
}

const FormatFacts& FactsOf(std::string_view name) {
  for (const FormatFacts& facts : kFormats) {
    if (facts.name == name) return facts;
  }
  return kFormats[0];
}

Gives GivesOf(const SourceOptions& source) {
  return HasDepthBeside(source) ? Gives::kKeypointsAndDepth : FactsOf(source.format).gives;
}

std::string FormatName(SourceFormat format) { return FactsOf(format).name; }

const char* Name(Gives gives) {
  switch (gives) {
    case Gives::kJointTracks:
      return "joint tracks";
    case Gives::kDepthViews:
      return "depth views";
    case Gives::kKeypoints:
      return "keypoints of several cameras";
    case Gives::kKeypointsAndDepth:
      return "keypoints and depth views";
    case Gives::kMotion:
      return "motion";
    case Gives::kNothing:
      break;
  }
  return "nothing";
}

}  // namespace mocurate
