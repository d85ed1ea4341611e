#include "fitting/audit/rig_fault.h"

#include <cmath>
#include <nlohmann/json.hpp>

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

}  // namespace mocurate
