#pragma once

#include "core/motion/motion.h"

namespace mocurate {

/// Forward kinematics on the tree: p_root = root_translation, G_root = rotation_root, for a child c of p:
/// p_c = p_p + G_p * (rest_offset_c scaled to bone_length_c), G_c = G_p * rotation_c. One frame; `rotation` (J),
/// `bone_length` (J) or empty for the rest lengths; `joints` and, if not null, `global_rotation` receive J entries.
void ForwardKinematics(const Skeleton& skeleton, const Vector3d& root_translation, const Quaterniond* rotation,
                       const std::vector<double>& bone_length, Vector3d* joints,
                       Quaterniond* global_rotation = nullptr);

/// Fills motion.joints from root_translation, rotation and bone_length.
void ComputeJoints(Motion& motion);

/// Makes a motion from its parameters and computes the joints. `rotation` is (F*J).
Motion MakeMotion(SkeletonPtr skeleton, FrameRate rate, std::vector<Vector3d> root_translation,
                  std::vector<Quaterniond> rotation, std::vector<double> bone_length);
Motion MakeJointsOnly(SkeletonPtr skeleton, FrameRate rate, JointPositions joints);

/// Whether Exp keeps the released code's floor (angle at least 0.01 rad, a2m_actor.md B.3) or is exact.
enum class LieExp { kReleased, kExact };

/// Action2Motion's forward kinematics (a2m_actor.md B.3, paper eq. 4): along each chain, starting from the identity,
/// R <- R Exp(w_c), p_c = p_parent + R (bone_c o_c). `parameters` is one frame of 3*J numbers: root translation, then
/// w_1..w_{J-1}. `root_rotation` (rotation vector) is an option the released training never uses. All in double.
/// Requires skeleton.lie.
void LieForward(const Skeleton& skeleton, const double* parameters, const std::vector<double>& bone_length, LieExp exp,
                Vector3d* joints, const Vector3d* root_rotation = nullptr);

/// Bone lengths |p_j - p_parent| of one frame, 0 for the root. (J), metres. Parents along the Lie chains if `lie`.
std::vector<double> BoneLengths(const Skeleton& skeleton, const Vector3d* joints);

/// Tree rotations of a full motion as Lie parameters of one frame, twist about the bones included: LieForward with the
/// motion's bone lengths gives its joints. Requires skeleton.lie with the tree's own parents. `parameters` receives
/// 3*J.
void LieFromTree(const Motion& motion, int frame, double* parameters);

}  // namespace mocurate
