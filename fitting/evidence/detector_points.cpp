#include "fitting/evidence/detector_points.h"

#include <algorithm>
#include <iterator>
#include <optional>

namespace mocurate {
namespace {

/// A point fixed to a joint: rest pose of the body template, metres. The first listed joint that a skeleton has is
/// used.
struct FixedPoint {
  const char* name;
  const char* joint;
  Vector3d offset;
};

/// Left and middle; the right side mirrors the left.
const std::vector<FixedPoint>& FixedPoints() {
  static const std::vector<FixedPoint> points = {{"mid_shoulder", "spine3", {0.0, 0.235, 0.02}},
                                                 {"mid_shoulder", "neck", {0.0, -0.08, 0.0}},
                                                 {"upper_neck", "neck", {0.0, 0.09, 0.03}},
                                                 {"nose", "head", {0.0, 0.035, 0.105}},
                                                 {"left_eye", "head", {0.032, 0.070, 0.085}},
                                                 {"left_ear", "head", {0.074, 0.045, -0.005}},
                                                 {"head_top", "head", {0.0, 0.165, -0.01}},
                                                 {"left_heel", "left_ankle", {0.0, -0.055, -0.050}},
                                                 {"left_big_toe", "left_ankle", {-0.015, -0.065, 0.192}},
                                                 {"left_small_toe", "left_ankle", {0.050, -0.068, 0.162}}};
  return points;
}

constexpr char kMiddleOfShoulders[] = "mid_shoulder";
constexpr char kMiddleOfHips[] = "mid_hip";
constexpr double kPelvisBesideHips =
    0.005;  ///< metres from the middle of the hips; beyond, the pelvis is another point

bool Has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "left_eye" of "right_eye" and back; other names unchanged.
std::string OtherSide(const std::string& name) {
  if (name.rfind("left_", 0) == 0) return "right_" + name.substr(5);
  if (name.rfind("right_", 0) == 0) return "left_" + name.substr(6);
  return name;
}

/// Detectors' mid-hip point is the middle of their hips and adds no information. Taken for a pelvis that lies above
/// them, it would give a wrong pitch.
bool IsAboveHips(const Skeleton& skeleton) {
  const auto hips = skeleton.Hips();
  if (!hips) return false;
  const Joint& left = skeleton.joints[static_cast<std::size_t>((*hips)[0])];
  const Joint& right = skeleton.joints[static_cast<std::size_t>((*hips)[1])];
  return left.parent == 0 && right.parent == 0 &&
         (left.rest_offset + right.rest_offset).norm() >= 2.0 * kPelvisBesideHips;
}

std::optional<Joint> PointNamed(const std::string& name, const Skeleton& skeleton) {
  Joint point;
  point.name = name;
  point.landmark = true;
  point.radius = 0.02;
  for (const Landmark& landmark : skeleton.landmarks) {
    if (landmark.name != name) continue;
    point.parent = landmark.joint;
    point.rest_offset = landmark.offset;
    return point;
  }
  for (const FixedPoint& fixed : FixedPoints()) {
    const bool same = name == fixed.name;
    if (!same && OtherSide(name) != fixed.name) continue;
    const auto joint = skeleton.FindJoint(same ? fixed.joint : OtherSide(fixed.joint));
    if (!joint) continue;
    point.parent = *joint;
    point.rest_offset = fixed.offset;
    if (!same) point.rest_offset.x() = -point.rest_offset.x();
    return point;
  }
  return {};
}

template <class T>
std::vector<T> FirstJoints(const std::vector<T>& values, int frames, int joints, int kept, int numbers) {
  std::vector<T> cut;
  if (values.empty()) return cut;
  cut.reserve(static_cast<std::size_t>(frames) * kept * numbers);
  for (int f = 0; f < frames; ++f) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(f) * joints * numbers;
    cut.insert(cut.end(), first, first + static_cast<std::ptrdiff_t>(kept) * numbers);
  }
  return cut;
}

}  // namespace

std::vector<std::string> DetectorNames(const std::vector<std::string>& names) {
  std::vector<std::string> meant = names;
  if (Has(names, "nose"))
    std::replace(meant.begin(), meant.end(), std::string("neck"), std::string(kMiddleOfShoulders));
  return meant;
}

SkeletonPtr WithDetectorPoints(const SkeletonPtr& skeleton, const std::vector<std::string>& names) {
  auto full = std::make_shared<Skeleton>(*skeleton);
  full->landmarks.clear();
  if (Has(names, kMiddleOfHips) && IsAboveHips(*skeleton) && skeleton->joints[0].name != kMiddleOfHips) {
    std::vector<std::string>& synonyms = full->joints[0].synonyms;
    synonyms.erase(std::remove(synonyms.begin(), synonyms.end(), kMiddleOfHips), synonyms.end());
  }
  std::vector<std::string> sorted = names;
  std::sort(sorted.begin(), sorted.end());
  for (const std::string& name : sorted) {
    if (full->FindJoint(name)) continue;
    std::optional<Joint> point = PointNamed(name, *skeleton);
    if (!point) continue;
    const auto index = full->joint_count();
    point->mirror = index;
    for (int j = skeleton->joint_count(); j < index; ++j) {
      if (full->joints[j].name != OtherSide(name)) continue;
      full->joints[j].mirror = index;
      point->mirror = j;
    }
    full->joints.push_back(std::move(*point));
  }
  return full;
}

SkeletonPtr WithoutDetectorPoints(const SkeletonPtr& body, const SkeletonPtr& skeleton) {
  if (std::equal(skeleton->joints.begin(), skeleton->joints.end(), body->joints.begin(),
                 [](const Joint& a, const Joint& b) { return a.rest_offset == b.rest_offset; }) &&
      skeleton->shape == body->shape) {
    return skeleton;
  }
  auto own = std::make_shared<Skeleton>(*skeleton);
  for (std::size_t j = 0; j < own->joints.size(); ++j) own->joints[j].rest_offset = body->joints[j].rest_offset;
  own->shape = body->shape;
  return own;
}

SkeletonTracks WithoutDetectorPoints(const SkeletonTracks& tracks, const SkeletonPtr& skeleton) {
  SkeletonTracks cut = tracks;
  const int kept = skeleton->joint_count();
  cut.skeleton = WithoutDetectorPoints(tracks.skeleton, skeleton);
  cut.positions = JointPositions(tracks.frames(), kept);
  cut.positions.xyz = FirstJoints(tracks.positions.xyz, tracks.frames(), tracks.joints(), kept, 3);
  cut.confidence = FirstJoints(tracks.confidence, tracks.frames(), tracks.joints(), kept, 1);
  cut.precision = FirstJoints(tracks.precision, tracks.frames(), tracks.joints(), kept, 1);
  return cut;
}

Motion WithoutDetectorPoints(const Motion& motion, const SkeletonPtr& skeleton) {
  Motion cut = motion;
  const int frames = motion.frame_count();
  const int joints = motion.joint_count();
  const int kept = skeleton->joint_count();
  cut.skeleton = WithoutDetectorPoints(motion.skeleton, skeleton);
  cut.joints = JointPositions(frames, kept);
  cut.joints.xyz = FirstJoints(motion.joints.xyz, frames, joints, kept, 3);
  cut.rotation = FirstJoints(motion.rotation, frames, joints, kept, 1);
  cut.state = FirstJoints(motion.state, frames, joints, kept, 1);
  cut.position_cov = FirstJoints(motion.position_cov, frames, joints, kept, 6);
  cut.rotation_sigma = FirstJoints(motion.rotation_sigma, frames, joints, kept, 3);
  cut.rotation_observed = FirstJoints(motion.rotation_observed, frames, joints, kept, 3);
  cut.bone_length.resize(static_cast<std::size_t>(kept));
  return cut;
}

}  // namespace mocurate
