#pragma once

#include <optional>
#include <vector>

#include "fitting/evidence/rotation_targets.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"
#include "fitting/solver/rest_sigmas.h"
#include "fitting/terms/terms.h"

namespace mocurate {

class BlockTridiagonal;

/// Factors on the process noise of the options, per step from a frame to the next: how much more (or less) this person
/// moves this joint here. (F*J); the last frame's entries are not read.
struct ProcessNoiseScale {
  std::vector<double> rotation;
  std::vector<double> position;

  static ProcessNoiseScale Ones(std::size_t numbers) {
    return {std::vector<double>(numbers, 1.0), std::vector<double>(numbers, 1.0)};
  }
};

/// The joint tracks of a clip, the pose that is fitted to them, and what the fit knows beside them.
struct TrackProblem {
  TrackProblem(const SkeletonTracks& of, PoseState& pose, double noise, const JointTrackOptions& with)
      : tracks(of),
        state(pose),
        sigma(noise),
        options(with),
        hinges(HingesOf(*of.skeleton)),
        huber(HuberSigmas(with.huber_share, 3)),
        rest_sigma(RestPoseSigmas(*of.skeleton, with.priors.rest)),
        shown(of.JointObservations()) {}

  const SkeletonTracks& tracks;
  PoseState& state;
  double sigma;  ///< of the tracks, metres per axis
  const JointTrackOptions& options;
  std::vector<std::optional<Hinge>> hinges;        ///< (J)
  double huber;                                    ///< length of a white residual from which it counts linearly
  std::vector<double> rest_sigma;                  ///< (J) rad, per axis of a joint's angle from the rest pose
  std::vector<bool> shown;                         ///< (J) in any frame
  const ProcessNoiseScale* noise_scale = nullptr;  ///< none: 1 everywhere
  const RotationTargets* rotations = nullptr;      ///< recorded; none: not used
  BlockTridiagonal* memory = nullptr;              ///< reused by all solves; null: their own

  int frames() const { return tracks.frames(); }
  std::size_t Index(int frame, int joint) const {
    return static_cast<std::size_t>(frame) * static_cast<std::size_t>(tracks.joints()) +
           static_cast<std::size_t>(joint);
  }
  /// Seconds from a frame to the next; coupled only up to kMaxGap_s, whatever may be interpolated.
  double Step(int frame) const { return tracks.time_s[frame + 1] - tracks.time_s[frame]; }
  bool Joined(int frame) const { return Step(frame) <= kMaxGap_s; }
  /// Information of the rest prior of a joint in a frame, 1/rad^2 per axis: counted once (RestShareOfStep).
  double RestInformation(int frame, int joint) const {
    const double rest = 1.0 / Square(rest_sigma[static_cast<std::size_t>(joint)]);
    const auto share = [&](int step) {
      const bool coupled = step >= 0 && step + 1 < frames() && Joined(step);
      return coupled ? RestShareOfStep(rest, 1.0 / RotationVariance(step, joint)) : kRestAtAnEnd;
    };
    return rest * (share(frame - 1) + share(frame));
  }
  /// Variances per axis of a joint's rotation (rad^2) and position (m^2) from a frame to the next.
  double RotationVariance(int frame, int joint) const {
    const double factor = noise_scale != nullptr ? noise_scale->rotation[Index(frame, joint)] : 1.0;
    return Square(options.priors.rotation_noise * factor) * Step(frame);
  }
  double MoveVariance(int frame, int joint) const {
    const double factor = noise_scale != nullptr ? noise_scale->position[Index(frame, joint)] : 1.0;
    return Square(options.priors.position_noise * factor) * Step(frame);
  }
  /// Of an observed joint's sample (1 / m^2), before the robust loss, and with it at the state's pose.
  Matrix3d Information(int frame, int joint) const { return tracks.precision_at(frame, joint) / (sigma * sigma); }
  Matrix3d RobustInformation(int frame, int joint) const;

  /// Terms of the frames [begin, end). `after_fixed`: frame begin - 1 is fixed, and coupled by process noise.
  /// They point to the hinges of this.
  PoseTerms Terms(int begin, int end, bool after_fixed) const&;
  PoseTerms Terms(int begin, int end, bool after_fixed) const&& = delete;

 private:
  StepTerm StepAfter(int frame) const;
};

}  // namespace mocurate
