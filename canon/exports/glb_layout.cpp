// The layout glb: a binary glTF 2.0 file with the joints as nodes, an animation of their rotations and of the root's
// place, and a mesh of capsules that they carry. Metres, y up, facing +z: glTF's frame is ours.

#include <tiny_gltf.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>

#include "canon/exports/clip_names.h"
#include "canon/exports/written_set.h"
#include "core/base/pi.h"
#include "core/base/version.h"
#include "core/body/bone_capsules.h"
#include "core/body/capsule_body.h"

namespace mocurate {
namespace {

constexpr int kAround = 12;  ///< corners of a capsule's cross-section
constexpr int kRings = 3;    ///< of each of its ends, without the pole

/// Triangles with the joint that carries each vertex; metres, in the rest pose.
struct CarriedMesh {
  std::vector<float> places, normals;
  std::vector<std::uint16_t> joints;  ///< four a vertex; one of them carries it
  std::vector<float> weights;
  std::vector<std::uint32_t> corners;

  void Add(const Vector3d& place, const Vector3d& normal, int joint) {
    for (int k = 0; k < 3; ++k) {
      places.push_back(static_cast<float>(place[k]));
      normals.push_back(static_cast<float>(normal[k]));
    }
    joints.insert(joints.end(), {static_cast<std::uint16_t>(joint), 0, 0, 0});
    weights.insert(weights.end(), {1.0F, 0.0F, 0.0F, 0.0F});
  }
};

/// A capsule: rings from the pole at `begin` to the pole at `end`.
void AddCapsule(const Vector3d& begin, const Vector3d& end, double radius, int joint, CarriedMesh& mesh) {
  const Vector3d along = end - begin, axis = along.norm() > 0.0 ? along.normalized() : Vector3d::UnitY();
  const Vector3d side = axis.unitOrthogonal(), other = axis.cross(side);
  const auto first = static_cast<std::uint32_t>(mesh.places.size() / 3);
  constexpr int kLevels = 2 * (kRings + 1);
  for (int level = 0; level < kLevels; ++level) {
    const bool near = level <= kRings;
    const int step = near ? level : level - 1;  // the two rings around the middle have the same normals
    const double up = -0.5 * kPi + kPi * step / (kLevels - 2);
    for (int k = 0; k < kAround; ++k) {
      const double turn = 2.0 * kPi * k / kAround;
      const Vector3d normal = std::cos(up) * (std::cos(turn) * side + std::sin(turn) * other) + std::sin(up) * axis;
      mesh.Add((near ? begin : end) + radius * normal, normal, joint);
    }
  }
  for (std::uint32_t level = 0; level + 1 < kLevels; ++level) {
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const std::uint32_t next = (k + 1) % kAround, low = first + level * kAround, high = low + kAround;
      mesh.corners.insert(mesh.corners.end(), {low + k, low + next, high + next, low + k, high + next, high + k});
    }
  }
}

/// A model under construction with its one buffer.
class GlbBuilder {
 public:
  tinygltf::Model model;

  GlbBuilder() { model.buffers.resize(1); }

  /// An accessor of `size` numbers per element; with `bounds` it states the least and the largest of each.
  template <class T>
  int Add(const std::vector<T>& values, int size, int type, int component, int target, bool bounds = false) {
    std::vector<unsigned char>& bytes = model.buffers[0].data;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = values.size() * sizeof(T);
    view.target = target;
    bytes.resize(bytes.size() + view.byteLength);
    if (!values.empty()) std::memcpy(&bytes[view.byteOffset], values.data(), view.byteLength);
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model.bufferViews.size());
    accessor.componentType = component;
    accessor.count = values.size() / static_cast<std::size_t>(size);
    accessor.type = type;
    if (bounds && !values.empty()) {
      accessor.minValues.assign(values.begin(), values.begin() + size);
      accessor.maxValues = accessor.minValues;
      for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t k = i % static_cast<std::size_t>(size);
        accessor.minValues[k] = std::min(accessor.minValues[k], static_cast<double>(values[i]));
        accessor.maxValues[k] = std::max(accessor.maxValues[k], static_cast<double>(values[i]));
      }
    }
    model.bufferViews.push_back(std::move(view));
    model.accessors.push_back(std::move(accessor));
    return static_cast<int>(model.accessors.size()) - 1;
  }
  int AddFloats(const std::vector<float>& values, int size, int type, int target = 0, bool bounds = false) {
    return Add(values, size, type, TINYGLTF_COMPONENT_TYPE_FLOAT, target, bounds);
  }
};

/// Places of the joints in the rest pose with this person's bones, the root at 0.
std::vector<Vector3d> RestPlaces(const Motion& motion, std::vector<Vector3d>& offsets) {
  const Skeleton& skeleton = *motion.skeleton;
  std::vector<Vector3d> places;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joints[static_cast<std::size_t>(j)];
    const bool own = j > 0 && !motion.bone_length.empty();
    offsets.push_back(
        j == 0 ? Vector3d(Vector3d::Zero())
        : own  ? Vector3d(motion.bone_length[static_cast<std::size_t>(j)] * joint.rest_offset.stableNormalized())
               : joint.rest_offset);
    places.push_back(offsets.back() +
                     (j == 0 ? Vector3d(Vector3d::Zero()) : places[static_cast<std::size_t>(joint.parent)]));
  }
  return places;
}

void AddBody(const Motion& motion, const std::vector<Vector3d>& rest, GlbBuilder& glb) {
  CarriedMesh mesh;
  const BoneCapsules body = BoneCapsules::Make(motion.skeleton, BodyScale(*motion.skeleton, motion.bone_length));
  for (const Capsule& capsule : body.capsules) {
    AddCapsule(rest[static_cast<std::size_t>(capsule.parent)], rest[static_cast<std::size_t>(capsule.joint)],
               capsule.radius, capsule.parent, mesh);
  }
  tinygltf::Model& model = glb.model;
  tinygltf::Skin skin;
  std::vector<float> inverse;  // columns: the joints are not turned in the rest pose
  for (std::size_t j = 0; j < rest.size(); ++j) {
    skin.joints.push_back(static_cast<int>(j));
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row)
        inverse.push_back(column == row ? 1.0F : column == 3 ? static_cast<float>(-rest[j][row]) : 0.0F);
    }
  }
  skin.inverseBindMatrices = glb.AddFloats(inverse, 16, TINYGLTF_TYPE_MAT4);
  skin.skeleton = 0;
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = 0;
  primitive.attributes["POSITION"] =
      glb.AddFloats(mesh.places, 3, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER, true);
  primitive.attributes["NORMAL"] = glb.AddFloats(mesh.normals, 3, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.attributes["JOINTS_0"] =
      glb.Add(mesh.joints, 4, TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.attributes["WEIGHTS_0"] = glb.AddFloats(mesh.weights, 4, TINYGLTF_TYPE_VEC4, TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.indices = glb.Add(mesh.corners, 1, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                              TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  tinygltf::Material material;
  material.name = "body";
  material.pbrMetallicRoughness.baseColorFactor = {0.55, 0.62, 0.74, 1.0};
  material.pbrMetallicRoughness.metallicFactor = 0.0;
  material.pbrMetallicRoughness.roughnessFactor = 0.8;
  model.materials.push_back(material);
  tinygltf::Mesh carried;
  carried.name = "body";
  carried.primitives.push_back(primitive);
  model.meshes.push_back(carried);
  model.skins.push_back(skin);
  tinygltf::Node node;
  node.name = "body";
  node.mesh = 0;
  node.skin = 0;
  model.scenes[0].nodes.push_back(static_cast<int>(model.nodes.size()));
  model.nodes.push_back(node);
}

void AddAnimation(const Clip& clip, GlbBuilder& glb) {
  const Motion& motion = *clip.motion;
  tinygltf::Animation animation;
  animation.name = clip.label.empty() ? clip.identity.recording : clip.label;
  std::vector<float> times, root;
  for (int f = 0; f < motion.frame_count(); ++f) {
    times.push_back(static_cast<float>(motion.rate.FrameTime(f)));
    for (int k = 0; k < 3; ++k)
      root.push_back(static_cast<float>(motion.root_translation[static_cast<std::size_t>(f)][k]));
  }
  const int input = glb.AddFloats(times, 1, TINYGLTF_TYPE_SCALAR, 0, true);
  const auto add = [&](int node, const char* path, int output) {
    tinygltf::AnimationSampler sampler;
    sampler.input = input;
    sampler.output = output;
    tinygltf::AnimationChannel channel;
    channel.sampler = static_cast<int>(animation.samplers.size());
    channel.target_node = node;
    channel.target_path = path;
    animation.samplers.push_back(sampler);
    animation.channels.push_back(channel);
  };
  add(0, "translation", glb.AddFloats(root, 3, TINYGLTF_TYPE_VEC3));
  for (int j = 0; j < motion.joint_count(); ++j) {
    std::vector<float> turns;
    for (int f = 0; f < motion.frame_count(); ++f) {
      const Quaterniond& q = motion.rotation_at(f, j);
      for (const double number : {q.x(), q.y(), q.z(), q.w()}) turns.push_back(static_cast<float>(number));
    }
    add(j, "rotation", glb.AddFloats(turns, 4, TINYGLTF_TYPE_VEC4));
  }
  glb.model.animations.push_back(animation);
}

Expected<std::string> GlbOfClip(const Clip& clip, const ExportSet&) {
  const Motion& motion = *clip.motion;
  if (motion.joints_only()) {
    return Fail(ErrorCode::kInconsistent, "the motion has joints alone, no rotations", clip.id(),
                "`mocurate fit` estimates rotations");
  }
  const Skeleton& skeleton = *motion.skeleton;
  GlbBuilder glb;
  tinygltf::Model& model = glb.model;
  model.asset.version = "2.0";
  model.asset.generator = CreatedBy();
  model.scenes.resize(1);
  model.scenes[0].name = WithoutControls(clip.id());
  model.scenes[0].nodes = {0};
  model.defaultScene = 0;
  std::vector<Vector3d> offsets;
  const std::vector<Vector3d> rest = RestPlaces(motion, offsets);
  const std::vector<std::vector<int>> children = skeleton.Children();
  const std::vector<std::string> names = JointNamesForFile(skeleton, "");
  for (std::size_t j = 0; j < rest.size(); ++j) {
    tinygltf::Node node;
    node.name = names[j];
    node.children = children[j];
    node.translation = {offsets[j].x(), offsets[j].y(), offsets[j].z()};
    model.nodes.push_back(node);
  }
  AddBody(motion, rest, glb);
  AddAnimation(clip, glb);
  std::ostringstream out;
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, out, false, true))
    return Fail(ErrorCode::kInternal, "the file cannot be written as glTF", clip.id());
  return out.str();
}

}  // namespace

std::unique_ptr<LayoutWriter> MakeGlbLayout(const ExportSet& set) {
  return MakeLabelledFolder(set, {"glb", ".glb", GlbOfClip, nullptr});
}

}  // namespace mocurate
