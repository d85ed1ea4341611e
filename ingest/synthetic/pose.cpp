#include "ingest/synthetic/pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "core/motion/kinematics.h"
#include "ingest/synthetic/actions.h"

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

constexpr double kSupportSoft = 0.012;  // metres over which the weight shifts from one foot to the other

/// The four points a person stands on: heels and toes, relative to the root.
std::array<Vector3d, 4> Soles(const Skeleton& skeleton, const std::vector<Vector3d>& joints, double scale) {
  // Metres from ankle and foot of a standing skeleton down to the floor: kinect20 has its feet on it, smpl24 has the
  // capsules of CapsuleBody below them.
  const bool kinect = skeleton.name == "kinect20";
  const double heel = kinect ? 0.055 : 0.073, ball = kinect ? 0.0 : 0.013;
  std::array<Vector3d, 4> soles;
  soles.fill(Vector3d::Zero());
  int next = 0;
  for (const char* name : {"left_ankle", "right_ankle", "left_foot", "right_foot"}) {
    soles[next] = joints[*skeleton.FindJoint(name)] - joints[0];
    soles[next].y() -= (next < 2 ? heel : ball) * scale;
    ++next;
  }
  return soles;
}

/// Share of the weight on each point: almost all on the lowest ones.
std::array<double, 4> Weights(const std::array<Vector3d, 4>& soles) {
  double lowest = soles[0].y();
  for (const Vector3d& sole : soles) lowest = std::min(lowest, sole.y());
  std::array<double, 4> weights{};
  double sum = 0.0;
  for (int i = 0; i < 4; ++i) sum += weights[i] = std::exp((lowest - soles[i].y()) / kSupportSoft);
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Share of the weight on each point when the left foot carries `left`: between heel and toe by their height.
std::array<double, 4> SharedWeights(const std::array<double, 4>& lowest, double left) {
  std::array<double, 4> weights = lowest;
  for (int side = 0; side < 2; ++side) {
    const double foot = lowest[side] + lowest[side + 2] + 1e-9;
    const double share = side == 0 ? left : 1.0 - left;
    for (const int point : {side, side + 2}) weights[point] = share * (lowest[point] + 0.5e-9) / foot;
  }
  return weights;
}

/// A segment of the body between two joints, with its share of the weight (Winter 2009, table 4.1).
struct WeighedPart {
  const char* from;
  const char* to;
  double share;
  double centre;  ///< of its length
};
constexpr WeighedPart kLimbs[] = {{"hip", "knee", 0.100, 0.433},
                                  {"knee", "ankle", 0.0465, 0.433},
                                  {"ankle", "foot", 0.0145, 0.5},
                                  {"shoulder", "elbow", 0.028, 0.436},
                                  {"elbow", "wrist", 0.022, 0.682}};
constexpr double kHeadWeight = 0.081, kTrunkWeight = 0.497;

/// Height of the centre of mass above the root.
double CentreAboveRoot(const Skeleton& skeleton, const std::vector<Vector3d>& joints) {
  const auto height = [&](const std::string& name) {
    const std::optional<int> joint = skeleton.FindJoint(name);
    return joint ? joints[static_cast<std::size_t>(*joint)].y() - joints[0].y() : 0.0;
  };
  double centre = kHeadWeight * height("head");
  for (const std::string side : {"left_", "right_"}) {
    centre += 0.25 * kTrunkWeight * (height(side + "hip") + height(side + "shoulder"));
    for (const WeighedPart& limb : kLimbs) {
      const double from = height(side + limb.from);
      centre += limb.share * (from + limb.centre * (height(side + limb.to) - from));
    }
  }
  return centre;
}

/// A body falls no faster than gravity allows. Where the legs would pull it down faster, the feet leave the floor for a
/// moment and the body follows a ballistic path. `height`: of the centre of mass while the feet carry it (metres, one
/// per frame).
std::vector<double> NoFasterThanFall(const std::vector<double>& height, double frame_s) {
  std::vector<double> path = height;
  for (std::size_t f = 2; f < path.size(); ++f)
    path[f] = std::max(height[f], 2.0 * path[f - 1] - path[f - 2] - kGravity * frame_s * frame_s);
  return path;
}

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

Motion MoveBody(const SkeletonPtr& skeleton, const std::vector<double>& bone_length, FrameRate rate,
                const std::vector<Pose>& poses, const Vector3d& start) {
  const int ankle = *skeleton->FindJoint("left_ankle");
  const double scale = bone_length[ankle] / skeleton->joints[ankle].rest_offset.norm();
  const auto joint_count = static_cast<std::size_t>(skeleton->joint_count());
  std::vector<Vector3d> root;
  std::vector<double> centre;  // of mass, above the root
  std::vector<Quaterniond> rotation;
  std::vector<Vector3d> joints(joint_count);
  std::array<Vector3d, 4> before;
  before.fill(Vector3d::Zero());
  Vector3d place(start.x(), 0.0, start.z());
  for (const Pose& pose : poses) {
    const std::vector<Quaterniond> local = RotationsOf(pose, *skeleton);
    ForwardKinematics(*skeleton, Vector3d::Zero(), local.data(), bone_length, joints.data());
    const std::array<Vector3d, 4> soles = Soles(*skeleton, joints, scale);
    const std::array<double, 4> weights = Weights(soles);
    const std::array<double, 4> support = pose.left_support < 0.0 ? weights : SharedWeights(weights, pose.left_support);
    double height = start.y() + pose.height;
    for (int i = 0; i < 4; ++i) {
      height -= weights[i] * soles[i].y();
      if (!root.empty()) place -= support[i] * (soles[i] - before[i]);
    }
    before = soles;
    if (pose.homing > 0.0)
      place += pose.homing * (Vector3d(start.x(), 0.0, start.z()) - Vector3d(place.x(), 0.0, place.z()));
    root.emplace_back(place.x(), height, place.z());
    centre.push_back(CentreAboveRoot(*skeleton, joints));
    rotation.insert(rotation.end(), local.begin(), local.end());
  }
  std::vector<double> height;
  for (std::size_t f = 0; f < root.size(); ++f) height.push_back(root[f].y() + centre[f]);
  height = NoFasterThanFall(height, rate.FrameTime(1));
  for (std::size_t f = 0; f < root.size(); ++f) root[f].y() = height[f] - centre[f];
  for (std::size_t j = 0; j < joint_count; ++j) {
    MakeSignContinuous(rotation.data() + j, poses.size(), joint_count);
  }
  return MakeMotion(skeleton, rate, std::move(root), std::move(rotation), bone_length);
}

}  // namespace mocurate
