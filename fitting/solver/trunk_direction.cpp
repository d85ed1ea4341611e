#include "fitting/solver/trunk_direction.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/median.h"
#include "core/geometry/rigid.h"
#include "core/geometry/rotation.h"
#include "fitting/solver/bone_lengths.h"

namespace mocurate {
namespace {

/// From a joint to one below it, in the rest pose.
Vector3d RestOffsetBelow(int joint, int below, const Skeleton& skeleton) {
  Vector3d offset = Vector3d::Zero();
  for (int at = below; at != joint; at = skeleton.joints[at].parent) offset += skeleton.joints[at].rest_offset;
  return offset;
}

/// Unit vector from right to left through the ends that are mirror partners; empty without such a pair.
std::optional<Vector3d> AxisAcross(const StarOfBones& star, const Skeleton& skeleton) {
  Vector3d across = Vector3d::Zero();
  for (std::size_t i = 0; i < star.ends.size(); ++i) {
    for (std::size_t k = i + 1; k < star.ends.size(); ++k) {
      if (skeleton.joints[star.ends[i]].mirror != star.ends[k]) continue;
      across += star.offsets.col(static_cast<Eigen::Index>(i)) - star.offsets.col(static_cast<Eigen::Index>(k));
    }
  }
  if (across.isZero()) return std::nullopt;
  return across.normalized();
}

/// Distance of the end that lies farthest from an axis through the joint, metres.
double FarthestFrom(const Vector3d& axis, const Eigen::Matrix3Xd& offsets) {
  return (offsets - axis * (axis.transpose() * offsets)).colwise().norm().maxCoeff();
}

/// Mean of the trunk's points in the star's frame; empty where a frame does not show all.
std::optional<Vector3d> TrunkInStar(const StarOfBones& star, const std::vector<int>& trunk, const SkeletonTracks& clip,
                                    int frame) {
  const auto shows = [&](int joint) { return clip.seen(frame, joint) && !IsAtParent(clip, frame, joint); };
  if (!shows(star.joint) || !std::all_of(trunk.begin(), trunk.end(), shows) ||
      !std::all_of(star.ends.begin(), star.ends.end(), shows))
    return std::nullopt;
  const auto count = star.offsets.cols();
  Eigen::Matrix3Xd source(3, count + 1), target(3, count + 1);
  source << Vector3d::Zero(), star.offsets;
  target.col(0) = clip.positions.at(frame, star.joint);
  for (Eigen::Index i = 0; i < count; ++i)
    target.col(i + 1) = clip.positions.at(frame, star.ends[static_cast<std::size_t>(i)]);
  const RigidTransform world_from_star = AlignPoints(source, target, Eigen::VectorXd::Ones(count + 1));
  Vector3d away = Vector3d::Zero();
  for (const int point : trunk) away += clip.positions.at(frame, point) - clip.positions.at(frame, star.joint);
  return world_from_star.rotation.conjugate() * away;
}

}  // namespace

std::vector<int> ObservedBeyond(int child, const Skeleton& skeleton, const std::vector<bool>& seen) {
  const std::vector<std::vector<int>> children = skeleton.Children();
  std::vector<int> level{child};
  while (!level.empty()) {
    std::vector<int> shown, next;
    for (const int joint : level) {
      if (seen[joint]) shown.push_back(joint);
      next.insert(next.end(), children[joint].begin(), children[joint].end());
    }
    if (!shown.empty()) return shown;
    level = std::move(next);
  }
  return {};
}

Eigen::Matrix3Xd AlignedToTrunk(const StarOfBones& star, const std::vector<int>& trunk,
                                const std::vector<SkeletonTracks>& clips, double across) {
  if (clips.empty()) return star.offsets;
  const Skeleton& skeleton = *clips.front().skeleton;
  const std::optional<Vector3d> axis = AxisAcross(star, skeleton);
  if (!axis || FarthestFrom(*axis, star.offsets) <= across) return star.offsets;
  Vector3d rest = Vector3d::Zero();
  for (const int point : trunk) rest += RestOffsetBelow(star.joint, point, skeleton);
  const Vector3d along = (rest - axis->dot(rest) * *axis).stableNormalized();
  const Vector3d beside = axis->cross(along);
  std::vector<double> cosines, sines;
  for (const SkeletonTracks& clip : clips) {
    for (int f = 0; f < clip.frames(); ++f) {
      const std::optional<Vector3d> seen = TrunkInStar(star, trunk, clip, f);
      if (!seen) continue;
      const double length = std::hypot(along.dot(*seen), beside.dot(*seen));
      if (!(length > 0.0)) continue;
      cosines.push_back(along.dot(*seen) / length);
      sines.push_back(beside.dot(*seen) / length);
    }
  }
  if (cosines.empty()) return star.offsets;
  const double pitch = std::atan2(MeanMedian(sines), MeanMedian(cosines));
  return Eigen::AngleAxisd(-pitch, *axis).toRotationMatrix() * star.offsets;
}

}  // namespace mocurate
