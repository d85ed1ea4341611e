#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <optional>
#include <vector>

#include "fitting/costs/hinge_cost.h"
#include "fitting/solver/pose_update.h"
#include "fitting/solver/track_window.h"

namespace mocurate {

/// The costs of a window as a Ceres problem.
class TrackProblem {
 public:
  explicit TrackProblem(const TrackWindow& window);

  ceres::Problem& problem() { return problem_; }

 private:
  void AddFrame(int frame);
  void AddStep(int frame);

  const TrackWindow window_;
  PoseState& state_;
  std::vector<std::optional<Hinge>> hinges_;  ///< (J)
  PoseUpdate update_;
  ceres::HuberLoss loss_;
  ceres::Problem problem_;
};

}  // namespace mocurate
