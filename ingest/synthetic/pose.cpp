#include "ingest/synthetic/pose.h"

#include <algorithm>
#include <string>

namespace mocurate {
namespace {

constexpr double kRightAngle = 1.57079632679489661923;
constexpr double kMostDorsiflexion = -0.7;
constexpr double kMostPlantarflexion = 0.9;
constexpr double kCollarFollows = 0.5;  // radians from which the collarbone rises with the arm
constexpr double kCollarShare = 0.2;

Quaterniond AboutX(double angle) { return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitX())); }
Quaterniond AboutY(double angle) { return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY())); }
Quaterniond AboutZ(double angle) { return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitZ())); }

/// Own names only: a synonym may be another joint's name.
bool HasJoint(const Skeleton& skeleton, const std::string& name) {
  return std::any_of(skeleton.joints.begin(), skeleton.joints.end(),
                     [&](const Joint& joint) { return joint.name == name; });
}

class Rotations {
 public:
  explicit Rotations(const Skeleton& skeleton)
      : skeleton_(skeleton), values_(skeleton.joints.size(), Quaterniond::Identity()) {}
  void Set(const std::string& joint, const Quaterniond& rotation) {
    if (const auto index = skeleton_.FindJoint(joint)) values_[*index] = rotation.normalized();
  }
  std::vector<Quaterniond> Take() { return std::move(values_); }

 private:
  const Skeleton& skeleton_;
  std::vector<Quaterniond> values_;
};

}  // namespace

std::vector<Quaterniond> RotationsOf(const Pose& pose, const Skeleton& skeleton) {
  Rotations rotations(skeleton);
  rotations.Set(skeleton.joints[0].name, AboutY(pose.yaw) * AboutX(pose.lean));
  // The trunk bends equally at two or three joints, the head rotates at one or two.
  const bool has_spines = HasJoint(skeleton, "spine3");
  const double share = has_spines ? 1.0 / 3.0 : 0.5;
  const Quaterniond part =
      AboutY(share * pose.trunk_twist) * AboutZ(-share * pose.trunk_side) * AboutX(share * pose.trunk_bend);
  if (has_spines) {
    for (const char* joint : {"spine1", "spine2", "spine3"}) rotations.Set(joint, part);
    const Quaterniond half = AboutY(0.5 * pose.head_rotation) * AboutX(0.5 * pose.head_nod);
    for (const char* joint : {"neck", "head"}) rotations.Set(joint, half);
  } else {
    rotations.Set("spine", part);
    rotations.Set("shoulder_center", part);
    rotations.Set("head", AboutY(pose.head_rotation) * AboutX(pose.head_nod));
  }
  for (int side = 0; side < 2; ++side) {
    const std::string prefix = side == 0 ? "left_" : "right_";
    const double mirror = side == 0 ? 1.0 : -1.0;  // a mirror image rotates the other way about y and z
    const ArmPose& arm = pose.arm[side];
    const Quaterniond upper_arm =
        AboutX(-arm.flex) * AboutZ(mirror * arm.abduct) * AboutY(mirror * arm.twist) * AboutZ(-mirror * kRightAngle);
    if (has_spines) {
      const double raised = std::max(std::abs(arm.flex), std::abs(arm.abduct)) - kCollarFollows;
      const double rise = raised > 0.0 ? kCollarShare * raised * raised / (raised + 0.3) : 0.0;
      const Quaterniond collar = AboutZ(mirror * rise);
      rotations.Set(prefix + "collar", collar);
      rotations.Set(prefix + "shoulder", collar.conjugate() * upper_arm);
    } else {
      rotations.Set(prefix + "shoulder", upper_arm);
    }
    rotations.Set(prefix + "elbow", AboutY(-mirror * arm.elbow));
    rotations.Set(prefix + "wrist", AboutY(-mirror * arm.wrist));
    const LegPose& leg = pose.leg[side];
    rotations.Set(prefix + "hip", AboutX(-leg.flex) * AboutZ(mirror * leg.abduct) * AboutY(mirror * leg.twist));
    rotations.Set(prefix + "knee", AboutX(leg.knee));
    const double level = leg.flex - leg.knee - pose.lean;
    rotations.Set(prefix + "ankle", AboutX(std::clamp(level + leg.point, kMostDorsiflexion, kMostPlantarflexion)) *
                                        AboutZ(-mirror * leg.abduct));
  }
  return rotations.Take();
}

}  // namespace mocurate
