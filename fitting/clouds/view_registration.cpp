#include "fitting/clouds/view_registration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/pi.h"
#include "core/base/text.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/depth_pose_graph.h"

namespace mocurate {
namespace {

constexpr double kRegistrationScale = 0.02;  ///< m, scale of the loss
/// m; scales of the loss, decreasing, each with its largest number of steps (numerical).
constexpr std::array<std::pair<double, int>, 4> kSchedule = {{{0.08, 4}, {0.05, 4}, {0.03, 4}, {0.02, 8}}};
/// Loss below which views need no wide scales.
constexpr double kNearLoss = 0.15;
constexpr double kNearScale = 0.03;                ///< m; largest scale then
constexpr double kRest = 5e-4;                     ///< m and rad; a shorter step ends a scale (numerical)
constexpr double kLongestRegistrationStep = 0.15;  ///< m and rad; longest step (numerical)
constexpr double kPlaceSpread = 0.5;               ///< m and rad; weak prior on the camera poses (numerical)
/// Of the mean of an edge's information: regularises undetermined directions (numerical).
constexpr double kLevelInformation = 1e-6;

/// Vector of rotation and translation of a move about a centre.
Vector6d VectorOf(const RigidTransform& move, const Vector3d& centre) {
  Vector6d vector;
  vector << LogQuaternion(move.rotation), move * centre - centre;
  return vector;
}

/// Inverse of VectorOf, with the centre as origin.
RigidTransform MoveOf(const Vector6d& vector) { return {ExpQuaternion(vector.head<3>()), vector.tail<3>()}; }

RigidTransform AboutCentre(const RigidTransform& move, const Vector3d& centre) {
  return {move.rotation, move.translation + centre - move.rotation * centre};
}

/// Move of the camera's points from their world position in `given` to that in `other`.
RigidTransform TotalMove(const Camera& given, const Camera& other) {
  return Inverse(other.camera_from_world) * given.camera_from_world;
}

/// Normal equations of the relative move of two nodes.
struct Tie {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

class Registration {
 public:
  Registration(const ObservedRig& rig, const std::vector<bool>& free, std::vector<Camera> from)
      : rig_(rig), given_(CamerasOf(rig.views)), cameras_(std::move(from)) {
    for (std::size_t v = 0; v < free.size(); ++v) node_.push_back(free[v] ? ++nodes_ : 0);
    ++nodes_;
  }

  Expected<std::vector<Camera>> Run() {
    const bool near = MeanLoss(LossOfSamples(rig_, cameras_)) < kNearLoss;
    for (const auto& [scale, steps] : kSchedule) {
      if (near && scale > kNearScale) continue;
      for (int step = 0; step < steps; ++step) {
        const Expected<double> moved = Step(scale);
        if (!moved) return Forward(moved);
        if (*moved < kRest) break;
      }
    }
    return cameras_;
  }

 private:
  /// One step; returns the largest move of a camera.
  Expected<double> Step(double scale) {
    const std::vector<PoseEdge> edges = Edges(scale);
    const Expected<std::vector<RigidTransform>> moves = SolvePoseGraph(nodes_, edges);
    if (!moves) return Forward(moves);
    double most = 0.0;
    for (std::size_t v = 0; v < node_.size(); ++v) {
      if (node_[v] == 0) continue;
      const RigidTransform& move = (*moves)[node_[v]];
      most = std::max(most, VectorOf(move, Vector3d::Zero()).lpNorm<Eigen::Infinity>());
      RigidTransform& pose = cameras_[v].camera_from_world;
      pose = pose * Inverse(AboutCentre(move, rig_.centre));
      pose.rotation.normalize();
    }
    return most;
  }

  std::vector<PoseEdge> Edges(double scale) const {
    std::vector<Tie> ties(nodes_ * nodes_);  // for free nodes a > b
    for (const auto& [a, b] : rig_.pairs) {
      if (node_[a] == node_[b]) continue;
      const bool exchanged = node_[a] < node_[b];
      const std::size_t moved = exchanged ? b : a, still = exchanged ? a : b;
      Tie& tie = ties[node_[moved] * nodes_ + node_[still]];
      for (const ObservedMoment& moment : rig_.moments) {
        if (moment[a] == nullptr || moment[b] == nullptr) continue;
        const PlacedSurface of_moved{*moment[moved], rig_.views[moved], cameras_[moved]};
        const PlacedSurface of_still{*moment[still], rig_.views[still], cameras_[still]};
        const Agreement there = Compare(of_moved, of_still, rig_.centre, scale);
        const Agreement back = Compare(of_still, of_moved, rig_.centre, scale);
        tie.information += there.information + back.information;
        tie.gradient += there.gradient - back.gradient;
      }
    }
    for (std::size_t v = 0; v < node_.size(); ++v) {
      if (node_[v] == 0) continue;
      Tie& tie = ties[node_[v] * nodes_];
      const double weight = scale * scale / (kPlaceSpread * kPlaceSpread);
      tie.information.diagonal().array() += weight;
      tie.gradient += weight * VectorOf(TotalMove(given_[v], cameras_[v]), rig_.centre);
    }
    std::vector<PoseEdge> edges;
    for (std::size_t moved = 1; moved < nodes_; ++moved) {
      for (std::size_t still = 0; still < moved; ++still) {
        const Tie& tie = ties[moved * nodes_ + still];
        const double level = kLevelInformation * tie.information.trace() / 6.0;
        if (level <= 0.0) continue;
        Matrix6d information = tie.information;
        information.diagonal().array() += level;
        Vector6d step = -information.ldlt().solve(tie.gradient);
        step *= std::min(1.0, kLongestRegistrationStep / std::max(step.lpNorm<Eigen::Infinity>(), 1e-12));
        edges.push_back({moved, still, MoveOf(step), information});
      }
    }
    return edges;
  }

  const ObservedRig& rig_;
  std::vector<Camera> given_, cameras_;
  std::vector<std::size_t> node_;
  std::size_t nodes_ = 0;
};

}  // namespace

std::vector<Camera> CamerasOf(const std::vector<DepthView>& views) {
  std::vector<Camera> cameras;
  for (const DepthView& view : views) cameras.push_back(view.camera);
  return cameras;
}

std::vector<double> LossOfSamples(const ObservedRig& rig, const std::vector<Camera>& cameras) {
  const auto together = static_cast<std::size_t>(rig.together);
  std::vector<double> losses;
  for (std::size_t begin = 0; begin < rig.moments.size(); begin += together) {
    for (const auto& [a, b] : rig.pairs) {
      double loss = 0.0, points = 0.0;
      for (std::size_t m = begin; m < begin + together; ++m) {
        const ObservedMoment& moment = rig.moments[m];
        if (moment[a] == nullptr || moment[b] == nullptr) continue;
        const PlacedSurface first{*moment[a], rig.views[a], cameras[a]};
        const PlacedSurface second{*moment[b], rig.views[b], cameras[b]};
        const Agreement there = Compare(first, second, rig.centre, kRegistrationScale);
        const Agreement back = Compare(second, first, rig.centre, kRegistrationScale);
        loss += there.loss + back.loss;
        points += there.points + back.points;
      }
      losses.push_back(points > 0.0 ? loss / points : kNotObserved);
    }
  }
  return losses;
}

double MeanLoss(const std::vector<double>& losses) {
  double sum = 0.0, count = 0.0;
  for (const double loss : losses) {
    if (loss < 0.0) continue;
    sum += loss;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

double ConfidenceOfLosses(const ObservedRig& rig, const std::vector<double>& worse, const std::vector<double>& better,
                          std::optional<std::size_t> view) {
  std::vector<double> was, is, was_of_groups, is_of_groups;
  const std::size_t pairs = rig.pairs.size();
  for (std::size_t begin = 0; begin < worse.size(); begin += pairs) {
    double was_sum = 0.0, is_sum = 0.0, count = 0.0;
    for (std::size_t i = begin; i < begin + pairs; ++i) {
      const auto& [a, b] = rig.pairs[i - begin];
      if (worse[i] < 0.0 || better[i] < 0.0 || (view && a != *view && b != *view)) continue;
      was.push_back(worse[i]), is.push_back(better[i]);
      was_sum += worse[i], is_sum += better[i], count += 1.0;
    }
    if (count > 0.0) was_of_groups.push_back(was_sum / count), is_of_groups.push_back(is_sum / count);
  }
  const double of_samples = ConfidenceOfSeparate(was, is);
  return worse.size() == pairs ? of_samples : std::min(of_samples, ConfidenceOfSeparate(was_of_groups, is_of_groups));
}

Expected<std::vector<Camera>> Register(const ObservedRig& rig, const std::vector<bool>& free,
                                       std::vector<Camera> from) {
  return Registration(rig, free, std::move(from)).Run();
}

std::vector<int> HalvesOfSamples(const ObservedRig& rig) {
  const std::size_t pairs = rig.pairs.size(), groups = rig.moments.size() / static_cast<std::size_t>(rig.together);
  std::vector<int> halves;
  for (std::size_t i = 0; i < groups * pairs; ++i) halves.push_back(static_cast<int>((groups > 1 ? i / pairs : i) % 2));
  return halves;
}

Expected<std::vector<std::vector<Camera>>> RegisterHalves(const ObservedRig& rig, const std::vector<bool>& free,
                                                          const std::vector<Camera>& from) {
  const auto together = static_cast<std::size_t>(rig.together);
  const bool by_groups = rig.moments.size() > together;
  std::vector<std::vector<Camera>> of_half;
  for (std::size_t half = 0; half < 2; ++half) {
    ObservedRig some = rig;
    some.moments.clear(), some.pairs.clear();
    for (std::size_t m = 0; m < rig.moments.size(); ++m) {
      if (!by_groups || m / together % 2 == half) some.moments.push_back(rig.moments[m]);
    }
    for (std::size_t p = 0; p < rig.pairs.size(); ++p) {
      if (by_groups || p % 2 == half) some.pairs.push_back(rig.pairs[p]);
    }
    Expected<std::vector<Camera>> found = Register(some, free, from);
    if (!found) return Forward(found);
    of_half.push_back(std::move(*found));
  }
  return of_half;
}

std::vector<double> HeldOutLosses(const ObservedRig& rig, const std::vector<std::vector<Camera>>& of_half) {
  const std::vector<int> halves = HalvesOfSamples(rig);
  std::vector<double> losses = LossOfSamples(rig, of_half[1]);
  const std::vector<double> of_second = LossOfSamples(rig, of_half[0]);
  for (std::size_t i = 0; i < losses.size(); ++i) {
    if (halves[i] == 1) losses[i] = of_second[i];
  }
  return losses;
}

CameraMoveAt MoveBetween(const Camera& given, const Camera& other, const Vector3d& centre) {
  const Vector6d move = VectorOf(TotalMove(given, other), centre);
  return {move.tail<3>().norm(), move.head<3>().norm()};
}

RigFault CameraMoved(const Camera& was, const Camera& is, const Vector3d& centre) {
  constexpr double kMovedAlongSight = 0.95;  ///< share of a move along the line of sight, from which wrong depths
                                             ///< explain it as well
  constexpr double kStraight = 0.05;         ///< rad; a depth offset does not explain larger rotations
  const CameraMoveAt move = MoveBetween(was, is, centre);
  const Vector3d way = is.Centre() - was.Centre();
  const double along = way.dot((centre - was.Centre()).normalized());
  const bool of_depths = std::abs(along) >= kMovedAlongSight * way.norm() && move.turn < kStraight;
  const double moved_mm = 1e3 * way.norm();
  return MakeFault("camera_moved", was.name, moved_mm,
                   "depth camera " + was.name + " stands " + RoundedText(moved_mm, 3) + " mm and " +
                       RoundedText(kDegrees * move.turn, 2) +
                       " degrees from its calibrated pose, which moves the person by " +
                       RoundedText(1e3 * move.shift, 3) + " mm" +
                       (!of_depths ? ""
                                   : "; the move is along its line of sight: instead, its depths may be too " +
                                         std::string(along > 0.0 ? "short" : "long")));
}

}  // namespace mocurate
