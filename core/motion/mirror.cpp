#include <algorithm>

#include "core/motion/kinematics.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

Vector3d Reflected(const Vector3d& v) { return Vector3d(-v.x(), v.y(), v.z()); }

/// Rotation S R S of the reflection S: x -> -x.
Quaterniond Reflected(const Quaterniond& q) { return Quaterniond(q.w(), q.x(), -q.y(), -q.z()); }

RigidTransform Reflected(const RigidTransform& transform) {
  return RigidTransform{Reflected(transform.rotation), Reflected(transform.translation)};
}

/// Cell (frame, mirror of joint) of `values` (frames*joints*width) receives that of (frame, joint).
template <class T>
void SwapSides(const Skeleton& skeleton, int frames, std::vector<T>& values) {
  if (values.empty()) return;
  const std::size_t joints = skeleton.joints.size();
  const std::size_t width = values.size() / (joints * static_cast<std::size_t>(frames));
  std::vector<T> swapped(values.size());
  for (std::size_t f = 0; f < static_cast<std::size_t>(frames); ++f) {
    for (std::size_t j = 0; j < joints; ++j) {
      const std::size_t from = (f * joints + j) * width;
      const std::size_t to = (f * joints + static_cast<std::size_t>(skeleton.joints[j].mirror)) * width;
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(from), width,
                  swapped.begin() + static_cast<std::ptrdiff_t>(to));
    }
  }
  values = std::move(swapped);
}

void ReflectPositions(JointPositions& positions) {
  for (std::size_t i = 0; i < positions.xyz.size(); i += 3) positions.xyz[i] = -positions.xyz[i];
}

/// Local rotations: G'_m(j) = M G_j S_j^T with the joint's reflection S_j, hence r'_m(j) = S_p r_j S_j^T.
void MirrorRotations(Motion& motion) {
  const Skeleton& skeleton = *motion.skeleton;
  std::vector<Matrix3d> reflections;
  for (int j = 0; j < skeleton.joint_count(); ++j) reflections.push_back(skeleton.Reflection(j));
  const Matrix3d world = Vector3d(-1, 1, 1).asDiagonal();
  std::vector<Quaterniond> rotation = motion.rotation;
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const Joint& joint = skeleton.joints[j];
      const Matrix3d& parent = joint.parent < 0 ? world : reflections[joint.parent];
      const Matrix3d local = parent * motion.rotation_at(f, j).toRotationMatrix() * reflections[j].transpose();
      rotation[static_cast<std::size_t>(f) * skeleton.joints.size() + joint.mirror] = Quaterniond(local).normalized();
    }
  }
  motion.rotation = std::move(rotation);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    MakeSignContinuous(motion.rotation.data() + j, static_cast<std::size_t>(motion.frame_count()),
                       skeleton.joints.size());
  }
}

void MirrorMotion(Motion& motion) {
  const Skeleton& skeleton = *motion.skeleton;
  const int frames = motion.frame_count();
  ReflectPositions(motion.joints);
  SwapSides(skeleton, frames, motion.joints.xyz);
  SwapSides(skeleton, frames, motion.state);
  SwapSides(skeleton, frames, motion.position_cov);
  RotateCovariances(Vector3d(-1, 1, 1).asDiagonal(), motion.position_cov);
  SwapSides(skeleton, frames, motion.rotation_sigma);
  SwapSides(skeleton, frames, motion.rotation_observed);
  SwapSides(skeleton, 1, motion.bone_length);
  for (std::size_t i = 0; i + 1 < motion.contact.size(); i += 2) std::swap(motion.contact[i], motion.contact[i + 1]);
  if (motion.joints_only()) return;
  for (Vector3d& translation : motion.root_translation) translation = Reflected(translation);
  MirrorRotations(motion);
  ComputeJoints(motion);
}

/// "left_hand" <-> "right_hand", "LHip" <-> "RHip", "Hand_L" <-> "Hand_R", "hand left" ...; empty without a side.
std::string OtherSide(const std::string& name, const std::vector<std::string>& names) {
  const std::pair<const char*, const char*> sides[] = {
      {"left", "right"}, {"Left", "Right"}, {"LEFT", "RIGHT"}, {"L", "R"}, {"l", "r"}};
  const auto known = [&](const std::string& other) {
    return std::find(names.begin(), names.end(), other) != names.end();
  };
  for (const auto& side : sides) {
    for (const auto& [from, to] : {side, std::pair<const char*, const char*>(side.second, side.first)}) {
      const std::string word = from;
      for (std::size_t at = name.find(word); at != std::string::npos; at = name.find(word, at + 1)) {
        std::string other = name.substr(0, at) + to + name.substr(at + word.size());
        if (known(other)) return other;
      }
    }
  }
  return {};
}

void SwapNames(std::vector<std::string>& names) {
  std::vector<std::string> renamed = names;
  for (std::string& name : renamed) {
    if (const std::string other = OtherSide(name, names); !other.empty()) name = other;
  }
  names = std::move(renamed);
}

void MirrorTracks(JointTracks& tracks) {
  ReflectPositions(tracks.positions);
  for (Quaterniond& rotation : tracks.rotation) rotation = Reflected(rotation);
  SwapNames(tracks.names);
}

/// The picture is not flipped: with the world and the camera's frame mirrored in x alike, its pixel x runs to the left,
/// which a negative fx and the tangential terms express exactly.
void MirrorCamera(Camera& camera) {
  camera.camera_from_world = Reflected(camera.camera_from_world);
  camera.fx = -camera.fx;
  camera.distortion.p2 = -camera.distortion.p2;
}

/// A mirror image in x is a point reflection and a rotation by pi about x.
void MirrorClouds(CloudFiles& clouds) {
  clouds.metres_per_unit = -clouds.metres_per_unit;
  clouds.world_from_file.rotation = Quaterniond(0.0, 1.0, 0.0, 0.0) * clouds.world_from_file.rotation;
  clouds.world_from_file.translation.x() *= -1.0;
}

}  // namespace

Clip Mirror(const Clip& clip) {
  Clip mirrored = clip;
  if (mirrored.motion) MirrorMotion(*mirrored.motion);
  if (mirrored.evidence.tracks) MirrorTracks(*mirrored.evidence.tracks);
  for (DepthView& view : mirrored.evidence.depth_views) MirrorCamera(view.camera);
  for (KeypointView& view : mirrored.evidence.keypoint_views) MirrorCamera(view.camera);
  if (mirrored.evidence.clouds) MirrorClouds(*mirrored.evidence.clouds);
  SwapNames(mirrored.evidence.keypoint_names);
  mirrored.canonical_from_source = Reflected(clip.canonical_from_source);
  return mirrored;
}

}  // namespace mocurate
