#include <filesystem>
#include <map>
#include <mutex>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/resources.h"
#include "core/base/text.h"
#include "core/geometry/axes.h"
#include "core/motion/skeleton.h"

namespace mocurate {
namespace {

struct JointEntry {
  std::string name;
  std::string parent;
  std::vector<double> rest_offset{0.0, 0.0, 0.0};
  std::string mirror;
  std::string lie_offset;
  std::string reflection;
  double radius = 0.05;
  bool landmark = false;
  std::vector<double> limits_min;
  std::vector<double> limits_max;
  std::vector<std::string> synonyms;

  void Declare(OptionVisitor& v) {
    v.Text("name", name, "the skeleton's own name of the joint");
    v.Text("parent", parent, "name of the parent, which comes before it; empty for the root");
    v.Numbers("rest_offset", rest_offset, Unit::kMetre, {-10.0, 10.0}, "from the parent in the rest pose");
    v.Text("mirror", mirror, "partner on the other side; empty on the midline");
    v.Text("lie_offset", lie_offset, "raw offset of Action2Motion's kinematics: +x, -x, +y, -y, +z or -z");
    v.Text("reflection", reflection, "frame of the partner from this frame in a mirror image, e.g. \"-x +y +z\"");
    v.Number("radius", radius, Unit::kMetre, {0.001, 1.0}, "capsule of the bone that ends here");
    v.Bool("landmark", landmark, "a surface point kept as a joint: its own rotation stays the identity");
    v.Numbers("limits_min", limits_min, Unit::kRadian, {-6.3, 6.3}, "least rotation vector");
    v.Numbers("limits_max", limits_max, Unit::kRadian, {-6.3, 6.3}, "greatest rotation vector");
    v.Texts("synonyms", synonyms, "other names, compared without case, blanks, '_' and '-'");
  }
};

struct LandmarkEntry {
  std::string name;
  std::string joint;
  std::vector<double> offset{0.0, 0.0, 0.0};

  void Declare(OptionVisitor& v) {
    v.Text("name", name, "name of the landmark");
    v.Text("joint", joint, "joint in whose frame it is fixed");
    v.Numbers("offset", offset, Unit::kMetre, {-10.0, 10.0}, "in the joint's frame");
  }
};

struct PlaceEntry {
  std::string point;
  std::string joint;
  std::vector<double> offset{0.0, 0.0, 0.0};
  double spread = 0.0;

  void Declare(OptionVisitor& v) {
    v.Text("point", point, "joint of this skeleton");
    v.Text("joint", joint, "joint of smpl24 that it moves with");
    v.Numbers("offset", offset, Unit::kMetre, {-10.0, 10.0}, "in that joint's frame");
    v.Number("spread", spread, Unit::kMetre, {0.0, 1.0}, "standard deviation of that position per axis");
  }
};

struct SkeletonFile {
  std::string name;
  std::vector<JointEntry> joints;
  std::vector<LandmarkEntry> landmarks;
  std::vector<PlaceEntry> on_body;
  std::vector<std::string> lie_chains;

  void Declare(OptionVisitor& v) {
    v.Text("name", name, "name of the skeleton");
    v.List("joints", joints, "joints, parents before children; the first is the root");
    v.List("landmarks", landmarks, "points outside the tree");
    v.List("on_body", on_body, "of a tracker's skeleton: positions of the points that are not joints of a body");
    v.Texts("lie_chains", lie_chains, "chains of Action2Motion's kinematics: names of joints with blanks between");
  }
};

Expected<Vector3d> Three(const std::vector<double>& numbers, const std::string& what, const std::string& where) {
  if (numbers.size() == 3) return Vector3d(numbers[0], numbers[1], numbers[2]);
  return Fail(ErrorCode::kConfig, what + " has " + std::to_string(numbers.size()) + " numbers, 3 are needed", where);
}

Expected<Vector3d> SignedAxis(const std::string& text, const std::string& what, const std::string& where) {
  if (text.size() == 2 && (text[0] == '+' || text[0] == '-') && text[1] >= 'x' && text[1] <= 'z') {
    Vector3d axis = Vector3d::Zero();
    axis[text[1] - 'x'] = text[0] == '+' ? 1.0 : -1.0;
    return axis;
  }
  return Fail(ErrorCode::kConfig, what + " is '" + text + "'", where, "write one of +x, -x, +y, -y, +z, -z");
}

using Index = std::map<std::string, int>;

Expected<int> Lookup(const Index& index, const std::string& joint, const std::string& what, const std::string& where) {
  if (const auto found = index.find(joint); found != index.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& entry : index) known.push_back(entry.first);
  const auto nearest = Nearest(joint, known);
  return Fail(ErrorCode::kConfig, what + " '" + joint + "' is not a joint of this skeleton", where,
              nearest ? "did you mean '" + *nearest + "'?" : "");
}

Expected<Joint> BuildJoint(const JointEntry& entry, const Index& index, const std::string& where) {
  Joint joint;
  joint.name = entry.name;
  joint.synonyms = entry.synonyms;
  joint.radius = entry.radius;
  joint.landmark = entry.landmark;
  const std::string label = "of joint '" + entry.name + "'";
  const auto offset = Three(entry.rest_offset, "rest_offset " + label, where);
  if (!offset) return Forward(offset);
  joint.rest_offset = *offset;
  const auto mirror = Lookup(index, entry.mirror.empty() ? entry.name : entry.mirror, "mirror " + label, where);
  if (!mirror) return Forward(mirror);
  joint.mirror = *mirror;
  if (!entry.parent.empty()) {
    const auto parent = Lookup(index, entry.parent, "parent " + label, where);
    if (!parent) return Forward(parent);
    joint.parent = *parent;
  }
  if (!entry.limits_min.empty() || !entry.limits_max.empty()) {
    const auto min = Three(entry.limits_min, "limits_min " + label, where);
    if (!min) return Forward(min);
    const auto max = Three(entry.limits_max, "limits_max " + label, where);
    if (!max) return Forward(max);
    joint.limits = JointLimits{*min, *max};
  }
  if (!entry.reflection.empty()) {
    const auto axes = AxisConvention::Parse(entry.reflection);
    if (!axes) return Fail(ErrorCode::kConfig, "reflection " + label + ": " + axes.error().what, where);
    joint.reflection = axes->canonical_from_source;
  }
  return joint;
}

Expected<LieChains> BuildLie(const SkeletonFile& file, const Index& index, const std::string& where) {
  LieChains lie;
  for (const std::string& text : file.lie_chains) {
    std::vector<int> chain;
    for (const std::string_view name : SplitBlanks(text)) {
      const auto joint = Lookup(index, std::string(name), "lie_chains:", where);
      if (!joint) return Forward(joint);
      chain.push_back(*joint);
    }
    lie.chains.push_back(std::move(chain));
  }
  for (const JointEntry& entry : file.joints) {
    if (entry.parent.empty()) {
      lie.raw_offsets.push_back(Vector3d::Zero());
      continue;
    }
    const auto axis = SignedAxis(entry.lie_offset, "lie_offset of joint '" + entry.name + "'", where);
    if (!axis) return Forward(axis);
    lie.raw_offsets.push_back(*axis);
  }
  return lie;
}

Expected<SkeletonPtr> Build(const SkeletonFile& file, const std::string& where) {
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = file.name;
  Index index;
  for (std::size_t j = 0; j < file.joints.size(); ++j) index.emplace(file.joints[j].name, static_cast<int>(j));
  for (const JointEntry& entry : file.joints) {
    auto joint = BuildJoint(entry, index, where);
    if (!joint) return Forward(joint);
    skeleton->joints.push_back(std::move(*joint));
  }
  for (const PlaceEntry& entry : file.on_body) {
    const auto point = Lookup(index, entry.point, "point of on_body", where);
    if (!point) return Forward(point);
    const auto offset = Three(entry.offset, "offset of '" + entry.point + "' on_body", where);
    if (!offset) return Forward(offset);
  }
  for (const LandmarkEntry& entry : file.landmarks) {
    const auto joint = Lookup(index, entry.joint, "joint of landmark '" + entry.name + "':", where);
    if (!joint) return Forward(joint);
    const auto offset = Three(entry.offset, "offset of landmark '" + entry.name + "'", where);
    if (!offset) return Forward(offset);
    skeleton->landmarks.push_back(Landmark{entry.name, *joint, *offset});
  }
  if (!file.lie_chains.empty()) {
    auto lie = BuildLie(file, index, where);
    if (!lie) return Forward(lie);
    skeleton->lie = std::move(*lie);
  }
  if (Status ok = skeleton->Check(); !ok) {
    Error error = ok.error();
    error.where = where;
    return tl::unexpected<Error>(error);
  }
  return SkeletonPtr(std::move(skeleton));
}

std::vector<std::string> BuiltInNames() {
  std::vector<std::string> names;
  for (const std::string& path : ResourcePaths()) {
    const std::string folder = "skeletons/", ending = ".yaml";
    if (path.rfind(folder, 0) != 0 || path.size() <= folder.size() + ending.size()) continue;
    names.push_back(path.substr(folder.size(), path.size() - folder.size() - ending.size()));
  }
  return names;
}

Expected<SkeletonFile> ParseFile(const std::string& yaml, const std::string& name) {
  const auto node = LoadData(ConfigSource{yaml, name, {}});
  if (!node) return Forward(node);
  return OptionsFromConfig<SkeletonFile>(*node);
}

/// Text of a skeleton's file, and what to call it in messages.
Expected<std::pair<std::string, std::string>> FindText(const std::string& name_or_path) {
  const std::string resource = "skeletons/" + name_or_path + ".yaml";
  if (const auto text = FindResource(resource)) return std::pair(std::string(*text), resource);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(name_or_path, ignored)) {
    auto file = ReadConfigFile(name_or_path);
    if (!file) return Forward(file);
    return std::pair(std::move(file->text), std::move(file->name));
  }
  std::string known;
  for (const std::string& name : BuiltInNames()) known += (known.empty() ? "" : ", ") + name;
  const auto nearest = Nearest(name_or_path, BuiltInNames());
  return Fail(ErrorCode::kNotFound, "there is no skeleton '" + name_or_path + "', neither built in nor as a file", {},
              nearest ? "did you mean '" + *nearest + "'?" : "built in: " + known);
}

}  // namespace

Expected<SkeletonPtr> ParseSkeleton(const std::string& yaml, const std::string& name) {
  const auto file = ParseFile(yaml, name);
  if (!file) return Forward(file);
  return Build(*file, name);
}

Expected<SkeletonPtr> LoadSkeleton(const std::string& name_or_path) {
  // Embedded skeletons never change: each is parsed once, as it is asked for once a clip.
  static std::mutex mutex;
  static std::map<std::string, SkeletonPtr> parsed;
  const bool embedded = FindResource("skeletons/" + name_or_path + ".yaml").has_value();
  if (embedded) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (const auto known = parsed.find(name_or_path); known != parsed.end()) return known->second;
  }
  const auto text = FindText(name_or_path);
  if (!text) return Forward(text);
  Expected<SkeletonPtr> skeleton = ParseSkeleton(text->first, text->second);
  if (skeleton && embedded) {
    const std::lock_guard<std::mutex> lock(mutex);
    parsed[name_or_path] = *skeleton;
  }
  return skeleton;
}

Expected<std::vector<PointPlace>> LoadPointPlaces(const std::string& name_or_path) {
  const auto text = FindText(name_or_path);
  if (!text) return Forward(text);
  const auto file = ParseFile(text->first, text->second);
  if (!file) return Forward(file);
  if (const auto sound = Build(*file, text->second); !sound) return Forward(sound);
  std::vector<PointPlace> places;
  for (const PlaceEntry& entry : file->on_body) {
    places.push_back({entry.point, entry.joint, {entry.offset[0], entry.offset[1], entry.offset[2]}, entry.spread});
  }
  return places;
}

}  // namespace mocurate
