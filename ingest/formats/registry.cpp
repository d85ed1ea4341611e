#include <algorithm>

#include "ingest/formats/driver.h"

namespace mocurate {

const std::vector<const FormatDriver*>& FormatDrivers() {
  static const FormatDriver none;
  static const std::vector<const FormatDriver*> drivers = {&none,
                                                           &JointTableFormat(),
                                                           &BvhFormat(),
                                                           &NpyFormat(),
                                                           &DepthSequenceFormat(),
                                                           &NtuSkeletonFormat(),
                                                           &AsfAmcFormat(),
                                                           &AmassFormat(),
                                                           &ExpmapFormat(),
                                                           &PhspdFormat(),
                                                           &VibeTracksFormat(),
                                                           &UestcFormat(),
                                                           &HumanAct12PickleFormat(),
                                                           &MotionsFormat(),
                                                           &OpenPoseFormat(),
                                                           &DepthViewsFormat(),
                                                           &PanopticFormat(),
                                                           &CloudsFormat()};
  return drivers;
}

const FormatDriver& DriverOf(SourceFormat format) {
  const auto& all = FormatDrivers();
  const auto own = std::find_if(all.begin(), all.end(), [&](const FormatDriver* d) { return d->format == format; });
  return own == all.end() ? *all.front() : **own;
}

const FormatDriver& DriverOf(std::string_view name) {
  const auto& all = FormatDrivers();
  const auto own = std::find_if(all.begin(), all.end(), [&](const FormatDriver* d) { return d->name == name; });
  return own == all.end() ? *all.front() : **own;
}

std::string FormatName(SourceFormat format) { return DriverOf(format).name; }

bool IsGathered(SourceFormat format) { return DriverOf(format).gathered; }

Gives GivesOf(const SourceOptions& source) {
  return HasDepthBeside(source) ? Gives::kKeypointsAndDepth : DriverOf(source.format).gives;
}

const char* Name(Gives gives) {
  switch (gives) {
    case Gives::kJointTracks:
      return "joint tracks";
    case Gives::kDepthViews:
      return "depth views";
    case Gives::kPointClouds:
      return "point clouds";
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
