#pragma once

#include <cmath>
#include <vector>

#include "core/formats/vibe_pickle.h"
#include "core/motion/kinematics.h"

namespace mocurate {

inline constexpr int kJoints = 24;

/// A person on `smpl24` who moves every joint, in the canonical world.
inline Motion MovingPerson(int frames, int seed) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) {
    root.emplace_back(0.02 * f, 0.9 + 0.01 * seed, -0.03 * f);
    for (int j = 0; j < kJoints; ++j) {
      const double phase = 0.3 * f + 0.7 * j + seed;
      rotation.push_back(ExpQuaternion(0.3 * Vector3d(std::sin(phase), std::cos(1.3 * phase), std::sin(2.1 * phase))));
    }
  }
  return MakeMotion(skeleton, FrameRate{30, 1}, root, rotation, {});
}

/// From the canonical world to a camera frame with y down, and back: 180 degrees about x.
inline const Quaterniond kHalfTurn(0.0, 1.0, 0.0, 0.0);

/// Rotation vectors (F, 72) in the frame of `file_from_world`.
inline std::vector<double> Vectors(const Motion& motion, const Quaterniond& file_from_world) {
  std::vector<double> vectors;
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < kJoints; ++j) {
      const Quaterniond local = motion.rotation[static_cast<std::size_t>(f) * kJoints + j];
      const Vector3d vector = LogQuaternion(j == 0 ? file_from_world * local : local);
      vectors.insert(vectors.end(), {vector.x(), vector.y(), vector.z()});
    }
  }
  return vectors;
}

inline std::vector<double> Places(const Motion& motion, const Quaterniond& file_from_world) {
  std::vector<double> places;
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < kJoints; ++j) {
      const Vector3d at = file_from_world * Vector3d(motion.joints.at(f, j));
      places.insert(places.end(), {at.x(), at.y(), at.z()});
    }
  }
  return places;
}

/// A track of 49 points of SPIN; the position of a point depends on its index.
inline VibeTrack SmplTrack(const Motion& motion, const Quaterniond& file_from_world) {
  VibeTrack track;
  track.id = 1;
  track.frames = static_cast<std::size_t>(motion.frame_count());
  track.joints = 49;
  track.pose = Vectors(motion, file_from_world);
  for (std::size_t f = 0; f < track.frames; ++f) {
    for (int k = 0; k < 49; ++k) {
      const double height = k == 8 ? 0.0 : 0.02 * k - 0.5;
      track.joints3d.insert(track.joints3d.end(), {0.01 * k, height, 0.001 * static_cast<double>(f)});
    }
    track.original_camera.insert(track.original_camera.end(),
                                 {0.7 + 0.01 * static_cast<double>(f), 0.9, 0.1 * static_cast<double>(f), -0.2});
    track.frame_ids.push_back(static_cast<std::int64_t>(f));
  }
  return track;
}

}  // namespace mocurate
