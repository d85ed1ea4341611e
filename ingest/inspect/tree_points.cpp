#include "ingest/inspect/tree_points.h"

#include <algorithm>

#include "core/motion/limbs.h"
#include "core/motion/skeleton.h"
#include "ingest/inspect/raw_clip.h"

namespace mocurate {
BodyLandmarks PointsOfTree(const std::vector<std::string>& whole_names, const std::vector<int>& parents) {
  const std::vector<std::string> names = WithoutNamespace(whole_names);
  Skeleton tree;
  BodyLandmarks points;
  for (std::size_t j = 0; j < names.size(); ++j) {
    Joint joint;
    joint.name = names[j];
    joint.parent = parents[j];
    tree.joints.push_back(joint);
    const bool head = names[j].find("head") != std::string::npos || names[j].find("Head") != std::string::npos;
    if (points.head < 0 && head) points.head = static_cast<int>(j);
  }
  const Limbs limbs = LimbsOf(tree);
  for (std::size_t side = 0; side < 2; ++side) {
    const Limb& leg = limbs.leg[side];
    points.knee[side] = leg.middle;
    points.hip[side] = leg.root;
    points.ankle[side] = leg.end;
    points.toe[side] = leg.tip;
    points.shoulder[side] = limbs.arm[side].root;
    points.wrist[side] = limbs.arm[side].end;
  }
  return points;
}

BodyLandmarks PointsOfBody(const Skeleton& skeleton) {
  const BodyLandmarks known = FindHandednessPoints([&](std::string_view name) { return skeleton.FindJoint(name); });
  if (known.knee[0] >= 0 && known.knee[1] >= 0) return known;
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Joint& joint : skeleton.joints) {
    names.push_back(joint.name);
    parents.push_back(joint.parent);
  }
  return PointsOfTree(names, parents);
}

BodyLandmarks PointsOfBody(const std::vector<std::string>& names, const Skeleton* skeleton) {
  const auto find = [&](std::string_view name) -> std::optional<int> {
    const std::optional<int> joint = skeleton != nullptr ? skeleton->FindJoint(name) : std::nullopt;
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k] == name) return static_cast<int>(k);
      if (joint && skeleton->FindJoint(names[k]) == joint) return static_cast<int>(k);
    }
    return std::nullopt;
  };
  return FindHandednessPoints([&](std::string_view name) {
    const std::optional<int> point = find(name);
    return point || name != "head" ? point : find("nose");
  });
}

/// Whether every joint hangs from the same joint as its namesake.
bool HangsAlike(const std::vector<std::string>& names, const std::vector<int>& parents, const Skeleton& skeleton) {
  for (std::size_t j = 0; j < names.size(); ++j) {
    const int above = skeleton.joints[static_cast<std::size_t>(*skeleton.FindJoint(names[j]))].parent;
    const int expected = parents[j] < 0 ? -1 : *skeleton.FindJoint(names[static_cast<std::size_t>(parents[j])]);
    if (above != expected) return false;
  }
  return true;
}

void FollowTree(const std::vector<int>& parents, const std::string& evidence, RawClip& clip) {
  clip.parents = parents;
  clip.points = PointsOfTree(clip.names, parents);
  clip.skeleton = AsDeclared("own tree of " + std::to_string(clip.joints) + " joints", evidence);
  for (const char* known : {"bandai22", "cmu31", "smpl24"}) {
    const auto skeleton = KnownSkeleton(known);
    if (!skeleton || (*skeleton)->joint_count() != clip.joints) continue;
    const std::vector<std::string> names = NamesIn(**skeleton, clip.names);
    const bool same = std::all_of(names.begin(), names.end(),
                                  [&](const std::string& joint) { return (*skeleton)->FindJoint(joint).has_value(); });
    if (!same) continue;
    if (HangsAlike(names, parents, **skeleton)) {
      clip.skeleton.value = known;
    } else {
      clip.skeleton.evidence = evidence + ": joints named as in '" + known + "', some hang from others than there";
    }
    if (clip.points.knee[0] < 0) FollowFormat(known, names, evidence, clip);
  }
}

}  // namespace mocurate
