#include "ingest/sense/inspect_duplicates.h"

#include <nlohmann/json.hpp>

#include "ingest/duplicate_findings.h"
#include "ingest/sense/check_report.h"
#include "ingest/sense/clip_report.h"

namespace mocurate {

void SeenMotions::Add(const ObservedClip& clip, const nlohmann::json& report) {
  const nlohmann::json &units = report.at("units").at("value"), &up = report.at("up").at("value");
  if (clip.positions.empty() || !units.is_string() || !up.is_string() || units == "px") return;
  ids_.push_back(report.at("id"));
  signatures_.push_back(SignatureShown(clip, units, up));
}

void SeenMotions::Tell(const CheckOptions& options, nlohmann::json& findings) const {
  for (const Duplicate& pair : FindDuplicates(signatures_, DuplicateLimitsOf(options))) {
    const Finding finding = DuplicateFinding(pair, ids_[pair.first], signatures_[pair.first], signatures_[pair.second]);
    if (options.ActionFor(finding.code) == OnFinding::kIgnore) continue;
    findings.push_back(InspectionFinding(finding.code, finding.severity, PlaceOf(finding, ids_[pair.second]),
                                         finding.value, finding.message));
  }
}

}  // namespace mocurate
