#include "tests/body/self_penetration.h"

#include <algorithm>

#include "core/body/capsule_body.h"
#include "core/motion/kinematics.h"
#include "core/motion/limbs.h"

namespace mocurate {
namespace {

enum class Part { kUpper, kLower, kEnd };  // upper arm or thigh; forearm or shin; hand or foot

/// The limb of a joint's frame; limb -1: trunk, neck or head. 0, 1: arms, 2, 3: legs.
struct Place {
  int limb = -1;
  Part part = Part::kUpper;
};

/// (J) of each joint; empty for a skeleton without limbs.
std::vector<Place> PlacesOf(const Skeleton& skeleton) {
  const Limbs limbs = LimbsOf(skeleton);
  const std::array<Limb, 4> all = {limbs.arm[0], limbs.arm[1], limbs.leg[0], limbs.leg[1]};
  if (std::none_of(all.begin(), all.end(), [](const Limb& limb) { return limb.known(); })) return {};
  std::vector<Place> places(skeleton.joints.size());
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    Place& place = places[static_cast<std::size_t>(j)];
    const int parent = skeleton.joints[static_cast<std::size_t>(j)].parent;
    if (parent >= 0) place = places[static_cast<std::size_t>(parent)];
    for (int l = 0; l < 4; ++l) {
      const Limb& limb = all[static_cast<std::size_t>(l)];
      if (!limb.known()) continue;
      if (j == limb.root) place = {l, Part::kUpper};
      if (j == limb.middle) place = {l, Part::kLower};
      if (j == limb.end) place = {l, Part::kEnd};
    }
  }
  return places;
}

bool AreCompared(const Place& a, const Place& b) {
  if (a.limb < 0 && b.limb < 0) return false;
  if (a.limb < 0) return b.part != Part::kUpper;
  if (b.limb < 0) return a.part != Part::kUpper;
  if (a.limb != b.limb) return true;
  return (a.part == Part::kUpper && b.part == Part::kEnd) || (a.part == Part::kEnd && b.part == Part::kUpper);
}

/// Mean over the frames of each bone's length. (J), metres.
std::vector<double> MeanBoneLengths(const Motion& motion) {
  std::vector<double> mean(static_cast<std::size_t>(motion.joint_count()), 0.0);
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 1; j < motion.joint_count(); ++j) {
      const int parent = motion.skeleton->joints[static_cast<std::size_t>(j)].parent;
      mean[static_cast<std::size_t>(j)] +=
          (motion.joints.at(f, j) - motion.joints.at(f, parent)).norm() / motion.frame_count();
    }
  }
  return mean;
}

/// Capsules along the bones: offsets from the bones need rotations.
CapsuleBody BodyOnBones(const SkeletonPtr& skeleton, double scale) {
  CapsuleBody body;
  body.skeleton = skeleton;
  for (const Capsule& bone : BoneCapsules::Make(skeleton, scale).capsules) {
    BodyCapsule capsule;
    capsule.frame = bone.parent;
    capsule.end_joint = bone.joint;
    capsule.radius = bone.radius;
    body.capsules.push_back(capsule);
  }
  return body;
}

/// Two capsules of a body that are compared.
struct Pair {
  std::size_t a = 0;
  std::size_t b = 0;
  double allowed = 0.0;  ///< metres by which they overlap in the rest pose
};

double Overlap(const PosedCapsule& a, const PosedCapsule& b) {
  return a.radius + b.radius - SegmentDistance(a.begin, a.end, b.begin, b.end);
}

std::vector<Pair> PairsOf(const CapsuleBody& body, const std::vector<Place>& places,
                          const std::vector<double>& lengths) {
  std::vector<Vector3d> joints(places.size());
  const std::vector<Quaterniond> rest(places.size(), Quaterniond::Identity());
  ForwardKinematics(*body.skeleton, Vector3d::Zero(), rest.data(), lengths, joints.data());
  const std::vector<PosedCapsule> posed = PosedCapsules(body, joints.data(), rest.data());
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < posed.size(); ++a) {
    for (std::size_t b = a + 1; b < posed.size(); ++b) {
      const Place& one = places[static_cast<std::size_t>(body.capsules[a].frame)];
      const Place& other = places[static_cast<std::size_t>(body.capsules[b].frame)];
      if (AreCompared(one, other)) pairs.push_back({a, b, std::max(0.0, Overlap(posed[a], posed[b]))});
    }
  }
  return pairs;
}

}  // namespace

double SegmentDistance(const Vector3d& a_begin, const Vector3d& a_end, const Vector3d& b_begin, const Vector3d& b_end) {
  const Vector3d a = a_end - a_begin, b = b_end - b_begin, between = a_begin - b_begin;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b);
  const double a_between = a.dot(between), b_between = b.dot(between);
  const double determinant = aa * bb - ab * ab;
  // Parallel segments are nearest at an end of one of them, which the clamping below finds from any start.
  double s =
      determinant > 1e-12 * aa * bb ? std::clamp((ab * b_between - a_between * bb) / determinant, 0.0, 1.0) : 0.0;
  double t = bb > 0.0 ? (ab * s + b_between) / bb : 0.0;
  if (bb <= 0.0 || t < 0.0 || t > 1.0) {
    t = std::clamp(t, 0.0, 1.0);
    s = aa > 0.0 ? std::clamp((ab * t - a_between) / aa, 0.0, 1.0) : 0.0;
  }
  return (between + s * a - t * b).norm();
}

double SelfPenetration::max_depth() const {
  return depth.empty() ? 0.0 : *std::max_element(depth.begin(), depth.end());
}

std::optional<SelfPenetration> MeasureSelfPenetration(const Motion& motion, const SelfPenetrationOptions& options) {
  const std::vector<Place> places = PlacesOf(*motion.skeleton);
  if (places.empty()) return std::nullopt;
  const bool joints_only = motion.joints_only();
  const std::vector<double> lengths = joints_only ? MeanBoneLengths(motion) : motion.bone_length;
  const double scale = BodyScale(*motion.skeleton, lengths);
  const CapsuleBody body =
      joints_only ? BodyOnBones(motion.skeleton, scale) : CapsuleBody::Make(motion.skeleton, scale);
  const std::vector<Pair> pairs = PairsOf(body, places, lengths);

  SelfPenetration measured;
  std::vector<Vector3d> joints(places.size());
  std::vector<Quaterniond> frames(places.size(), Quaterniond::Identity());
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) joints[static_cast<std::size_t>(j)] = motion.joints.at(f, j);
    if (!joints_only) {
      ForwardKinematics(*motion.skeleton, motion.root_translation[static_cast<std::size_t>(f)],
                        &motion.rotation_at(f, 0), lengths, joints.data(), frames.data());
    }
    const std::vector<PosedCapsule> posed = PosedCapsules(body, joints.data(), frames.data());
    double deepest = 0.0;
    std::array<int, 2> of = {-1, -1};
    for (const Pair& pair : pairs) {
      const double depth = Overlap(posed[pair.a], posed[pair.b]) - pair.allowed;
      if (depth <= deepest) continue;
      deepest = depth;
      of = {body.capsules[pair.a].frame, body.capsules[pair.b].frame};
    }
    measured.depth.push_back(deepest);
    measured.joints.push_back(of);
    measured.mean_depth += deepest;
    measured.penetrating_share += deepest > options.threshold ? 1.0 : 0.0;
  }
  const double frame_count = std::max(1, motion.frame_count());
  measured.mean_depth /= frame_count;
  measured.penetrating_share /= frame_count;
  return measured;
}

}  // namespace mocurate
