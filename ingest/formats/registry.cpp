#include <algorithm>

#include "ingest/formats/driver.h"

namespace mocurate {

// One a format, each in the file of its name.
const FormatDriver& JointTableFormat();
const FormatDriver& BvhFormat();
const FormatDriver& NpyFormat();
const FormatDriver& DepthSequenceFormat();
const FormatDriver& NtuSkeletonFormat();
const FormatDriver& AsfAmcFormat();
const FormatDriver& AmassFormat();
const FormatDriver& ExpmapFormat();
const FormatDriver& PhspdFormat();
const FormatDriver& VibeTracksFormat();
const FormatDriver& UestcFormat();
const FormatDriver& HumanAct12PickleFormat();
const FormatDriver& MotionsFormat();
const FormatDriver& OpenPoseFormat();
const FormatDriver& DepthViewsFormat();
const FormatDriver& PanopticFormat();
const FormatDriver& CloudsFormat();

namespace {

std::vector<const FormatDriver*>& AllFormats() {
  static const FormatDriver none;
  static std::vector<const FormatDriver*> drivers = {&none,
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

}  // namespace

const std::vector<const FormatDriver*>& FormatDrivers() { return AllFormats(); }

const FormatDriver& DriverOf(std::string_view name) {
  const auto& all = FormatDrivers();
  const auto own = std::find_if(all.begin(), all.end(), [&](const FormatDriver* d) { return d->name == name; });
  return own == all.end() ? *all.front() : **own;
}

const FormatDriver* RecogniseFormat(const FileBytes& file) {
  const FileKind kind = KindOf(file.bytes);
  const FormatDriver* by_kind = nullptr;
  for (const FormatDriver* driver : FormatDrivers()) {
    if (driver->observe == nullptr) continue;
    if (driver->sniff != nullptr && driver->sniff(file, kind)) return driver;
    if (driver->sniff == nullptr && driver->kind == kind) by_kind = driver;
  }
  return by_kind;
}

void AddFormat(const FormatDriver& driver) {
  AllFormats().push_back(&driver);
  AddSourceFormat(driver.name);
}

bool FormatDriver::HasOption(std::string_view option) const {
  return std::find(options.begin(), options.end(), option) != options.end();
}

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
