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
    findings.push_back(
        MakeFinding("camera_without_person", Severity::kWarning, report.without_person[v],
                    "depth camera " + report.cameras[v] + " shows no person in " +
                        RoundedText(100.0 * report.without_person[v], 3) +
                        " % of the frames in which other cameras show one; these frames are fitted without it",
                    FindingAction::kKept));
  }
  if (report.not_audited.empty()) return findings;
  findings.push_back(MakeFinding("rig_not_audited", Severity::kWarning, static_cast<double>(report.cameras.size()),
                                 report.not_audited + "; the rig is used as given", FindingAction::kKept));
  return findings;
}

}  // namespace mocurate
