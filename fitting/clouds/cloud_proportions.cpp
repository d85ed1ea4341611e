#include "fitting/clouds/cloud_proportions.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <utility>

#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/clouds/cloud_start.h"
#include "fitting/clouds/cloud_tracking.h"

namespace mocurate {
namespace {

constexpr int kFramesOfClip = 9;       ///< of each clip, evenly spread
constexpr std::size_t kFewClouds = 3;  ///< people may squat or raise an arm in so many
constexpr std::array<double, 7> kHeightFactors = {0.85, 0.92, 1.0, 1.08,
                                                  1.16, 1.28, 1.45};  ///< on the scale from the height
constexpr std::size_t kLimbsOfScales = 4;  ///< the cheapest, whose limbs are looked for before one is taken
constexpr std::array<double, 4> kUsualScales = {0.87, 0.95, 1.03, 1.11};  ///< scales of grown people

/// What the best poses of a body of some scale cost in all clouds.
Expected<double> CostOfScale(const SkeletonPtr& skeleton, const std::vector<FusedCloud>& clouds, double scale,
                             const PointCloudOptions& options, StartSearch search) {
  const FleshBody body = FleshBody::Make(skeleton, scale, options.capsule_radius_scale);
  std::vector<double> lengths = skeleton->RestBoneLengths();
  for (double& length : lengths) length *= scale;
  double cost = 0.0;
  for (const FusedCloud& cloud : clouds) {
    if (cloud.size() == 0) continue;
    PoseState state(*skeleton, 1, lengths, body.MovingJoints());
    const auto start = FindStart(body, cloud, 0, options, state, search);
    if (!start) return Forward(start);
    cost += start->cost;
  }
  return cost;
}

/// The scale whose body fits a few clouds best: the height does not tell it when people do not stand upright, or are
/// seen in part.
Expected<double> BestScale(const SkeletonPtr& skeleton, const std::vector<FusedCloud>& clouds, double from_height,
                           const PointCloudOptions& options) {
  std::vector<double> scales;
  for (const double factor : kHeightFactors) scales.push_back(factor * from_height);
  for (const double usual : kUsualScales) {
    if (usual > scales.back()) scales.push_back(usual);
  }
  std::vector<std::pair<double, double>> by_cost;
  for (const double scale : scales) {
    const Expected<double> cost = CostOfScale(skeleton, clouds, scale, options, StartSearch::kStances);
    if (!cost) return Forward(cost);
    by_cost.emplace_back(*cost, scale);
  }
  std::sort(by_cost.begin(), by_cost.end());
  by_cost.resize(std::min(by_cost.size(), kLimbsOfScales));
  for (auto& [cost_of, scale] : by_cost) {
    const Expected<double> cost = CostOfScale(skeleton, clouds, scale, options, StartSearch::kStancesAndLimbs);
    if (!cost) return Forward(cost);
    cost_of = *cost;
  }
  return std::min_element(by_cost.begin(), by_cost.end())->second;
}

}  // namespace

Expected<std::vector<double>> BoneLengthsFromClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                                    const PointCloudOptions& options) {
  std::vector<FusedCloud> clouds;
  for (const Clip& clip : clips) {
    DepthRigReport report;
    const Expected<Clip> audited = WithAuditedRig(clip, options.audit, report);
    if (!audited) return Forward(audited);
    Expected<std::vector<FusedCloud>> of_clip = FuseClip(*audited, options, kFramesOfClip);
    if (!of_clip) return Forward(of_clip);
    clouds.insert(clouds.end(), std::make_move_iterator(of_clip->begin()), std::make_move_iterator(of_clip->end()));
  }
  double scale = ScaleFromHeight(skeleton, clouds, options.voxel_size);
  const bool any_points =
      std::any_of(clouds.begin(), clouds.end(), [](const FusedCloud& cloud) { return cloud.size() > 0; });
  if (any_points && clouds.size() <= kFewClouds) {
    const Expected<double> best = BestScale(skeleton, clouds, scale, options);
    if (!best) return Forward(best);
    scale = *best;
  }
  std::vector<double> lengths = skeleton->RestBoneLengths();
  for (double& length : lengths) length *= scale;
  return lengths;
}

}  // namespace mocurate
