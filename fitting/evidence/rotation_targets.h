#pragma once

#include <vector>

#include "core/base/finding.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/terms/pose_state.h"

namespace mocurate {

/// Recorded rotations as targets of the skeleton's joints. F frames, J joints.
struct RotationTargets {
  std::vector<Quaterniond> world_from_joint;  ///< (F*J)
  std::vector<double> weight;                 ///< (F*J) confidence / sigma, 1/rad; 0: no target
  std::vector<double> joint_sigma;            ///< (J) rad per axis; 0: the joint has no targets

  bool has(std::size_t at) const { return weight[at] > 0.0; }
};

/// Recorded rotations of `tracks` in the joints' own frames. The offset of a recorded frame in its joint is constant in
/// time. It is estimated from the pose `state` (kinematics up to date) as the rotation with the least robust distance.
/// Sigma is the median scatter about it over all frames and axes, as the pose's twist may be wrong without evidence.
/// Only frames with an observed position count. A joint whose recording does not follow the pose (sigma above 30
/// degrees) or has fewer than 10 frames gets no targets, and a finding "rotations_disagree" or "rotations_too_few" in
/// `findings` (may be null). Targets thus determine changes of rotation during the clip; the mean rotation is the
/// pose's.
RotationTargets AlignRotations(const SkeletonTracks& tracks, const PoseState& state, std::vector<Finding>* findings);

}  // namespace mocurate
