#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/problem.h>

#include "fitting/costs/pose_state.h"

namespace mocurate {

/// Updates the kinematics of frames [begin, end) once per iterate, before the costs are evaluated.
class PoseUpdate final : public ceres::EvaluationCallback {
 public:
  PoseUpdate(PoseState& state, int begin, int end) : state_(state), begin_(begin), end_(end) {}
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    if (new_evaluation_point) has_derivatives_ = false;
    if (!new_evaluation_point && (has_derivatives_ || !evaluate_jacobians)) return;
    state_.Update(begin_, end_, evaluate_jacobians);
    has_derivatives_ = evaluate_jacobians;
  }

 private:
  PoseState& state_;
  int begin_;
  int end_;
  bool has_derivatives_ = false;
};

/// Options of a problem over the memory of a PoseState. The owner of the problem owns the loss functions.
inline ceres::Problem::Options PoseProblemOptions(PoseUpdate& update) {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = &update;
  return options;
}

}  // namespace mocurate
