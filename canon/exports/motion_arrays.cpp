#include "canon/exports/motion_arrays.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "canon/exports/clip_names.h"
#include "core/base/text.h"
#include "core/geometry/rotation.h"
#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

std::string_view NameOfRotations(RotationArrays rotations) {
  return std::find_if(kRotationArraysNames.begin(), kRotationArraysNames.end(),
                      [&](const RotationArraysName& name) { return name.value == rotations; })
      ->name;
}

void Add(Npz& npz, const char* name, std::vector<std::size_t> shape, std::vector<double> values,
         const char* dtype = "<f8") {
  npz.members.push_back({name, {std::move(shape), dtype, std::move(values), {}}, ""});
}

void AddTexts(Npz& npz, const char* name, std::vector<std::size_t> shape, std::vector<std::string> texts) {
  std::size_t longest = 1;
  for (std::string& text : texts) {
    text = WithoutControls(text);
    longest = std::max(longest, text.size());
  }
  npz.members.push_back({name, {std::move(shape), "<U" + std::to_string(longest), {}, std::move(texts)}, ""});
}

/// Number of values per rotation.
std::vector<double> Numbers(const Quaterniond& rotation, RotationArrays as) {
  if (as == RotationArrays::kQuaternion) return {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  if (as == RotationArrays::kAxisAngle) {
    const Vector3d w = LogQuaternion(rotation);
    return {w.x(), w.y(), w.z()};
  }
  const Matrix3d matrix = rotation.toRotationMatrix();
  if (as == RotationArrays::kMatrix) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = matrix;
    return {rows.data(), rows.data() + 9};
  }
  const auto six = Matrix6D(matrix, as == RotationArrays::k6dRows ? Rotation6D::kRows : Rotation6D::kColumns);
  return {six.begin(), six.end()};
}

std::vector<std::size_t> ShapeOf(RotationArrays as, std::size_t frames, std::size_t joints) {
  if (as == RotationArrays::kMatrix) return {frames, joints, 3, 3};
  const std::size_t numbers = as == RotationArrays::kQuaternion ? 4 : as == RotationArrays::kAxisAngle ? 3 : 6;
  return {frames, joints, numbers};
}

std::vector<double> Flat(const std::vector<Vector3d>& vectors) {
  std::vector<double> flat;
  for (const Vector3d& vector : vectors) flat.insert(flat.end(), {vector.x(), vector.y(), vector.z()});
  return flat;
}

void AddTreeRotations(const Motion& motion, RotationArrays as, Npz& npz) {
  std::vector<double> numbers;
  for (const Quaterniond& rotation : motion.rotation) {
    const std::vector<double> of_one = Numbers(rotation, as);
    numbers.insert(numbers.end(), of_one.begin(), of_one.end());
  }
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  Add(npz, "poses", ShapeOf(as, static_cast<std::size_t>(motion.frame_count()), joints), std::move(numbers));
}

void AddLieParameters(const Motion& motion, Npz& npz) {
  const auto frames = static_cast<std::size_t>(motion.frame_count());
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  std::vector<double> parameters(3 * frames * joints);
  for (std::size_t f = 0; f < frames; ++f) {
    LieFromTree(motion, static_cast<int>(f), parameters.data() + 3 * joints * f);
  }
  Add(npz, "lie", {frames, joints, 3}, std::move(parameters));
}

bool HasLieChains(const Skeleton& skeleton) {
  if (!skeleton.lie) return false;
  const std::vector<int> along = skeleton.LieParents();
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (along[j] != skeleton.joints[j].parent) return false;
  }
  return true;
}

/// Rest offsets with the person's bone lengths, and parents, of the tree or along the Lie chains.
void AddBody(const Motion& motion, bool lie, Npz& npz) {
  const Skeleton& skeleton = *motion.skeleton;
  const auto joints = static_cast<std::size_t>(skeleton.joint_count());
  std::vector<double> parents;
  std::vector<Vector3d> offsets;
  const std::vector<int> along = lie ? skeleton.LieParents() : std::vector<int>();
  for (std::size_t j = 0; j < joints; ++j) {
    parents.push_back(lie ? along[j] : skeleton.joints[j].parent);
    const Vector3d direction = lie ? skeleton.lie->raw_offsets[j] : skeleton.joints[j].rest_offset.stableNormalized();
    offsets.push_back(motion.bone_length.empty() ? skeleton.joints[j].rest_offset : motion.bone_length[j] * direction);
  }
  Add(npz, "rest_offset", {joints, 3}, Flat(offsets));
  Add(npz, "parents", {joints}, std::move(parents), "<i4");
  if (!lie) return;
  std::vector<double> chain(joints, -1.0);
  for (std::size_t c = 0; c < skeleton.lie->chains.size(); ++c) {
    const std::vector<int>& members = skeleton.lie->chains[c];
    for (std::size_t i = 1; i < members.size(); ++i) chain[members[i]] = static_cast<double>(c);
  }
  Add(npz, "lie_chain", {joints}, std::move(chain), "<i4");
}

/// The clip's uncertainties, states and contacts, where it has them.
void AddQuality(const Motion& motion, Npz& npz) {
  const auto frames = static_cast<std::size_t>(motion.frame_count());
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  std::vector<double> states;
  for (const JointState state : motion.state) states.push_back(static_cast<double>(state));
  if (!states.empty()) Add(npz, "state", {frames, joints}, std::move(states), "|u1");
  const auto add = [&](const char* name, std::size_t numbers, const auto& values, const char* dtype) {
    if (values.empty()) return;
    const std::vector<std::size_t> shape =
        numbers == 2 ? std::vector<std::size_t>{frames, 2} : std::vector<std::size_t>{frames, joints, numbers};
    Add(npz, name, shape, {values.begin(), values.end()}, dtype);
  };
  add("position_cov", 6, motion.position_cov, "<f4");
  add("rotation_sigma", 3, motion.rotation_sigma, "<f4");
  add("contact", 2, motion.contact, "|u1");
}

}  // namespace

Expected<Npz> ArraysOfMotion(const Clip& clip, RotationArrays rotations) {
  if (!clip.motion) return Fail(ErrorCode::kInconsistent, "the clip has no motion", clip.id());
  Motion motion = *clip.motion;
  const bool lie = rotations == RotationArrays::kLie;
  if (rotations != RotationArrays::kNone && motion.joints_only()) {
    return Fail(ErrorCode::kInconsistent, "the motion has joints alone, no rotations", clip.id(),
                "write them with --as joints; `mocurate fit` estimates rotations");
  }
  if (lie && !HasLieChains(*motion.skeleton)) {
    return Fail(ErrorCode::kUnsupported, "skeleton '" + motion.skeleton->name + "' has no Lie chains along its tree",
                clip.id(), "choose another --as, or fit a skeleton that has them, e.g. smpl24");
  }
  if (!motion.joints_only()) ComputeJoints(motion);  // a file's joints may have fewer digits than its rotations
  Npz npz;
  if (lie) {
    AddLieParameters(motion, npz);
  } else if (rotations != RotationArrays::kNone) {
    AddTreeRotations(motion, rotations, npz);
  }
  if (!motion.root_translation.empty()) {
    Add(npz, "trans", {motion.root_translation.size(), 3}, Flat(motion.root_translation));
  }
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  Add(npz, "joints", {static_cast<std::size_t>(motion.frame_count()), joints, 3}, motion.joints.xyz);
  AddBody(motion, lie, npz);
  AddTexts(npz, "joint_names", {joints}, JointNamesForFile(*motion.skeleton, ""));
  Add(npz, "mocap_frame_rate", {}, {motion.rate.hz()});
  AddTexts(npz, "representation", {}, {std::string(NameOfRotations(rotations))});
  AddTexts(npz, "skeleton", {}, {motion.skeleton->name});
  AddTexts(npz, "clip", {}, {clip.id()});
  AddTexts(npz, "label", {}, {clip.label});
  AddQuality(motion, npz);
  return npz;
}

}  // namespace mocurate
