#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <vector>

#include "fitting/costs/pose_state.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"
#include "fitting/solver/joint_track_fit.h"
#include "fitting/solver/pose_update.h"

namespace mocurate {

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
