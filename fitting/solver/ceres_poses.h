#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/problem.h>

#include <memory>
#include <string>
#include <vector>

#include "fitting/solver/solve.h"

namespace mocurate {

/// Terms as a Ceres problem over the memory of a state. The rows of one body, or of one joint, in a frame are one
/// residual block: QR of [a r] reduces them to seven (four), and the robust loss is in them (a frame of depth has
/// thousands of points). Cost, gradient and J'J are those of the rows. Terms and state must outlive it.
class CeresPoses final : public ceres::EvaluationCallback {
 public:
  CeresPoses(const PoseTerms& terms, PoseState& state);
  ~CeresPoses() override;

  ceres::Problem& problem() { return *problem_; }

  /// Updates the kinematics and evaluates all rows, once per iterate.
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

 private:
  struct Block;
  class BlockCost;
  class Rows;

  const PoseTerms& terms_;
  PoseState& state_;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::unique_ptr<Rows> rows_;
  std::unique_ptr<ceres::Problem> problem_;
  bool has_derivatives_ = false;
};

/// "frames A to B", and what to check there, for messages.
std::string FramesOf(const PoseTerms& terms);
inline constexpr const char* kCheckFrames = "check that these frames show a person, in metres";

Expected<Solution> SolveWithCeres(const PoseTerms& terms, PoseState& state, const SolveOptions& options);

}  // namespace mocurate
