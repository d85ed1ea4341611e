#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/base/pi.h"
#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "ingest/synthetic/sensors.h"

namespace mocurate {

constexpr double kRightAngle = 0.5 * kPi;

/// A rotation vector of a joint, rad. '?' stands for both sides: the vector is the left one's, mirrored for the right.
/// Rotations of one joint multiply in their order.
struct JointTurn {
  const char* joint;
  Vector3d rotation;
};

/// Where a person faces: about towards a single camera, any way before several; nowhere, because the pelvis faces up or
/// down or the person lies; away from the cameras.
enum class Faces { kCamera, kNowhere, kAway };

struct HardPose {
  const char* name;
  Faces faces;
  Vector3d root;  ///< rotation vector of the pelvis: upright and facing +z is 0
  std::vector<JointTurn> joints;
};

/// On smpl24: T-pose, left is +x. Positive x bends the trunk forwards, knees backwards, and lowers toes.
inline const std::vector<HardPose>& HardPoses() {
  static const std::vector<HardPose> poses = {
      {"bent_forwards",
       Faces::kCamera,
       {0.75, 0, 0},
       {{"?_hip", {-0.95, 0, 0.08}},
        {"?_knee", {0.2, 0, 0}},
        {"spine1", {0.7, 0, 0}},
        {"spine2", {0.45, 0, 0}},
        {"spine3", {0.3, 0, 0}},
        {"neck", {0.2, 0, 0}},
        {"?_shoulder", {0, -1.2, 0.6}},
        {"?_elbow", {0, -0.2, 0}}}},
      {"bent_sideways",
       Faces::kCamera,
       {0, 0, -0.15},
       {{"left_hip", {0, 0, 0.35}},
        {"right_hip", {0, 0, -0.05}},
        {"spine1", {0, 0, -0.45}},
        {"spine2", {0, 0, -0.35}},
        {"spine3", {0, 0, -0.35}},
        {"neck", {0, 0, -0.2}},
        {"right_collar", {0, 0, -0.25}},
        {"right_shoulder", {0, 0, -1.1}},
        {"left_shoulder", {0, 0, -0.1}}}},
      {"crouching",
       Faces::kCamera,
       {0.45, 0, 0},
       {{"?_hip", {-2.1, 0, 0.3}},
        {"?_knee", {2.5, 0, 0}},
        {"?_ankle", {-0.55, 0, 0}},
        {"spine1", {0.3, 0, 0}},
        {"spine2", {0.2, 0, 0}},
        {"spine3", {0.15, 0, 0}},
        {"?_shoulder", {-0.17, -1.41, 0.14}},
        {"?_elbow", {0, -0.3, 0}}}},
      {"kneeling_on_one_knee",
       Faces::kCamera,
       {0.05, 0, 0},
       {{"left_hip", {-1.75, 0, 0.1}},
        {"left_knee", {1.7, 0, 0}},
        {"right_knee", {1.5, 0, 0}},
        {"right_ankle", {1.0, 0, 0}},
        {"left_shoulder", {0, -0.9, -0.8}},
        {"left_elbow", {0, -0.7, 0}},
        {"right_shoulder", {0, 0, 1.2}},
        {"right_elbow", {0, 0.3, 0}}}},
      {"kneeling",
       Faces::kCamera,
       {0, 0, 0},
       {{"?_hip", {0, 0, 0.1}},
        {"?_knee", {1.5, 0, 0}},
        {"?_ankle", {1.0, 0, 0}},
        {"?_shoulder", {0, 0, -1.2}},
        {"?_elbow", {0, -0.3, 0}}}},
      {"lying_on_the_back",
       Faces::kNowhere,
       {-kRightAngle, 0, 0},
       {{"?_hip", {0, 0, 0.12}}, {"?_ankle", {0.4, 0, 0}}, {"?_shoulder", {0, 0, -1.0}}}},
      {"lying_on_the_front",
       Faces::kNowhere,
       {kRightAngle, 0, 0},
       {{"?_hip", {0, 0, 0.12}},
        {"?_ankle", {1.0, 0, 0}},
        {"neck", {0, 0.7, 0}},
        {"?_shoulder", {0, -0.25, 0}},
        {"?_shoulder", {0, 0, 0.3}},
        {"?_shoulder", {-kRightAngle, 0, 0}},
        {"?_elbow", {0, -1.3, 0}}}},
      {"lying_on_the_left_side",
       Faces::kNowhere,
       {0, 0, -kRightAngle},
       {{"left_hip", {-0.6, 0, 0}},
        {"left_knee", {0.8, 0, 0}},
        {"right_hip", {-0.9, 0, 0.15}},
        {"right_knee", {1.1, 0, 0}},
        {"spine1", {0.15, 0, 0}},
        {"neck", {0, 0, -0.25}},
        {"left_shoulder", {0, -1.3, 0}},
        {"right_shoulder", {0, 1.6, 0}},
        {"?_elbow", {0, -0.6, 0}}}},
      {"lying_on_the_right_side",
       Faces::kNowhere,
       {0, 0, kRightAngle},
       {{"right_hip", {-0.6, 0, 0}},
        {"right_knee", {0.8, 0, 0}},
        {"left_hip", {-0.9, 0, -0.15}},
        {"left_knee", {1.1, 0, 0}},
        {"spine1", {0.15, 0, 0}},
        {"neck", {0, 0, 0.25}},
        {"right_shoulder", {0, 1.3, 0}},
        {"left_shoulder", {0, -1.6, 0}},
        {"?_elbow", {0, -0.6, 0}}}},
      {"sitting_on_the_floor",
       Faces::kCamera,
       {-0.15, 0, 0},
       {{"?_hip", {-1.4, 0, 0.15}},
        {"?_knee", {0.1, 0, 0}},
        {"spine1", {0.2, 0, 0}},
        {"spine2", {0.1, 0, 0}},
        {"?_shoulder", {0, -0.5, -1.1}},
        {"?_elbow", {0, -0.4, 0}}}},
      {"sitting_cross_legged",
       Faces::kCamera,
       {0, 0, 0},
       {{"left_hip", {-1.83, 1.34, -0.47}},
        {"left_knee", {2.5, 0, 0}},
        {"right_hip", {-1.83, -1.41, 0.58}},
        {"right_knee", {2.3, 0, 0}},
        {"?_ankle", {0.5, 0, 0}},
        {"spine1", {0.2, 0, 0}},
        {"?_shoulder", {-0.04, -0.33, -0.84}},
        {"?_elbow", {0, -0.91, 0}}}},
      {"handstand",
       Faces::kCamera,
       {0, 0, kPi},
       {{"?_hip", {0, 0, 0.1}},
        {"?_ankle", {0.7, 0, 0}},
        {"neck", {-0.3, 0, 0}},
        {"?_collar", {0, 0, 0.3}},
        {"?_shoulder", {0, 0, 1.2}},
        {"?_shoulder", {-kRightAngle, 0, 0}},
        {"?_wrist", {0, 0, 1.2}}}},
      {"arms_crossed",
       Faces::kCamera,
       {0, 0, 0},
       {{"?_hip", {0, 0, 0.06}},
        {"left_shoulder", {0.79, -1.01, -0.91}},
        {"left_elbow", {0, -1.66, 0}},
        {"right_shoulder", {0.47, 0.94, 0.94}},
        {"right_elbow", {0, 1.9, 0}}}},
      {"hugging_oneself",
       Faces::kCamera,
       {0, 0, 0},
       {{"?_hip", {0, 0, 0.06}},
        {"left_shoulder", {0.33, -1.51, -0.62}},
        {"left_elbow", {0, -1.7, 0}},
        {"right_shoulder", {0.61, 1.44, 0.71}},
        {"right_elbow", {0, 1.43, 0}}}},
      {"back_to_the_cameras",
       Faces::kAway,
       {0, kPi, 0},
       {{"left_hip", {-0.25, 0, 0.05}},
        {"left_knee", {0.2, 0, 0}},
        {"right_hip", {0.15, 0, -0.05}},
        {"?_shoulder", {0, 0, -1.2}},
        {"?_elbow", {0, -0.3, 0}}}},
      {"leg_up_forwards",
       Faces::kCamera,
       {-0.1, 0, 0},
       {{"left_hip", {-1.35, 0, 0}},
        {"left_knee", {0.2, 0, 0}},
        {"right_hip", {0.1, 0, 0}},
        {"?_shoulder", {0, 0, -0.4}}}},
      {"leg_up_sideways",
       Faces::kCamera,
       {0, 0, -0.2},
       {{"left_hip", {0, 0, 0.2}}, {"right_hip", {0, 0, -0.9}}, {"?_shoulder", {0, 0, -0.7}}}},
      {"all_fours",
       Faces::kNowhere,
       {1.45, 0, 0},
       {{"?_hip", {-1.45, 0, 0.08}},
        {"?_knee", {1.5, 0, 0}},
        {"?_ankle", {1.0, 0, 0}},
        {"neck", {-0.3, 0, 0}},
        {"?_shoulder", {0, -1.5, 0}},
        {"?_wrist", {0, 0, 1.2}}}},
  };
  return poses;
}

/// Four poses in which a person's size and shape are measured.
inline const std::vector<HardPose>& StandingPoses() {
  static const std::vector<HardPose> poses = {
      {"arms_apart", Faces::kCamera, {0, 0, 0}, {{"?_shoulder", {0, 0, -0.6}}, {"?_hip", {0, 0, 0.1}}}},
      {"arms_down", Faces::kCamera, {0, 0, 0}, {{"?_shoulder", {0, 0, -1.1}}, {"?_elbow", {0, -0.3, 0}}}},
      {"arms_forwards", Faces::kCamera, {0, 0, 0}, {{"?_shoulder", {0, -1.2, 0}}, {"?_hip", {0, 0, 0.15}}}},
      {"step",
       Faces::kCamera,
       {0, 0, 0},
       {{"?_shoulder", {0, 0, -0.3}}, {"left_hip", {-0.4, 0, 0}}, {"right_hip", {0.3, 0, 0}}}},
  };
  return poses;
}

/// The pose with every joint's rotation changed at random, by `variation` rad RMS and within the joint's limits; then
/// `yaw` about y. One frame of the actor's: the lowest point of the capsules at y = 0, the mean joint above the origin.
inline Motion PosedActor(const Actor& actor, const HardPose& pose, double yaw, double variation, Random random) {
  const Skeleton& skeleton = *actor.skeleton;
  std::vector<Quaterniond> rotations(skeleton.joints.size(), Quaterniond::Identity());
  rotations[0] = ExpQuaternion(pose.root);
  for (const JointTurn& turn : pose.joints) {
    const std::string name = turn.joint;
    for (const bool right : {false, true}) {
      const bool both = name[0] == '?';
      if (right && !both) continue;
      const Vector3d mirrored(turn.rotation.x(), -turn.rotation.y(), -turn.rotation.z());
      Quaterniond& of_joint = rotations[static_cast<std::size_t>(
          *skeleton.FindJoint(both ? (right ? "right" : "left") + name.substr(1) : name))];
      of_joint = of_joint * ExpQuaternion(right ? mirrored : turn.rotation);
    }
  }
  for (std::size_t j = 0; j < rotations.size(); ++j) {
    const Vector3d change(random.Normal(), random.Normal(), random.Normal());
    rotations[j] = rotations[j] * ExpQuaternion(variation / std::sqrt(3.0) * change);
    if (const auto& limits = skeleton.joints[j].limits)
      rotations[j] = ExpQuaternion(LogQuaternion(rotations[j]).cwiseMax(limits->min).cwiseMin(limits->max));
  }
  rotations[0] = ExpQuaternion({0.0, yaw, 0.0}) * rotations[0];
  const auto posed_at = [&](const Vector3d& root) {
    return MakeMotion(actor.skeleton, FrameRate{30, 1}, {root}, rotations, actor.subject.bone_length);
  };
  const Motion posed = posed_at(Vector3d::Zero());
  double lowest = std::numeric_limits<double>::max();
  for (const PosedCapsule& capsule : BodyView(actor).Capsules(posed, 0))
    lowest = std::min(lowest, std::min(capsule.begin.y(), capsule.end.y()) - capsule.radius);
  Vector3d middle = Vector3d::Zero();
  for (int j = 0; j < posed.joint_count(); ++j) middle += posed.joints.at(0, j) / posed.joint_count();
  return posed_at({-middle.x(), -lowest, -middle.z()});
}

}  // namespace mocurate
