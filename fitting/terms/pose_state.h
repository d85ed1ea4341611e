#pragma once

#include <algorithm>
#include <vector>

#include "core/motion/motion.h"

namespace mocurate {

/// Parameters of F frames of one person in one block of memory, where the solver writes, and derived values that all
/// costs need, computed once per iterate. Per frame: root translation (3, world, metres), then a rotation vector per
/// joint (3, parent_from_joint; world_from_root for joint 0). After all frames: one bone length per joint (metres).
///
/// With R = Exp(w), G the global rotations and p the positions: p_c = p_p + G_p b_c u_c, u the rest directions, and for
/// a joint a above j: dp_j/dw_a = -Hat(p_j - p_a) A_a, A_a = G_parent(a) J_l(w_a).
class PoseState {
 public:
  /// `active` (J): joints whose rotation is a parameter; the others stay at the identity (but see SetActive).
  PoseState(const Skeleton& skeleton, int frames, const std::vector<double>& bone_length, std::vector<bool> active);

  int frames() const { return frames_; }
  int joints() const { return joints_; }
  double* translation(int frame) { return parameters_.data() + static_cast<std::size_t>(frame) * stride_; }
  const double* translation(int frame) const { return parameters_.data() + static_cast<std::size_t>(frame) * stride_; }
  double* rotation(int frame, int joint) { return translation(frame) + 3 + std::ptrdiff_t{3} * joint; }
  const double* rotation(int frame, int joint) const { return translation(frame) + 3 + std::ptrdiff_t{3} * joint; }
  double* bone(int joint) { return parameters_.data() + static_cast<std::size_t>(frames_) * stride_ + joint; }
  const double* bone(int joint) const {
    return parameters_.data() + static_cast<std::size_t>(frames_) * stride_ + joint;
  }

  /// (J) metres.
  std::vector<double> bone_lengths() const { return {bone(0), bone(0) + joints_}; }

  /// Translation and rotations of a frame, 3 + 3 J numbers.
  std::vector<double> FrameParameters(int frame) const { return {translation(frame), translation(frame) + stride_}; }
  void SetFrameParameters(int frame, const std::vector<double>& parameters) {
    std::copy(parameters.begin(), parameters.end(), translation(frame));
  }

  bool active(int joint) const { return active_[joint]; }
  /// Selects the rotations that are parameters; the others stay as the last Update left them.
  void SetActive(std::vector<bool> active);
  /// Active joints strictly above a joint, root first: the rotations its position depends on.
  const std::vector<int>& path(int joint) const { return paths_[joint]; }
  /// Joints from below the root down to a joint: the bones its position depends on.
  const std::vector<int>& bones(int joint) const { return bones_[joint]; }
  int parent(int joint) const { return parents_[joint]; }

  /// Recomputes frames [begin, end) from the parameters.
  void Update(int begin, int end, bool derivatives);

  const Vector3d& position(int frame, int joint) const { return derived_[Index(frame, joint)].position; }
  const Matrix3d& local(int frame, int joint) const { return derived_[Index(frame, joint)].local; }
  const Matrix3d& global(int frame, int joint) const { return derived_[Index(frame, joint)].global; }
  /// J_r(w) of the joint.
  const Matrix3d& right_jacobian(int frame, int joint) const { return derived_[Index(frame, joint)].right_jacobian; }
  /// A_a of the class comment.
  const Matrix3d& lever(int frame, int joint) const { return derived_[Index(frame, joint)].lever; }

 private:
  struct Derived {
    Matrix3d local = Matrix3d::Identity();
    Matrix3d global = Matrix3d::Identity();
    Matrix3d right_jacobian = Matrix3d::Identity();
    Matrix3d lever = Matrix3d::Identity();
    Vector3d position = Vector3d::Zero();
  };
  std::size_t Index(int frame, int joint) const { return static_cast<std::size_t>(frame) * joints_ + joint; }

  int frames_;
  int joints_;
  std::size_t stride_;
  std::vector<double> parameters_;
  std::vector<Derived> derived_;
  std::vector<int> parents_;
  std::vector<Vector3d> directions_;
  std::vector<bool> active_;
  std::vector<std::vector<int>> paths_;
  std::vector<std::vector<int>> bones_;
};

/// The motion that a state's parameters describe: rotations as quaternions, sign-continuous in time.
Motion MotionOf(const PoseState& state, SkeletonPtr skeleton, const FrameRate& rate);

}  // namespace mocurate
