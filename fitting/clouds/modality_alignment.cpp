#include "fitting/clouds/modality_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/median.h"
#include "core/geometry/rotation.h"
#include "fitting/clouds/cloud_match.h"

namespace mocurate {
namespace {

constexpr double kAlignmentScale = 0.03;   ///< m, of the robust loss: beyond, a point is an outlier
constexpr double kFarApart = 0.15;         ///< m; people farther apart are first moved to the same position
constexpr double kBodyPatchPoints = 10.0;  ///< points that share an error of the body
constexpr int kAlignmentRounds = 8;        ///< Gauss-Newton steps, at most (numerical)
constexpr int kWideRounds = 4;             ///< rounds with a wider reach (numerical)
constexpr double kWide = 3.0;              ///< factor on the reach, in the first of these rounds (numerical)
constexpr double kUsualMove = 0.5;         ///< m; standard deviation of the prior on the translation
constexpr double kUsualRotation = 0.3;     ///< rad; likewise, on the rotation
constexpr double kUsualDelay = 0.25;       ///< s; likewise, on the delay

/// Translation and rotation about the centre of the person, and delay.
using Unknowns = Eigen::Matrix<double, 7, 1>;

struct Placement {
  Quaterniond rotation = Quaterniond::Identity();
  Vector3d move = Vector3d::Zero();
  double late_s = 0.0;
};

/// The unknowns to estimate.
struct Free {
  bool move = false;
  bool delay = false;
};

double MeanExtent(const Eigen::Matrix3Xd& points) {
  return std::sqrt((points.colwise() - points.rowwise().mean()).colwise().squaredNorm().mean());
}

class Aligner {
 public:
  Aligner(const CapsuleBody& body, const PoseState& state, const std::vector<bool>& known,
          const std::vector<FusedCloud>& clouds, const std::vector<int>& frames, double step_s)
      : body_(body), state_(state), known_(known), clouds_(clouds), frames_(frames), step_s_(step_s) {
    for (const int f : frames_) centre_ += JointsAt(f).rowwise().mean() / static_cast<double>(frames_.size());
  }

  Eigen::Matrix3Xd JointsAt(int frame) const {
    Eigen::Matrix3Xd joints(3, state_.joints());
    for (int j = 0; j < state_.joints(); ++j) joints.col(j) = state_.position(frame, j);
    return joints;
  }

  RigidTransform Transform(const Placement& placement) const {
    return {placement.rotation, centre_ + placement.move - placement.rotation * centre_};
  }

  /// Mean loss in [0, 1] and share of the points within reach.
  struct Explained {
    double loss = 1.0;
    double near = 0.0;
  };
  Explained Explain(const Placement& placement, double reach) const {
    double loss = 0.0, near = 0.0, all = 0.0;
    for (const int f : frames_) {
      const std::optional<int> shown = Shown(f, placement.late_s);
      if (!shown) continue;
      const FusedCloud cloud = Moved(clouds_[static_cast<std::size_t>(f)], Transform(placement));
      const std::vector<CloudMatch> matches = MatchPoints(body_, state_, *shown, cloud, reach);
      all += cloud.size();
      loss += cloud.size() - static_cast<double>(matches.size());
      const double rest = placement.late_s - step_s_ * (f - *shown);
      for (const CloudMatch& match : matches) {
        if (!Known(match)) {
          all -= 1.0;
          continue;
        }
        near += 1.0;
        const double r = match.distance + rest * Across(match, *shown, cloud).speed;
        loss += r * r / (r * r + kAlignmentScale * kAlignmentScale);
      }
    }
    return all > 0.0 ? Explained{loss / all, near / all} : Explained{};
  }

  /// One Gauss-Newton step of the free unknowns; returns their information.
  Eigen::Matrix<double, 7, 7> Improve(double reach, Free free, Placement& placement) const {
    Eigen::Matrix<double, 7, 7> matrix = Eigen::Matrix<double, 7, 7>::Zero();
    Unknowns right = Unknowns::Zero();
    for (const int f : frames_) {
      const std::optional<int> shown = Shown(f, placement.late_s);
      if (!shown) continue;
      const FusedCloud cloud = Moved(clouds_[static_cast<std::size_t>(f)], Transform(placement));
      const double rest = placement.late_s - step_s_ * (f - *shown);
      for (const CloudMatch& match : MatchPoints(body_, state_, *shown, cloud, reach)) {
        if (!Known(match)) continue;
        const Surface at = Across(match, *shown, cloud);
        const double r = match.distance + rest * at.speed;
        const double weight =
            std::pow(kAlignmentScale * kAlignmentScale / (r * r + kAlignmentScale * kAlignmentScale), 2) /
            (kBodyPatchPoints * kAlignmentScale * kAlignmentScale);
        Unknowns row;
        row << at.out, (Vector3d(cloud.points.col(match.point)) - centre_ - placement.move).cross(at.out), at.speed;
        if (!free.move) row.head<6>().setZero();
        if (!free.delay) row[6] = 0.0;
        matrix.noalias() += weight * row * row.transpose();
        right.noalias() -= weight * r * row;
      }
    }
    const Vector3d turned = LogQuaternion(placement.rotation);
    for (int i = 0; i < 7; ++i) {
      const double usual = i < 3 ? kUsualMove : i < 6 ? kUsualRotation : kUsualDelay;
      const double now = i < 3 ? placement.move[i] : i < 6 ? turned[i - 3] : placement.late_s;
      matrix(i, i) += 1.0 / (usual * usual);
      right[i] -= now / (usual * usual);
    }
    const Unknowns step = matrix.ldlt().solve(right);
    placement.move += step.head<3>();
    placement.rotation = (ExpQuaternion(step.segment<3>(3)) * placement.rotation).normalized();
    placement.late_s += step[6];
    return matrix;
  }

 private:
  /// The surface matched to a point: outward normal, and its inward speed.
  struct Surface {
    Vector3d out = Vector3d::Zero();
    double speed = 0.0;  ///< m/s by which the point's distance grows per second of delay
  };

  bool Known(const CloudMatch& match) const {
    return known_[static_cast<std::size_t>(body_.capsules[match.capsule].end_joint)];
  }

  /// The frame of the poses nearest to the time that a cloud shows.
  std::optional<int> Shown(int frame, double late_s) const {
    const int shown = frame - static_cast<int>(std::lround(late_s / step_s_));
    if (shown < 0 || shown >= state_.frames()) return std::nullopt;
    return shown;
  }

  Surface Across(const CloudMatch& match, int frame, const FusedCloud& cloud) const {
    const BodyCapsule& capsule = body_.capsules[match.capsule];
    const CapsuleEnds ends = EndsOf(capsule, state_, frame);
    const Vector3d point = cloud.points.col(match.point);
    const double place = PlaceOnAxis(ends.begin, ends.end, point);
    Surface surface;
    surface.out = (point - ends.begin - place * (ends.end - ends.begin)).stableNormalized();
    const int before = std::max(0, frame - 1), after = std::min(state_.frames() - 1, frame + 1);
    if (after == before) return surface;
    const auto at = [&](int f) {
      const CapsuleEnds moved = EndsOf(capsule, state_, f);
      return Vector3d(moved.begin + place * (moved.end - moved.begin));
    };
    surface.speed = surface.out.dot(at(after) - at(before)) / (step_s_ * (after - before));
    return surface;
  }

  const CapsuleBody& body_;
  const PoseState& state_;
  const std::vector<bool>& known_;
  const std::vector<FusedCloud>& clouds_;
  const std::vector<int>& frames_;
  double step_s_;
  Vector3d centre_ = Vector3d::Zero();
};

/// Initial delay in whole frames: the one with the lowest loss, or 0 without a clear minimum.
double FirstDelay(const Aligner& aligner, const Placement& placement, double step_s, double longest_s, double reach) {
  /// Share of the loss without a delay, at most: otherwise the search starts at no delay.
  constexpr double kClearly = 0.95;
  const int most = static_cast<int>(longest_s / step_s);
  const int stride = std::max(1, most / 8);
  double best_loss = kClearly * aligner.Explain(placement, reach).loss, best = 0.0;
  for (int k = -most; k <= most; k += stride) {
    Placement later = placement;
    later.late_s = k * step_s;
    const double loss = aligner.Explain(later, reach).loss;
    if (loss >= best_loss) continue;
    best_loss = loss;
    best = later.late_s;
  }
  return best;
}

}  // namespace

FusedCloud Moved(const FusedCloud& cloud, const RigidTransform& transform) {
  const Matrix3d rotation = transform.rotation.toRotationMatrix();
  FusedCloud moved = cloud;
  moved.points = (rotation * cloud.points).colwise() + transform.translation;
  moved.normals = rotation * cloud.normals;
  return moved;
}

ModalityAlignment AlignModalities(const CapsuleBody& body, const PoseState& state, const std::vector<bool>& known,
                                  const std::vector<FusedCloud>& clouds, const std::vector<int>& frames, double step_s,
                                  double longest_s, double reach) {
  const Aligner aligner(body, state, known, clouds, frames, step_s);
  ModalityAlignment found;
  if (frames.empty()) return found;
  std::vector<double> apart[3], far, sizes;
  for (const int f : frames) {
    const Eigen::Matrix3Xd joints = aligner.JointsAt(f);
    const Eigen::Matrix3Xd& points = clouds[static_cast<std::size_t>(f)].points;
    const Vector3d way = joints.rowwise().mean() - points.rowwise().mean();
    for (int i = 0; i < 3; ++i) apart[i].push_back(way[i]);
    far.push_back(way.norm());
    sizes.push_back(MeanExtent(points) / std::max(1e-9, MeanExtent(joints)));
  }
  found.apart = MeanMedian(far);
  found.size_ratio = MeanMedian(sizes);
  const Aligner::Explained given = aligner.Explain({}, reach);
  found.near = found.near_after = given.near;
  found.loss = given.loss;
  const auto settle = [&](Free free, double wide, Placement& placement) {
    Eigen::Matrix<double, 7, 7> information;
    for (int round = 0; round < kAlignmentRounds; ++round) {
      const double widening = 1.0 + (wide - 1.0) * std::max(0.0, 1.0 - static_cast<double>(round) / kWideRounds);
      information = aligner.Improve(widening * reach, free, placement);
      placement.late_s = std::clamp(placement.late_s, -longest_s, longest_s);
    }
    const Eigen::Matrix<double, 7, 7> covariance = information.inverse();
    const Aligner::Explained explained = aligner.Explain(placement, reach);
    found.near_after = std::max(found.near_after, explained.near);
    ModalityAlignment::Taken taken;
    taken.world_from_clouds = aligner.Transform(placement);
    taken.moved = placement.move.norm();
    taken.turned = LogQuaternion(placement.rotation).norm();
    taken.late_s = placement.late_s;
    taken.moved_sigma = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
    taken.clock_offset_sigma = std::sqrt(covariance(6, 6));
    taken.loss = explained.loss;
    return taken;
  };
  Placement still;
  if (found.apart > kFarApart) still.move = Vector3d(MeanMedian(apart[0]), MeanMedian(apart[1]), MeanMedian(apart[2]));
  found.moved = settle({true, false}, kWide, still);
  Placement late, both = still;
  late.late_s = FirstDelay(aligner, late, step_s, longest_s, reach);
  found.late = settle({false, true}, 1.0, late);
  both.late_s = FirstDelay(aligner, still, step_s, longest_s, reach);
  found.both = settle({true, true}, 1.0, both);
  // Start from the result with delay alone: a translation can imitate a delay and hide it.
  Placement after_late = late;
  const ModalityAlignment::Taken other = settle({true, true}, 1.0, after_late);
  if (other.loss < found.both.loss) found.both = other;
  return found;
}

}  // namespace mocurate
