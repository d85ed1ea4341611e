#include <algorithm>
#include <cmath>

#include "core/store/content_file.h"
#include "core/store/dataset_writer.h"
#include "core/store/fields.h"

namespace mocurate::store {
namespace {

template <class T>
Status CheckSize(const std::vector<T>& values, std::size_t expected, const std::string& field, const std::string& id,
                 bool may_be_empty = false) {
  if (values.size() == expected || (may_be_empty && values.empty())) return {};
  return Fail(ErrorCode::kInconsistent,
              field + " of the motion has " + std::to_string(values.size()) + " entries; " + std::to_string(expected) +
                  " are needed",
              id);
}

/// The optional fields in the order of their bits.
template <class Work>
void ForEachOptional(const Work& work) {
  work(0, &Motion::state, std::uint8_t(), [](std::size_t joints) { return std::vector<std::uint64_t>{joints}; });
  work(1, &Motion::position_cov, float(), [](std::size_t joints) { return std::vector<std::uint64_t>{joints, 6}; });
  work(2, &Motion::rotation_sigma, float(), [](std::size_t joints) { return std::vector<std::uint64_t>{joints, 3}; });
  work(3, &Motion::rotation_observed, float(), [](std::size_t joints) {
    return std::vector<std::uint64_t>{joints, 3};
  });
  work(4, &Motion::contact, std::uint8_t(), [](std::size_t) { return std::vector<std::uint64_t>{2}; });
}

std::string FramesPath(const std::string& prefix, unsigned bit) {
  return prefix + "/frames/" + kOptionalFrameFields[bit];
}

/// Type and shape of a field of /frames of so many rows.
template <class Stored>
void PutLater(const std::string& path, std::uint64_t rows, std::vector<std::uint64_t> per_row, Content& content) {
  per_row.insert(per_row.begin(), rows);
  content.fields[path] = MakeArray(std::move(per_row), std::vector<Stored>());
  content.later.insert(path);
}

Status CheckKinematics(const std::string& id, const Motion& motion, bool joints_only) {
  if (motion.joints_only() == joints_only || motion.joints.empty()) return {};
  return Fail(ErrorCode::kInconsistent,
              joints_only ? "the motion has rotations in a file of joints only" : "the motion has no rotations", id,
              "a file holds either rotations for all clips or joints only");
}

Status CheckOutline(const MotionRow& row, const Skeleton& skeleton, bool joints_only) {
  const Motion& motion = *row.motion;
  if (Status fits = CheckKinematics(row.id, motion, joints_only); !fits) return fits;
  const bool same = motion.skeleton != nullptr && (joints_only ? SameSkeleton(*motion.skeleton, skeleton)
                                                               : SameButRestOffsets(*motion.skeleton, skeleton));
  if (!same) {
    return Fail(ErrorCode::kInconsistent, "the motion's skeleton is not the file's '" + skeleton.name + "'", row.id,
                "one file holds one skeleton; map the joints first");
  }
  const std::size_t J = skeleton.joints.size();
  if (motion.frame_count() < 0 || motion.joint_count() != skeleton.joint_count()) {
    return Fail(ErrorCode::kInconsistent,
                "the motion has " + std::to_string(motion.joint_count()) + " joints, its skeleton " + std::to_string(J),
                row.id);
  }
  return CheckSize(motion.bone_length, joints_only ? 0 : J, "bone_length", row.id, joints_only);
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

void PackTree(const Motion& motion, const std::string& prefix, Content& content) {
  const auto F = static_cast<std::size_t>(motion.frame_count());
  const auto J = static_cast<std::size_t>(motion.joint_count());
  std::vector<float> root, rotation;
  root.reserve(F * 3);
  rotation.reserve(F * J * 4);
  for (const Vector3d& p : motion.root_translation) {
    for (int k = 0; k < 3; ++k) root.push_back(static_cast<float>(p[k]));
  }
  for (const Quaterniond& q : motion.rotation) {
    const auto stored = StoredQuaternion(q);
    rotation.insert(rotation.end(), stored.begin(), stored.end());
  }
  content.Put(prefix + "/frames/root_translation", {F, 3}, std::move(root));
  content.Put(prefix + "/frames/rotation", {F, J, 4}, std::move(rotation));
}

void UnpackTree(const Content& content, const std::string& prefix, std::size_t offset, Motion& motion) {
  const auto F = static_cast<std::size_t>(motion.frame_count());
  const auto J = static_cast<std::size_t>(motion.joint_count());
  const float* root = content.Values<float>(prefix + "/frames/root_translation").data() + 3 * offset;
  const float* rotation = content.Values<float>(prefix + "/frames/rotation").data() + 4 * offset * J;
  motion.root_translation.reserve(F);
  for (std::size_t f = 0; f < F; ++f)
    motion.root_translation.emplace_back(root[3 * f], root[3 * f + 1], root[3 * f + 2]);
  motion.rotation.reserve(F * J);
  for (std::size_t i = 0; i < F * J; ++i) motion.rotation.push_back(ReadQuaternion(rotation + 4 * i));
}

}  // namespace

Motion UnpackOutline(const Content& content, const std::string& prefix, const SkeletonPtr& skeleton, std::size_t row) {
  const auto J = static_cast<std::size_t>(skeleton->joint_count());
  Motion motion;
  motion.skeleton = WithRestOffsets(content, prefix, row, skeleton);
  if (motion.skeleton != skeleton) motion.rotation_reference = skeleton;
  motion.rate = *FrameRate::Parse(content.Values<std::string>(prefix + "/clips/rate")[row]);
  motion.joints.frames = static_cast<int>(content.Values<std::int64_t>(prefix + "/clips/count")[row]);
  motion.joints.joints = static_cast<int>(J);
  if (content.Text("/@kinematics") == "tree") {
    const double* bones = content.Values<double>(prefix + "/clips/bone_length").data() + row * J;
    motion.bone_length.assign(bones, bones + J);
  }
  return motion;
}

Motion UnpackMotion(const Content& content, const std::string& prefix, const SkeletonPtr& skeleton, std::size_t row) {
  const auto offset = static_cast<std::size_t>(content.Values<std::int64_t>(prefix + "/clips/offset")[row]);
  const auto J = static_cast<std::size_t>(skeleton->joint_count());
  Motion motion = UnpackOutline(content, prefix, skeleton, row);
  const std::size_t count = static_cast<std::size_t>(motion.frame_count());
  const float* joints = content.Values<float>(prefix + "/frames/joints").data() + 3 * offset * J;
  motion.joints.xyz.assign(joints, joints + 3 * count * J);
  if (content.Text("/@kinematics") == "tree") UnpackTree(content, prefix, offset, motion);
  const unsigned mask = content.Values<std::uint8_t>(prefix + "/clips/field_mask")[row];
  ForEachOptional([&](unsigned bit, auto member, auto stored, auto per_frame) {
    if ((mask & (1u << bit)) == 0) return;
    std::size_t width = 1;
    for (const std::uint64_t extent : per_frame(J)) width *= extent;
    const auto* values = content.Values<decltype(stored)>(FramesPath(prefix, bit)).data() + width * offset;
    auto& held = motion.*member;
    held.reserve(width * count);
    using Held = typename std::decay_t<decltype(held)>::value_type;
    for (std::size_t i = 0; i < width * count; ++i) held.push_back(static_cast<Held>(values[i]));
  });
  return motion;
}

Quaterniond ReadQuaternion(const float* stored) {
  // The largest number is recomputed from the other three, which stay exact: the norm is 1 and storing is idempotent.
  // (Dividing by the norm instead would change small numbers by a last bit each time.)
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
  if (!(std::abs(rotation.norm() - 1.0) <= 1e-5))
    return round(rotation);  // not unit: reported by the rule of the field
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

Status InFile(Status status, const std::filesystem::path& path) {
  if (!status) status.error().where = Where(path, status.error().where);
  return status;
}

Status CheckRates(const Clip& clip, const std::filesystem::path& path) {
  if (clip.motion->rate == clip.rate) return {};
  return Fail(ErrorCode::kInconsistent,
              "the clip's rate is " + clip.rate.Text() + ", its motion's " + clip.motion->rate.Text(),
              Where(path, clip.id()));
}

Status PackOutlines(const std::vector<MotionRow>& rows, const Skeleton& skeleton, bool joints_only,
                    const std::string& prefix, Content& content) {
  const std::uint64_t C = rows.size(), J = skeleton.joints.size();
  std::uint64_t F = 0;
  unsigned present = 0;
  std::vector<std::int64_t> offsets, counts;
  std::vector<std::uint8_t> masks;
  std::vector<double> bones;
  for (const MotionRow& row : rows) {
    if (Status checked = CheckOutline(row, skeleton, joints_only); !checked) return checked;
    offsets.push_back(static_cast<std::int64_t>(F));
    counts.push_back(row.motion->frame_count());
    masks.push_back(row.optional_fields);
    present |= row.optional_fields;
    F += static_cast<std::uint64_t>(row.motion->frame_count());
    bones.insert(bones.end(), row.motion->bone_length.begin(), row.motion->bone_length.end());
  }
  PutLater<float>(prefix + "/frames/joints", F, {J, 3}, content);
  if (!joints_only) {
    PutLater<float>(prefix + "/frames/root_translation", F, {3}, content);
    PutLater<float>(prefix + "/frames/rotation", F, {J, 4}, content);
    content.Put(prefix + "/clips/bone_length", {C, J}, std::move(bones));
    PackRestOffsets(rows, skeleton, prefix, content);
  }
  ForEachOptional([&](unsigned bit, auto, auto stored, auto per_frame) {
    if ((present & (1u << bit)) == 0) return;
    PutLater<decltype(stored)>(FramesPath(prefix, bit), F, per_frame(J), content);
  });
  content.Put(prefix + "/clips/offset", {C}, std::move(offsets));
  content.Put(prefix + "/clips/count", {C}, std::move(counts));
  content.Put(prefix + "/clips/field_mask", {C}, std::move(masks));
  return {};
}

Status CheckFrames(const std::string& id, const Motion& motion, bool joints_only) {
  if (Status fits = CheckKinematics(id, motion, joints_only); !fits) return fits;
  const auto F = static_cast<std::size_t>(motion.frame_count());
  const auto J = static_cast<std::size_t>(motion.joint_count());
  const std::size_t tree = joints_only ? 0 : 1;
  for (const Status& status : {CheckSize(motion.joints.xyz, F * J * 3, "joints", id),
                               CheckSize(motion.root_translation, tree * F, "root_translation", id),
                               CheckSize(motion.rotation, tree * F * J, "rotation", id)}) {
    if (!status) return status;
  }
  Status sized;
  ForEachOptional([&](unsigned bit, auto member, auto, auto per_frame) {
    std::size_t expected = F;
    for (const std::uint64_t extent : per_frame(J)) expected *= extent;
    if (sized) sized = CheckSize(motion.*member, expected, kOptionalFrameFields[bit], id, true);
  });
  return sized;
}

void PackFrames(const Motion& motion, unsigned present, bool joints_only, const std::string& prefix, Content& content) {
  const auto F = static_cast<std::size_t>(motion.frame_count());
  const auto J = static_cast<std::size_t>(motion.joint_count());
  content.Put(prefix + "/frames/joints", {F, J, 3},
              std::vector<float>(motion.joints.xyz.begin(), motion.joints.xyz.end()));
  if (!joints_only) PackTree(motion, prefix, content);
  ForEachOptional([&](unsigned bit, auto member, auto stored, auto per_frame) {
    if ((present & (1u << bit)) == 0) return;
    std::vector<std::uint64_t> shape = per_frame(J);
    shape.insert(shape.begin(), F);
    std::size_t count = 1;
    for (const std::uint64_t extent : shape) count *= extent;
    std::vector<decltype(stored)> values;
    values.reserve(count);
    for (const auto value : motion.*member) values.push_back(static_cast<decltype(stored)>(value));
    values.resize(count);  // zeros where the motion has none
    content.Put(FramesPath(prefix, bit), std::move(shape), std::move(values));
  });
}

std::vector<Motion> UnpackMotions(const Content& content, const std::string& prefix, const SkeletonPtr& skeleton) {
  std::vector<Motion> motions;
  const std::size_t clips = content.fields.at(prefix + "/clips/count").rows();
  motions.reserve(clips);
  for (std::size_t row = 0; row < clips; ++row) motions.push_back(UnpackMotion(content, prefix, skeleton, row));
  return motions;
}

}  // namespace mocurate::store

namespace mocurate {

std::uint8_t OptionalFieldsOf(const Motion& motion) {
  unsigned mask = 0;
  store::ForEachOptional(
      [&](unsigned bit, auto member, auto, auto) { mask |= (motion.*member).empty() ? 0u : 1u << bit; });
  return static_cast<std::uint8_t>(mask);
}

}  // namespace mocurate
