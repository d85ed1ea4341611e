#pragma once

#include <ceres/cost_function.h>

#include <vector>

#include "fitting/costs/pose_gaussian.h"

namespace mocurate {

/// Knowledge of a frame's pose from other evidence.
/// Residual: r = W d, 3 + 3 K rows (PoseGaussian): unitless.
/// Blocks: translation[3], rotation vector[3] (parent_from_joint) of each of its K joints.
/// Jacobian: W_t; W_k J_r^-1(d_k) J_r(w_k).
/// Degenerate: a joint rotated by exactly pi from the mean, where Log changes its branch.
/// Source: Gaussian marginal of another fit; Sola et al. 2018, eqs. 143-147.
class PoseGaussianCost final : public ceres::CostFunction {
 public:
  PoseGaussianCost(const PoseState& state, int frame, const PoseGaussian& pose)
      : state_(state), frame_(frame), pose_(pose) {
    set_num_residuals(static_cast<int>(pose.size()));
    mutable_parameter_block_sizes()->assign(1 + pose.joints.size(), 3);
  }

  std::vector<double*> Blocks(PoseState& state) const {
    std::vector<double*> blocks{state.translation(frame_)};
    for (const int j : pose_.joints) blocks.push_back(state.rotation(frame_, j));
    return blocks;
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    using Block = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>;
    const Eigen::VectorXd errors = pose_.Errors(state_, frame_);
    const auto whitening = pose_.whitening.triangularView<Eigen::Lower>();
    Eigen::Map<Eigen::VectorXd>(residuals, pose_.size()) = whitening * errors;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Block(jacobians[0], pose_.size(), 3) = pose_.whitening.leftCols<3>();
    for (std::size_t k = 0; k < pose_.joints.size(); ++k) {
      if (jacobians[1 + k] == nullptr) continue;
      Block(jacobians[1 + k], pose_.size(), 3).noalias() =
          pose_.whitening.middleCols<3>(PoseGaussian::At(k)) * pose_.Derivative(errors, state_, frame_, k);
    }
    return true;
  }

 private:
  const PoseState& state_;
  int frame_;
  const PoseGaussian& pose_;
};

}  // namespace mocurate
