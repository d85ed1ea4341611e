#pragma once

#include <array>
#include <string_view>

#include "core/base/error.h"
#include "core/formats/npz.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Representation of the rotations of an exported motion.
enum class RotationArrays { kQuaternion, kAxisAngle, kMatrix, k6dRows, k6dColumns, kLie, kNone };

struct RotationArraysName {
  std::string_view name;
  RotationArrays value;
  std::string_view help;
};

/// Their names on the command line and in an exported file.
inline constexpr std::array<RotationArraysName, 7> kRotationArraysNames = {{
    {"quaternion", RotationArrays::kQuaternion, "poses (F,J,4), w x y z"},
    {"axis_angle", RotationArrays::kAxisAngle, "poses (F,J,3), as SMPL's and AMASS's"},
    {"matrix", RotationArrays::kMatrix, "poses (F,J,3,3)"},
    {"6d_rows", RotationArrays::k6dRows, "poses (F,J,6), the first two rows, as ACTOR's"},
    {"6d_columns", RotationArrays::k6dColumns, "poses (F,J,6), the first two columns, interleaved, as MultiAct's"},
    {"lie", RotationArrays::kLie, "lie (F,J,3), as Action2Motion's: root translation, then a vector per bone"},
    {"joints", RotationArrays::kNone, "positions only"},
}};

/// The motion of a clip as arrays of numpy, numbers as doubles. F frames, J joints; metres, radians, y up,
/// right-handed.
///   poses or lie     rotations, parent_from_joint, the root's world_from_root; Lie parameters along `lie_parents`
///   trans            (F,3) joint 0 in the world; with rotations
///   lie_chain        (J) with Lie parameters: where it differs from the parent's, rotations begin at the identity
///   joints           (F,J,3) in the world; where there are rotations, of those
///   rest_offset      (J,3) from the parent in the rest pose, of this person's lengths: forward kinematics needs
///                    nothing else. With Lie parameters: the raw offset times the bone's length
///   parents          (J) -1 for the root; of Lie parameters those along the chains
///   joint_names (J), mocap_frame_rate (Hz), representation, skeleton, clip, label
///   state, position_cov, rotation_sigma, contact   as the clip has them, in the shapes of Motion
/// Errors: kInconsistent for rotations of a motion that has none; kUnsupported for Lie parameters of a skeleton without
/// chains.
Expected<Npz> ArraysOfMotion(const Clip& clip, RotationArrays rotations);

}  // namespace mocurate
