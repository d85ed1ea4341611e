#include "fitting/audit/sides_throughout.h"

#include <algorithm>
#include <utility>

#include "fitting/audit/camera_moves.h"
#include "fitting/audit/rig_fault.h"

namespace mocurate {
namespace {

/// Share of the cost that the exchange must remove. Finds 40 of 40 views with exchanged sides and none of 240 correct
/// ones. Source: bench_keypoint_rigs 40 5 sides=1 frames=45, and 60 5 frames=45 on four rigs
constexpr double kExplained = 0.1;

}  // namespace

std::optional<SidesThroughout> FindSidesThroughout(const RigSamples& samples, const RigModel& model,
                                                   const std::vector<double>& cost, double sure,
                                                   const TriangulationOptions& options) {
  if (samples.views() < kLeastViewsAudited || samples.count() < kFewestMoments) return {};
  std::vector<SidesThroughout> all;
  for (std::size_t v = 0; v < samples.views(); ++v) {
    if (model.sides_exchanged[v]) continue;
    SidesThroughout one{v, model, {}, 0.0};
    one.model.sides_exchanged[v] = true;
    const std::vector<ViewKeypoints> views = samples.Views(one.model);
    one.cost =
        CostOfMoments(views, TriangulateViews(views, samples.count(), samples.keypoints(), options), options.noise);
    all.push_back(std::move(one));
  }
  const auto best = std::min_element(all.begin(), all.end(), [](const SidesThroughout& a, const SidesThroughout& b) {
    return Sum(a.cost) < Sum(b.cost);
  });
  if (best == all.end() || Sum(best->cost) > (1.0 - kExplained) * Sum(cost)) return {};
  best->confidence = Confidence(cost, best->cost);
  for (const SidesThroughout& other : all) {
    if (other.view != best->view) best->confidence = std::min(best->confidence, Confidence(other.cost, best->cost));
  }
  if (best->confidence < sure) return {};
  return std::move(*best);
}

}  // namespace mocurate
