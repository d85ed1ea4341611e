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

/// Factors on the process noise of the options, per step from a frame to the next: how much more (or less) this person
/// moves this joint here. (F*J); the last frame's entries are not read.
struct ProcessNoiseScale {
  std::vector<double> rotation;
  std::vector<double> position;

  static ProcessNoiseScale Ones(std::size_t numbers) {
    return {std::vector<double>(numbers, 1.0), std::vector<double>(numbers, 1.0)};
  }
};

class BlockTridiagonal;

/// Frames [begin, end) of a fit, solved together: what FitJointTracks minimises, over the memory of a PoseState.
struct TrackWindow {
  const SkeletonTracks& tracks;
  PoseState& state;
  double sigma;  ///< of the tracks, metres per axis
  const JointTrackOptions& options;
  int begin = 0;
  int end = 0;
  bool after_fixed = false;                        ///< frame begin - 1 is fixed and coupled by process noise
  const ProcessNoiseScale* noise_scale = nullptr;  ///< of all frames of the tracks; none: 1 everywhere
  const RotationTargets* rotations = nullptr;      ///< recorded, of all frames of the tracks
  TrackStep step = {};                             ///< solver settings
  BlockTridiagonal* memory = nullptr;              ///< for banded equations, reused by the next solve; null: their own
  const std::vector<double>* rest_sigmas = nullptr;  ///< (J) radians; none: options.rest_sigma of all

  const std::vector<double>* rest_information = nullptr;  ///< (F*J) 1/rad^2; none: that of RestSigma in each frame

  /// First frame whose kinematics the window reads.
  int first() const { return after_fixed ? begin - 1 : begin; }
  /// Seconds from a frame to the next; coupled only up to kMaxGap_s, whatever may be interpolated.
  double Step(int frame) const { return tracks.time_s[frame + 1] - tracks.time_s[frame]; }
  bool Joined(int frame) const { return Step(frame) <= kMaxGap_s; }
  /// Standard deviation per axis of a joint's angle from the rest pose, radians.
  double RestSigma(int joint) const {
    return rest_sigmas != nullptr ? (*rest_sigmas)[static_cast<std::size_t>(joint)] : options.rest_sigma;
  }
  /// Information of the rest prior of a joint in a frame, 1/rad^2 per axis.
  double RestInformation(int frame, int joint) const {
    const double rest = RestSigma(joint);
    return rest_information != nullptr ? (*rest_information)[Index(frame, joint)] : 1.0 / (rest * rest);
  }
  /// Variances per axis of a joint's rotation (rad^2) and position (m^2) from a frame to the next.
  double RotationVariance(int frame, int joint) const {
    const double noise =
        options.rotation_process_noise * (noise_scale != nullptr ? noise_scale->rotation[Index(frame, joint)] : 1.0);
    return noise * noise * Step(frame);
  }
  double MoveVariance(int frame, int joint) const {
    const double noise =
        options.velocity_process_noise * (noise_scale != nullptr ? noise_scale->position[Index(frame, joint)] : 1.0);
    return noise * noise * Step(frame);
  }
  /// Of an observed joint's sample (1 / m^2), before the robust loss.
  Matrix3d Information(int frame, int joint) const { return tracks.precision_at(frame, joint) / (sigma * sigma); }
  std::size_t Index(int frame, int joint) const {
    return static_cast<std::size_t>(frame) * static_cast<std::size_t>(tracks.joints()) +
           static_cast<std::size_t>(joint);
  }
};

/// Termination of the solver; the solution is in the window's state.
struct WindowSolution {
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  bool converged = false;
  bool exhausted = false;  ///< no step reduces the cost, however small
};

/// Ceres: Levenberg-Marquardt with sparse Cholesky (CHOLMOD), one residual block per term.
Expected<WindowSolution> SolveWithCeres(const TrackWindow& window);

/// The same costs and steps with the block-tridiagonal normal equations of the window, assembled by subtree sums.
Expected<WindowSolution> SolveBanded(const TrackWindow& window);

}  // namespace mocurate
