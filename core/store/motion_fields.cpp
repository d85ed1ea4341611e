#include <algorithm>
#include <cmath>

#include "core/store/fields.h"

namespace mocurate::store {
namespace {

struct Sizes {
  std::size_t frames = 0;
  std::size_t joints = 0;
};

template <class T>
Status CheckSize(const std::vector<T>& values, std::size_t expected, const std::string& field, const std::string& id,
                 bool may_be_empty = false) {
  if (values.size() == expected || (may_be_empty && values.empty())) return {};
  return Fail(ErrorCode::kInconsistent,
              field + " of the motion has " + std::to_string(values.size()) + " entries; " + std::to_string(expected) +
                  " are needed",
              id);
}

Status CheckMotion(const MotionRow& row, const Skeleton& skeleton, bool joints_only) {
  const Motion& motion = *row.motion;
  const bool same = motion.skeleton != nullptr && (joints_only ? SameSkeleton(*motion.skeleton, skeleton)
                                                               : SameButRestOffsets(*motion.skeleton, skeleton));
  if (!same) {
    return Fail(ErrorCode::kInconsistent, "the motion's skeleton is not the file's '" + skeleton.name + "'", row.id,
                "one file holds one skeleton; map the joints first");
  }
  if (motion.joints_only() != joints_only) {
    return Fail(ErrorCode::kInconsistent,
                joints_only ? "the motion has rotations in a file of joints only" : "the motion has no rotations",
                row.id, "a file holds either rotations for all clips or joints only");
  }
  const std::size_t J = skeleton.joints.size();
  if (motion.frame_count() < 0 || motion.joint_count() != skeleton.joint_count()) {
    return Fail(ErrorCode::kInconsistent,
                "the motion has " + std::to_string(motion.joint_count()) + " joints, its skeleton " + std::to_string(J),
                row.id);
  }
  const auto F = static_cast<std::size_t>(motion.frame_count());
  const std::size_t tree = joints_only ? 0 : 1;
  for (const Status& status : {CheckSize(motion.joints.xyz, F * J * 3, "joints", row.id),
                               CheckSize(motion.root_translation, tree * F, "root_translation", row.id),
                               CheckSize(motion.rotation, tree * F * J, "rotation", row.id),
                               CheckSize(motion.bone_length, tree * J, "bone_length", row.id, joints_only),
                               CheckSize(motion.state, F * J, "state", row.id, true),
                               CheckSize(motion.position_cov, F * J * 6, "position_cov", row.id, true),
                               CheckSize(motion.rotation_sigma, F * J * 3, "rotation_sigma", row.id, true),
                               CheckSize(motion.rotation_observed, F * J * 3, "rotation_observed", row.id, true),
                               CheckSize(motion.contact, F * 2, "contact", row.id, true)}) {
    if (!status) return status;
  }
  return {};
}

/// One optional field of all clips side by side; nothing when no clip has it. Sets `bit` of the masks of those that do.
template <class Stored, class Held>
void PackOptional(const std::vector<MotionRow>& rows, const std::vector<Held> Motion::*member, std::size_t per_frame,
                  unsigned bit, std::vector<std::uint64_t> shape, const std::string& prefix,
                  std::vector<std::uint8_t>& masks, Content& content) {
  std::vector<Stored> values;
  bool any = false;
  for (const MotionRow& row : rows) any = any || !(row.motion->*member).empty();
  if (!any) return;
  values.reserve(shape[0] * per_frame);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& held = rows[i].motion->*member;
    for (const Held value : held) values.push_back(static_cast<Stored>(value));
    if (!held.empty()) masks[i] = static_cast<std::uint8_t>(masks[i] | (1u << bit));
    if (held.empty())
      values.resize(values.size() + per_frame * static_cast<std::size_t>(rows[i].motion->frame_count()));
  }
  content.Put(prefix + "/frames/" + kOptionalFrameFields[bit], std::move(shape), std::move(values));
}

template <class Stored, class Held>
void UnpackOptional(const Content& content, const std::string& prefix, unsigned bit, std::size_t per_frame,
                    std::size_t offset, std::vector<Held>& held, const Motion& motion) {
  const auto& values = content.Values<Stored>(prefix + "/frames/" + kOptionalFrameFields[bit]);
  const std::size_t count = per_frame * static_cast<std::size_t>(motion.frame_count());
  held.reserve(count);
  for (std::size_t i = 0; i < count; ++i) held.push_back(static_cast<Held>(values[per_frame * offset + i]));
}

void PackTree(const std::vector<MotionRow>& rows, Sizes sizes, const std::string& prefix, Content& content) {
  std::vector<float> root;
  std::vector<float> rotation;
  std::vector<double> bones;
  root.reserve(sizes.frames * 3);
  rotation.reserve(sizes.frames * sizes.joints * 4);
  for (const MotionRow& row : rows) {
    for (const Vector3d& p : row.motion->root_translation) {
      for (int k = 0; k < 3; ++k) root.push_back(static_cast<float>(p[k]));
    }
    for (const Quaterniond& q : row.motion->rotation) {
      const auto stored = StoredQuaternion(q);
      rotation.insert(rotation.end(), stored.begin(), stored.end());
    }
    bones.insert(bones.end(), row.motion->bone_length.begin(), row.motion->bone_length.end());
  }
  content.Put(prefix + "/frames/root_translation", {sizes.frames, 3}, std::move(root));
  content.Put(prefix + "/frames/rotation", {sizes.frames, sizes.joints, 4}, std::move(rotation));
  content.Put(prefix + "/clips/bone_length", {rows.size(), sizes.joints}, std::move(bones));
}

/// Where the people's rest offsets are not all the file's.
void PackRestOffsets(const std::vector<MotionRow>& rows, const Skeleton& skeleton, const std::string& prefix,
                     Content& content) {
  if (std::all_of(rows.begin(), rows.end(),
                  [&](const MotionRow& row) { return SameRestOffsets(*row.motion->skeleton, skeleton); })) {
    return;
  }
  std::vector<double> offsets;
  for (const MotionRow& row : rows) {
    for (const Joint& joint : row.motion->skeleton->joints) {
      offsets.insert(offsets.end(), joint.rest_offset.data(), joint.rest_offset.data() + 3);
    }
  }
  content.Put(prefix + "/clips/rest_offset", {rows.size(), skeleton.joints.size(), 3}, std::move(offsets));
}

void UnpackTree(const Content& content, const std::string& prefix, std::size_t row, std::size_t offset,
                Motion& motion) {
  const auto F = static_cast<std::size_t>(motion.frame_count());
  const auto J = static_cast<std::size_t>(motion.joint_count());
  const float* root = content.Values<float>(prefix + "/frames/root_translation").data() + 3 * offset;
  const float* rotation = content.Values<float>(prefix + "/frames/rotation").data() + 4 * offset * J;
  const double* bones = content.Values<double>(prefix + "/clips/bone_length").data() + row * J;
  motion.root_translation.reserve(F);
  for (std::size_t f = 0; f < F; ++f)
    motion.root_translation.emplace_back(root[3 * f], root[3 * f + 1], root[3 * f + 2]);
  motion.rotation.reserve(F * J);
  for (std::size_t i = 0; i < F * J; ++i) motion.rotation.push_back(ReadQuaternion(rotation + 4 * i));
  motion.bone_length.assign(bones, bones + J);
}

Motion UnpackMotion(const Content& content, const std::string& prefix, const SkeletonPtr& skeleton, std::size_t row) {
  const auto offset = static_cast<std::size_t>(content.Values<std::int64_t>(prefix + "/clips/offset")[row]);
  const auto count = static_cast<std::size_t>(content.Values<std::int64_t>(prefix + "/clips/count")[row]);
  const auto J = static_cast<std::size_t>(skeleton->joint_count());
  Motion motion;
  motion.skeleton = WithRestOffsets(content, prefix, row, skeleton);
  if (motion.skeleton != skeleton) motion.counted_from = skeleton;
  motion.rate = *FrameRate::Parse(content.Values<std::string>(prefix + "/clips/rate")[row]);
  motion.joints.frames = static_cast<int>(count);
  motion.joints.joints = static_cast<int>(J);
  const float* joints = content.Values<float>(prefix + "/frames/joints").data() + 3 * offset * J;
  motion.joints.xyz.assign(joints, joints + 3 * count * J);
  if (content.Text("/@kinematics") == "tree") UnpackTree(content, prefix, row, offset, motion);
  const unsigned mask = content.Values<std::uint8_t>(prefix + "/clips/field_mask")[row];
  if ((mask & 1u) != 0) UnpackOptional<std::uint8_t>(content, prefix, 0, J, offset, motion.state, motion);
  if ((mask & 2u) != 0) UnpackOptional<float>(content, prefix, 1, J * 6, offset, motion.position_cov, motion);
  if ((mask & 4u) != 0) UnpackOptional<float>(content, prefix, 2, J * 3, offset, motion.rotation_sigma, motion);
  if ((mask & 8u) != 0) UnpackOptional<float>(content, prefix, 3, J * 3, offset, motion.rotation_observed, motion);
  if ((mask & 16u) != 0) UnpackOptional<std::uint8_t>(content, prefix, 4, 2, offset, motion.contact, motion);
  return motion;
}

}  // namespace

Quaterniond ReadQuaternion(const float* stored) {
  // The largest number is made again from the other three, which stay exact: unit, and stored again as it was.
  // (Dividing by the norm instead would let small numbers creep by a last bit each time.)
  std::array<double, 4> q = {stored[0], stored[1], stored[2], stored[3]};
  std::size_t largest = 0;
  double square = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (std::abs(q[k]) > std::abs(q[largest])) largest = k;
  }
  for (std::size_t k = 0; k < 4; ++k) square += k == largest ? 0.0 : q[k] * q[k];
  q[largest] = std::copysign(std::sqrt(std::max(0.0, 1.0 - square)), q[largest]);
  return Quaterniond(q[0], q[1], q[2], q[3]);
}

std::array<float, 4> StoredQuaternion(const Quaterniond& rotation) {
  using Stored = std::array<float, 4>;
  const auto round = [](const Quaterniond& q) {
    return Stored{static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                  static_cast<float>(q.z())};
  };
  if (!(std::abs(rotation.norm() - 1.0) <= 1e-5)) return round(rotation);  // not unit: the rule of the field says so
  // Two numbers that differ by a last bit may take turns as the largest: follow them until they repeat, and take the
  // least of the values that go round, the same whichever of them one starts from.
  constexpr std::size_t kSteps = 16;
  std::array<Stored, kSteps> seen;
  seen[0] = round(rotation);
  for (std::size_t n = 1; n < kSteps; ++n) {
    const Stored next = round(ReadQuaternion(seen[n - 1].data()));
    for (std::size_t k = 0; k < n; ++k) {
      if (seen[k] == next) return *std::min_element(seen.begin() + k, seen.begin() + n);
    }
    seen[n] = next;
  }
  return seen[kSteps - 1];
}

Status PackMotions(const std::vector<MotionRow>& rows, const Skeleton& skeleton, bool joints_only,
                   const std::string& prefix, Content& content) {
  Sizes sizes{0, skeleton.joints.size()};
  std::vector<std::int64_t> offsets;
  std::vector<std::int64_t> counts;
  for (const MotionRow& row : rows) {
    if (Status checked = CheckMotion(row, skeleton, joints_only); !checked) return checked;
    offsets.push_back(static_cast<std::int64_t>(sizes.frames));
    counts.push_back(row.motion->frame_count());
    sizes.frames += static_cast<std::size_t>(row.motion->frame_count());
  }
  const std::uint64_t C = rows.size();
  const std::uint64_t F = sizes.frames;
  const std::uint64_t J = sizes.joints;
  std::vector<float> joints;
  joints.reserve(F * J * 3);
  for (const MotionRow& row : rows) {
    for (const double value : row.motion->joints.xyz) joints.push_back(static_cast<float>(value));
  }
  content.Put(prefix + "/frames/joints", {F, J, 3}, std::move(joints));
  if (!joints_only) PackTree(rows, sizes, prefix, content);
  if (!joints_only) PackRestOffsets(rows, skeleton, prefix, content);
  std::vector<std::uint8_t> masks(C, 0);
  PackOptional<std::uint8_t>(rows, &Motion::state, J, 0, {F, J}, prefix, masks, content);
  PackOptional<float>(rows, &Motion::position_cov, J * 6, 1, {F, J, 6}, prefix, masks, content);
  PackOptional<float>(rows, &Motion::rotation_sigma, J * 3, 2, {F, J, 3}, prefix, masks, content);
  PackOptional<float>(rows, &Motion::rotation_observed, J * 3, 3, {F, J, 3}, prefix, masks, content);
  PackOptional<std::uint8_t>(rows, &Motion::contact, 2, 4, {F, 2}, prefix, masks, content);
  content.Put(prefix + "/clips/offset", {C}, std::move(offsets));
  content.Put(prefix + "/clips/count", {C}, std::move(counts));
  content.Put(prefix + "/clips/field_mask", {C}, std::move(masks));
  return {};
}

std::vector<Motion> UnpackMotions(const Content& content, const std::string& prefix, const SkeletonPtr& skeleton) {
  std::vector<Motion> motions;
  const std::size_t clips = content.fields.at(prefix + "/clips/count").rows();
  motions.reserve(clips);
  for (std::size_t row = 0; row < clips; ++row) motions.push_back(UnpackMotion(content, prefix, skeleton, row));
  return motions;
}

}  // namespace mocurate::store
