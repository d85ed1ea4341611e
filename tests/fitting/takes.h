#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// A body of 14 joints with a trunk, arms and legs; tracks of all of them.
inline SkeletonPtr TestSkeleton() {
  auto body = std::make_shared<Skeleton>();
  body->name = "test_body";
  const auto add = [&](const char* name, int parent, const Vector3d& offset, int mirror) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.rest_offset = offset;
    joint.mirror = mirror;
    body->joints.push_back(joint);
  };
  add("pelvis", -1, {0, 0, 0}, 0);
  add("chest", 0, {0, 0.4, 0.02}, 1);
  add("head", 1, {0, 0.25, 0}, 2);
  add("left_shoulder", 1, {0.18, 0.08, 0}, 6);
  add("left_elbow", 3, {0.28, 0, 0}, 7);
  add("left_wrist", 4, {0.25, 0, 0}, 8);
  add("right_shoulder", 1, {-0.18, 0.08, 0}, 3);
  add("right_elbow", 6, {-0.28, 0, 0}, 4);
  add("right_wrist", 7, {-0.25, 0, 0}, 5);
  add("left_hip", 0, {0.1, -0.06, 0}, 11);
  add("left_ankle", 9, {0, -0.8, 0}, 12);
  add("right_hip", 0, {-0.1, -0.06, 0}, 9);
  add("right_ankle", 11, {0, -0.8, 0}, 10);
  add("head_top", 2, {0, 0.12, 0}, 13);
  return body;
}

/// A smooth motion as the truth, and tracks that equal it.
struct PlayedTake {
  Motion truth;
  SkeletonTracks tracks;
};

/// Every joint swings; `world_from_root` rotates the whole person.
inline PlayedTake SmoothTake(int frames, const Quaterniond& world_from_root = Quaterniond::Identity(),
                             double rate_hz = 30.0, double turn_speed = 0.4, const SkeletonPtr& body = TestSkeleton()) {
  Random random(3, "take");
  std::vector<Vector3d> translation;
  std::vector<Quaterniond> rotation;
  std::vector<Vector3d> amplitude;
  std::vector<Vector3d> phase;
  for (int j = 0; j < body->joint_count(); ++j) {
    amplitude.emplace_back(0.4 * random.Normal(), 0.4 * random.Normal(), 0.4 * random.Normal());
    phase.emplace_back(random.Uniform(0, 6), random.Uniform(0, 6), random.Uniform(0, 6));
  }
  SkeletonTracks tracks;
  tracks.skeleton = body;
  for (int f = 0; f < frames; ++f) {
    const double t = f / rate_hz;
    tracks.time_s.push_back(t);
    translation.emplace_back(0.5 * t, 1.0 + 0.05 * std::sin(3.0 * t), -2.0 + 0.2 * t);
    for (int j = 0; j < body->joint_count(); ++j) {
      const Vector3d swing = amplitude[j].cwiseProduct((Vector3d::Constant(2.0 * t) + phase[j]).array().sin().matrix());
      rotation.push_back(j == 0 ? world_from_root * ExpQuaternion(Vector3d(0, turn_speed * t, 0)) *
                                      ExpQuaternion(0.3 * swing)
                                : ExpQuaternion(swing));
    }
  }
  PlayedTake take;
  take.truth = MakeMotion(body, FrameRate::FromHz(rate_hz), translation, rotation, body->RestBoneLengths());
  tracks.positions = take.truth.joints;
  tracks.confidence.assign(tracks.positions.xyz.size() / 3, 1.0);
  take.tracks = std::move(tracks);
  return take;
}

inline JointState StateAt(const Motion& motion, int frame, int joint) {
  return motion.state[static_cast<std::size_t>(frame) * motion.joint_count() + static_cast<std::size_t>(joint)];
}

/// Marks a sample as not observed; its position must not be read.
inline void Hide(SkeletonTracks& tracks, int frame, int joint) {
  tracks.confidence[static_cast<std::size_t>(frame) * tracks.joints() + joint] = 0.0;
  tracks.positions.at(frame, joint).setConstant(1e9);
}

inline void AddNoise(SkeletonTracks& tracks, double sigma, std::uint64_t seed) {
  Random random(seed, "noise");
  for (double& value : tracks.positions.xyz) value += sigma * random.Normal();
}

/// Noise of `sigma` times a factor for each axis of each sample, between a third and three, with random axes. The
/// tracks state it as precision.
inline void AddUnevenNoise(SkeletonTracks& tracks, double sigma, std::uint64_t seed) {
  Random random(seed, "uneven");
  const auto normal = [&] { return Vector3d(random.Normal(), random.Normal(), random.Normal()); };
  for (int f = 0; f < tracks.frames(); ++f) {
    for (int j = 0; j < tracks.joints(); ++j) {
      const Matrix3d axes = ExpQuaternion(2.0 * normal()).toRotationMatrix();
      Vector3d scale;
      for (double& value : scale) value = std::pow(3.0, random.Uniform(-1.0, 1.0));
      tracks.positions.at(f, j) += sigma * (axes * scale.cwiseProduct(normal()));
      tracks.precision.emplace_back(axes * scale.cwiseAbs2().cwiseInverse().asDiagonal() * axes.transpose());
    }
  }
}

/// Tracks as a source provides them, under the skeleton's own names.
inline JointTracks AsSource(const SkeletonTracks& tracks) {
  JointTracks source;
  for (const Joint& joint : tracks.skeleton->joints) source.names.push_back(joint.name);
  source.time_s = tracks.time_s;
  source.positions = tracks.positions;
  source.confidence = tracks.confidence;
  return source;
}

}  // namespace mocurate
