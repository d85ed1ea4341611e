#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <vector>

#include "fitting/costs/pose_state.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"
#include "fitting/solver/joint_track_fit.h"

namespace mocurate {

/// Kinematics once per iterate, before the costs are asked.
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

/// The costs of frames [begin, end) over the memory of a PoseState; frame begin - 1, if there is one, is held and joins
/// through smoothness. Bones are held unless free.
class TrackProblem {
 public:
  TrackProblem(const SkeletonTracks& tracks, PoseState& state, const std::vector<double>& joint_sigma,
               const std::vector<double>& bone_prior, Bones bones, const JointTrackOptions& options, int begin,
               int end);

  ceres::Problem& problem() { return problem_; }

 private:
  void AddFrame(int frame);
  void AddStep(int frame);
  void AddBonePriors(const std::vector<double>& bone_prior);

  const SkeletonTracks& tracks_;
  PoseState& state_;
  const std::vector<double>& joint_sigma_;
  const JointTrackOptions& options_;
  bool free_bones_;
  PoseUpdate update_;
  ceres::HuberLoss loss_;
  ceres::Problem problem_;
};

}  // namespace mocurate
