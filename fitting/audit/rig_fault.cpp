#include "fitting/audit/rig_fault.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/text.h"

namespace mocurate {

Finding FindingOf(const RigFault& fault) {
  Finding finding;
  finding.code = fault.code;
  finding.severity = Severity::kWarning;
  finding.frame_begin = fault.frame_begin;
  finding.frame_end = fault.frame_end;
  finding.value = fault.value;
  finding.message = fault.message + "; confidence " + RoundedText(100.0 * fault.confidence, 4) + " %";
  finding.action = !fault.corrected                   ? FindingAction::kFlagged
                   : fault.code == kContradictingView ? FindingAction::kExcluded
                                                      : FindingAction::kRepaired;
  return finding;
}

bool IsAmbiguous(const RigFault& fault) {
  return !fault.corrected && !fault.guessed && fault.code != kContradictingView;
}

std::string FaultsText(const std::vector<RigFault>& faults) {
  nlohmann::json list = nlohmann::json::array();
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  for (const RigFault& fault : faults) {
    list.push_back({{"code", fault.code},
                    {"camera", fault.camera},
                    {"frames", {fault.frame_begin, fault.frame_end}},
                    {"value", rounded(fault.value)},
                    {"confidence", rounded(fault.confidence)},
                    {"corrected", fault.corrected}});
    if (!fault.limb.empty()) list.back()["limb"] = fault.limb;
  }
  return list.dump();
}

}  // namespace mocurate
