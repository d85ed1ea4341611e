#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "fitting/costs/pose_state.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"
#include "fitting/solver/joint_track_fit.h"

namespace mocurate {

/// Frames [begin, end) of a fit, solved together: what FitJointTracks minimises, over the memory of a PoseState.
struct TrackWindow {
  const SkeletonTracks& tracks;
  PoseState& state;
  const std::vector<double>& joint_sigma;  ///< (J) metres per axis
  const std::vector<double>& bone_prior;   ///< (J) metres
  Bones bones = Bones::kFixed;
  const JointTrackOptions& options;
  int begin = 0;
  int end = 0;
  bool after_held = false;  ///< frame begin - 1 is held and joins through smoothness; then bones must be fixed

  /// First frame whose kinematics the window reads.
  int first() const { return after_held ? begin - 1 : begin; }
  /// Seconds from a frame to the next; smoothed together only up to options.max_gap_s.
  double Step(int frame) const { return tracks.time_s[frame + 1] - tracks.time_s[frame]; }
  bool Joined(int frame) const { return Step(frame) <= options.max_gap_s; }
};

/// How the solver ended; the solution is in the window's state.
struct WindowSolution {
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  bool converged = false;
};

/// Ceres: Levenberg-Marquardt with sparse Cholesky (CHOLMOD), one residual block per term.
Expected<WindowSolution> SolveWithCeres(const TrackWindow& window);

/// The same costs and steps with the block-tridiagonal normal equations of the window, assembled by subtree sums.
Expected<WindowSolution> SolveBanded(const TrackWindow& window);

}  // namespace mocurate
