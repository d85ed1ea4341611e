#pragma once

#include <vector>

#include "core/base/finding.h"
#include "fitting/costs/pose_state.h"
#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// What recorded rotations say of the skeleton's joints. F frames, J joints.
struct RotationTargets {
  std::vector<Quaterniond> world_from_joint;  ///< (F*J)
  std::vector<double> weight;                 ///< (F*J) confidence / sigma, 1/rad; 0: nothing is said
  std::vector<double> joint_sigma;            ///< (J) rad per axis; 0: the joint has no targets

  bool has(std::size_t at) const { return weight[at] > 0.0; }
};

/// Recorded rotations of `tracks` in the joints' own frames. How a recorded frame lies in its joint is constant in
/// time, and read from the pose `state` (its kinematics up to date): the rotation that leaves the least robust distance
/// between both. Sigma is the median scatter about it, of all frames and axes: what positions do not show (twist) may
/// be wrong in the pose without making a good recording look bad. Read where the joint's position is seen too. A joint
/// whose recording does not follow the pose (sigma above 30 degrees), or is of fewer than 10 frames, gets no targets,
/// and a finding "rotations_disagree" or "rotations_too_few" in `findings` (may be null). Targets thus tell how a joint
/// turns in the course of the clip; where its turn lies in the mean, the pose has told.
RotationTargets AlignRotations(const SkeletonTracks& tracks, const PoseState& state, std::vector<Finding>* findings);

}  // namespace mocurate
