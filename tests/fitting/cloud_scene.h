#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/formats/depth_sequence.h"
#include "core/motion/clip.h"
#include "core/motion/kinematics.h"
#include "tests/support/depth_files.h"
#include "tests/support/render_depth.h"

namespace mocurate {

/// A camera three metres from the y axis, 1 m high, that looks at it; `angle` about y, 0 stands at +z.
inline Camera CameraAround(double angle, const std::string& name) {
  Camera camera;
  camera.name = name;
  camera.width = 320, camera.height = 300;
  camera.fx = camera.fy = 300.0;
  camera.cx = 159.5, camera.cy = 149.5;
  const Vector3d centre(3.0 * std::sin(angle), 0.0, 3.0 * std::cos(angle));
  Matrix3d camera_from_world;
  camera_from_world.row(2) = -centre.normalized().transpose();
  camera_from_world.row(1) = -Vector3d::UnitY().transpose();
  camera_from_world.row(0) = camera_from_world.row(1).cross(camera_from_world.row(2));
  camera.camera_from_world.rotation = Quaterniond(camera_from_world);
  camera.camera_from_world.translation = -(camera.camera_from_world.rotation * centre);
  return camera;
}

/// smpl24's joints under other names: a body of plain bone capsules, as core/body draws it.
inline SkeletonPtr PlainSkeleton() {
  const Expected<SkeletonPtr> smpl = LoadSkeleton("smpl24");
  if (!smpl) return nullptr;
  auto plain = std::make_shared<Skeleton>(**smpl);
  plain->name = "plain";
  for (Joint& joint : plain->joints) joint.name = "plain_" + joint.name;
  return plain;
}

/// A person `scale` times as large as the rest skeleton, standing still with arms held apart.
inline Motion StandingStill(const SkeletonPtr& skeleton, double scale, const FrameRate& rate, int frames) {
  std::vector<double> bones = skeleton->RestBoneLengths();
  for (double& bone : bones) bone *= scale;
  std::vector<Quaterniond> pose(skeleton->joints.size(), Quaterniond::Identity());
  pose[*skeleton->FindJoint("left_shoulder")] = ExpQuaternion({0.0, 0.0, -0.9});
  pose[*skeleton->FindJoint("right_shoulder")] = ExpQuaternion({0.0, 0.0, 0.7});
  std::vector<Quaterniond> rotations;
  for (int f = 0; f < frames; ++f) rotations.insert(rotations.end(), pose.begin(), pose.end());
  return MakeMotion(skeleton, rate, std::vector<Vector3d>(frames, {0.1, 0.05, -0.05}), rotations, bones);
}

/// Draws a motion through three cameras into 16-bit PNG files in millimetres, in `folder`.
inline Expected<Clip> RenderClip(const Motion& motion, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  Clip clip;
  clip.rate = motion.rate;
  const BoneCapsules body = BoneCapsules::Make(motion.skeleton);
  for (int v = 0; v < 3; ++v) {
    DepthView view;
    view.camera = CameraAround(2.1 * v + 0.3, "c" + std::to_string(v));
    for (int f = 0; f < motion.frame_count(); ++f) {
      std::vector<Vector3d> joints;
      for (int j = 0; j < motion.joint_count(); ++j) joints.emplace_back(motion.joints.at(f, j));
      DepthImage image{view.camera.width, view.camera.height, {}};
      for (const float depth : RenderDepth(body, joints.data(), view.camera)) {
        image.values.push_back(static_cast<std::uint16_t>(std::lround(1000.0 * depth)));
      }
      view.files.push_back(folder / (view.camera.name + "_" + std::to_string(f) + ".png"));
      view.time_s.push_back(clip.rate.FrameTime(f));
      if (Status written = WriteDepthImage(image, view.files.back()); !written) return Forward(written);
    }
    clip.evidence.depth_views.push_back(view);
  }
  return clip;
}

/// The rendered sequence with its truth, both in the canonical world.
struct RenderedSequence {
  Clip clip;
  JointPositions truth;
};

inline Expected<RenderedSequence> ReadRenderedSequence(const std::filesystem::path& folder, int frames) {
  const Expected<std::string> bytes = ReadFile(folder / "seq_male.json");
  if (!bytes) return Forward(bytes);
  const auto sequence = ParseDepthSequence(*bytes, "seq_male.json");
  if (!sequence) return Forward(sequence);
  const auto truth = ParseDepthSequenceTruth(*bytes, "seq_male.json");
  if (!truth) return Forward(truth);
  const Matrix3d world_from_rig = Vector3d(1.0, -1.0, -1.0).asDiagonal();
  RenderedSequence read;
  read.clip.rate = FrameRate::FromHz(sequence->fps);
  for (const DepthSequenceView& given : sequence->views) {
    DepthView view;
    view.camera = {given.name, given.width, given.height, given.fx, given.fy, given.cx, given.cy, {}, {}};
    view.camera.camera_from_world =
        given.camera_from_rig * RigidTransform{Quaterniond(world_from_rig), Vector3d::Zero()};
    for (int f = 0; f < frames; ++f) {
      const std::string number = std::to_string(f);
      view.files.push_back(folder / "depth" /
                           (given.name + "_" + std::string(4 - number.size(), '0') + number + ".png"));
      view.time_s.push_back(read.clip.rate.FrameTime(f));
    }
    read.clip.evidence.depth_views.push_back(view);
  }
  read.truth = JointPositions(frames, truth->joints);
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < truth->joints; ++j) read.truth.at(f, j) = world_from_rig * truth->joint[f * truth->joints + j];
  }
  return read;
}

/// Mean distance between joints of a motion and the truth, metres.
inline double MeanJointError(const JointPositions& fitted, const JointPositions& truth) {
  double sum = 0.0;
  for (int f = 0; f < truth.frames; ++f) {
    for (int j = 0; j < truth.joints; ++j) sum += (fitted.at(f, j) - truth.at(f, j)).norm();
  }
  return sum / (truth.frames * truth.joints);
}

}  // namespace mocurate
