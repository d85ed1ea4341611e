#include "ingest/inspect/inspect_duplicates.h"

#include "ingest/checks/duplicate_findings.h"
#include "ingest/inspect/check_report.h"

namespace mocurate {

void InspectedMotions::Add(const RawClip& clip, const InspectedClip& report) {
  const std::optional<std::string>&units = report.units.value, &up = report.up.value;
  if (clip.positions.empty() || !units || !up || *units == "px") return;
  ids_.push_back(report.id);
  signatures_.push_back(SignatureShown(clip, *units, *up));
}

void InspectedMotions::Compare(const CheckOptions& options, std::vector<Finding>& findings) const {
  for (const Duplicate& pair : FindDuplicates(signatures_, DuplicateLimitsOf(options))) {
    const Finding finding = DuplicateFinding(pair, ids_[pair.first], signatures_[pair.first], signatures_[pair.second]);
    if (options.ActionFor(finding.code) == OnFinding::kIgnore) continue;
    findings.push_back(FindingAt(PlaceOf(finding, ids_[pair.second]), finding));
  }
}

}  // namespace mocurate
