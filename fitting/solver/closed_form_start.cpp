#include "fitting/solver/closed_form_start.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/pi.h"
#include "core/geometry/rigid.h"
#include "core/geometry/rotation.h"
#include "fitting/evidence/noise.h"
#include "fitting/terms/hinge.h"
#include "fitting/terms/huber.h"

namespace mocurate {
namespace {

/// rad, 1.5 pi: longer rotation vectors are not unwrapped further (numerical).
constexpr double kLargestAngle = 4.712;
/// Seconds from the nearest observation of a joint beyond which interpolation is unreliable.
constexpr double kStale_s = 0.25;

/// Positions of all observed joints in every frame: medians where observed, linear in time between, constant at the
/// ends.
JointPositions FillInTime(const SkeletonTracks& tracks) {
  JointPositions filled(tracks.frames(), tracks.joints());
  for (int j = 0; j < tracks.joints(); ++j) {
    int last = -1;
    for (int f = 0; f < tracks.frames(); ++f) {
      if (!tracks.seen(f, j)) continue;
      filled.at(f, j) = RunningMedian(tracks, f, j);
      for (int g = last + 1; g < f; ++g) {
        if (last < 0) {
          filled.at(g, j) = filled.at(f, j);
          continue;
        }
        const double a = (tracks.time_s[g] - tracks.time_s[last]) / (tracks.time_s[f] - tracks.time_s[last]);
        filled.at(g, j) = (1.0 - a) * filled.at(last, j) + a * filled.at(f, j);
      }
      last = f;
    }
    if (last < 0) continue;
    for (int g = last + 1; g < tracks.frames(); ++g) filled.at(g, j) = filled.at(last, j);
  }
  return filled;
}

/// Whether each joint is observed in a frame or at most kStale_s from it. (F*J)
std::vector<bool> ObservedRecently(const SkeletonTracks& tracks) {
  std::vector<bool> lately(tracks.confidence.size(), false);
  const auto mark = [&](int joint, int begin, int end, int step) {
    double seen_s = -std::numeric_limits<double>::infinity();
    for (int f = begin; f != end; f += step) {
      if (tracks.seen(f, joint)) seen_s = tracks.time_s[f];
      if (std::abs(tracks.time_s[f] - seen_s) > kStale_s) continue;
      lately[static_cast<std::size_t>(f) * tracks.joints() + joint] = true;
    }
  };
  for (int j = 0; j < tracks.joints(); ++j) {
    mark(j, 0, tracks.frames(), 1);
    mark(j, tracks.frames() - 1, -1, -1);
  }
  return lately;
}

/// The frame that shows most joints.
int FullestFrame(const SkeletonTracks& tracks) {
  int fullest = 0;
  int most = -1;
  for (int f = 0; f < tracks.frames(); ++f) {
    int seen = 0;
    for (int j = 0; j < tracks.joints(); ++j) seen += tracks.seen(f, j) ? 1 : 0;
    if (seen <= most) continue;
    fullest = f;
    most = seen;
  }
  return fullest;
}

/// Share of the distance of targets: with a smaller standard deviation across their common line they determine no
/// rotation about it.
constexpr double kAcrossLine = 0.05;
constexpr double kFarOffHinge = 0.35;   ///< sine of the angle from which a hinge bends the wrong way
constexpr int kTwistSteps = 24;         ///< steps of a whole turn, each tried (numerical)
constexpr double kTwistGain = 0.02;     ///< sine; gain in distance from the hinge that justifies a larger twist
constexpr double kFartherWeight = 0.1;  ///< weight of a target beyond another joint, which may rotate itself

/// Target of a joint's rotation: below each child the nearest observed joint, and its rest position.
struct Target {
  int joint;
  Vector3d rest_in_joint;
  double weight = 1.0;
};

void AppendTarget(const Skeleton& skeleton, const std::vector<std::vector<int>>& children,
                  const std::vector<bool>& seen, const PoseState& state, int joint, const Vector3d& rest,
                  std::vector<Target>& targets) {
  const Vector3d here = rest + *state.bone(joint) * skeleton.joints[joint].rest_offset.stableNormalized();
  if (seen[joint]) {
    targets.push_back({joint, here});
    return;
  }
  for (const int child : children[joint]) AppendTarget(skeleton, children, seen, state, child, here, targets);
}

/// Whether all targets lie on one line, which must pass through the joint unless the joint is unobserved (`alone`).
/// Examples: the collars of a chest, the hips of an unobserved pelvis.
bool OnOneLine(const std::vector<Target>& targets, bool alone) {
  Vector3d on_line = Vector3d::Zero();
  for (const Target& target : targets) on_line += target.rest_in_joint / static_cast<double>(targets.size());
  if (!alone) on_line.setZero();
  Matrix3d scatter = Matrix3d::Zero();
  for (const Target& target : targets) {
    const Vector3d from_line = target.rest_in_joint - on_line;
    scatter += from_line * from_line.transpose();
  }
  const Vector3d values = Eigen::SelfAdjointEigenSolver<Matrix3d>(scatter, Eigen::EigenvaluesOnly).eigenvalues();
  return values[1] <= kAcrossLine * kAcrossLine * values[2];
}

class ClosedFormPose {
 public:
  ClosedFormPose(const SkeletonTracks& tracks, PoseState& state)
      : skeleton_(*tracks.skeleton),
        state_(state),
        seen_(tracks.JointObservations()),
        lately_(ObservedRecently(tracks)),
        hinges_(HingesOf(skeleton_)),
        targets_(skeleton_.joints.size()),
        global_(skeleton_.joints.size(), Quaterniond::Identity()),
        position_(skeleton_.joints.size(), Vector3d::Zero()) {
    const std::vector<std::vector<int>> children = skeleton_.Children();
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      for (const int child : children[j]) {
        AppendTarget(skeleton_, children, seen_, state, child, Vector3d::Zero(), targets_[j]);
      }
      const std::size_t near = targets_[j].size();
      if (near < 2 || !OnOneLine(targets_[j], j == 0 && !seen_[0])) continue;
      for (std::size_t i = 0; i < near; ++i) {
        const Target target = targets_[j][i];
        for (const int child : children[target.joint]) {
          AppendTarget(skeleton_, children, seen_, state, child, target.rest_in_joint, targets_[j]);
        }
      }
      for (std::size_t i = near; i < targets_[j].size(); ++i) targets_[j][i].weight = kFartherWeight;
    }
  }

  /// `filled`: positions of the observed joints in this frame; `near`: the frame solved before, or -1.
  void Solve(const JointPositions& filled, int frame, int near) {
    if (near < 0 && !Lately(frame, 0)) position_[0] = MiddleOfSeen(filled, frame);
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      const int parent = skeleton_.joints[j].parent;
      const Quaterniond above = parent < 0 ? global_[0] : global_[parent];  // root: of the frame before
      if (parent >= 0) {
        const Vector3d direction = skeleton_.joints[j].rest_offset.stableNormalized();
        position_[j] = position_[parent] + above * (*state_.bone(j) * direction);
      } else if (seen_[j]) {
        position_[j] = filled.at(frame, j);
      }
      global_[j] = state_.active(j) ? RotationOf(filled, frame, j, above) : above;
      if (parent < 0) Eigen::Map<Vector3d>(state_.translation(frame)).noalias() = position_[j];
      if (state_.active(j)) Write(frame, near, j, parent < 0 ? global_[j] : above.conjugate() * global_[j]);
    }
  }

 private:
  /// Global rotation of a joint, as near to `above` as its targets allow; of several targets, stale ones are ignored.
  /// Places an unobserved root.
  Quaterniond RotationOf(const JointPositions& filled, int frame, int joint, const Quaterniond& above) {
    std::vector<Target> targets;
    for (const Target& target : targets_[joint]) {
      if (targets_[joint].size() == 1 || Lately(frame, target.joint)) targets.push_back(target);
    }
    if (targets.empty()) return above;
    const bool free_root = joint == 0 && !Lately(frame, 0);
    const Vector3d pivot = Lately(frame, joint) ? Vector3d(filled.at(frame, joint)) : position_[joint];
    if (targets.size() == 1) {
      const Vector3d rest = above * targets[0].rest_in_joint;
      const Vector3d target = filled.at(frame, targets[0].joint);
      if (free_root) position_[0] = target - rest;
      if (free_root) return above;
      const Quaterniond turned = (SwingBetween(rest, target - pivot) * above).normalized();
      return TwistedToHinge(filled, frame, targets[0].joint, (target - pivot).stableNormalized(), turned);
    }
    const auto count = static_cast<Eigen::Index>(targets.size());
    Eigen::Matrix3Xd source(3, count + 1);
    Eigen::Matrix3Xd target(3, count + 1);
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(count + 1);
    source.col(count).setZero();
    target.col(count) = pivot;
    if (free_root) {
      target.col(count).setZero();
      weights[count] = 0.0;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      source.col(i) = above * targets[i].rest_in_joint;
      target.col(i) = filled.at(frame, targets[i].joint);
      weights[i] = targets[i].weight;
    }
    const RigidTransform world_from_rest = AlignPoints(source, target, weights);
    if (free_root) position_[0] = world_from_rest.translation;
    return (world_from_rest.rotation * above).normalized();
  }

  /// Violation of the hinge (OffHinge) of a joint with one observed joint below, given its parent's rotation. Negative
  /// where it is undetermined.
  double BentOffHinge(const JointPositions& filled, int frame, int joint, const Quaterniond& parent) const {
    if (!hinges_[joint] || targets_[joint].size() != 1 || !Lately(frame, joint) ||
        !Lately(frame, targets_[joint][0].joint))
      return -1.0;
    const Vector3d below = filled.at(frame, targets_[joint][0].joint) - filled.at(frame, joint);
    const Quaterniond bend = SwingBetween(targets_[joint][0].rest_in_joint, parent.conjugate() * below);
    return OffHinge(*hinges_[joint], bend.toRotationMatrix()).norm();
  }

  /// Rotation of a joint whose only bone, along `bone`, ends in a hinge. The twist about that bone, which positions do
  /// not determine, is changed where the joint below would else bend far off its hinge, as for sitting cross-legged.
  Quaterniond TwistedToHinge(const JointPositions& filled, int frame, int hinge, const Vector3d& bone,
                             const Quaterniond& turned) const {
    double least = BentOffHinge(filled, frame, hinge, turned);
    if (least < kFarOffHinge) return turned;
    Quaterniond best = turned;
    for (int step = 1; step <= kTwistSteps / 2; ++step) {
      for (const double side : {1.0, -1.0}) {
        const double angle = side * 2.0 * kPi * step / kTwistSteps;
        const Quaterniond twisted = (Quaterniond(Eigen::AngleAxisd(angle, bone)) * turned).normalized();
        const double off = BentOffHinge(filled, frame, hinge, twisted);
        if (off >= least - kTwistGain) continue;
        least = off;
        best = twisted;
      }
    }
    return best;
  }

  /// Mean of the recently observed joints; the origin without any.
  Vector3d MiddleOfSeen(const JointPositions& filled, int frame) const {
    Vector3d sum = Vector3d::Zero();
    int count = 0;
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      if (!Lately(frame, j)) continue;
      sum += filled.at(frame, j);
      ++count;
    }
    return sum / std::max(count, 1);
  }

  bool Lately(int frame, int joint) const {
    return lately_[static_cast<std::size_t>(frame) * static_cast<std::size_t>(skeleton_.joint_count()) + joint];
  }

  void Write(int frame, int near, int joint, const Quaterniond& rotation) {
    Vector3d w = LogQuaternion(rotation);
    if (near >= 0) {
      const Vector3d unwrapped = UnwrapNear(w, Eigen::Map<const Vector3d>(state_.rotation(near, joint)));
      if (unwrapped.norm() < kLargestAngle) w = unwrapped;
    }
    Eigen::Map<Vector3d>(state_.rotation(frame, joint)).noalias() = w;
  }

  const Skeleton& skeleton_;
  PoseState& state_;
  std::vector<bool> seen_;
  std::vector<bool> lately_;                  ///< (F*J)
  std::vector<std::optional<Hinge>> hinges_;  ///< (J)
  std::vector<std::vector<Target>> targets_;
  std::vector<Quaterniond> global_;
  std::vector<Vector3d> position_;
};

}  // namespace

std::vector<bool> JointsWithEvidenceBelow(const SkeletonTracks& tracks) {
  const std::vector<bool> seen = tracks.JointObservations();
  std::vector<bool> below(seen.size(), false);
  for (std::size_t i = 0; i < tracks.rotation_confidence.size(); ++i) {
    const int frame = static_cast<int>(i / seen.size());
    const int joint = static_cast<int>(i % seen.size());
    if (tracks.rotation_confidence[i] > 0.0 && tracks.seen(frame, joint)) below[joint] = true;
  }
  for (int j = tracks.joints() - 1; j > 0; --j) {
    if (seen[j] || below[j]) below[tracks.skeleton->joints[j].parent] = true;
  }
  return below;
}

void ClosedFormStart(const SkeletonTracks& tracks, PoseState& state) {
  const JointPositions filled = FillInTime(tracks);
  const int first = FullestFrame(tracks);
  ClosedFormPose forwards(tracks, state);
  forwards.Solve(filled, first, -1);
  ClosedFormPose backwards = forwards;
  for (int f = first + 1; f < tracks.frames(); ++f) forwards.Solve(filled, f, f - 1);
  for (int f = first - 1; f >= 0; --f) backwards.Solve(filled, f, f + 1);
}

}  // namespace mocurate
