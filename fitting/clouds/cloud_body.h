#pragma once

#include <vector>

#include "core/body/capsule_body.h"
#include "fitting/costs/pose_state.h"

namespace mocurate {

/// Ends of a capsule in a frame of a state. Needs Update.
inline CapsuleEnds EndsOf(const BodyCapsule& capsule, const PoseState& state, int frame) {
  return EndsOf(capsule, state.global(frame, capsule.frame), state.position(frame, capsule.frame),
                state.position(frame, capsule.end_joint));
}

/// (J) how far joints of this body usually are from those of the person whose surface it lies on, metres, standard
/// deviation per axis: of size and shape measured in clouds (FitShape), or, where the skeleton's shape is unknown,
/// of the template's scaled by one height. Measured on synthetic people whose bodies have other shapes
/// (`bench_fit_clouds`).
std::vector<double> BodyErrors(const Skeleton& skeleton, double scale);

/// How far such errors turn the frames of joints, all along: variances about the axes of the joint's frame (rad^2;
/// (J)). `body_error` (J) as above.
std::vector<Vector3d> BodyRotations(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                    const std::vector<double>& body_error);

}  // namespace mocurate
