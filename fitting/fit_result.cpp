#include "fitting/fit_result.h"

#include "core/base/text.h"

namespace mocurate {

void ReportFramesWithout(const std::vector<bool>& without, const std::string& what, FindingAction action,
                         std::vector<Finding>& findings) {
  const auto frames = static_cast<int>(without.size());
  for (int begin = 0; begin < frames; ++begin) {
    if (!without[begin]) continue;
    int end = begin;
    while (end < frames && without[end]) ++end;
    Finding finding;
    finding.code = kFramesWithoutEvidence;
    finding.frame_begin = begin;
    finding.frame_end = end;
    finding.value = end - begin;
    finding.message = what + " in " + Counted(end - begin, "frame");
    finding.action = action;
    findings.push_back(std::move(finding));
    begin = end;
  }
}

}  // namespace mocurate
