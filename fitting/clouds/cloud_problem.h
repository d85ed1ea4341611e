#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <optional>
#include <vector>

#include "fitting/clouds/cloud_match.h"
#include "fitting/options.h"
#include "fitting/solver/pose_update.h"

namespace mocurate {

/// Frames [begin, end) of a state that are solved together.
struct CloudFrames {
  int begin = 0;
  int end = 0;
  /// Seconds since frame begin - 1, which then is held and joins through the walks of the options.
  std::optional<double> since_previous_s;
};

/// The costs of matched points over the memory of a PoseState. Weights: points share the error of the body with their
/// neighbours, so that a patch of them counts as one observation of `sigma` metres.
class CloudProblem {
 public:
  CloudProblem(const FleshBody& body, PoseState& state, const CloudFrames& frames, double sigma,
               const PointCloudOptions& options);

  void AddFrame(int frame, const FusedCloud& cloud, const std::vector<CloudMatch>& matches);
  /// Joins the first frame to the one before it, which is held.
  void AddStep();

  ceres::Problem& problem() { return problem_; }

 private:
  const FleshBody& body_;
  PoseState& state_;
  CloudFrames frames_;
  const PointCloudOptions& options_;
  double weight_;
  std::vector<double> rest_spreads_;
  PoseUpdate update_;
  ceres::HuberLoss loss_;
  ceres::Problem problem_;
};

}  // namespace mocurate
