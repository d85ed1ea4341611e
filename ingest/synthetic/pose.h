#pragma once

#include <vector>

#include "core/motion/motion.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// Angles of an arm, radians. All zero: it hangs straight down.
struct ArmPose {
  double flex = 0.0;    ///< raised to the front
  double abduct = 0.0;  ///< raised to its own side
  double twist = 0.0;   ///< about its axis: at a right angle a bent forearm points sideways instead of forwards
  double elbow = 0.0;
  double wrist = 0.0;
};

/// Angles of a leg, radians. All zero: it stands straight.
struct LegPose {
  double flex = 0.0;
  double abduct = 0.0;
  double twist = 0.0;  ///< toes outwards
  double knee = 0.0;
  double point = 0.0;  ///< toes down, against a level foot
};

/// A posture in anatomical angles. Sides are (left, right).
struct Pose {
  ArmPose arm[2];
  LegPose leg[2];
  double trunk_bend = 0.0;   ///< forwards
  double trunk_twist = 0.0;  ///< right shoulder forwards
  double trunk_side = 0.0;   ///< to the right
  double head_nod = 0.0;
  double head_rotation = 0.0;  ///< to the left
  double lean = 0.0;           ///< of the pelvis, forwards
  double yaw = 0.0;            ///< of the whole body about +y
  double left_support = -1.0;  ///< share of the weight on the left foot; negative: on the lower one
  double height = 0.0;         ///< of the lowest foot above the floor, metres
  double homing = 0.0;         ///< share of the way back to the take's starting point since the previous frame
};

/// Rotations (J) of skeleton "kinect20" or "smpl24", parent_from_joint; for the root world_from_root with the person
/// facing +z.
std::vector<Quaterniond> RotationsOf(const Pose& pose, const Skeleton& skeleton);

/// A body in these poses, one per frame, moved so that the foot that carries the weight stays in place. Skeletons
/// kinect20 and smpl24 (by their ankles and feet). `start` is the starting point in frame 0: x, z of the pelvis, y of
/// the floor. The body never falls faster than gravity allows. Canonical axes, metres.
Motion MoveBody(const SkeletonPtr& skeleton, const std::vector<double>& bone_length, FrameRate rate,
                const std::vector<Pose>& poses, const Vector3d& start);

}  // namespace mocurate
