#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "ingest/formats/driver.h"
#include "ingest/inspect/read_raw.h"

namespace mocurate {

// One per format, each in the file of its name.
FormatDriver JointTableFormat();
FormatDriver BvhFormat();
FormatDriver NpyFormat();
FormatDriver DepthSequenceFormat();
FormatDriver NtuSkeletonFormat();
FormatDriver AsfAmcFormat();
FormatDriver AmassFormat();
FormatDriver ExpmapFormat();
FormatDriver PhspdFormat();
FormatDriver VibeTracksFormat();
FormatDriver UestcFormat();
FormatDriver HumanAct12PickleFormat();
FormatDriver MotionsFormat();
FormatDriver OpenPoseFormat();
FormatDriver DepthViewsFormat();
FormatDriver PanopticFormat();
FormatDriver CloudsFormat();
FormatDriver C3dFormat();
FormatDriver TrcFormat();

namespace {

std::deque<FormatDriver>& AllFormats() {
  static std::deque<FormatDriver> drivers = {
      FormatDriver(),           JointTableFormat(),  BvhFormat(),        NpyFormat(),
      DepthSequenceFormat(),    NtuSkeletonFormat(), AsfAmcFormat(),     AmassFormat(),
      ExpmapFormat(),           PhspdFormat(),       VibeTracksFormat(), UestcFormat(),
      HumanAct12PickleFormat(), MotionsFormat(),     OpenPoseFormat(),   DepthViewsFormat(),
      PanopticFormat(),         CloudsFormat(),      C3dFormat(),        TrcFormat()};
  return drivers;
}

}  // namespace

const std::deque<FormatDriver>& FormatDrivers() { return AllFormats(); }

const FormatDriver& DriverOf(std::string_view name) {
  const auto& all = FormatDrivers();
  const auto own = std::find_if(all.begin(), all.end(), [&](const FormatDriver& d) { return d.name == name; });
  return own == all.end() ? all.front() : *own;
}

const FormatDriver* RecogniseFormat(const FileBytes& file, FileKind kind) {
  const auto& all = FormatDrivers();
  // Formats that a program adds come last in the list and are asked first.
  const auto sniffed = std::find_if(all.rbegin(), all.rend(),
                                    [&](const FormatDriver& d) { return d.sniff != nullptr && d.sniff(file, kind); });
  if (sniffed != all.rend()) return &*sniffed;
  const auto own = std::find_if(all.begin(), all.end(), [&](const FormatDriver& d) { return d.IsOf(kind); });
  return own == all.end() ? nullptr : &*own;
}

void AddFormat(const FormatDriver& driver) {
  const std::string name = driver.name;
  if (DriverOf(name).name == name) throw std::logic_error("format '" + name + "' exists already");
  if (driver.to_clip == nullptr) throw std::logic_error("format '" + name + "' has no to_clip");
  if (driver.to_clip == TracksAsOpened && driver.open == nullptr)
    throw std::logic_error("format '" + name + "' has no open");
  const nlohmann::json options = OptionsToJson(SourceOptions());
  for (const std::string& option : driver.options) {
    if (!options.contains(option)) throw std::logic_error("ingest.source has no option '" + option + "'");
  }
  AllFormats().push_back(driver);
  AddSourceFormat(name);
}

bool FormatDriver::HasOption(std::string_view option) const {
  return std::find(options.begin(), options.end(), option) != options.end();
}

EvidenceKind EvidenceKindOf(const SourceOptions& source) {
  return HasDepthBeside(source) ? EvidenceKind::kKeypointsAndDepth : DriverOf(source.format).gives;
}

const char* Name(EvidenceKind gives) {
  static const char* const names[] = {"nothing",
                                      "joint tracks",
                                      "depth views",
                                      "point clouds",
                                      "keypoints of several cameras",
                                      "keypoints and depth views",
                                      "motion"};
  return names[static_cast<int>(gives)];
}

}  // namespace mocurate
