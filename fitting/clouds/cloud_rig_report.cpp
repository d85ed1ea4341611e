#include <algorithm>
#include <utility>

#include "fitting/clouds/cloud_rig_audit.h"

namespace mocurate {

bool DepthRigReport::IsDoubtful() const { return std::any_of(faults.begin(), faults.end(), mocurate::IsDoubtful); }

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
  if (report.not_audited.empty()) return findings;
  Finding finding;
  finding.code = "rig_not_audited";
  finding.severity = Severity::kInfo;
  finding.value = static_cast<double>(report.cameras.size());
  finding.message = report.not_audited;
  finding.action = "taken as given";
  findings.push_back(std::move(finding));
  return findings;
}

}  // namespace mocurate
