#include "canon/frames/level.h"
#include "canon/options.h"
#include "canon/stage_parts.h"
#include "canon/stages.h"
#include "core/base/file.h"
#include "core/base/pi.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

Finding UnknownFloor(const std::string& group) {
  return MakeFinding(
      "floor_unknown", Severity::kWarning, 0.0,
      "the floor under the clips of " + group +
          " is unknown: no foot is ever at rest on it, or the skeleton has no legs; the clips were not levelled");
}

Finding SensorTilt(const std::string& group, const FloorPlane& floor) {
  const auto degrees = [](double radians) { return radians * 180.0 / kPi; };
  const double tilt = degrees(floor.tilt());
  return MakeFinding(
      "sensor_tilt", Severity::kInfo, tilt,
      "sensor (" + group + "): tilted by " + RoundedText(tilt, 3) + " +- " + RoundedText(degrees(floor.tilt_sigma), 2) +
          " degrees, the floor " + RoundedText(-floor.height, 3) +
          " m below it; stance phases: " + std::to_string(floor.contacts) + " times in " + Counted(floor.clips, "clip"),
      FindingAction::kRepaired);
}

}  // namespace

Expected<StageOutcome> LevelStage(const StageRequest& request) {
  const auto options = OptionsFromJson<LevelOptions>(request.options, "canon.level");
  if (!options) return Forward(options);
  std::vector<Motion> motions;
  for (const StageInput& input : request.inputs) {
    if (input.role != "motion") continue;
    auto clip = ReadMotionClip(input, nullptr);
    if (!clip) return Forward(clip);
    motions.push_back(*std::move(clip->motion));
  }
  StageOutcome outcome;
  const std::optional<FloorPlane> floor = EstimateFloor(*options, motions);
  if (!floor) {
    outcome.kind = OutcomeKind::kSuspect;
    outcome.findings.push_back(UnknownFloor(request.item));
  } else {
    outcome.findings.push_back(SensorTilt(request.item, *floor));
  }
  const nlohmann::json result = floor ? nlohmann::json(*floor) : nlohmann::json();
  outcome.summary["floor"] = result;
  if (Status written = WriteFile(request.output, result.dump(1) + "\n"); !written) return Forward(written);
  return outcome;
}

}  // namespace mocurate
