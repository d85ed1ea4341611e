#include "fitting/solver/rest_directions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "fitting/evidence/noise.h"

namespace mocurate {
namespace {

constexpr double kRestSpread = 0.25;  ///< of the distances of the rest skeleton, as a share of the bones
constexpr double kLeastSigma = 2e-3;  ///< metres: tracked joints wander with the pose, however many samples there are
constexpr double kRounding = 1e-4;

/// Bones that start at one joint, by the joints they end at.
using Star = std::vector<int>;

/// Distances between the ends, metres; none where two are never seen together, or noise reaches across a bone.
std::optional<Eigen::MatrixXd> DistancesOf(const Star& star, const Eigen::MatrixXd& rest,
                                           const std::vector<SkeletonTracks>& clips, const std::vector<double>& white) {
  const double across = std::sqrt(6.0) * *std::max_element(white.begin(), white.end());  // of two points, three axes
  const auto count = static_cast<Eigen::Index>(star.size());
  Eigen::MatrixXd distances = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    if (rest.col(i).norm() <= across) return std::nullopt;
    for (Eigen::Index k = i + 1; k < count; ++k) {
      const BoneDistance seen =
          DistanceOver(clips, white, star[static_cast<std::size_t>(i)], star[static_cast<std::size_t>(k)]);
      const double expected = (rest.col(i) - rest.col(k)).norm();
      if (seen.samples == 0) return std::nullopt;
      const double sigma = std::max(kLeastSigma, seen.sigma);
      const double trust = std::pow(0.5 * kRestSpread * (rest.col(i).norm() + rest.col(k).norm()) / sigma, 2.0);
      const bool near = std::max(seen.length, expected) <= across;  // no more is known than that
      distances(i, k) = distances(k, i) = near ? expected : (trust * seen.length + expected) / (trust + 1.0);
    }
  }
  return distances;
}

void ShareBetweenSides(const Star& star, const Skeleton& skeleton, Eigen::MatrixXd& distances) {
  std::vector<Eigen::Index> partner;
  for (const int end : star) {
    const auto found = std::find(star.begin(), star.end(), skeleton.joints[end].mirror);
    if (found == star.end()) return;
    partner.push_back(found - star.begin());
  }
  const Eigen::MatrixXd seen = distances;
  for (Eigen::Index i = 0; i < seen.rows(); ++i) {
    for (Eigen::Index k = 0; k < seen.cols(); ++k) {
      distances(i, k) =
          0.5 * (seen(i, k) + seen(partner[static_cast<std::size_t>(i)], partner[static_cast<std::size_t>(k)]));
    }
  }
}

/// (3, n), one column per bone: what has these lengths and distances, however it is turned, or mirrored.
Eigen::MatrixXd Arranged(const Eigen::MatrixXd& distances, const Eigen::MatrixXd& near) {
  const Eigen::Index count = near.cols();
  Eigen::MatrixXd gram(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index k = 0; k < count; ++k) {
      gram(i, k) = 0.5 * (near.col(i).squaredNorm() + near.col(k).squaredNorm() - distances(i, k) * distances(i, k));
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  Eigen::MatrixXd points = Eigen::MatrixXd::Zero(3, count);
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(3, count); ++i) {
    const Eigen::Index from = count - 1 - i;
    points.row(i) = std::sqrt(std::max(0.0, eigen.eigenvalues()[from])) * eigen.eigenvectors().col(from).transpose();
  }
  return points;
}

/// Distances do not tell a body from its mirror image; frames do: whether most of them have the three bones that span
/// the most the other way round.
bool IsMirrored(const Eigen::MatrixXd& points, const Star& star, int parent, const std::vector<SkeletonTracks>& clips) {
  const auto volume = [](const Vector3d& a, const Vector3d& b, const Vector3d& c) { return a.cross(b).dot(c); };
  double most = 0.0;
  std::array<Eigen::Index, 3> spanning = {0, 0, 0};
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    for (Eigen::Index k = i + 1; k < points.cols(); ++k) {
      for (Eigen::Index l = k + 1; l < points.cols(); ++l) {
        const double spanned = volume(points.col(i), points.col(k), points.col(l));
        if (std::abs(spanned) <= std::abs(most)) continue;
        most = spanned;
        spanning = {i, k, l};
      }
    }
  }
  if (most == 0.0) return false;  // flat: its mirror image is itself, turned
  double alike = 0.0;
  for (const SkeletonTracks& clip : clips) {
    for (int f = 0; f < clip.frames(); ++f) {
      double confidence = clip.confidence_at(f, parent);
      std::array<Vector3d, 3> bone;
      for (std::size_t i = 0; i < 3; ++i) {
        const int end = star[static_cast<std::size_t>(spanning[i])];
        confidence = std::min(confidence, clip.confidence_at(f, end));
        bone[i] = clip.positions.at(f, end) - clip.positions.at(f, parent);
      }
      if (confidence > 0.0) alike += std::copysign(confidence, most * volume(bone[0], bone[1], bone[2]));
    }
  }
  return alike < 0.0;
}

/// The points turned (not mirrored) as near to `near` as they go.
Eigen::MatrixXd TurnedTo(const Eigen::MatrixXd& near, const Eigen::MatrixXd& points) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(near * points.transpose(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d sign = Vector3d::Ones();
  sign.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose() * points;
}

}  // namespace

Vector3d RoundedDirection(const Vector3d& offset) {
  const Vector3d rounded = (offset.normalized() / kRounding).array().round() * kRounding;
  return rounded.normalized() * offset.norm();
}

SkeletonPtr WithOwnDirections(const std::vector<SkeletonTracks>& clips, const SkeletonPtr& skeleton,
                              const BoneEstimate& bones, bool symmetric) {
  if (clips.empty()) return skeleton;
  std::vector<double> white;
  for (const SkeletonTracks& clip : clips) white.push_back(EstimateNoise(clip, {}).white);
  auto own = std::make_shared<Skeleton>(*skeleton);
  const std::vector<std::vector<int>> children = skeleton->Children();
  for (int parent = 0; parent < skeleton->joint_count(); ++parent) {
    Star star;
    for (const int child : children[parent]) {
      if (bones.samples[child] > 0 && !skeleton->joints[child].rest_offset.isZero()) star.push_back(child);
    }
    if (star.size() < 2) continue;
    Eigen::MatrixXd near(3, static_cast<Eigen::Index>(star.size()));
    for (Eigen::Index i = 0; i < near.cols(); ++i) {
      const int end = star[static_cast<std::size_t>(i)];
      near.col(i) = bones.length[end] * skeleton->joints[end].rest_offset.normalized();
    }
    std::optional<Eigen::MatrixXd> distances = DistancesOf(star, near, clips, white);
    if (!distances) continue;
    if (symmetric) ShareBetweenSides(star, *skeleton, *distances);
    Eigen::MatrixXd points = Arranged(*distances, near);
    if (IsMirrored(points, star, parent, clips)) points.row(2) = -points.row(2);
    const Eigen::MatrixXd arranged = TurnedTo(near, points);
    for (Eigen::Index i = 0; i < arranged.cols(); ++i) {
      Vector3d& offset = own->joints[star[static_cast<std::size_t>(i)]].rest_offset;
      const Vector3d turned = arranged.col(i);
      if (!turned.isZero()) offset = RoundedDirection(turned.normalized() * offset.norm());
    }
  }
  return own;
}

}  // namespace mocurate
