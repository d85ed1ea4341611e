#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "ingest/formats/driver.h"
#include "ingest/sense/observe.h"

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
  const auto& all = FormatDrivers();
  const FileKind kind = KindOf(file.bytes);
  // Formats that a program adds stand behind ours and are asked before them.
  const auto sniffs = [&](const FormatDriver* d) { return d->sniff != nullptr && d->sniff(file, kind); };
  const auto sniffed = std::find_if(all.rbegin(), all.rend(), sniffs);
  if (sniffed != all.rend()) return *sniffed;
  const auto of_kind = [&](const FormatDriver* d) { return d->sniff == nullptr && d->kind == kind; };
  const auto own = kind == FileKind::kUnknown ? all.end() : std::find_if(all.begin(), all.end(), of_kind);
  return own == all.end() ? nullptr : *own;
}

void AddFormat(const FormatDriver& driver) {
  const std::string name = driver.name;
  if (DriverOf(name).name == name) throw std::logic_error("there is a format '" + name + "' already");
  if (driver.to_clip == nullptr) throw std::logic_error("format '" + name + "' has no to_clip");
  const nlohmann::json options = OptionsToJson(SourceOptions());
  for (const std::string& option : driver.options) {
    if (!options.contains(option)) throw std::logic_error("ingest.source has no option '" + option + "'");
  }
  AllFormats().push_back(&driver);
  AddSourceFormat(name);
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
