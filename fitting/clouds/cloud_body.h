#pragma once

#include <vector>

#include "core/body/capsule_body.h"
#include "fitting/costs/pose_state.h"

namespace mocurate {

/// A capsule that moves with the frame of one joint. It goes from that joint to `end_joint` (a child, or the joint
/// itself), both ends moved by offsets in the joint's frame: flesh is not centred on bones and reaches past the last
/// joints. Metres.
struct FleshCapsule {
  int frame = 0;
  int end_joint = 0;
  Vector3d begin_offset = Vector3d::Zero();
  Vector3d end_offset = Vector3d::Zero();
  double radius = 0.05;
  int mirror = 0;  ///< the capsule on the other side; its own index on the midline
};

/// The body that point clouds are fitted with.
struct FleshBody {
  SkeletonPtr skeleton;
  std::vector<FleshCapsule> capsules;

  /// One capsule per bone with the radius of its end; the trunk, hands, feet and head of a skeleton with SMPL's joints
  /// get the cross-sections of the CC0 body template that its rest pose is taken from. Offsets and radii are scaled by
  /// `scale`, radii also by `radius_scale`.
  static FleshBody Make(SkeletonPtr skeleton, double scale, double radius_scale);

  /// (J) joints that turn a capsule.
  std::vector<bool> MovingJoints() const;
};

/// Posed ends of a capsule in the world.
struct CapsuleEnds {
  Vector3d begin;
  Vector3d end;
};
CapsuleEnds EndsOf(const FleshCapsule& capsule, const PoseState& state, int frame);

}  // namespace mocurate
