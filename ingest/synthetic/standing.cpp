#include "ingest/synthetic/standing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "core/motion/kinematics.h"
#include "ingest/synthetic/action_parts.h"

namespace mocurate {
namespace {

constexpr double kSupportSoft = 0.012;  // metres over which the weight shifts from one foot to the other

/// Metres from a joint of a standing skeleton down to the floor.
struct SoleHeights {
  double heel = 0.055;  ///< below the ankle
  double ball = 0.0;    ///< below the foot
};

/// kinect20 has its feet on the floor; smpl24 has the capsules of CapsuleBody below them.
SoleHeights SolesOf(const Skeleton& skeleton) {
  return skeleton.name == "kinect20" ? SoleHeights{} : SoleHeights{0.073, 0.013};
}

/// The four points a person stands on: heels and toes, relative to the root.
std::array<Vector3d, 4> Soles(const Skeleton& skeleton, const std::vector<Vector3d>& joints, double scale) {
  const SoleHeights heights = SolesOf(skeleton);
  std::array<Vector3d, 4> soles;
  soles.fill(Vector3d::Zero());
  int next = 0;
  for (const char* name : {"left_ankle", "right_ankle", "left_foot", "right_foot"}) {
    soles[next] = joints[*skeleton.FindJoint(name)] - joints[0];
    soles[next].y() -= (next < 2 ? heights.heel : heights.ball) * scale;
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
