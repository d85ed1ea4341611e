#include "fitting/clouds/cloud_match.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"
#include "core/body/bone_capsules.h"

namespace mocurate {
namespace {

constexpr double kNormalPenalty = 0.04;  ///< m added to the distance of a surface with another normal, per (1 - cosine)
constexpr double kLeastSurfaceSigma = 0.003;  ///< m; standard deviation of distances to the surface, at least
constexpr double kPriorPoints = 200.0;        ///< points that the previous radius counts as

/// Bounding ball of a capsule.
struct Ball {
  Vector3d centre;
  double radius = 0.0;
};

}  // namespace

std::vector<CloudMatch> MatchPoints(const CapsuleBody& body, const PoseState& state, int frame, const FusedCloud& cloud,
                                    double max_distance) {
  std::vector<CapsuleEnds> ends;
  std::vector<Ball> balls;
  for (const BodyCapsule& capsule : body.capsules) {
    ends.push_back(EndsOf(capsule, state, frame));
    balls.push_back({0.5 * (ends.back().begin + ends.back().end),
                     0.5 * (ends.back().end - ends.back().begin).norm() + capsule.radius});
  }
  std::vector<CloudMatch> matches;
  matches.reserve(cloud.size());
  for (int i = 0; i < cloud.size(); ++i) {
    CloudMatch best;
    double least = max_distance + 2.0 * kNormalPenalty;
    for (std::size_t c = 0; c < body.capsules.size(); ++c) {
      const double reach = balls[c].radius + std::min(least, max_distance);
      if ((cloud.points.col(i) - balls[c].centre).squaredNorm() > reach * reach) continue;
      const double radius = body.capsules[c].radius;
      const Vector3d point = cloud.points.col(i);
      const double distance = std::abs(SignedDistance(ends[c].begin, ends[c].end, radius, point));
      if (distance > max_distance || distance >= least) continue;  // most points stop here, before normals are compared
      const CapsulePoint on = ClosestOnCapsule(ends[c].begin, ends[c].end, radius, point);
      const double score = distance + kNormalPenalty * (1.0 - on.normal.dot(cloud.normals.col(i)));
      if (score >= least) continue;
      least = score;
      best = {i, static_cast<int>(c), on.distance};
    }
    if (least < max_distance + 2.0 * kNormalPenalty) matches.push_back(best);
  }
  return matches;
}

double RobustSigma(std::vector<double> distances) {
  if (distances.empty()) return kLeastSurfaceSigma;
  for (double& distance : distances) distance = std::abs(distance);
  return std::max(kLeastSurfaceSigma, kMadToSigma * MeanMedian(distances));
}

void CalibrateRadii(const std::vector<FusedCloud>& clouds, const PoseState& state, int begin, int end,
                    double max_distance, CapsuleBody& body) {
  std::vector<std::vector<double>> radii(body.capsules.size());
  for (int f = begin; f < end; ++f) {
    for (const CloudMatch& match : MatchPoints(body, state, f, clouds[f], max_distance)) {
      const BodyCapsule& capsule = body.capsules[match.capsule];
      const double radius = capsule.radius + match.distance;
      radii[match.capsule].push_back(radius);
      if (capsule.mirror != match.capsule) radii[capsule.mirror].push_back(radius);
    }
  }
  for (std::size_t c = 0; c < radii.size(); ++c) {
    if (radii[c].empty()) continue;
    const auto count = static_cast<double>(radii[c].size());
    const double median = MeanMedian(radii[c]);
    body.capsules[c].radius += (median - body.capsules[c].radius) * count / (count + kPriorPoints);
  }
}

}  // namespace mocurate
