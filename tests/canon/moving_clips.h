#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/motion/kinematics.h"
#include "core/store/store.h"

namespace mocurate {

inline SkeletonPtr Skeleton15() { return *LoadSkeleton("openni15"); }

/// Stands still, moves from `begin` to `end`, stands still.
inline Clip ClipMoving(const std::string& person, const std::string& label, int frames, int begin, int end,
                       double reach) {
  const SkeletonPtr skeleton = Skeleton15();
  JointPositions joints(frames, skeleton->joint_count());
  for (int f = 0; f < frames; ++f) {
    const double phase = std::clamp(static_cast<double>(f - begin) / (end - begin), 0.0, 1.0);
    Vector3d place = Vector3d::Zero();
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      const int parent = skeleton->joints[j].parent;
      place = skeleton->joints[j].rest_offset;
      if (parent >= 0) place += joints.at(f, parent);
      joints.at(f, j) = place;
    }
    for (int j = 0; j < skeleton->joint_count(); ++j) joints.at(f, j) += Vector3d(0, 0, reach * phase);
  }
  Clip clip;
  clip.identity = {"test", person, label + std::to_string(frames) + "_" + std::to_string(begin), "", "", "", 0, frames};
  clip.label = label;
  clip.rate = FrameRate{30, 1};
  clip.motion = MakeJointsOnly(skeleton, clip.rate, joints);
  return clip;
}

inline Dataset SetOf(std::vector<Clip> clips) {
  Dataset dataset;
  dataset.skeleton = Skeleton15();
  dataset.joints_only = true;
  dataset.clips = std::move(clips);
  dataset.labels = {"a", "b"};
  return dataset;
}

}  // namespace mocurate
