#include "fitting/clouds/inconsistent_views.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/median.h"
#include "core/base/text.h"
#include "fitting/audit/rig_fault.h"

namespace mocurate {
namespace {

constexpr double kInconsistentViewLoss = 0.25;       ///< loss that every comparison of the view must reach
constexpr double kInconsistentViewConfidence = 0.9;  ///< confidence of the finding, at least
/// Views that may have been moved, at most, with more views than kFewViews (numerical).
constexpr std::size_t kMostMoved = 4;
/// Loss of the worst view of a few moments. Correct stills of rendered_body reach 0.054. With the depths of one camera
/// a tenth wrong it is 0.18 to 0.49, with 2 % 0.20 to 0.40. With 5 % (surfaces often too far apart to be compared) it
/// is 0.09 to 0.25. Source: stills of rendered_body
constexpr double kMissing = 0.12;
constexpr double kOddLoss = 1.3;  ///< of the median loss, from which one of many views may have been moved

/// Loss of the view's best agreement with another one; empty without comparisons.
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

/// Whether contradicting views may be excluded: all their possible causes are to be corrected, and most views agree
/// with another one.
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
    const std::string& camera = rig.views[v].camera.name;
    RigFault fault =
        MakeFault(kContradictingView, camera, 100.0 * *best[v],
                  "depth camera " + camera + " contradicts every other view, the nearest one in " +
                      RoundedText(100.0 * *best[v], 2) + " % of its points" +
                      (exclude ? ", and the others agree with each other" : "") + ": its clock offset may exceed " +
                      RoundedText(1e3 * options.longest_s, 3) + " ms, or it shows another scene");
    const std::vector<double> limit(losses.size(), kInconsistentViewLoss);
    fault.confidence = ConfidenceOfTests(ConfidenceOfLosses(rig, losses, limit, v), rig.views.size());
    fault.corrected = exclude;
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
  const double usual = MeanMedian(loss);
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
  if (cameras.size() < kLeastViewsAudited || worst < kMissing) return {};
  std::vector<RigFault> faults;
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    RigFault fault = MakeFault(
        kContradictingView, cameras[v], 100.0 * losses[v],
        "the surfaces of depth camera " + cameras[v] + " miss those of the other cameras (loss " +
            RoundedText(losses[v], 2) + ", for views that agree 0.05): the depths or the pose of one camera are " +
            "wrong; with so few moments, which one is ambiguous; check the calibration and the unit of each camera");
    fault.confidence = 1.0;
    fault.confidence_of = ConfidenceOf::kModel;
    faults.push_back(std::move(fault));
  }
  return faults;
}

namespace {

constexpr double kHalfDepth = 0.1;       ///< m; visible surface of a person in front of the centre
constexpr double kAwayAlongSight = 0.9;  ///< of the offset: least share along the line of sight
/// Factor; largest difference from the one of the offset. Where one view has the person inside the other view's person,
/// that one cannot observe it, and the loss is uninformative.
constexpr double kFactorReach = 0.03;
constexpr double kFinestWayAside = 0.0025;  ///< factor; last step of the search (numerical)

}  // namespace

std::vector<Vector3d> AsideOf(const ObservedRig& rig, const std::vector<Camera>& cameras) {
  std::vector<Vector3d> aside(cameras.size(), Vector3d::Zero());
  std::vector<double> moments(cameras.size(), 0.0);
  for (const ObservedMoment& moment : rig.moments) {
    std::vector<std::optional<Vector3d>> middle(moment.size());
    for (std::size_t v = 0; v < moment.size(); ++v) {
      if (moment[v] == nullptr) continue;
      const Vector3d seen = Inverse(cameras[v].camera_from_world) * Vector3d(moment[v]->points.rowwise().mean());
      middle[v] = seen + kHalfDepth * (seen - cameras[v].Centre()).normalized();
    }
    for (std::size_t v = 0; v < moment.size(); ++v) {
      Vector3d others = Vector3d::Zero();
      double count = 0.0;
      for (std::size_t o = 0; o < moment.size(); ++o) {
        if (o == v || !middle[o]) continue;
        others += *middle[o];
        count += 1.0;
      }
      if (!middle[v] || count == 0.0) continue;
      aside[v] += *middle[v] - others / count;
      moments[v] += 1.0;
    }
  }
  for (std::size_t v = 0; v < aside.size(); ++v) aside[v] /= std::max(moments[v], 1.0);
  return aside;
}

std::vector<DepthView> WithDepths(std::vector<DepthView> views, std::size_t view, double factor) {
  views[view].metres_per_unit *= factor;
  return views;
}

Expected<std::optional<WrongDepths>> FindWrongDepths(const DepthRigSampler& sampler, const std::vector<int>& delays,
                                                     const ObservedRig& rig, const std::vector<Camera>& cameras) {
  const std::vector<Vector3d> aside = AsideOf(rig, cameras);
  const auto farthest = std::max_element(aside.begin(), aside.end(), [](const Vector3d& a, const Vector3d& b) {
    return a.squaredNorm() < b.squaredNorm();
  });
  WrongDepths found;
  found.view = static_cast<std::size_t>(farthest - aside.begin());
  const Vector3d sight = rig.centre - cameras[found.view].Centre();
  const double along = farthest->dot(sight.normalized());
  if (farthest->norm() < kAside || std::abs(along) < kAwayAlongSight * farthest->norm()) {
    return std::optional<WrongDepths>();
  }
  const double distance = sight.norm() + farthest->norm() / static_cast<double>(cameras.size());  // as it sees it
  double middle = std::max(0.1, 1.0 - along / distance);
  found.loss = 1.0;
  std::vector<std::vector<double>> candidates;
  for (double step = 0.01; step >= kFinestWayAside; step *= 0.5) {
    const int reach = step == 0.01 ? static_cast<int>(std::lround(kFactorReach / step)) : 1;
    for (int i = -reach; i <= reach; ++i) {
      const double factor = middle + step * i;
      if (factor <= 0.05) continue;
      DepthRigSampler corrected(WithDepths(sampler.views(), found.view, factor));
      Expected<ObservedRig> seen = corrected.Seen(delays);
      if (!seen) return Forward(seen);
      seen->pairs = rig.pairs;
      candidates.push_back(LossOfSamples(*seen, cameras));
      const double loss = MeanLoss(candidates.back());
      if (loss >= found.loss) continue;
      found.loss = loss;
      found.factor = factor;
    }
    middle = found.factor;
  }
  if (!candidates.empty()) found.held_out = HeldOutCosts(candidates, HalvesOfSamples(rig));
  found.too_long = distance * (1.0 - found.factor);
  return std::optional<WrongDepths>(found);
}

RigFault DepthsOff(const std::string& camera, const WrongDepths& wrong) {
  const double off_mm = 1e3 * wrong.too_long;
  return MakeFault("camera_depths_off", camera, off_mm,
                   "depths of camera " + camera + " are " + RoundedText(std::abs(off_mm), 2) + " mm too " +
                       (off_mm > 0.0 ? "long" : "short") + " at the person (by an offset, or a factor of " +
                       RoundedText(1.0 / wrong.factor, 3) + ")");
}

}  // namespace mocurate
