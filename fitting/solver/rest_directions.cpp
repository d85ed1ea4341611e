#include "fitting/solver/rest_directions.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/median.h"
#include "core/geometry/rigid.h"
#include "core/geometry/rotation.h"
#include "fitting/evidence/noise.h"
#include "fitting/solver/bone_lengths.h"
#include "fitting/solver/one_thread.h"
#include "fitting/solver/rest_sigmas.h"

namespace mocurate {
namespace {

/// Share of the bone lengths: standard deviation of the ends of the rest skeleton's bones.
constexpr double kRestSigma = 0.25;
constexpr double kLeastJointSigma =
    2e-3;                             ///< metres: tracked joints shift with the pose, however many samples there are
constexpr double kBendSigma = 2e-2;   ///< metres: of distances to an end beyond an unobserved joint, which bends
constexpr double kFramesAlike = 5.0;  ///< frames in sequence with the same information
/// Standard deviations of a difference of frames that is random in its sign.
constexpr double kReportedSigmas = 2.5;
/// Share of a unit vector: directions are stored as multiples of it (numerical).
constexpr double kDirectionRounding = 1e-4;
constexpr int kStarSteps = 60;  ///< Levenberg-Marquardt steps, at most (numerical)

/// Bones that start at one joint, by their observed ends: the children, or, below an unobserved child, the joint that
/// follows it.
using Star = std::vector<int>;

/// Distances between the ends and their sigmas, metres.
struct EndDistances {
  Eigen::MatrixXd length;
  Eigen::MatrixXd sigma;
};

/// Sigma of a distance between two points, from the noise of one coordinate, metres.
double NoiseAcross(double noise) { return std::sqrt(6.0) * noise; }

/// `noise`: of one coordinate, `white` in each clip. Empty where two ends are never observed together, or noise exceeds
/// a bone.
std::optional<EndDistances> DistancesOf(const Star& star, const Eigen::MatrixXd& rest,
                                        const std::vector<SkeletonTracks>& clips, const std::vector<double>& white,
                                        double noise, bool symmetric) {
  const std::vector<Joint>& joints = clips.front().skeleton->joints;
  const double across = NoiseAcross(noise);
  const auto count = static_cast<Eigen::Index>(star.size());
  EndDistances distances{Eigen::MatrixXd::Zero(count, count), Eigen::MatrixXd::Ones(count, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    if (rest.col(i).norm() <= across) return std::nullopt;
    for (Eigen::Index k = i + 1; k < count; ++k) {
      const int a = star[static_cast<std::size_t>(i)], b = star[static_cast<std::size_t>(k)];
      BoneDistance seen = DistanceOver(clips, white, a, b);
      if (seen.samples == 0) return std::nullopt;
      if (symmetric) {
        const BoneDistance mirrored = DistanceOver(clips, white, joints[a].mirror, joints[b].mirror);
        if (mirrored.samples > 0) seen.length = 0.5 * (seen.length + mirrored.length);
      }
      const double expected = (rest.col(i) - rest.col(k)).norm();
      const bool near = std::max(seen.length, expected) <= across;  // shorter distances are not resolved
      const double pair_sigma = std::max(seen.sigma, std::sqrt(2.0) * noise);
      const double independent = std::max(1.0, seen.confidence / kFramesAlike);
      const double least = joints[a].parent == joints[b].parent ? kLeastJointSigma : kBendSigma;
      distances.length(i, k) = distances.length(k, i) = near ? expected : seen.length;
      distances.sigma(i, k) = distances.sigma(k, i) = std::max(least, pair_sigma / std::sqrt(independent));
    }
  }
  return distances;
}

/// (3, n), one column per bone: points with these lengths and distances, up to rotation and reflection (classical
/// scaling).
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

double Volume(const Vector3d& a, const Vector3d& b, const Vector3d& c) { return a.cross(b).dot(c); }

/// Columns of three bones that span the largest volume; empty where all lie in a plane.
std::optional<std::array<Eigen::Index, 3>> Spanning(const Eigen::MatrixXd& points) {
  std::array<Eigen::Index, 3> spanning = {0, 0, 0};
  double most = 0.0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    for (Eigen::Index k = i + 1; k < points.cols(); ++k) {
      for (Eigen::Index l = k + 1; l < points.cols(); ++l) {
        const double spanned = std::abs(Volume(points.col(i), points.col(k), points.col(l)));
        if (spanned <= most) continue;
        most = spanned;
        spanning = {i, k, l};
      }
    }
  }
  if (most == 0.0) return std::nullopt;
  return spanning;
}

/// Confidence-weighted difference of the frames that show three bones as a right-handed or a left-handed triple. Only
/// ratios of confidences matter: frames that are all uncertain and all agree still decide.
struct TripleSigns {
  double surplus = 0.0;
  double squares = 0.0;  ///< of what each counts

  bool AreDecisive() const { return std::abs(surplus) > kReportedSigmas * std::sqrt(kFramesAlike * squares); }
};

TripleSigns CountTripleSigns(const std::vector<SkeletonTracks>& clips, int parent, const std::array<int, 3>& ends) {
  TripleSigns signs;
  for (const SkeletonTracks& clip : clips) {
    for (int f = 0; f < clip.frames(); ++f) {
      double confidence = clip.confidence_at(f, parent);
      std::array<Vector3d, 3> bone;
      for (std::size_t i = 0; i < 3; ++i) {
        confidence = std::min(confidence, clip.confidence_at(f, ends[i]));
        bone[i] = clip.positions.at(f, ends[i]) - clip.positions.at(f, parent);
      }
      if (!(confidence > 0.0)) continue;
      signs.surplus += std::copysign(confidence, Volume(bone[0], bone[1], bone[2]));
      signs.squares += confidence * confidence;
    }
  }
  return signs;
}

/// The points rotated (not mirrored) as near to `near` as possible.
Eigen::MatrixXd RotatedTo(const Eigen::MatrixXd& near, const Eigen::MatrixXd& points) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(near * points.transpose(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d sign = Vector3d::Ones();
  sign.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose() * points;
}

bool IsOtherImage(const Eigen::MatrixXd& points, const Eigen::MatrixXd& start) {
  const auto spanning = Spanning(start);
  if (!spanning) return false;
  const auto volume = [&](const Eigen::MatrixXd& of) {
    return Volume(of.col((*spanning)[0]), of.col((*spanning)[1]), of.col((*spanning)[2]));
  };
  return volume(points) * volume(start) < 0.0;
}

/// Distances do not distinguish a body from its mirror image; frames do. Without a decision of the frames: the image
/// nearer to the rest skeleton's.
Eigen::MatrixXd OfTwoImages(const Eigen::MatrixXd& points, const Eigen::MatrixXd& near, const Star& star, int parent,
                            const std::vector<SkeletonTracks>& clips, bool symmetric) {
  Eigen::MatrixXd mirrored = points;
  mirrored.row(2) = -mirrored.row(2);
  Eigen::MatrixXd as_is = RotatedTo(near, points);
  mirrored = RotatedTo(near, mirrored);
  const auto spanning = Spanning(points);
  if (!spanning) return as_is;
  std::array<int, 3> ends{}, partners{};
  const std::vector<Joint>& joints = clips.front().skeleton->joints;
  for (std::size_t i = 0; i < 3; ++i) {
    ends[i] = star[static_cast<std::size_t>((*spanning)[i])];
    partners[i] = joints[ends[i]].mirror;
  }
  TripleSigns signs = CountTripleSigns(clips, parent, ends);
  if (symmetric) {  // the other side's bones have the other handedness
    const TripleSigns other = CountTripleSigns(clips, joints[parent].mirror, partners);
    signs = {signs.surplus - other.surplus, signs.squares + other.squares};
  }
  if (!signs.AreDecisive()) return (as_is - near).squaredNorm() <= (mirrored - near).squaredNorm() ? as_is : mirrored;
  const double is = Volume(as_is.col((*spanning)[0]), as_is.col((*spanning)[1]), as_is.col((*spanning)[2]));
  return is * signs.surplus > 0.0 ? as_is : mirrored;
}

/// Distance of two points from a measured one, r = (|a - b| - length) / sigma; `b` none: from the origin.
struct DistanceResidual {
  double length, sigma;

  template <class T>
  bool operator()(const T* a, const T* b, T* residual) const {
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> from(b), to(a);
    return OfVector<T>(to - from, residual);
  }
  template <class T>
  bool operator()(const T* a, T* residual) const {
    return OfVector<T>(Eigen::Map<const Eigen::Matrix<T, 3, 1>>(a), residual);
  }
  template <class T>
  bool OfVector(const Eigen::Matrix<T, 3, 1>& apart, T* residual) const {
    const T square = apart.squaredNorm();
    residual[0] = ((square > T(0.0) ? sqrt(square) : T(0.0)) - length) / sigma;
    return true;
  }
};

/// Maximum-likelihood ends for distances, lengths of the bones and the rest skeleton, from a start. Poorly determined
/// parts, as the depth of a flat star, stay with the rest skeleton.
Eigen::MatrixXd Likeliest(const EndDistances& distances, const Eigen::MatrixXd& near, Eigen::MatrixXd points) {
  ceres::Problem problem;
  const auto at = [&](Eigen::Index i) { return points.data() + 3 * i; };
  for (Eigen::Index i = 0; i < near.cols(); ++i) {
    const double length = near.col(i).norm();
    const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(3, 3) / (kRestSigma * length);
    problem.AddResidualBlock(new ceres::NormalPrior(rest, near.col(i)), nullptr, at(i));
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<DistanceResidual, 1, 3>(new DistanceResidual{length, kLeastJointSigma}),
        nullptr, at(i));
    for (Eigen::Index k = i + 1; k < near.cols(); ++k) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<DistanceResidual, 1, 3, 3>(
                                   new DistanceResidual{distances.length(i, k), distances.sigma(i, k)}),
                               nullptr, at(i), at(k));
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = kStarSteps;
  options.function_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  const OneThread one_thread;
  ceres::Solve(options, &problem, &summary);
  return points;
}

/// From the start of the first bone to the end of the last, in the rest pose.
Vector3d OffsetOver(const std::vector<int>& way, const Skeleton& skeleton) {
  Vector3d offset = Vector3d::Zero();
  for (const int joint : way) offset += skeleton.joints[joint].rest_offset;
  return offset;
}

/// A child of a joint and, where it is unobserved, the joints that follow, as long as each has a single bone and hardly
/// rotates against it, as behind a collar: down to an observed joint. Empty where there is none, or a limb swings
/// between.
std::vector<int> PathToObserved(int child, const std::vector<bool>& seen, const std::vector<bool>& swings,
                                const std::vector<std::vector<int>>& children) {
  std::vector<int> way{child};
  while (!seen[way.back()]) {
    if (children[way.back()].size() != 1 || swings[way.back()]) return {};
    way.push_back(children[way.back()].front());
  }
  return way;
}

}  // namespace

Vector3d RoundedDirection(const Vector3d& offset) {
  const Vector3d rounded = (offset.normalized() / kDirectionRounding).array().round() * kDirectionRounding;
  return rounded.normalized() * offset.norm();
}

SkeletonPtr WithOwnDirections(const std::vector<SkeletonTracks>& clips, const SkeletonPtr& skeleton,
                              const BoneEstimate& bones, bool symmetric) {
  if (clips.empty()) return skeleton;
  std::vector<double> white;
  for (const SkeletonTracks& clip : clips) white.push_back(EstimateNoise(clip, {}).white);
  std::vector<double> noises = white;
  const double noise = MeanMedian(noises);
  auto own = std::make_shared<Skeleton>(*skeleton);
  const std::vector<std::vector<int>> children = skeleton->Children();
  const std::vector<bool> seen = ShownJoints(clips);
  const std::vector<bool> swings = SwingingJoints(*skeleton);
  for (int parent = 0; parent < skeleton->joint_count(); ++parent) {
    if (!seen[parent]) continue;
    Star star;
    std::vector<std::vector<int>> ways;  // to each end
    std::vector<int> trunk;
    for (const int child : children[parent]) {
      const std::vector<int> way = PathToObserved(child, seen, swings, children);
      const bool middle = skeleton->joints[parent].mirror == parent && skeleton->joints[child].mirror == child;
      if (way.empty() && middle && trunk.empty()) trunk = ObservedBeyond(child, *skeleton, seen);
      if (way.empty() || OffsetOver(way, *skeleton).isZero()) continue;
      if (way.size() == 1 && bones.samples[child] == 0) continue;
      star.push_back(way.back());
      ways.push_back(way);
    }
    if (star.size() < 2) continue;
    const auto count = static_cast<Eigen::Index>(star.size());
    Eigen::MatrixXd near(3, count), rest(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const int end = star[at];
      rest.col(i) = OffsetOver(ways[at], *skeleton);
      const double length = ways[at].size() == 1 ? bones.length[end] : DistanceOver(clips, white, parent, end).length;
      near.col(i) = length * rest.col(i).normalized();
    }
    const std::optional<EndDistances> distances = DistancesOf(star, near, clips, white, noise, symmetric);
    if (!distances) continue;
    const Eigen::MatrixXd start = OfTwoImages(Arranged(distances->length, near), near, star, parent, clips, symmetric);
    Eigen::MatrixXd offsets = Likeliest(*distances, near, start);
    if (IsOtherImage(offsets, start)) offsets = start;  // the prior of the rest skeleton does not overrule frames
    for (Eigen::Index i = 0; i < count; ++i) offsets.col(i) *= rest.col(i).norm() / offsets.col(i).norm();
    offsets = RotatedTo(rest, offsets);  // rotations refer to the rest pose of `skeleton`
    if (!trunk.empty()) offsets = AlignedToTrunk({parent, star, offsets}, trunk, clips, NoiseAcross(noise));
    if (!offsets.allFinite()) continue;
    for (Eigen::Index i = 0; i < count; ++i) {
      const Quaterniond swing = SwingBetween(rest.col(i), offsets.col(i));
      for (const int joint : ways[static_cast<std::size_t>(i)]) {
        own->joints[joint].rest_offset = RoundedDirection(swing * skeleton->joints[joint].rest_offset);
      }
    }
  }
  return own;
}

namespace {

/// From a joint to one below it, in the rest pose.
Vector3d RestOffsetBelow(int joint, int below, const Skeleton& skeleton) {
  Vector3d offset = Vector3d::Zero();
  for (int at = below; at != joint; at = skeleton.joints[at].parent) offset += skeleton.joints[at].rest_offset;
  return offset;
}

/// Unit vector from right to left through the ends that are mirror partners; empty without such a pair.
std::optional<Vector3d> AxisAcross(const StarOfBones& star, const Skeleton& skeleton) {
  Vector3d across = Vector3d::Zero();
  for (std::size_t i = 0; i < star.ends.size(); ++i) {
    for (std::size_t k = i + 1; k < star.ends.size(); ++k) {
      if (skeleton.joints[star.ends[i]].mirror != star.ends[k]) continue;
      across += star.offsets.col(static_cast<Eigen::Index>(i)) - star.offsets.col(static_cast<Eigen::Index>(k));
    }
  }
  if (across.isZero()) return std::nullopt;
  return across.normalized();
}

/// Distance of the end that lies farthest from an axis through the joint, metres.
double FarthestFrom(const Vector3d& axis, const Eigen::Matrix3Xd& offsets) {
  return (offsets - axis * (axis.transpose() * offsets)).colwise().norm().maxCoeff();
}

/// Mean of the trunk's points in the star's frame; empty where a frame does not show all.
std::optional<Vector3d> TrunkInStar(const StarOfBones& star, const std::vector<int>& trunk, const SkeletonTracks& clip,
                                    int frame) {
  const auto shows = [&](int joint) { return clip.seen(frame, joint) && !IsAtParent(clip, frame, joint); };
  if (!shows(star.joint) || !std::all_of(trunk.begin(), trunk.end(), shows) ||
      !std::all_of(star.ends.begin(), star.ends.end(), shows))
    return std::nullopt;
  const auto count = star.offsets.cols();
  Eigen::Matrix3Xd source(3, count + 1), target(3, count + 1);
  source << Vector3d::Zero(), star.offsets;
  target.col(0) = clip.positions.at(frame, star.joint);
  for (Eigen::Index i = 0; i < count; ++i)
    target.col(i + 1) = clip.positions.at(frame, star.ends[static_cast<std::size_t>(i)]);
  const RigidTransform world_from_star = AlignPoints(source, target, Eigen::VectorXd::Ones(count + 1));
  Vector3d away = Vector3d::Zero();
  for (const int point : trunk) away += clip.positions.at(frame, point) - clip.positions.at(frame, star.joint);
  return world_from_star.rotation.conjugate() * away;
}

}  // namespace

std::vector<int> ObservedBeyond(int child, const Skeleton& skeleton, const std::vector<bool>& seen) {
  const std::vector<std::vector<int>> children = skeleton.Children();
  std::vector<int> level{child};
  while (!level.empty()) {
    std::vector<int> shown, next;
    for (const int joint : level) {
      if (seen[joint]) shown.push_back(joint);
      next.insert(next.end(), children[joint].begin(), children[joint].end());
    }
    if (!shown.empty()) return shown;
    level = std::move(next);
  }
  return {};
}

Eigen::Matrix3Xd AlignedToTrunk(const StarOfBones& star, const std::vector<int>& trunk,
                                const std::vector<SkeletonTracks>& clips, double across) {
  if (clips.empty()) return star.offsets;
  const Skeleton& skeleton = *clips.front().skeleton;
  const std::optional<Vector3d> axis = AxisAcross(star, skeleton);
  if (!axis || FarthestFrom(*axis, star.offsets) <= across) return star.offsets;
  Vector3d rest = Vector3d::Zero();
  for (const int point : trunk) rest += RestOffsetBelow(star.joint, point, skeleton);
  const Vector3d along = (rest - axis->dot(rest) * *axis).stableNormalized();
  const Vector3d beside = axis->cross(along);
  std::vector<double> cosines, sines;
  for (const SkeletonTracks& clip : clips) {
    for (int f = 0; f < clip.frames(); ++f) {
      const std::optional<Vector3d> seen = TrunkInStar(star, trunk, clip, f);
      if (!seen) continue;
      const double length = std::hypot(along.dot(*seen), beside.dot(*seen));
      if (!(length > 0.0)) continue;
      cosines.push_back(along.dot(*seen) / length);
      sines.push_back(beside.dot(*seen) / length);
    }
  }
  if (cosines.empty()) return star.offsets;
  const double pitch = std::atan2(MeanMedian(sines), MeanMedian(cosines));
  return Eigen::AngleAxisd(-pitch, *axis).toRotationMatrix() * star.offsets;
}

}  // namespace mocurate
