#include "fitting/solver/closed_form_start.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/geometry/rigid.h"
#include "fitting/evidence/outliers.h"

namespace mocurate {
namespace {

constexpr double kLargestAngle = 4.712;  ///< 1.5 pi

/// Every seen joint in every frame: medians where seen, between them linear in time, at the ends constant.
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

/// Targets that spread across their common line by less than this share of their distance tell no turn about it.
constexpr double kAcrossLine = 0.05;
constexpr double kFartherWeight = 0.1;  ///< of a target beyond another joint, which may turn itself

/// What a joint's rotation is read from: below each child the nearest seen joint, and where it lies at rest.
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

/// Whether all targets lie on one line through the joint, as the collars of a chest from whose top they start.
bool OnOneLine(const std::vector<Target>& targets) {
  Matrix3d spread = Matrix3d::Zero();
  for (const Target& target : targets) spread += target.rest_in_joint * target.rest_in_joint.transpose();
  const Vector3d values = Eigen::SelfAdjointEigenSolver<Matrix3d>(spread, Eigen::EigenvaluesOnly).eigenvalues();
  return values[1] <= kAcrossLine * kAcrossLine * values[2];
}

class ClosedFormPose {
 public:
  ClosedFormPose(const SkeletonTracks& tracks, PoseState& state)
      : skeleton_(*tracks.skeleton),
        state_(state),
        seen_(tracks.SeenJoints()),
        targets_(skeleton_.joints.size()),
        global_(skeleton_.joints.size(), Quaterniond::Identity()),
        position_(skeleton_.joints.size()) {
    const std::vector<std::vector<int>> children = skeleton_.Children();
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      for (const int child : children[j]) {
        AppendTarget(skeleton_, children, seen_, state, child, Vector3d::Zero(), targets_[j]);
      }
      const std::size_t near = targets_[j].size();
      if (near < 2 || !OnOneLine(targets_[j])) continue;
      for (std::size_t i = 0; i < near; ++i) {
        const Target target = targets_[j][i];
        for (const int child : children[target.joint]) {
          AppendTarget(skeleton_, children, seen_, state, child, target.rest_in_joint, targets_[j]);
        }
      }
      for (std::size_t i = near; i < targets_[j].size(); ++i) targets_[j][i].weight = kFartherWeight;
    }
  }

  /// `filled`: positions of the seen joints in this frame.
  void Solve(const JointPositions& filled, int frame) {
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      const int parent = skeleton_.joints[j].parent;
      const Quaterniond above = parent < 0 ? global_[0] : global_[parent];  // root: of the frame before
      if (parent >= 0) {
        const Vector3d direction = skeleton_.joints[j].rest_offset.stableNormalized();
        position_[j] = position_[parent] + above * (*state_.bone(j) * direction);
      } else if (seen_[j]) {
        position_[j] = filled.at(frame, j);
      }
      global_[j] = state_.active(j) ? Turn(filled, frame, j, above) : above;
      if (parent < 0) Eigen::Map<Vector3d>(state_.translation(frame)).noalias() = position_[j];
      if (state_.active(j)) Write(frame, j, parent < 0 ? global_[j] : above.conjugate() * global_[j]);
    }
  }

 private:
  /// Global rotation of a joint, as near to `above` as its targets allow. Places a root that is not seen.
  Quaterniond Turn(const JointPositions& filled, int frame, int joint, const Quaterniond& above) {
    const std::vector<Target>& targets = targets_[joint];
    const bool free_root = joint == 0 && !seen_[0];
    if (targets.empty()) return above;
    const Vector3d pivot = seen_[joint] ? Vector3d(filled.at(frame, joint)) : position_[joint];
    if (targets.size() == 1) {
      const Vector3d rest = above * targets[0].rest_in_joint;
      const Vector3d target = filled.at(frame, targets[0].joint);
      if (free_root) position_[0] = target - rest;
      return free_root ? above : (SwingBetween(rest, target - pivot) * above).normalized();
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

  void Write(int frame, int joint, const Quaterniond& rotation) {
    Vector3d w = LogQuaternion(rotation);
    if (frame > 0) {
      const Vector3d near = UnwrapNear(w, Eigen::Map<const Vector3d>(state_.rotation(frame - 1, joint)));
      if (near.norm() < kLargestAngle) w = near;
    }
    Eigen::Map<Vector3d>(state_.rotation(frame, joint)).noalias() = w;
  }

  const Skeleton& skeleton_;
  PoseState& state_;
  std::vector<bool> seen_;
  std::vector<std::vector<Target>> targets_;
  std::vector<Quaterniond> global_;
  std::vector<Vector3d> position_;
};

}  // namespace

std::vector<bool> JointsWithEvidenceBelow(const SkeletonTracks& tracks) {
  const std::vector<bool> seen = tracks.SeenJoints();
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
  ClosedFormPose start(tracks, state);
  for (int f = 0; f < tracks.frames(); ++f) start.Solve(filled, f);
}

}  // namespace mocurate
