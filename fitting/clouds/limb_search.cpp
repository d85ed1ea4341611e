#include "fitting/clouds/cloud_start.h"

#include <algorithm>
#include <vector>

#include "core/base/pi.h"

namespace mocurate {
namespace {

constexpr int kRounds = 3;               ///< over all limbs, at most (numerical)
constexpr int kRankedPoints = 600;       ///< points used to rank poses (numerical)
constexpr std::size_t kRefined = 3;      ///< best poses of a limb, fitted with the whole body (numerical)
constexpr int kFewMatchings = 12;        ///< matchings before costs are compared (numerical)
constexpr double kApart = 0.12;          ///< m; least distance between the limb ends of two fitted poses
constexpr double kLessToExplain = 0.99;  ///< of the cost before; otherwise the limb stays

/// An arm or a leg: shoulder and elbow, or hip and knee.
struct LimbJoints {
  int above = -1;  ///< the collar, when this limb is its only child; else -1
  int upper = 0;
  int lower = 0;
  int end = 0;
  Vector3d hinge;  ///< axis about which the lower joint bends, in its frame
  bool arm = false;
  double side = 1.0;  ///< towards +x (left) 1, -x -1
};

/// Rotations of a limb's two joints.
struct LimbPose {
  Vector3d upper;
  Vector3d lower;
};

std::vector<LimbJoints> LimbsOf(const Skeleton& skeleton, const PoseState& state) {
  const auto children = skeleton.Children();
  std::vector<LimbJoints> limbs;
  const auto add = [&](const auto& uppers, bool arm) {
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      if (!uppers) return;
      LimbJoints limb;
      limb.upper = (*uppers)[side];
      limb.lower = OnlyChild(children, limb.upper);
      const int parent = skeleton.joints[static_cast<std::size_t>(limb.upper)].parent;
      if (OnlyChild(children, parent) == limb.upper && state.active(parent)) limb.above = parent;
      limb.end = OnlyChild(children, limb.lower);
      limb.arm = arm;
      limb.side = side == 0 ? 1.0 : -1.0;
      // Arms raised sideways bend forwards about the vertical, legs backwards.
      limb.hinge = arm ? Vector3d(0.0, -limb.side, 0.0) : Vector3d(1.0, 0.0, 0.0);
      if (limb.end < 0 || !state.active(limb.upper) || !state.active(limb.lower)) continue;
      limbs.push_back(limb);
    }
  };
  add(skeleton.Shoulders(), true);
  add(LegsOfBody(skeleton), false);
  return limbs;
}

/// Directions of the upper bone, x to the limb's own side, y up, z forward, in the frame of the joint above.
std::vector<Vector3d> Directions(bool arm) {
  if (arm) {
    return {{1, 0, 0},     {0.2, -1, 0},      {0.2, 1, 0},       {0.1, 0, 1},    {0.7, 0, 0.7}, {0.2, -0.7, 0.7},
            {0, 0.7, 0.7}, {-0.6, -0.2, 0.8}, {0.2, -0.8, -0.6}, {0.7, -0.7, 0}, {0.7, 0.7, 0}};
  }
  return {{0.1, -1, 0}, {0.1, -0.7, 0.7}, {0.1, -0.1, 1}, {0.1, -0.8, -0.6}, {0.6, -0.8, 0}, {0.5, -0.4, 0.7}};
}

std::vector<LimbPose> PosesOfLimb(const Skeleton& skeleton, const LimbJoints& limb) {
  const Vector3d rest = skeleton.joints[static_cast<std::size_t>(limb.lower)].rest_offset.normalized();
  const std::vector<double> bends = limb.arm ? std::vector<double>{0.2, 1.2, 2.1} : std::vector<double>{0.1, 0.9, 1.7};
  const std::vector<double> twists =
      limb.arm ? std::vector<double>{-0.5 * kPi, 0.0, 0.5 * kPi, kPi} : std::vector<double>{-0.5, 0.0, 0.5};
  std::vector<LimbPose> poses;
  for (const Vector3d& direction : Directions(limb.arm)) {
    const Vector3d to = Vector3d(limb.side * direction.x(), direction.y(), direction.z()).normalized();
    const Quaterniond swing = Quaterniond::FromTwoVectors(rest, to);
    for (const double bend : bends) {
      for (const double twist : twists) {
        poses.push_back({LogQuaternion(swing * ExpQuaternion(twist * rest)), bend * limb.hinge});
        if (bend == bends.front()) break;  // the twist of a straight limb has no effect
      }
    }
  }
  return poses;
}

struct RankedPose {
  double cost = 0.0;
  Vector3d end;
  LimbPose pose;
};

class LimbSearcher {
 public:
  LimbSearcher(const CapsuleBody& body, const FusedCloud& cloud, int frame, const PointCloudOptions& options,
               PoseState& state)
      : body_(body),
        cloud_(cloud),
        coarse_(CoarseCloud(cloud, kRankedPoints)),
        frame_(frame),
        options_(options),
        state_(state) {}

  Expected<double> Search() {
    state_.Update(frame_, frame_ + 1, false);
    const std::vector<double> given = state_.FrameParameters(frame_);
    const double cost_of_given = PoseCost(body_, cloud_, Fit(), state_, options_);
    cost_ = PoseCost(body_, coarse_, Fit(), state_, options_);
    const std::vector<LimbJoints> limbs = LimbsOf(*body_.skeleton, state_);
    for (int round = 0; round < kRounds; ++round) {
      bool found = false;
      for (const LimbJoints& limb : limbs) {
        const Expected<bool> better = Improve(limb);
        if (!better) return Forward(better);
        found = found || *better;
      }
      if (!found) break;
    }
    if (const auto fitted = FitCloudFrame(body_, cloud_, Fit(), state_, options_); !fitted) return Forward(fitted);
    const double cost = PoseCost(body_, cloud_, Fit(), state_, options_);
    if (cost <= cost_of_given) return cost;
    state_.SetFrameParameters(frame_, given);
    state_.Update(frame_, frame_ + 1, false);
    return cost_of_given;
  }

 private:
  FrameFit Fit() const { return ComparedFit(frame_, options_.iterations); }

  void Set(const LimbJoints& limb, const LimbPose& pose) {
    if (limb.above >= 0) Eigen::Map<Vector3d>(state_.rotation(frame_, limb.above)).setZero();
    Eigen::Map<Vector3d>(state_.rotation(frame_, limb.upper)) = pose.upper;
    Eigen::Map<Vector3d>(state_.rotation(frame_, limb.lower)) = pose.lower;
    state_.Update(frame_, frame_ + 1, false);
  }

  /// Sorted by cost; of limbs that end at about the same position only the first.
  std::vector<RankedPose> Ranked(const LimbJoints& limb) {
    std::vector<RankedPose> ranked;
    for (const LimbPose& pose : PosesOfLimb(*body_.skeleton, limb)) {
      Set(limb, pose);
      ranked.push_back({PoseCost(body_, coarse_, Fit(), state_, options_), state_.position(frame_, limb.end), pose});
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const RankedPose& a, const RankedPose& b) { return a.cost < b.cost; });
    std::vector<RankedPose> apart;
    for (const RankedPose& pose : ranked) {
      const bool is_new = std::none_of(apart.begin(), apart.end(),
                                       [&](const RankedPose& other) { return (pose.end - other.end).norm() < kApart; });
      if (is_new && apart.size() < kRefined) apart.push_back(pose);
    }
    return apart;
  }

  Expected<bool> Improve(const LimbJoints& limb) {
    std::vector<double> best = state_.FrameParameters(frame_);
    const std::vector<double> before = best;
    bool found = false;
    for (const RankedPose& ranked : Ranked(limb)) {
      state_.SetFrameParameters(frame_, before);
      Set(limb, ranked.pose);
      const auto fitted = FitCloudFrame(body_, coarse_, ComparedFit(frame_, kFewMatchings), state_, options_);
      if (!fitted) return Forward(fitted);
      const double cost = PoseCost(body_, coarse_, Fit(), state_, options_);
      if (cost >= kLessToExplain * cost_) continue;
      cost_ = cost;
      best = state_.FrameParameters(frame_);
      found = true;
    }
    state_.SetFrameParameters(frame_, best);
    state_.Update(frame_, frame_ + 1, false);
    return found;
  }

  const CapsuleBody& body_;
  const FusedCloud& cloud_;
  const FusedCloud coarse_;
  const int frame_;
  const PointCloudOptions& options_;
  PoseState& state_;
  double cost_ = 0.0;
};

}  // namespace

int OnlyChild(const std::vector<std::vector<int>>& children, int joint) {
  return joint >= 0 && children[joint].size() == 1 ? children[joint][0] : -1;
}

std::optional<std::array<int, 2>> LegsOfBody(const Skeleton& skeleton) {
  const auto hips = skeleton.Hips();  // shoulders, for a skeleton without hips
  return hips == skeleton.Shoulders() ? std::nullopt : hips;
}

Expected<double> SearchLimbs(const CapsuleBody& body, const FusedCloud& cloud, int frame,
                             const PointCloudOptions& options, PoseState& state) {
  return LimbSearcher(body, cloud, frame, options, state).Search();
}

}  // namespace mocurate
