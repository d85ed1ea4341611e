#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/formats/camera_files.h"
#include "core/formats/openpose.h"
#include "core/motion/clip.h"
#include "core/motion/kinematics.h"

namespace mocurate {

/// A camera that looks at a point, with an upright image; y is up. 1280 x 960 pixels.
inline Camera LookingAt(const std::string& name, const Vector3d& centre, const Vector3d& at) {
  const Vector3d forward = (at - centre).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitY()).normalized();
  Matrix3d rows;
  rows << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  Camera camera;
  camera.name = name;
  camera.width = 1280;
  camera.height = 960;
  camera.fx = camera.fy = 1150;
  camera.cx = 640;
  camera.cy = 480;
  camera.distortion = {-0.1, 0.03, 0.001, -0.0005, 0.0};
  camera.camera_from_world.rotation = Quaterniond(rows);
  camera.camera_from_world.translation = -(camera.camera_from_world.rotation * centre);
  return camera;
}

/// Cameras on a circle of 4 m around (0, 1, 0).
inline std::vector<Camera> Ring(int count) {
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i) {
    const double angle = 6.283185307179586 * (i + 0.3) / count;
    cameras.push_back(LookingAt("cam" + std::to_string(i + 1),
                                {4.0 * std::sin(angle), 1.5 + 0.2 * (i % 3), 4.0 * std::cos(angle)}, {0, 1, 0}));
  }
  return cameras;
}

/// A person of a scale and place who swings arms and legs on the spot. Skeleton smpl24, 30 Hz.
inline Motion Swinging(int frames, double scale = 1.0, const Vector3d& place = Vector3d::Zero()) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  std::vector<double> bones = skeleton->RestBoneLengths();
  for (double& bone : bones) bone *= scale;
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) {
    const double t = f / 30.0;
    root.push_back(place + Vector3d(0.1 * std::sin(2.0 * t), 0.93 * scale, 0.05 * t));
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      const std::string& name = skeleton->joints[j].name;
      Vector3d turn = 0.05 * std::sin(1.5 * t + j) * Vector3d(1, 0.5, 0.3);
      if (name == "left_hip") turn.x() += 0.5 * std::sin(4.0 * t);
      if (name == "right_hip") turn.x() -= 0.5 * std::sin(4.0 * t);
      if (name == "left_knee" || name == "right_knee") turn.x() += 0.4 + 0.3 * std::sin(4.0 * t);
      if (name == "left_shoulder") turn += Vector3d(0, 0, -1.1 + 0.3 * std::sin(4.0 * t));
      if (name == "right_shoulder") turn += Vector3d(0, 0, 1.1 + 0.3 * std::sin(4.0 * t));
      if (name == "left_elbow") turn.y() -= 0.6;
      if (name == "right_elbow") turn.y() += 0.6;
      rotation.push_back(ExpQuaternion(turn));
    }
  }
  return MakeMotion(skeleton, FrameRate{30, 1}, root, rotation, bones);
}

/// Detections of people in every camera, in an order that changes from frame to frame: all joints, with noise.
inline Evidence Detections(const std::vector<Camera>& cameras, const std::vector<Motion>& people, double noise_px,
                           double missing = 0.0) {
  Evidence evidence;
  const Skeleton& skeleton = *people[0].skeleton;
  for (const Joint& joint : skeleton.joints) evidence.keypoint_names.push_back(joint.name);
  const int keypoints = skeleton.joint_count();
  Random random(11, "detections");
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    KeypointView view;
    view.camera = cameras[c];
    view.people = static_cast<int>(people.size());
    for (int f = 0; f < people[0].frame_count(); ++f) {
      view.time_s.push_back(people[0].rate.FrameTime(f));
      for (std::size_t p = 0; p < people.size(); ++p) {
        const Motion& person = people[(p + static_cast<std::size_t>(f) + c) % people.size()];
        for (int k = 0; k < keypoints; ++k) {
          const auto pixel = view.camera.ProjectWorld(person.joints.at(f, k));
          const bool is_detected = pixel && random.Uniform() >= missing;
          const Vector2d error = noise_px * Vector2d(random.Normal(), random.Normal());
          view.values.insert(view.values.end(), {is_detected ? pixel->x() + error.x() : 0.0,
                                                 is_detected ? pixel->y() + error.y() : 0.0, is_detected ? 0.9 : 0.0});
        }
      }
    }
    evidence.keypoint_views.push_back(std::move(view));
  }
  return evidence;
}

/// A trial of the Pose2Sim folder: every person of every image, in the folder's own world (z up).
inline Evidence ReadPose2Sim(const std::filesystem::path& folder, const std::string& trial,
                             const std::string& layout = "BODY_25B") {
  Evidence evidence;
  for (const KeypointLayout& known : KeypointLayouts()) {
    if (known.name == layout) evidence.keypoint_names = known.points;
  }
  const std::size_t keypoints = evidence.keypoint_names.size();
  const auto calibration = ParseCalibration(*ReadFile(folder / "calib_converted.json"), "calib_converted.json");
  for (std::size_t c = 0; c < calibration->views.size(); ++c) {
    KeypointView view;
    view.camera = CameraOf(calibration->views[c], PoseConvention::kWorldToCamera, 1.0);
    std::vector<std::filesystem::path> files;
    const std::string name = "cam0" + std::to_string(c + 1) + "_json";
    for (const auto& entry : std::filesystem::directory_iterator(folder / trial / name)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<OpenPoseFrame> frames;
    for (const auto& file : files) {
      frames.push_back(*ParseOpenPose(*ReadFile(file), file.filename().string()));
      view.people = std::max(view.people, static_cast<int>(frames.back().people.size()));
    }
    for (std::size_t f = 0; f < frames.size(); ++f) {
      view.time_s.push_back(static_cast<double>(f) / 60.0);
      for (std::size_t p = 0; p < static_cast<std::size_t>(view.people); ++p) {
        for (std::size_t k = 0; k < keypoints; ++k) {
          DetectedKeypoint point;
          if (p < frames[f].people.size() && k < frames[f].people[p].pose.size()) point = frames[f].people[p].pose[k];
          view.values.insert(view.values.end(), {point.u_px, point.v_px, point.confidence});
        }
      }
    }
    evidence.keypoint_views.push_back(std::move(view));
  }
  return evidence;
}

/// Mean distance of the triangulated points from a person's joints, metres.
inline double MeanError(const JointTracks& tracks, const Motion& truth) {
  double sum = 0.0;
  int count = 0;
  for (int f = 0; f < tracks.positions.frames; ++f) {
    for (int k = 0; k < tracks.positions.joints; ++k) {
      if (tracks.confidence[static_cast<std::size_t>(f) * tracks.positions.joints + k] <= 0.0) continue;
      sum += (tracks.positions.at(f, k) - truth.joints.at(f, k)).norm();
      ++count;
    }
  }
  return count > 0 ? sum / count : 1e9;
}

}  // namespace mocurate
