#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/motion/kinematics.h"
#include "core/store/store.h"

namespace mocurate {

/// A person who walks along and swings every joint, by `angle` (radians), with individual bone lengths.
inline Clip Swinging(const SkeletonPtr& skeleton, ClipIdentity identity, const std::string& label, double phase,
                     double angle = 0.3) {
  const int frames = identity.end_frame - identity.begin_frame;
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  std::vector<double> bones = skeleton->RestBoneLengths();
  for (double& bone : bones) bone *= 1.0 + 0.05 * std::sin(phase);
  for (int f = 0; f < frames; ++f) {
    const double t = 0.2 * f + phase;
    root.emplace_back(0.1 * std::sin(t), 0.95, 0.02 * f);
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      rotation.push_back(ExpQuaternion(angle * Vector3d(std::sin(t + j), std::cos(2 * t - j), std::sin(0.5 * t))));
    }
  }
  for (int j = 0; j < skeleton->joint_count(); ++j) {
    MakeSignContinuous(rotation.data() + j, static_cast<std::size_t>(frames), skeleton->joints.size());
  }
  Clip clip;
  clip.identity = std::move(identity);
  clip.label = label;
  clip.rate = FrameRate{30000, 1001};
  clip.motion = MakeMotion(skeleton, clip.rate, root, rotation, bones);
  return clip;
}

inline ClipIdentity StudioTake(const std::string& person, const std::string& recording, int begin, int end) {
  return {"studio", person, recording, "", "", "CC0", begin, end};
}

/// Two persons; labels and recordings that are not valid file names, two spans of one recording, a fine label,
/// segments.
inline Dataset SwingingSet(const std::string& skeleton_name, double angle = 0.3) {
  Dataset set;
  set.skeleton = *LoadSkeleton(skeleton_name);
  set.labels = {"walk", "exercise/training, hard", "never"};
  set.clips = {Swinging(set.skeleton, StudioTake("anna", "take 1", 0, 30), "walk", 0.0, angle),
               Swinging(set.skeleton, StudioTake("anna", "take: 2", 0, 24), "exercise/training, hard", 1.0, angle),
               Swinging(set.skeleton, StudioTake("bob", "long", 0, 20), "walk", 2.0, angle),
               Swinging(set.skeleton, StudioTake("bob", "long", 40, 71), "walk", 3.0, angle)};
  set.clips[1].fine_label = "push up";
  set.clips[2].segments = {{0.0, 0.25, "step", "walk, step", "annotated"}, {0.25, 0.6, "turn", "", "annotated"}};
  Split by_person{"persons", {0, 1}, {}, {2, 3}, "by person", "ok"};
  Split mixed{"mixed", {0, 2}, {1}, {3}, "by hand", "ok"};
  set.splits = {mixed, by_person};
  return set;
}

}  // namespace mocurate
