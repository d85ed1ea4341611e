#include "fitting/fit_result.h"

#include "core/base/text.h"
#include "core/motion/gaps.h"
#include "core/quality/tracked_points.h"

namespace mocurate {

tl::unexpected<Error> InClip(Error error, const Clip& clip) {
  error.where = clip.id() + (error.where.empty() ? "" : ": " + error.where);
  return tl::unexpected<Error>(std::move(error));
}

void ReportFramesWithout(const std::vector<bool>& without, const std::string& what, std::vector<Finding>& findings) {
  for (const FrameRun& run : RunsWhere(without, true)) {
    findings.push_back(FrameFinding(kFramesWithoutEvidence, run.begin, run.end, "", run.frames(),
                                    what + " in " + Counted(run.frames(), "frame")));
    findings.back().action = FindingAction::kInterpolated;
  }
}

Finding NoUncertainty(const Error& error) {
  return MakeFinding(kNoUncertainty, Severity::kWarning, 0.0,
                     error.Message() + "; the motion is fitted, but no standard deviation is stated",
                     FindingAction::kKept);
}

}  // namespace mocurate
