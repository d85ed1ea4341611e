#include <algorithm>
#include <utility>

#include "core/base/text.h"
#include "fitting/clouds/cloud_rig_audit.h"

namespace mocurate {
namespace {

constexpr double kRarelySeen = 0.5;  ///< share of the moments without a person, from which a finding is written

}  // namespace

bool DepthRigReport::IsAmbiguous() const {
  return std::any_of(faults.begin(), faults.end(), [](const RigFault& fault) {
    return mocurate::IsAmbiguous(fault) || (fault.code == kContradictingView && !fault.corrected);
  });
}

Expected<Clip> WithAuditedRig(const Clip& clip, const RigAuditOptions& options, DepthRigReport& report) {
  Expected<AuditedDepthRig> audited = AuditDepthRig(clip.evidence.depth_views, options);
  if (!audited) return Forward(audited);
  report = std::move(audited->report);
  Clip corrected = clip;
  corrected.evidence.depth_views = std::move(audited->views);
  return corrected;
}

std::vector<Finding> FindingsOf(const DepthRigReport& report) {
  std::vector<Finding> findings;
  for (const RigFault& fault : report.faults) findings.push_back(FindingOf(fault));
  for (std::size_t v = 0; v < report.without_person.size(); ++v) {
    if (report.without_person[v] < kRarelySeen) continue;
    Finding finding;
    finding.code = "camera_without_person";
    finding.severity = Severity::kWarning;
    finding.value = report.without_person[v];
    finding.message = "depth camera " + report.cameras[v] + " shows no person in " +
                      RoundedText(100.0 * report.without_person[v], 3) +
                      " % of the frames in which other cameras show one";
    finding.message += "; these frames are fitted without it";
    finding.action = FindingAction::kKept;
    findings.push_back(std::move(finding));
  }
  if (report.not_audited.empty()) return findings;
  Finding finding;
  finding.code = "rig_not_audited";
  finding.severity = Severity::kWarning;
  finding.value = static_cast<double>(report.cameras.size());
  finding.message = report.not_audited;
  finding.message += "; the rig is used as given";
  finding.action = FindingAction::kKept;
  findings.push_back(std::move(finding));
  return findings;
}

}  // namespace mocurate
