#pragma once

#include <vector>

#include "core/body/capsule_body.h"
#include "fitting/costs/pose_state.h"
#include "fitting/rules.h"

namespace mocurate {

/// Ends of a capsule in a frame of a state. Needs Update.
inline CapsuleEnds EndsOf(const BodyCapsule& capsule, const PoseState& state, int frame) {
  return EndsOf(capsule, state.global(frame, capsule.frame), state.position(frame, capsule.frame),
                state.position(frame, capsule.end_joint));
}

/// Factor on the usual deviations from the template when the body shape is unknown (a given height, a tracker's own
/// points, other skeletons), so that the template's is used. Source: bench_fit_clouds
inline constexpr double kUnknownShape = 3.0;

/// (J) usual error of this body's joints for the person whose surface was fitted, standard deviation per axis, metres.
/// For size and shape from clouds (FitShape), or, when the skeleton's shape is unknown, for the template scaled to one
/// height. Measured on synthetic people with other body shapes (`bench_fit_clouds`). 0 where the rule is off.
std::vector<double> BodyErrors(const Skeleton& skeleton, double scale, const Rules& rules);

/// Rotations of joint frames that these errors cause in all frames: variances about the axes of the joint's frame ((J),
/// rad^2). `body_error` (J) as above.
std::vector<Vector3d> BodyRotations(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                    const std::vector<double>& body_error);
/// The same; 0 where the rule is off.
std::vector<Vector3d> BodyRotations(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                    const std::vector<double>& body_error, const Rules& rules);

}  // namespace mocurate
