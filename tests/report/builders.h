#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/body/bone_capsules.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"
#include "report/options.h"
#include "report/stages.h"
#include "tests/support/scratch_folder.h"

/// A small run as its stages leave it: three fitted clips of a person, one of them also recorded by a depth camera.
namespace mocurate::test {

inline SkeletonPtr Walker() {
  auto s = std::make_shared<Skeleton>();
  s->name = "walker";
  const auto add = [&s](const char* name, int parent, Vector3d offset, int mirror, double radius) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.rest_offset = offset;
    joint.mirror = mirror;
    joint.radius = radius;
    s->joints.push_back(joint);
  };
  add("pelvis", -1, Vector3d::Zero(), 0, 0.1);
  add("left_hip", 0, {0.1, -0.05, 0}, 2, 0.09);
  add("right_hip", 0, {-0.1, -0.05, 0}, 1, 0.09);
  add("left_knee", 1, {0, -0.4, 0}, 4, 0.07);
  add("right_knee", 2, {0, -0.4, 0}, 3, 0.07);
  add("left_ankle", 3, {0, -0.4, 0}, 6, 0.05);
  add("right_ankle", 4, {0, -0.4, 0}, 5, 0.05);
  add("neck", 0, {0, 0.5, 0}, 7, 0.12);
  add("head", 7, {0, 0.2, 0.02}, 8, 0.1);
  return s;
}

/// Steps on the spot, facing +z.
inline Motion Stepping(const SkeletonPtr& skeleton, int frames) {
  std::vector<Vector3d> root(frames, Vector3d(0.0, 0.95, 3.0));
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      const double swing = 0.6 * std::sin(0.3 * f) * (j == 1 ? 1.0 : j == 2 ? -1.0 : 0.0);
      rotation.push_back(ExpQuaternion(Vector3d(swing, 0.0, 0.0)));
    }
  }
  return MakeMotion(skeleton, FrameRate{30, 1}, std::move(root), std::move(rotation), skeleton->RestBoneLengths());
}

/// Every joint but the pelvis, with noise and some samples missing.
inline JointTracks NoisyTracks(const Motion& motion) {
  JointTracks tracks;
  Random random(7, "noise", "");
  const int points = motion.joint_count() - 1;
  tracks.positions = JointPositions(motion.frame_count(), points);
  for (int k = 0; k < points; ++k) tracks.names.push_back(motion.skeleton->joints[k + 1].name);
  for (int f = 0; f < motion.frame_count(); ++f) {
    tracks.time_s.push_back(motion.rate.FrameTime(f));
    for (int k = 0; k < points; ++k) {
      const Vector3d noise(random.Normal(), random.Normal(), random.Normal());
      tracks.positions.at(f, k) = motion.joints.at(f, k + 1) + 0.02 * noise;
      tracks.confidence.push_back((f + k) % 11 == 0 ? 0.0 : 1.0);
    }
  }
  return tracks;
}

/// Looks from z = 6 m back at the origin, y up in the world.
inline Camera FrontCamera() {
  Camera camera;
  camera.name = "front";
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 110.0;
  camera.cx = 79.5;
  camera.cy = 59.5;
  camera.camera_from_world.rotation = Quaterniond(0.0, 1.0, 0.0, 0.0);  // half a turn about x: y down, z forward
  camera.camera_from_world.translation = Vector3d(0.0, 0.9, 6.0);
  return camera;
}

/// Files and summary of the run; change `run` before asking for the page.
struct SmallRun {
  ScratchFolder folder;
  nlohmann::json run;
  std::vector<StageInput> inputs;

  explicit SmallRun(const std::string& label = "step");
  Expected<std::string> Page(const std::string& output = "index.html");
  StageRequest Request(const std::string& output) const;

 private:
  void AddClip(const std::string& item, const Clip& evidence, const Motion& fitted);
};

/// RunSummary of the program for one clip.
nlohmann::json FittedClip(const std::string& item, const std::string& label, double residual_mm);
nlohmann::json FailedClip(const std::string& item, const std::string& message);

}  // namespace mocurate::test
