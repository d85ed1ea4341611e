#include "ingest/inspect/fitted_skeleton.h"

#include <algorithm>
#include <set>

#include "core/base/resources.h"
#include "core/motion/skeleton.h"

namespace mocurate {
namespace {

constexpr const char* kUsualSkeleton = "smpl24";
constexpr const char* kFolder = "skeletons/";
constexpr double kNearHips = 0.1;  // metres, in the rest pose

bool HoldsAll(const std::vector<std::string>& joints, const Skeleton& skeleton) {
  std::set<int> taken;
  for (const std::string& name : joints) {
    if (name.empty() || name == "-") continue;
    const auto is_it = [&](const Landmark& landmark) { return landmark.name == name; };
    if (std::any_of(skeleton.landmarks.begin(), skeleton.landmarks.end(), is_it)) continue;
    const auto joint = skeleton.FindJoint(name);
    if (!joint || !taken.insert(*joint).second) return false;
  }
  return !taken.empty();
}

bool RootBetweenHips(const Skeleton& skeleton) {
  const auto hips = skeleton.Hips();
  if (!hips) return false;
  Vector3d middle = Vector3d::Zero();
  for (const int hip : *hips) {
    for (int joint = hip; joint > 0; joint = skeleton.joints[static_cast<std::size_t>(joint)].parent)
      middle += 0.5 * skeleton.joints[static_cast<std::size_t>(joint)].rest_offset;
  }
  return middle.norm() < kNearHips;
}

}  // namespace

std::string FittedSkeleton(const std::vector<std::string>& joints) {
  const Expected<SkeletonPtr> usual = LoadSkeleton(kUsualSkeleton);
  if (usual && HoldsAll(joints, **usual)) return kUsualSkeleton;
  SkeletonPtr best;
  for (const std::string& path : ResourcePaths()) {
    const std::string file = path.rfind(kFolder, 0) == 0 ? path.substr(std::string(kFolder).size()) : "";
    const std::size_t ending = file.rfind(".yaml");
    if (ending == std::string::npos) continue;
    const Expected<SkeletonPtr> skeleton = LoadSkeleton(file.substr(0, ending));
    if (!skeleton || !HoldsAll(joints, **skeleton) || !RootBetweenHips(**skeleton)) continue;
    if (!best || (*skeleton)->joint_count() < best->joint_count()) best = *skeleton;
  }
  return best ? best->name : "";
}

}  // namespace mocurate
