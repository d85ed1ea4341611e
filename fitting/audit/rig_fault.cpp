#include "fitting/audit/rig_fault.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/pi.h"
#include "core/base/text.h"

namespace mocurate {

std::string_view Name(ConfidenceOf of) {
  switch (of) {
    case ConfidenceOf::kSpansOfOneTake:
      return "spans_of_one_take";
    case ConfidenceOf::kTakes:
      return "takes";
    case ConfidenceOf::kModel:
      return "model";
  }
  return "";
}

std::string ConfidenceText(double confidence, ConfidenceOf of) {
  const std::string percent = RoundedText(100.0 * confidence, 4) + " %";
  if (of == ConfidenceOf::kSpansOfOneTake) return "repeatable to " + percent + " within this take";
  return "confidence " + percent + (of == ConfidenceOf::kTakes ? " between takes" : "");
}

Finding FindingOf(const RigFault& fault) {
  Finding finding;
  finding.code = fault.code;
  finding.severity = Severity::kWarning;
  finding.frame_begin = fault.frame_begin;
  finding.frame_end = fault.frame_end;
  finding.value = fault.value;
  finding.message = fault.message + "; " + ConfidenceText(fault.confidence, fault.confidence_of);
  finding.action = !fault.corrected                   ? FindingAction::kFlagged
                   : fault.code == kContradictingView ? FindingAction::kExcluded
                                                      : FindingAction::kRepaired;
  return finding;
}

Finding ContradictionOfRig(const RigFault& fault) {
  Finding finding = FindingOf(fault);
  finding.code = kRigContradicted;
  finding.message = "this take contradicts the audited rig that it uses: " + finding.message +
                    "; nothing was corrected. Audit the rig again with this take and others of it: "
                    "mocurate rig audit CONFIG --clip THIS_TAKE --clip ANOTHER_TAKE -o rig.yaml";
  finding.action = FindingAction::kFlagged;
  return finding;
}

bool IsAmbiguous(const RigFault& fault) {
  return !fault.corrected && !fault.guessed && fault.code != kContradictingView;
}

nlohmann::json FaultsJson(const std::vector<RigFault>& faults) {
  nlohmann::json list = nlohmann::json::array();
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  for (const RigFault& fault : faults) {
    list.push_back({{"code", fault.code},
                    {"camera", fault.camera},
                    {"frames", {fault.frame_begin, fault.frame_end}},
                    {"value", rounded(fault.value)},
                    {"confidence", rounded(fault.confidence)},
                    {"confidence_of", Name(fault.confidence_of)},
                    {"corrected", fault.corrected}});
    if (!fault.limb.empty()) list.back()["limb"] = fault.limb;
  }
  return list;
}

std::string FaultsText(const std::vector<RigFault>& faults) { return FaultsJson(faults).dump(); }

RigFault ClockOff(const std::string& camera, double later_s, std::optional<double> sigma_s, double worse) {
  RigFault fault;
  fault.code = "camera_clock_off";
  fault.camera = camera;
  fault.value = 1e3 * later_s;
  fault.message = "camera " + camera + ": clock offset " + (fault.value > 0.0 ? "+" : "-") +
                  RoundedText(std::abs(fault.value), 3) + " ms relative to the other cameras";
  if (sigma_s) fault.message += " (standard deviation " + RoundedText(1e3 * *sigma_s, 2) + " ms)";
  fault.message += "; without it, the cost is " + RoundedText(100.0 * worse, 2) + " % higher";
  return fault;
}

RigFault SidesExchanged(const std::string& camera, int frames, double margin) {
  RigFault fault;
  fault.code = "view_swaps_sides";
  fault.camera = camera;
  fault.frame_end = frames;
  fault.value = margin;
  fault.message = "camera " + camera + " exchanges left and right in all " + Counted(frames, "frame");
  return fault;
}

RigFault CameraMoved(const Camera& was, const Camera& is, const std::string& reference, int begin, int end,
                     int frames) {
  RigFault fault;
  fault.code = "camera_moved";
  fault.camera = was.name;
  fault.value = 1e3 * (is.Centre() - was.Centre()).norm();
  const double angle = is.camera_from_world.rotation.angularDistance(was.camera_from_world.rotation);
  fault.message = "camera " + was.name + " stands " + RoundedText(fault.value, 3) + " mm and " +
                  RoundedText(kDegrees * angle, 2) + " degrees from the pose of " + reference;
  if (begin == 0 && end == frames) return fault;
  fault.frame_begin = begin;
  fault.frame_end = end;
  fault.message += begin == 0 ? " until frame " + std::to_string(end) : " from frame " + std::to_string(begin) + " on";
  return fault;
}

}  // namespace mocurate
