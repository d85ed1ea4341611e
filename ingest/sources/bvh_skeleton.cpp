#include "ingest/sources/bvh_skeleton.h"

#include <algorithm>
#include <set>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kSameOffset = 1e-6;

std::vector<std::vector<int>> ChildrenOf(const Bvh& bvh) {
  std::vector<std::vector<int>> children(bvh.joints.size());
  for (std::size_t j = 1; j < bvh.joints.size(); ++j) children[bvh.joints[j].parent].push_back(static_cast<int>(j));
  return children;
}

BvhOffsets::Joint MeasureJoint(const Bvh& bvh, int joint, const Matrix3d& metres_from_file) {
  BvhOffsets::Joint measured;
  const Vector3d written = metres_from_file * bvh.joints[joint].offset;
  measured.offset = written;
  if (!bvh.joints[joint].HasPosition()) return measured;
  Vector3d low = metres_from_file * BvhLocalPosition(bvh, 0, joint);
  Vector3d high = low;
  for (int f = 1; f < bvh.frames; ++f) {
    const Vector3d position = metres_from_file * BvhLocalPosition(bvh, f, joint);
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  measured.slide = 0.5 * (high - low).norm();
  const Vector3d middle = 0.5 * (low + high);
  if ((middle - written).norm() > BvhOffsets::kConstant) measured.offset = middle;
  return measured;
}

/// Partner by name: "left" and "right", or a lone L and R at either end ("Hand_L", "LHipJoint", "LeftUpLeg").
std::string MirroredName(const std::string& name) {
  for (const auto& [a, b] : {std::pair{"Left", "Right"}, {"left", "right"}, {"LEFT", "RIGHT"}}) {
    const std::size_t at = name.find(a);
    if (at != std::string::npos) return name.substr(0, at) + b + name.substr(at + std::string(a).size());
  }
  const std::size_t size = name.size();
  if (size > 2 && name.compare(size - 2, 2, "_L") == 0) return name.substr(0, size - 1) + "R";
  if (size > 2 && name.compare(size - 2, 2, "_l") == 0) return name.substr(0, size - 1) + "r";
  if (size > 1 && name[0] == 'L' && ((name[1] >= 'A' && name[1] <= 'Z') || name[1] == ' ')) return "R" + name.substr(1);
  if (size > 1 && name[0] == 'l' && name[1] >= 'A' && name[1] <= 'Z') return "r" + name.substr(1);
  return name;
}

/// The joints from `root` on; those before it are its ancestors.
SkeletonPtr FromFile(const Bvh& bvh, int root, const std::vector<Vector3d>& offset, const std::string& source) {
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = source;
  std::set<std::string> names;
  for (auto j = static_cast<std::size_t>(root); j < bvh.joints.size(); ++j) {
    Joint joint;
    joint.name = bvh.joints[j].name;
    for (int copy = 2; !names.insert(joint.name).second; ++copy) {
      joint.name = bvh.joints[j].name + "_" + std::to_string(copy);
    }
    const bool is_root = skeleton->joints.empty();
    joint.parent = is_root ? -1 : bvh.joints[j].parent - root;
    joint.rest_offset = is_root ? Vector3d(Vector3d::Zero()) : offset[j];
    joint.mirror = skeleton->joint_count();
    skeleton->joints.push_back(joint);
  }
  Skeleton paired = *skeleton;
  std::vector<std::string> names_of;
  for (const Joint& joint : skeleton->joints) names_of.push_back(joint.name);
  names_of = WithoutNamespace(names_of);
  for (int j = 0; j < paired.joint_count(); ++j) {
    const std::string partner = MirroredName(names_of[j]);
    for (int k = 0; k < paired.joint_count(); ++k) {
      if (k == j || names_of[k] != partner) continue;
      paired.joints[j].mirror = k;
      paired.joints[k].mirror = j;
    }
  }
  if (paired.Check()) *skeleton = paired;
  return skeleton;
}

/// Joint of the skeleton for each joint of the file.
Expected<std::vector<int>> Targets(const Bvh& bvh, const Skeleton& skeleton, const std::string& file) {
  std::vector<int> target(bvh.joints.size(), -1);
  std::vector<std::string> known, whole;
  for (const BvhJoint& joint : bvh.joints) whole.push_back(joint.name);
  const std::vector<std::string> names = NamesIn(skeleton, whole);
  for (const Joint& joint : skeleton.joints) known.push_back(joint.name);
  std::set<int> used;
  for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
    const std::string& name = names[j];
    const std::optional<int> found = skeleton.FindJoint(name);
    if (!found || !used.insert(*found).second) {
      return Fail(ErrorCode::kInconsistent,
                  "joint '" + name + (found ? "' maps to a joint of skeleton '" : "' is unknown to skeleton '") +
                      skeleton.name + (found ? "' that is assigned already" : "'"),
                  file, DidYouMean(name, known, "name another skeleton, or none to use the file's own"),
                  Reason::kOtherTree);
    }
    target[j] = *found;
    const int parent = bvh.joints[j].parent;
    if (skeleton.joints[*found].parent != (parent < 0 ? -1 : target[parent])) {
      return Fail(ErrorCode::kInconsistent,
                  "joint '" + name + "' has another parent than in skeleton '" + skeleton.name + "'", file,
                  "name another skeleton, or none to use the file's own", Reason::kOtherTree);
    }
  }
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (used.count(j) != 0) continue;
    return Fail(ErrorCode::kInconsistent,
                "joint '" + skeleton.joints[j].name + "' of skeleton '" + skeleton.name + "' is not in the file", file,
                "name another skeleton, or none to use the file's own", Reason::kOtherTree);
  }
  return target;
}

}  // namespace

std::vector<int> BvhOffsets::Path(const Bvh& bvh) const {
  std::vector<int> path;
  for (int j = carrier; j >= 0; j = bvh.joints[j].parent) path.push_back(j);
  std::reverse(path.begin(), path.end());
  return path;
}

Status CheckBones(const Bvh& bvh, const std::string& file) {
  const auto lies_on_parent = [&](std::size_t j) {
    if (!bvh.joints[j].offset.isZero(0.0)) return false;
    for (int f = 0; f < bvh.frames && bvh.joints[j].HasPosition(); ++f) {
      if (!BvhLocalPosition(bvh, f, static_cast<int>(j)).isZero(0.0)) return false;
    }
    return true;
  };
  std::size_t joints = 1;
  while (joints < bvh.joints.size() && lies_on_parent(joints)) ++joints;
  if (joints < 2 || joints < bvh.joints.size()) return {};
  return Fail(ErrorCode::kInconsistent,
              "the OFFSETs of all " + std::to_string(joints - 1) +
                  " joints below the root are 0 0 0: no bone has a length, all joints lie in one point",
              file, "export it again with the skeleton's bones, or remove the file");
}

BvhOffsets MeasureOffsets(const Bvh& bvh, const Matrix3d& metres_from_file, double max_slide,
                          const Skeleton* declared) {
  BvhOffsets offsets;
  for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
    offsets.joints.push_back(MeasureJoint(bvh, static_cast<int>(j), metres_from_file));
    offsets.joints.back().moves = offsets.joints.back().slide > max_slide;
  }
  std::vector<std::string> names;
  for (const BvhJoint& joint : bvh.joints) names.push_back(joint.name);
  if (declared != nullptr) names = NamesIn(*declared, names);
  const std::vector<std::vector<int>> children = ChildrenOf(bvh);
  for (int j = 0; children[j].size() == 1;) {
    j = children[j][0];
    BvhOffsets::Joint& joint = offsets.joints[j];
    const auto known = declared != nullptr ? declared->FindJoint(names[j]) : std::nullopt;
    const bool on_parent = known && declared->joints[*known].rest_offset.norm() <= kSameOffset;
    if (on_parent && joint.offset.norm() > max_slide) joint.moves = true;  // it carries the person, who stands still
    if (joint.moves) offsets.carrier = j;
  }
  for (const int j : offsets.Path(bvh)) offsets.joints[j].above_carrier = true;
  return offsets;
}

Expected<BvhSkeleton> MakeBvhSkeleton(const Bvh& bvh, const BvhOffsets& offsets, const SkeletonPtr& declared,
                                      const std::string& source, const std::string& file) {
  const std::size_t count = bvh.joints.size();
  BvhSkeleton fit;
  if (declared) {
    Expected<std::vector<int>> target = Targets(bvh, *declared, file);
    if (!target) return Forward(target);
    fit.target = std::move(*target);
  } else {
    fit.root = offsets.carrier;
    for (int j = 0; j < static_cast<int>(count); ++j) fit.target.push_back(j < fit.root ? -1 : j - fit.root);
  }
  bool as_declared = declared != nullptr;
  fit.offset.assign(count, Vector3d::Zero());
  for (std::size_t j = 1; j < count; ++j) {
    const bool moves = offsets.joints[j].above_carrier && offsets.joints[j].moves;
    const Vector3d rest = declared ? declared->joints[fit.target[j]].rest_offset : Vector3d(Vector3d::Zero());
    fit.offset[j] = moves ? rest : offsets.joints[j].offset;
    as_declared = as_declared && (fit.offset[j] - rest).norm() <= kSameOffset;
  }
  if (as_declared) {
    fit.skeleton = declared;
  } else if (declared) {
    auto skeleton = std::make_shared<Skeleton>(*declared);
    for (std::size_t j = 1; j < count; ++j) {
      skeleton->joints[fit.target[j]].rest_offset = fit.offset[j];
    }
    fit.skeleton = skeleton;
  } else {
    fit.skeleton = FromFile(bvh, fit.root, fit.offset, source);
  }
  fit.bone_length.assign(fit.skeleton->joints.size(), 0.0);
  for (auto j = static_cast<std::size_t>(fit.root) + 1; j < count; ++j) {
    fit.bone_length[fit.target[j]] = fit.offset[j].norm();
  }
  if (Status ok = fit.skeleton->Check(); !ok) return Forward(ok);
  return fit;
}

}  // namespace mocurate
