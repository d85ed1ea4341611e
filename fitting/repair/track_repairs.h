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

  std::string
      code;  ///< "swapped_sides", "position jump", "joint_far", "repeated_value", "frozen_frames", "zero_length_bone",
             ///< "bone_length_violation", "zero_frames", "collapsed_frames", "coincident_limbs"
  Severity severity = Severity::kInfo;
  Action action = Action::kExcluded;
  int frame_begin = 0;
  int frame_end = 0;
  std::vector<int> joints;  ///< of an exchange the left ones; each with its mirror partner
  double value = 0.0;       ///< of the code: margin, metres, frames
  std::string message;
};

/// Tracks as the fit takes them; the given ones are left as they are.
struct RepairedTracks {
  SkeletonTracks tracks;
  std::vector<bool> exchanged;       ///< (F*J) what is seen there was tracked as the other side
  std::vector<TrackRepair> repairs;  ///< in the order in which they were made
  std::vector<Finding> findings;     ///< errors that were reported, not corrected
};

/// Takes samples for missing that no body gives (bones without length, teleports, held joints, limbs in one place: of
/// the side that went over, or of both), then exchanges left and right where the tracker did: of the whole body where
/// anatomy says so (FindBodyExchanges), of limbs by steps (FindExchanges); and joints that bones do not reach
/// (DetectBoneViolations). Where anatomy has the sides exchanged in all that is seen, the names of the joints are wrong
/// or the axes are mirrored, which tracks cannot decide: an error "sides_exchanged" in `findings`, no correction.
/// `bone_length` (J) metres; `noise_sigma` metres per axis.
RepairedTracks RepairTracks(const SkeletonTracks& given, const std::vector<double>& bone_length, double noise_sigma,
                            const RepairOptions& options);

/// Of all that the exchange of limbs alone (FindExchanges), where that of bodies is settled: keypoints of many views.
RepairedTracks RepairLimbs(const SkeletonTracks& given, const std::vector<double>& bone_length, double noise_sigma,
                           double least_margin);

/// Samples that are observed, but as the other side, are repaired. `exchanged` (F*J) or none.
void MarkRepaired(const std::vector<bool>& exchanged, Motion& motion);

/// One finding per repair: code, frames, joint (the first), value; action "repaired" or "taken as missing".
std::vector<Finding> FindingsOf(const std::vector<TrackRepair>& repairs, const Skeleton& skeleton);

/// [{"code", "action", "frames": [begin, end), "joints": [names], "value"}], one line: what provenance keeps
/// (kTrackRepairs), so that each repair can be taken back.
inline constexpr const char* kTrackRepairs = "track_repairs";
std::string RepairsText(const std::vector<TrackRepair>& repairs, const Skeleton& skeleton);

}  // namespace mocurate
