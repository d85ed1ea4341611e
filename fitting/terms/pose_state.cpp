#include "fitting/terms/pose_state.h"

#include <utility>

#include "core/motion/kinematics.h"

namespace mocurate {

PoseState::PoseState(const Skeleton& skeleton, int frames, const std::vector<double>& bone_length,
                     std::vector<bool> active)
    : frames_(frames),
      joints_(skeleton.joint_count()),
      stride_(3 + 3 * static_cast<std::size_t>(joints_)),
      parameters_(static_cast<std::size_t>(frames) * stride_ + joints_, 0.0),
      derived_(static_cast<std::size_t>(frames) * joints_),
      bones_(joints_) {
  for (int j = 0; j < joints_; ++j) {
    const Joint& joint = skeleton.joints[j];
    parents_.push_back(joint.parent);
    const double length = joint.rest_offset.norm();
    directions_.push_back(length > 0.0 ? Vector3d(joint.rest_offset / length) : Vector3d(Vector3d::Zero()));
    *bone(j) = bone_length[j];
    if (joint.parent < 0) continue;
    bones_[j] = bones_[joint.parent];
    bones_[j].push_back(j);
  }
  SetActive(std::move(active));
}

void PoseState::SetActive(std::vector<bool> active) {
  active_ = std::move(active);
  paths_.assign(static_cast<std::size_t>(joints_), {});
  for (int j = 0; j < joints_; ++j) {
    const int parent = parents_[j];
    if (parent < 0) continue;
    paths_[j] = paths_[parent];
    if (active_[parent]) paths_[j].push_back(parent);
  }
}

void PoseState::Update(int begin, int end, bool derivatives) {
  for (int f = begin; f < end; ++f) {
    for (int j = 0; j < joints_; ++j) {
      Derived& d = derived_[Index(f, j)];
      if (active_[j]) {
        const Eigen::Map<const Vector3d> w(rotation(f, j));
        d.local = ExpMatrix(w);
        if (derivatives) d.right_jacobian = RightJacobian(w);
      }
      const int p = parents_[j];
      if (p < 0) {
        d.position = Eigen::Map<const Vector3d>(translation(f));
        d.global = d.local;
        if (derivatives) d.lever = d.right_jacobian.transpose();
        continue;
      }
      const Derived& above = derived_[Index(f, p)];
      d.position = above.position + above.global * (*bone(j) * directions_[j]);
      d.global.noalias() = above.global * d.local;
      if (derivatives && active_[j]) d.lever.noalias() = above.global * d.right_jacobian.transpose();  // J_l = J_r^T
    }
  }
}

Motion MotionOf(const PoseState& state, SkeletonPtr skeleton, const FrameRate& rate) {
  std::vector<Vector3d> translation;
  std::vector<Quaterniond> rotation;
  std::vector<double> bone_length;
  for (int f = 0; f < state.frames(); ++f) {
    translation.emplace_back(Eigen::Map<const Vector3d>(state.translation(f)));
    for (int j = 0; j < state.joints(); ++j) {
      rotation.push_back(ExpQuaternion(Eigen::Map<const Vector3d>(state.rotation(f, j))));
    }
  }
  for (int j = 0; j < state.joints(); ++j) {
    bone_length.push_back(*state.bone(j));
    MakeSignContinuous(rotation.data() + j, state.frames(), state.joints());
  }
  return MakeMotion(std::move(skeleton), rate, std::move(translation), std::move(rotation), std::move(bone_length));
}

}  // namespace mocurate
