#pragma once

#include <ceres/cost_function.h>

#include <vector>

#include "fitting/costs/pose_state.h"

namespace mocurate {

/// Process noise of a joint's position between a frame and the next.
/// Residual: r = weight * (joint_in_world(next) - joint_in_world(frame)), 3 rows; weight = 1 / (q * sqrt(dt)) with the
/// process noise q in m per sqrt(s): unitless, the same for any frame rate. Blocks: those of JointPositionCost of both
/// frames (root_translation, rotations above), first frame first. For the root: the two translations alone. Jacobian:
/// that of the position, negative for the first frame. Degenerate: none beyond those of the position. Source:
/// random-walk prior; weak, it fills gaps rather than smooths.
class JointVelocityCost final : public ceres::CostFunction {
 public:
  JointVelocityCost(const PoseState& state, int frame, int joint, double weight)
      : state_(state), frame_(frame), joint_(joint), weight_(weight) {
    set_num_residuals(3);
    mutable_parameter_block_sizes()->assign(2 * (1 + state.path(joint).size()), 3);
  }

  std::vector<double*> Blocks(PoseState& state) const {
    std::vector<double*> blocks;
    for (const int f : {frame_, frame_ + 1}) {
      blocks.push_back(state.translation(f));
      for (const int a : state.path(joint_)) blocks.push_back(state.rotation(f, a));
    }
    return blocks;
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    Eigen::Map<Vector3d>(residuals).noalias() =
        weight_ * (state_.position(frame_ + 1, joint_) - state_.position(frame_, joint_));
    if (jacobians == nullptr) return true;
    std::size_t block = 0;
    Fill(frame_, -weight_, jacobians, block);
    Fill(frame_ + 1, weight_, jacobians, block);
    return true;
  }

 private:
  void Fill(int frame, double weight, double** jacobians, std::size_t& block) const {
    using Block = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
    if (jacobians[block] != nullptr) Block(jacobians[block]).noalias() = weight * Matrix3d::Identity();
    ++block;
    for (const int a : state_.path(joint_)) {
      double* jacobian = jacobians[block++];
      if (jacobian == nullptr) continue;
      Block(jacobian).noalias() =
          Hat(weight * (state_.position(frame, a) - state_.position(frame, joint_))) * state_.lever(frame, a);
    }
  }

  const PoseState& state_;
  int frame_;
  int joint_;
  double weight_;
};

}  // namespace mocurate
