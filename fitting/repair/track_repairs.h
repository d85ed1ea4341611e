#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/motion/motion.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"

namespace mocurate {

/// What was done to the samples of some joints in frames [frame_begin, frame_end) before the fit.
struct TrackRepair {
  enum class Action { kExchanged, kExcluded };

  std::string code;  ///< "swapped_sides", "position_jump", "joint_far", "repeated_value", "frozen_frames",
                     ///< "zero_length_bone", "bone_length_violation", "zero_frames", "collapsed_frames"
  Action action = Action::kExcluded;
  int frame_begin = 0;
  int frame_end = 0;
  std::vector<int> joints;  ///< of an exchange: the left ones, each with its mirror joint
  double value = 0.0;       ///< by code: margin, metres or frames
  std::string message;
};

/// The tracks that the fit uses.
struct RepairedTracks {
  SkeletonTracks tracks;
  std::vector<bool> exchanged;       ///< (F*J) samples that the tracker assigned to the other side
  std::vector<TrackRepair> repairs;  ///< in the order of application
  std::vector<Finding> findings;     ///< problems that were not repaired
};

/// Corrects tracks before the fit. First it marks samples as missing that no body can produce: bones of zero length,
/// position jumps, repeated values. Then it exchanges left and right
/// where the tracker did: of the whole body by anatomy (FindBodyExchanges), of limbs by steps (FindExchanges). Last it
/// marks joints as missing that bones do not reach (DetectBoneViolations). When anatomy shows the sides exchanged in
/// all observed frames, joint names are wrong or axes are mirrored. This is ambiguous: nothing is changed, and the
/// result has the error "sides_exchanged". `bone_length` (J): metres; `noise_sigma`: metres per axis.
RepairedTracks RepairTracks(const SkeletonTracks& given, const std::vector<double>& bone_length, double noise_sigma,
                            const RepairOptions& options);

/// Only the exchange of limbs (FindExchanges): for keypoints of several views, where those of bodies are corrected
/// already.
RepairedTracks RepairLimbs(const SkeletonTracks& given, const std::vector<double>& bone_length, double noise_sigma,
                           const RepairOptions& options);

/// Sets the state of observed samples that were exchanged to kRepaired. `exchanged`: (F*J) or empty.
void MarkRepaired(const std::vector<bool>& exchanged, Motion& motion);

/// One finding per repair: code, frames, joint (the first), value; action kRepaired or kMissing.
std::vector<Finding> FindingsOf(const std::vector<TrackRepair>& repairs, const Skeleton& skeleton);

/// [{"code", "action", "frames": [begin, end), "joints": [names], "value"}], one line: the provenance entry
/// (kTrackRepairs) with which each repair can be undone.
inline constexpr const char* kTrackRepairs = "track_repairs";
std::string RepairsText(const std::vector<TrackRepair>& repairs, const Skeleton& skeleton);

}  // namespace mocurate
