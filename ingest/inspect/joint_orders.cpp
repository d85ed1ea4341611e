#include "ingest/inspect/joint_orders.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "core/base/median.h"
#include "core/base/resources.h"
#include "core/base/text.h"
#include "ingest/sources/ntu_people.h"
#include "ingest/sources/smpl_motion.h"
#include "ingest/synthetic/tracker.h"

namespace mocurate {
namespace {

constexpr int kFramesLookedAt = 64;

std::vector<std::string> SmplJoints(int count) { return {kSmplJointNames, kSmplJointNames + count}; }

/// Median length and robust relative spread of the distance between two points over the frames; spread 1 when they are
/// hardly ever seen together.
struct Distance {
  double median = 0.0;
  double spread = 1.0;
};

Distance DistanceBetween(const JointPositions& positions, const std::vector<double>& confidence, int a, int b) {
  std::vector<double> lengths;
  const int step = std::max(1, positions.frames / kFramesLookedAt);
  const auto seen = [&](int f, int k) {
    return confidence.empty() || confidence[static_cast<std::size_t>(f) * positions.joints + k] > 0.0;
  };
  for (int f = 0; f < positions.frames; f += step) {
    if (seen(f, a) && seen(f, b)) lengths.push_back((positions.at(f, a) - positions.at(f, b)).norm());
  }
  Distance distance;
  if (lengths.size() < 2) return distance;
  distance.median = Median(lengths);
  if (!(distance.median > 0.0)) return distance;
  for (double& length : lengths) length = std::abs(length - distance.median);
  distance.spread = std::min(1.0, kMadToSigma * Median(lengths) / distance.median);
  return distance;
}

}  // namespace

const std::vector<JointOrder>& KnownJointOrders() {
  static const std::vector<JointOrder> orders = {
      {"kard",
       "openni15",
       {"head", "neck", "right_shoulder", "right_elbow", "right_wrist", "left_shoulder", "left_elbow", "left_wrist",
        "torso", "right_hip", "right_knee", "right_ankle", "left_hip", "left_knee", "left_ankle"}},
      {"florence3d",
       "openni15",
       {"head", "neck", "torso", "left_shoulder", "left_elbow", "left_wrist", "right_shoulder", "right_elbow",
        "right_wrist", "left_hip", "left_knee", "left_ankle", "right_hip", "right_knee", "right_ankle"}},
      {"cad60",
       "openni15",
       {"head", "neck", "torso", "left_shoulder", "left_elbow", "right_shoulder", "right_elbow", "left_hip",
        "left_knee", "right_hip", "right_knee", "left_wrist", "right_wrist", "left_ankle", "right_ankle"},
       "",
       30.0,
       "CAD-60 lists joints so, which a Kinect recorded at 30 Hz (Sung et al. 2011)"},
      {"msr_action3d",
       "kinect20",
       {"left_shoulder", "right_shoulder", "shoulder_center", "spine",       "left_hip",   "right_hip",  "hip_center",
        "left_elbow",    "right_elbow",    "left_wrist",      "right_wrist", "left_hand",  "right_hand", "left_knee",
        "right_knee",    "left_ankle",     "right_ankle",     "left_foot",   "right_foot", "head"},
       "",
       15.0,
       "MSR-Action3D lists joints so, which was recorded at 15 Hz (Li et al. 2010)"},
      {"kinect1", "kinect20", {"hip_center",  "spine",      "shoulder_center", "head",           "left_shoulder",
                               "left_elbow",  "left_wrist", "left_hand",       "right_shoulder", "right_elbow",
                               "right_wrist", "right_hand", "left_hip",        "left_knee",      "left_ankle",
                               "left_foot",   "right_hip",  "right_knee",      "right_ankle",    "right_foot"}},
      {"studio", "kinect20", TrackedJoints()},
      {"kinect2", "ntu25", NtuJointNames()},
      {"body_25b",
       "openni15",
       {"nose",       "left_eye",      "right_eye",       "left_ear",    "right_ear", "left_shoulder", "right_shoulder",
        "left_elbow", "right_elbow",   "left_wrist",      "right_wrist", "left_hip",  "right_hip",     "left_knee",
        "right_knee", "left_ankle",    "right_ankle",     "neck",        "head",      "left_big_toe",  "left_small_toe",
        "left_heel",  "right_big_toe", "right_small_toe", "right_heel"},
       "BODY_25B"},
      {"smpl", "smpl24", SmplJoints(24)},
      {"smpl22", "smpl24", SmplJoints(22)}};
  return orders;
}

std::vector<std::string> SkeletonNames() {
  constexpr std::string_view kFolder = "skeletons/", kEnding = ".yaml";
  std::vector<std::string> names;
  for (const std::string& path : ResourcePaths()) {
    if (path.rfind(kFolder, 0) == 0 && EndsWith(path, kEnding))
      names.push_back(path.substr(kFolder.size(), path.size() - kFolder.size() - kEnding.size()));
  }
  return names;
}

Expected<SkeletonPtr> KnownSkeleton(const std::string& name_or_path) {
  static std::mutex mutex;
  static std::map<std::string, SkeletonPtr> skeletons;
  const std::lock_guard<std::mutex> lock(mutex);
  if (const auto known = skeletons.find(name_or_path); known != skeletons.end()) return known->second;
  Expected<SkeletonPtr> skeleton = LoadSkeleton(name_or_path);
  if (skeleton) skeletons.emplace(name_or_path, *skeleton);
  return skeleton;
}

std::vector<RawBone> BonesOf(const std::vector<std::string>& joints, const Skeleton& skeleton) {
  std::vector<int> point_of_joint(skeleton.joints.size(), -1);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (const auto joint = skeleton.FindJoint(joints[k])) point_of_joint[*joint] = static_cast<int>(k);
  }
  std::vector<RawBone> bones;
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    if (point_of_joint[j] < 0) continue;
    Vector3d offset = skeleton.joints[j].rest_offset;  // distance in the rest pose, whatever is stepped over
    int parent = skeleton.joints[j].parent;
    while (parent >= 0 && point_of_joint[parent] < 0) {
      offset += skeleton.joints[parent].rest_offset;
      parent = skeleton.joints[parent].parent;
    }
    if (parent >= 0) bones.push_back({point_of_joint[parent], point_of_joint[j], offset.norm()});
  }
  return bones;
}

namespace {

/// By `distance_between`, of two points.
template <class DistanceOfPoints>
BodyScore ScoreBones(const std::vector<RawBone>& bones, const DistanceOfPoints& distance_between) {
  BodyScore score{1.0, 1.0};
  double spread = 0.0;
  std::vector<double> ratios;
  for (const RawBone& bone : bones) {
    const Distance distance = distance_between(bone.from, bone.to);
    spread += distance.spread;
    if (distance.median > 0.0 && bone.rest_length > 0.0) ratios.push_back(std::log(distance.median / bone.rest_length));
  }
  score.spread = spread / static_cast<double>(bones.size());
  if (ratios.empty()) return score;
  const double scale = Median(ratios);
  double sum = 0.0;
  for (const double ratio : ratios) sum += std::min(1.0, std::abs(ratio - scale));
  score.proportion = sum / static_cast<double>(ratios.size());
  return score;
}

}  // namespace

BodyScore ScoreBody(const JointPositions& positions, const std::vector<double>& confidence,
                    const std::vector<RawBone>& bones) {
  if (bones.empty() || positions.frames < 2) return {1.0, 1.0};
  return ScoreBones(bones, [&](int a, int b) { return DistanceBetween(positions, confidence, a, b); });
}

std::optional<PointExchange> BestExchange(const JointPositions& positions, const std::vector<double>& confidence,
                                          const std::vector<RawBone>& bones) {
  if (bones.empty() || positions.frames < 2) return std::nullopt;
  const int count = positions.joints;
  std::vector<Distance> distances(static_cast<std::size_t>(count) * static_cast<std::size_t>(count));
  const auto between = [&](int a, int b) -> Distance& {
    return distances[static_cast<std::size_t>(a) * static_cast<std::size_t>(count) + static_cast<std::size_t>(b)];
  };
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < a; ++b) between(a, b) = between(b, a) = DistanceBetween(positions, confidence, a, b);
  }
  std::optional<PointExchange> best;
  for (int first = 0; first < count; ++first) {
    for (int second = 0; second < first; ++second) {
      const auto point = [&](int k) { return k == first ? second : k == second ? first : k; };
      const BodyScore score = ScoreBones(bones, [&](int a, int b) { return between(point(a), point(b)); });
      if (!best || score.total() < best->score.total()) best = PointExchange{second, first, score};
    }
  }
  return best;
}

std::vector<OrderScore> ScoreOrders(const JointPositions& positions, const std::vector<double>& confidence) {
  std::vector<OrderScore> scores;
  for (const JointOrder& order : KnownJointOrders()) {
    if (static_cast<int>(order.joints.size()) != positions.joints) continue;
    const auto skeleton = KnownSkeleton(order.skeleton);
    if (!skeleton) continue;
    scores.push_back({&order, ScoreBody(positions, confidence, BonesOf(order.joints, **skeleton))});
  }
  std::stable_sort(scores.begin(), scores.end(),
                   [](const OrderScore& a, const OrderScore& b) { return a.score.total() < b.score.total(); });
  return scores;
}

double Rigidity(const JointPositions& positions, const std::vector<double>& confidence) {
  std::vector<double> best;
  for (int a = 0; a < positions.joints; ++a) {
    double smallest = 1.0;
    for (int b = 0; b < positions.joints; ++b) {
      if (a != b) smallest = std::min(smallest, DistanceBetween(positions, confidence, a, b).spread);
    }
    best.push_back(smallest);
  }
  return Median(best);
}

}  // namespace mocurate
