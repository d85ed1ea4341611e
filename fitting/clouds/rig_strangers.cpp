#include "fitting/clouds/rig_strangers.h"

#include <algorithm>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/confidence.h"

namespace mocurate {
namespace {

constexpr double kContradicting = 0.25;  ///< loss of every comparison
constexpr double kLikely = 0.9;

/// Loss of the view's best agreement with another one; 0 where it is compared with none.
double BestLoss(const SeenRig& rig, const std::vector<double>& losses, std::size_t view) {
  double least = 1.0;
  bool compared = false;
  for (std::size_t p = 0; p < rig.pairs.size(); ++p) {
    if (rig.pairs[p].first != view && rig.pairs[p].second != view) continue;
    std::vector<double> of_pair;
    for (std::size_t i = p; i < losses.size(); i += rig.pairs.size()) {
      if (losses[i] >= 0.0) of_pair.push_back(losses[i]);
    }
    if (of_pair.empty()) continue;
    least = std::min(least, MeanLoss(of_pair));
    compared = true;
  }
  return compared ? least : 0.0;
}

}  // namespace

std::vector<RigFault> StrangersOf(const SeenRig& rig, const std::vector<double>& losses, double longest_s) {
  std::vector<RigFault> strangers;
  for (std::size_t v = 0; v < rig.views.size(); ++v) {
    const double least = BestLoss(rig, losses, v);
    if (least < kContradicting) continue;
    const std::vector<double> seen = OfView(rig, v, losses, losses).first;
    RigFault fault;
    fault.code = "views_disagree";
    fault.camera = rig.views[v].camera.name;
    fault.value = 100.0 * least;
    fault.confidence = ConfidenceOfSeparate(seen, std::vector<double>(seen.size(), kContradicting));
    fault.message = "what depth camera " + fault.camera + " sees contradicts every other view, the nearest in " +
                    RoundedText(100.0 * least, 2) + " % of it: its clock may be off by more than " +
                    RoundedText(1e3 * longest_s, 3) + " ms, or it sees something else";
    if (fault.confidence >= kLikely) strangers.push_back(std::move(fault));
  }
  return strangers;
}

}  // namespace mocurate
