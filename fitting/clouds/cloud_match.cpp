#include "fitting/clouds/cloud_match.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

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

double RobustSigma(const std::vector<CloudMatch>& matches) {
  std::vector<double> distances;
  for (const CloudMatch& match : matches) distances.push_back(match.distance);
  return RobustSigma(std::move(distances));
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

namespace {

constexpr int kOffsetRounds = 3;            ///< rounds of matching and solving (numerical)
constexpr double kPointError = 0.015;       ///< m, of a patch of points to a capsule of the right shape
constexpr double kShapePatchPoints = 10.0;  ///< points that share this error
constexpr double kUsualOffset = 0.006;      ///< m, standard deviation of an end from the template's
constexpr double kUsualRadius = 0.003;      ///< m, standard deviation of a radius
constexpr double kThinnest = 0.5;           ///< of the radius before, at least

/// Change of a capsule: begin (3) and end (3) in the joint's frame, radius.
using Change = Eigen::Matrix<double, 7, 1>;

struct Sums {
  Eigen::Matrix<double, 7, 7> matrix = Eigen::Matrix<double, 7, 7>::Zero();
  Change right = Change::Zero();
};

/// The mirrored change, for the other side.
Change Mirrored(Change change) {
  change[0] = -change[0];
  change[3] = -change[3];
  return change;
}

/// `now`: the change so far; the prior is relative to the template.
void AddPriors(const Change& now, double factor, Sums& sums) {
  for (int i = 0; i < 7; ++i) {
    const double usual = factor * (i < 6 ? kUsualOffset : kUsualRadius);
    sums.matrix(i, i) += 1.0 / (usual * usual);
    sums.right[i] -= now[i] / (usual * usual);
  }
}

/// Adds the pose error that all points of a capsule share, so that many points do not make the shape more certain.
/// Returns the share of the prior shape variance that remains.
double SharePosesInError(double pose_variance, double usual, Sums& sums) {
  const double information =
      (sums.matrix.topLeftCorner<6, 6>().trace() + 2.0 * sums.matrix.block<3, 3>(0, 3).trace()) / 3.0;
  const double factor = 1.0 / (1.0 + information * pose_variance);
  sums.matrix *= factor;
  sums.right *= factor;
  return 1.0 / (1.0 + usual * usual * factor * information);
}

}  // namespace

double FitCapsuleOffsets(const std::vector<FusedCloud>& clouds, const PoseState& state, const std::vector<int>& frames,
                         double max_distance, const std::vector<double>& pose_variance, CapsuleBody& body) {
  double left = 1.0;
  const double unknown = body.skeleton->shape == BodyShape{} ? kUnknownShape : 1.0;
  const double weight = 1.0 / (kShapePatchPoints * kPointError * kPointError * std::max<double>(1.0, frames.size()));
  std::vector<Change> changed(body.capsules.size(), Change::Zero());
  for (int round = 0; round < kOffsetRounds; ++round) {
    std::vector<Sums> sums(body.capsules.size());
    for (const int f : frames) {
      for (const CloudMatch& match : MatchPoints(body, state, f, clouds[f], max_distance)) {
        const BodyCapsule& capsule = body.capsules[match.capsule];
        const CapsuleEnds ends = EndsOf(capsule, state, f);
        const Vector3d point = clouds[f].points.col(match.point);
        const double place = PlaceOnAxis(ends.begin, ends.end, point);
        const Vector3d away = point - (ends.begin + place * (ends.end - ends.begin));
        if (away.norm() < 1e-6) continue;
        const Vector3d normal = state.global(f, capsule.frame).transpose() * away.normalized();
        Change row;
        row << (1.0 - place) * normal, place * normal, 1.0;
        sums[match.capsule].matrix += weight * row * row.transpose();
        sums[match.capsule].right += weight * match.distance * row;
        if (capsule.mirror == match.capsule) continue;
        row = Mirrored(row);
        sums[capsule.mirror].matrix += weight * row * row.transpose();
        sums[capsule.mirror].right += weight * match.distance * row;
      }
    }
    left = 0.0;
    for (std::size_t c = 0; c < sums.size(); ++c) {
      BodyCapsule& capsule = body.capsules[c];
      const double variance = 0.5 * (pose_variance[static_cast<std::size_t>(capsule.frame)] +
                                     pose_variance[static_cast<std::size_t>(capsule.end_joint)]);
      left += SharePosesInError(variance, unknown * kUsualOffset, sums[c]) / static_cast<double>(sums.size());
      AddPriors(changed[c], unknown, sums[c]);
      const Change step = sums[c].matrix.ldlt().solve(sums[c].right);
      changed[c] += step;
      capsule.begin_offset += step.head<3>();
      capsule.end_offset += step.segment<3>(3);
      capsule.radius = std::max(kThinnest * capsule.radius, capsule.radius + step[6]);
    }
  }
  return left;
}

}  // namespace mocurate
