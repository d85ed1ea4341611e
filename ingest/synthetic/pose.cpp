#include "ingest/synthetic/pose.h"

#include <algorithm>
#include <string>

namespace mocurate {
namespace {

constexpr double kRightAngle = 1.57079632679489661923;
constexpr double kMostDorsiflexion = -0.7;
constexpr double kMostPlantarflexion = 0.9;

Quaterniond AboutX(double angle) { return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitX())); }
Quaterniond AboutY(double angle) { return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY())); }
Quaterniond AboutZ(double angle) { return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitZ())); }

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
  // The trunk bends at two places alike.
  const Quaterniond half =
      AboutY(0.5 * pose.trunk_twist) * AboutZ(-0.5 * pose.trunk_side) * AboutX(0.5 * pose.trunk_bend);
  rotations.Set("spine", half);
  rotations.Set("shoulder_center", half);
  rotations.Set("head", AboutY(pose.head_turn) * AboutX(pose.head_nod));
  for (int side = 0; side < 2; ++side) {
    const std::string prefix = side == 0 ? "left_" : "right_";
    const double mirror = side == 0 ? 1.0 : -1.0;  // a mirror image turns the other way about y and z
    const ArmPose& arm = pose.arm[side];
    rotations.Set(prefix + "shoulder", AboutX(-arm.flex) * AboutZ(mirror * arm.abduct) * AboutY(mirror * arm.twist) *
                                           AboutZ(-mirror * kRightAngle));
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
