#include "core/store/fields.h"

namespace mocurate::store {
namespace {

void Append(std::vector<double>& values, const Vector3d& vector) {
  values.insert(values.end(), vector.data(), vector.data() + 3);
}

Vector3d RowVector(const std::vector<double>& values, std::size_t row) {
  return Vector3d(values[3 * row], values[3 * row + 1], values[3 * row + 2]);
}

void PackLimits(const Skeleton& skeleton, const std::string& path, Content& content) {
  const std::uint64_t J = skeleton.joints.size();
  std::vector<std::uint8_t> given;
  std::vector<double> min;
  std::vector<double> max;
  bool any = false;
  for (const Joint& joint : skeleton.joints) {
    any = any || joint.limits.has_value();
    given.push_back(joint.limits ? 1 : 0);
    Append(min, joint.limits ? joint.limits->min : Vector3d::Zero());
    Append(max, joint.limits ? joint.limits->max : Vector3d::Zero());
  }
  if (!any) return;
  content.Put(path + "/limits/given", {J}, std::move(given));
  content.Put(path + "/limits/min", {J, 3}, std::move(min));
  content.Put(path + "/limits/max", {J, 3}, std::move(max));
}

void PackReflections(const Skeleton& skeleton, const std::string& path, Content& content) {
  std::vector<std::int32_t> joints;
  std::vector<double> matrices;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    if (!skeleton.joints[j].reflection) continue;
    joints.push_back(static_cast<std::int32_t>(j));
    for (int row = 0; row < 3; ++row) Append(matrices, skeleton.joints[j].reflection->row(row).transpose());
  }
  const std::uint64_t count = joints.size();
  if (count == 0) return;
  content.Put(path + "/reflections/joint", {count}, std::move(joints));
  content.Put(path + "/reflections/matrix", {count, 3, 3}, std::move(matrices));
}

void UnpackReflections(const Content& content, const std::string& path, Skeleton& skeleton) {
  if (!content.Has(path + "/reflections/joint")) return;
  const auto& joints = content.Values<std::int32_t>(path + "/reflections/joint");
  const auto& matrices = content.Values<double>(path + "/reflections/matrix");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Matrix3d matrix;
    for (int row = 0; row < 3; ++row) matrix.row(row) = RowVector(matrices, 3 * i + static_cast<std::size_t>(row));
    skeleton.joints[static_cast<std::size_t>(joints[i])].reflection = matrix;
  }
}

void PackSynonyms(const Skeleton& skeleton, const std::string& path, Content& content) {
  std::vector<std::int32_t> joints;
  std::vector<std::string> names;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    for (const std::string& name : skeleton.joints[j].synonyms) {
      joints.push_back(static_cast<std::int32_t>(j));
      names.push_back(name);
    }
  }
  const std::uint64_t count = joints.size();
  if (count == 0) return;
  content.Put(path + "/synonyms/joint", {count}, std::move(joints));
  content.Put(path + "/synonyms/name", {count}, std::move(names));
}

void PackLandmarks(const Skeleton& skeleton, const std::string& path, Content& content) {
  const std::uint64_t count = skeleton.landmarks.size();
  if (count == 0) return;
  std::vector<std::string> names;
  std::vector<std::int32_t> joints;
  std::vector<double> offsets;
  for (const Landmark& landmark : skeleton.landmarks) {
    names.push_back(landmark.name);
    joints.push_back(landmark.joint);
    Append(offsets, landmark.offset);
  }
  content.Put(path + "/landmarks/name", {count}, std::move(names));
  content.Put(path + "/landmarks/joint", {count}, std::move(joints));
  content.Put(path + "/landmarks/offset", {count, 3}, std::move(offsets));
}

void PackLie(const LieChains& lie, const std::string& path, Content& content) {
  std::vector<std::int32_t> lengths;
  std::vector<std::int32_t> joints;
  std::vector<double> offsets;
  for (const auto& chain : lie.chains) {
    lengths.push_back(static_cast<std::int32_t>(chain.size()));
    joints.insert(joints.end(), chain.begin(), chain.end());
  }
  for (const Vector3d& offset : lie.raw_offsets) Append(offsets, offset);
  const std::uint64_t H = lengths.size();
  const std::uint64_t Q = joints.size();
  content.Put(path + "/lie/chain_length", {H}, std::move(lengths));
  content.Put(path + "/lie/chain_joint", {Q}, std::move(joints));
  content.Put(path + "/lie/raw_offset", {lie.raw_offsets.size(), 3}, std::move(offsets));
}

LieChains UnpackLie(const Content& content, const std::string& path) {
  LieChains lie;
  const auto& joints = content.Values<std::int32_t>(path + "/lie/chain_joint");
  auto next = joints.begin();
  for (const std::int32_t length : content.Values<std::int32_t>(path + "/lie/chain_length")) {
    lie.chains.emplace_back(next, next + length);
    next += length;
  }
  const auto& offsets = content.Values<double>(path + "/lie/raw_offset");
  for (std::size_t j = 0; 3 * j < offsets.size(); ++j) lie.raw_offsets.push_back(RowVector(offsets, j));
  return lie;
}

}  // namespace

void PackSkeleton(const Skeleton& skeleton, const std::string& prefix, Content& content) {
  const std::string path = prefix + "/skeleton";
  const std::uint64_t J = skeleton.joints.size();
  std::vector<std::string> names;
  std::vector<std::int32_t> parents;
  std::vector<std::int32_t> mirror;
  std::vector<double> offsets;
  std::vector<double> radius;
  std::vector<std::uint8_t> surface;
  for (const Joint& joint : skeleton.joints) {
    names.push_back(joint.name);
    parents.push_back(joint.parent);
    mirror.push_back(joint.mirror);
    Append(offsets, joint.rest_offset);
    radius.push_back(joint.radius);
    surface.push_back(joint.landmark ? 1 : 0);
  }
  content.PutText("/@skeleton", skeleton.name);
  content.Put(path + "/names", {J}, std::move(names));
  content.Put(path + "/parents", {J}, std::move(parents));
  content.Put(path + "/rest_offsets", {J, 3}, std::move(offsets));
  content.Put(path + "/mirror", {J}, std::move(mirror));
  content.Put(path + "/radius", {J}, std::move(radius));
  content.Put(path + "/surface_point", {J}, std::move(surface));
  PackLimits(skeleton, path, content);
  PackReflections(skeleton, path, content);
  PackSynonyms(skeleton, path, content);
  PackLandmarks(skeleton, path, content);
  if (skeleton.lie) PackLie(*skeleton.lie, path, content);
}

Skeleton UnpackSkeleton(const Content& content, const std::string& prefix) {
  const std::string path = prefix + "/skeleton";
  Skeleton skeleton;
  skeleton.name = content.Text("/@skeleton");
  const auto& names = content.Values<std::string>(path + "/names");
  for (std::size_t j = 0; j < names.size(); ++j) {
    Joint joint;
    joint.name = names[j];
    joint.parent = content.Values<std::int32_t>(path + "/parents")[j];
    joint.rest_offset = RowVector(content.Values<double>(path + "/rest_offsets"), j);
    joint.mirror = content.Values<std::int32_t>(path + "/mirror")[j];
    joint.radius = content.Values<double>(path + "/radius")[j];
    joint.landmark = content.Values<std::uint8_t>(path + "/surface_point")[j] != 0;
    if (content.Has(path + "/limits/given") && content.Values<std::uint8_t>(path + "/limits/given")[j] != 0) {
      joint.limits = JointLimits{RowVector(content.Values<double>(path + "/limits/min"), j),
                                 RowVector(content.Values<double>(path + "/limits/max"), j)};
    }
    skeleton.joints.push_back(std::move(joint));
  }
  UnpackReflections(content, path, skeleton);
  if (content.Has(path + "/synonyms/joint")) {
    const auto& joints = content.Values<std::int32_t>(path + "/synonyms/joint");
    for (std::size_t i = 0; i < joints.size(); ++i) {
      skeleton.joints.at(static_cast<std::size_t>(joints[i]))
          .synonyms.push_back(content.Values<std::string>(path + "/synonyms/name")[i]);
    }
  }
  if (content.Has(path + "/landmarks/name")) {
    const auto& landmarks = content.Values<std::string>(path + "/landmarks/name");
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      skeleton.landmarks.push_back({landmarks[i], content.Values<std::int32_t>(path + "/landmarks/joint")[i],
                                    RowVector(content.Values<double>(path + "/landmarks/offset"), i)});
    }
  }
  if (content.Has(path + "/lie/chain_length")) skeleton.lie = UnpackLie(content, path);
  return skeleton;
}

bool SameSkeleton(const Skeleton& a, const Skeleton& b) {
  if (&a == &b) return true;
  Content first;
  Content second;
  PackSkeleton(a, "", first);
  PackSkeleton(b, "", second);
  return first.fields == second.fields;
}

bool SameButRestOffsets(const Skeleton& a, const Skeleton& b) {
  if (a.joints.size() != b.joints.size()) return false;
  Skeleton alike = a;
  for (std::size_t j = 0; j < a.joints.size(); ++j) alike.joints[j].rest_offset = b.joints[j].rest_offset;
  return SameSkeleton(alike, b);
}

SkeletonPtr WithRestOffsets(const Content& content, const std::string& prefix, std::size_t row,
                            const SkeletonPtr& skeleton) {
  const std::string field = prefix + "/clips/rest_offset";
  if (!content.Has(field)) return skeleton;
  const auto& offsets = content.Values<double>(field);
  auto own = std::make_shared<Skeleton>(*skeleton);
  for (std::size_t j = 0; j < own->joints.size(); ++j) {
    own->joints[j].rest_offset = RowVector(offsets, row * own->joints.size() + j);
  }
  if (SameRestOffsets(*own, *skeleton)) return skeleton;
  return own;
}

}  // namespace mocurate::store
