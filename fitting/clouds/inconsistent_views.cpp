#include "fitting/clouds/inconsistent_views.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/median.h"
#include "core/base/text.h"
#include "fitting/audit/confidence.h"

namespace mocurate {
namespace {

constexpr double kInconsistentViewLoss = 0.25;  ///< loss of every comparison
constexpr double kInconsistentViewConfidence = 0.9;
constexpr std::size_t kMostMoved = 4;  ///< of more views than kFewViews
constexpr std::size_t kLeastViews = 3;
/// Loss of the worst view of a few moments. Of the sound stills of rendered_body at most 0.054; with the depths of one
/// camera a tenth too long or too short 0.18 to 0.49, by 2 % 0.20 to 0.40, by 5 % (surfaces too far apart to be
/// compared) 0.09 to 0.25.
constexpr double kMissing = 0.12;
constexpr double kOddLoss = 1.3;  ///< of the median, from which on one of many views may have been moved

/// Loss of the view's best agreement with another one; none where it is compared with none.
std::optional<double> BestLoss(const ObservedRig& rig, const std::vector<double>& losses, std::size_t view) {
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
  return compared ? std::optional(least) : std::nullopt;
}

/// Whether what contradicts the other views may be excluded: what may be behind it is to be corrected, and the views
/// that agree with another one are more than those that do not.
bool MayBeExcluded(const std::vector<std::optional<double>>& best, const RigAuditOptions& options) {
  if (options.clocks != AuditAction::kCorrect || options.moved != AuditAction::kCorrect ||
      options.exchanged != AuditAction::kCorrect)
    return false;
  const auto agree =
      std::count_if(best.begin(), best.end(), [](auto loss) { return loss && *loss < kInconsistentViewLoss; });
  const auto not_so =
      std::count_if(best.begin(), best.end(), [](auto loss) { return loss && *loss >= kInconsistentViewLoss; });
  return agree > not_so;
}

}  // namespace

std::vector<RigFault> FindInconsistentViews(const ObservedRig& rig, const std::vector<double>& losses,
                                            const RigAuditOptions& options) {
  std::vector<std::optional<double>> best;
  for (std::size_t v = 0; v < rig.views.size(); ++v) best.push_back(BestLoss(rig, losses, v));
  const bool exclude = MayBeExcluded(best, options);
  std::vector<RigFault> inconsistent_views;
  for (std::size_t v = 0; v < rig.views.size(); ++v) {
    if (!best[v] || *best[v] < kInconsistentViewLoss) continue;
    const std::vector<double> seen = OfView(rig, v, losses, losses).first;
    RigFault fault;
    fault.code = kContradictingView;
    fault.camera = rig.views[v].camera.name;
    fault.value = 100.0 * *best[v];
    fault.confidence = ConfidenceOfSeparate(seen, std::vector<double>(seen.size(), kInconsistentViewLoss));
    fault.corrected = exclude;
    fault.message = "what depth camera " + fault.camera + " sees contradicts every other view, the nearest in " +
                    RoundedText(100.0 * *best[v], 2) + " % of it" +
                    (exclude ? ", and the others agree with each other" : "") + ": its clock may be off by more than " +
                    RoundedText(1e3 * options.longest_s, 3) + " ms, or it sees something else";
    if (fault.confidence >= kInconsistentViewConfidence) inconsistent_views.push_back(std::move(fault));
  }
  return inconsistent_views;
}

void ReportInconsistentViews(std::vector<RigFault> inconsistent_views, std::vector<RigFault>& faults) {
  for (RigFault& inconsistent_view : inconsistent_views) {
    const auto of_it = [&](const RigFault& fault) {
      return inconsistent_view.corrected && fault.camera == inconsistent_view.camera;
    };
    faults.erase(std::remove_if(faults.begin(), faults.end(), of_it), faults.end());
    faults.push_back(std::move(inconsistent_view));
  }
}

std::vector<DepthView> WithoutInconsistentViews(std::vector<DepthView> views, const std::vector<RigFault>& faults) {
  const auto excluded = [&](const DepthView& view) {
    return std::any_of(faults.begin(), faults.end(), [&](const RigFault& fault) {
      return fault.code == kContradictingView && fault.corrected && fault.camera == view.camera.name;
    });
  };
  views.erase(std::remove_if(views.begin(), views.end(), excluded), views.end());
  return views;
}

std::vector<bool> MayHaveMoved(const std::vector<double>& loss_of_views) {
  const std::vector<double>& loss = loss_of_views;
  std::vector<bool> may(loss.size(), loss.size() <= kFewViews);
  if (loss.size() <= kFewViews) {
    may[static_cast<std::size_t>(std::min_element(loss.begin(), loss.end()) - loss.begin())] = false;
    return may;
  }
  std::vector<double> sorted = loss;
  const double usual = MeanMedian(sorted);
  std::vector<std::pair<double, std::size_t>> odd;
  for (std::size_t v = 0; v < loss.size(); ++v) {
    if (loss[v] > kOddLoss * usual) odd.emplace_back(-loss[v], v);
  }
  std::sort(odd.begin(), odd.end());
  for (std::size_t i = 0; i < std::min(odd.size(), kMostMoved); ++i) may[odd[i].second] = true;
  return may;
}

std::vector<RigFault> ContradictionOf(const std::vector<std::string>& cameras, const std::vector<double>& losses) {
  const double worst = losses.empty() ? 0.0 : *std::max_element(losses.begin(), losses.end());
  if (cameras.size() < kLeastViews || worst < kMissing) return {};
  std::vector<RigFault> faults;
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    RigFault fault;
    fault.code = kContradictingView;
    fault.camera = cameras[v];
    fault.value = 100.0 * losses[v];
    fault.confidence = 1.0;
    fault.message = "what depth camera " + cameras[v] + " sees misses the surfaces that others see (loss " +
                    RoundedText(losses[v], 2) + ", of views that agree 0.05): the depths of one, or its place, are " +
                    "wrong, and so few moments do not tell whose; look at the calibration and the unit of each camera";
    faults.push_back(std::move(fault));
  }
  return faults;
}

}  // namespace mocurate
