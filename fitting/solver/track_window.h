#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "fitting/costs/pose_state.h"
#include "fitting/evidence/rotation_targets.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"
#include "fitting/solver/joint_track_fit.h"

namespace mocurate {

/// Factors on the random walks of the options, of the step from a frame to the next: how much more (or less) than they
/// say this person moves this joint here. (F*J); what belongs to the last frame is not read.
struct WalkFactors {
  std::vector<double> rotation;
  std::vector<double> position;

  static WalkFactors Ones(std::size_t numbers) {
    return {std::vector<double>(numbers, 1.0), std::vector<double>(numbers, 1.0)};
  }
};

class BlockTridiagonal;

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
  const WalkFactors* walks = nullptr;          ///< of all frames of the tracks; none: 1 everywhere
  const RotationTargets* rotations = nullptr;  ///< recorded, of all frames of the tracks
  TrackStep step = {};                         ///< how long it is solved
  BlockTridiagonal* memory = nullptr;          ///< for banded equations, used again by the next solve; none: their own
  const std::vector<double>* rest_spreads = nullptr;  ///< (J) radians; none: options.rest_spread of all

  const std::vector<double>* rest_information = nullptr;  ///< (F*J) 1/rad^2; none: that of RestSpread in each frame

  /// First frame whose kinematics the window reads.
  int first() const { return after_held ? begin - 1 : begin; }
  /// Seconds from a frame to the next; smoothed together only up to options.max_gap_s.
  double Step(int frame) const { return tracks.time_s[frame + 1] - tracks.time_s[frame]; }
  bool Joined(int frame) const { return Step(frame) <= options.max_gap_s; }
  /// Standard deviation per axis of a joint's angle from the rest pose, radians.
  double RestSpread(int joint) const {
    return rest_spreads != nullptr ? (*rest_spreads)[static_cast<std::size_t>(joint)] : options.rest_spread;
  }
  /// What ties a joint to its rest pose in a frame, 1/rad^2 per axis.
  double RestInformation(int frame, int joint) const {
    const double spread = RestSpread(joint);
    return rest_information != nullptr ? (*rest_information)[Index(frame, joint)] : 1.0 / (spread * spread);
  }
  /// Variances per axis of a joint's turn (rad^2) and move (m^2) from a frame to the next.
  double TurnVariance(int frame, int joint) const {
    const double walk = options.rotation_walk * (walks != nullptr ? walks->rotation[Index(frame, joint)] : 1.0);
    return walk * walk * Step(frame);
  }
  double MoveVariance(int frame, int joint) const {
    const double walk = options.velocity_walk * (walks != nullptr ? walks->position[Index(frame, joint)] : 1.0);
    return walk * walk * Step(frame);
  }
  /// Of a seen joint's sample (1 / m^2), before the robust loss.
  Matrix3d Information(int frame, int joint) const {
    return tracks.precision_at(frame, joint) / (joint_sigma[joint] * joint_sigma[joint]);
  }
  std::size_t Index(int frame, int joint) const {
    return static_cast<std::size_t>(frame) * static_cast<std::size_t>(tracks.joints()) +
           static_cast<std::size_t>(joint);
  }
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
