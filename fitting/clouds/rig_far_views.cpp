#include "fitting/clouds/rig_far_views.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
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
  for (double step = 0.01; step >= kFinestWayAside; step *= 0.5) {
    const int reach = step == 0.01 ? static_cast<int>(std::lround(kFactorReach / step)) : 1;
    for (int i = -reach; i <= reach; ++i) {
      const double factor = middle + step * i;
      if (factor <= 0.05) continue;
      DepthRigSampler corrected(WithDepths(sampler.views(), found.view, factor));
      const Expected<ObservedRig> seen = corrected.Seen(delays);
      if (!seen) return Forward(seen);
      const double loss = MeanLoss(LossOfSamples(*seen, cameras));
      if (loss >= found.loss) continue;
      found.loss = loss;
      found.factor = factor;
    }
    middle = found.factor;
  }
  found.too_long = distance * (1.0 - found.factor);
  return std::optional<WrongDepths>(found);
}

}  // namespace mocurate
