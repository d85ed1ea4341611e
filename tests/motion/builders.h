#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/motion/clip.h"
#include "core/motion/kinematics.h"
#include "core/motion/skeleton.h"

namespace mocurate::test {

inline SkeletonPtr Built(const std::string& name) {
  const Expected<SkeletonPtr> skeleton = LoadSkeleton(name);
  if (!skeleton) {
    ADD_FAILURE() << skeleton.error().Message();
    std::abort();
  }
  return *skeleton;
}

inline Vector3d RandomVector(Random& random, double size) {
  const double x = random.Normal(), y = random.Normal(), z = random.Normal();
  return size * Vector3d(x, y, z);
}

/// A person whose joints swing about the rest pose, all optional fields filled.
inline Motion SwingingPerson(const SkeletonPtr& skeleton, int frames, FrameRate rate = {30, 1}) {
  Random random(7, "swinging", skeleton->name);
  const int joints = skeleton->joint_count();
  std::vector<Vector3d> axis;
  for (int j = 0; j < joints; ++j) axis.push_back(RandomVector(random, 0.4));
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) {
    const double t = rate.FrameTime(f);
    root.push_back(Vector3d(0.3 * t, 0.9 + 0.02 * std::sin(5 * t), 0.5 * t));
    for (int j = 0; j < joints; ++j) rotation.push_back(ExpQuaternion(std::sin(2.0 * t + j) * axis[j]));
  }
  std::vector<double> bones = skeleton->RestBoneLengths();
  for (std::size_t j = 0; j < bones.size(); ++j) bones[j] *= 1.0 + 0.05 * random.Normal();
  Motion motion = MakeMotion(skeleton, rate, std::move(root), std::move(rotation), std::move(bones));
  for (int cell = 0; cell < frames * joints; ++cell) {
    motion.state.push_back(static_cast<JointState>(cell % 4));
    const Matrix3d a = Matrix3d::NullaryExpr([&] { return 0.01 * random.Normal(); });
    motion.position_cov.resize(motion.position_cov.size() + 6);
    ToSixNumbers(a * a.transpose(), motion.position_cov.data() + motion.position_cov.size() - 6);
    for (int k = 0; k < 3; ++k) motion.rotation_sigma.push_back(static_cast<float>(0.1 * random.Uniform()));
    for (int k = 0; k < 3; ++k) motion.rotation_observed.push_back(static_cast<float>(random.Uniform()));
  }
  for (int f = 0; f < frames; ++f) {
    motion.contact.push_back(f % 2);
    motion.contact.push_back(f % 3 == 0);
  }
  return motion;
}

/// A clip that has something in every field: motion, tracks at the same times, a view with depth and one with
/// keypoints of two people, clouds, two segments.
inline Clip FullClip(const std::string& skeleton_name, int frames, FrameRate rate = {30, 1}) {
  Clip clip;
  clip.identity = {"set", "s01", "take", "day", "front", "CC0", 100, 100 + frames};
  clip.rate = rate;
  clip.motion = SwingingPerson(Built(skeleton_name), frames, rate);
  JointTracks tracks;
  for (const Joint& joint : clip.motion->skeleton->joints) tracks.names.push_back(joint.name);
  tracks.positions = clip.motion->joints;
  tracks.confidence.assign(static_cast<std::size_t>(frames) * tracks.names.size(), 1.0);
  for (int f = 0; f < frames; ++f) {
    for (std::size_t k = 0; k < tracks.names.size(); ++k)
      tracks.rotation.push_back(clip.motion->rotation_at(f, static_cast<int>(k)));
  }
  tracks.rotation_confidence = tracks.confidence;
  DepthView view;
  view.camera = {"left", 640, 480, 525, 524, 319.5, 239.5, {0.1, -0.05, 0.002, -0.003, 0.01}, {}};
  view.camera.camera_from_world = {ExpQuaternion(Vector3d(3.0, 0.2, 0.1)), Vector3d(0.1, 0.9, 3.0)};
  for (int f = 0; f < frames; ++f) {
    tracks.time_s.push_back(rate.FrameTime(f));
    view.time_s.push_back(rate.FrameTime(f));
    view.files.push_back("depth_" + std::to_string(f) + ".png");
    view.sha256.push_back("sha_" + std::to_string(f));
  }
  CloudFiles clouds;
  clouds.time_s = view.time_s;
  clouds.sha256 = view.sha256;
  for (int f = 0; f < frames; ++f) clouds.files.push_back("cloud_" + std::to_string(f) + ".ply");
  clouds.metres_per_unit = 0.001;
  clouds.world_from_file = {ExpQuaternion(Vector3d(-0.4, 0.1, 0.9)), Vector3d(0.3, -0.2, 1.0)};
  clip.evidence.clouds = std::move(clouds);
  KeypointView seen;
  seen.camera = view.camera;
  seen.time_s = view.time_s;
  seen.people = 2;
  clip.evidence.keypoint_names = {"nose", "left_knee", "right_knee"};
  for (int f = 0; f < frames; ++f) {
    for (int cell = 0; cell < 6; ++cell) seen.values.insert(seen.values.end(), {100.0 * cell, 1.0 * f, 0.5});
  }
  clip.evidence.keypoint_views.push_back(std::move(seen));
  clip.evidence.tracks = std::move(tracks);
  clip.evidence.depth_views.push_back(std::move(view));
  const double end = rate.FrameTime(frames);
  clip.segments = {{0.0, end / 2, "walk", "gait", "annotated"}, {end / 4, end, "wave", "", "measured"}};
  clip.canonical_from_source = {ExpQuaternion(Vector3d(0.1, 1.0, 0.2)), Vector3d(1, 2, 3)};
  return clip;
}

inline double LargestDistance(const JointPositions& a, const JointPositions& b) {
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.joints, b.joints);
  double largest = a.xyz.size() == b.xyz.size() ? 0.0 : 1e9;
  for (std::size_t i = 0; i < a.xyz.size() && i < b.xyz.size(); ++i) {
    largest = std::max(largest, std::abs(a.xyz[i] - b.xyz[i]));
  }
  return largest;
}

inline double LargestAngle(const Motion& a, const Motion& b) {
  EXPECT_EQ(a.rotation.size(), b.rotation.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < a.rotation.size() && i < b.rotation.size(); ++i) {
    largest = std::max(largest, AngleBetween(a.rotation[i], b.rotation[i]));
  }
  return largest;
}

}  // namespace mocurate::test
