#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/quality/tracked_points.h"

namespace mocurate::test {

/// A take of somebody: 20 joints of the Kinect v1, metres, y up.
struct Take {
  JointPositions positions;
  std::vector<double> confidence;
  std::vector<double> time_s;
  std::vector<std::string> names;
  std::vector<int> parents;
  std::vector<double> rest_lengths;

  TrackedPoints view() const { return {positions, confidence, time_s, names, parents, rest_lengths}; }
  int Joint(const std::string& name) const {
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k] == name) return static_cast<int>(k);
    }
    return -1;
  }
};

struct TakeOptions {
  int frames = 90;
  double rate_hz = 30.0;
  double noise = 0.005;  ///< metres, standard deviation of each coordinate
  double stature = 1.0;  ///< of the skeleton's
  double walk = 1.0;     ///< m/s
  double hop_s = 0.0;    ///< of each flight of somebody who hops; 0: stays on the floor
};

/// Somebody who walks (or hops on the spot) and swings arms and legs in a manner of their own. `seed` is the manner.
inline Take Perform(std::uint64_t seed, const TakeOptions& options = {}) {
  Random random(seed, "take", "person");
  Take take;
  struct Bone {
    const char* name;
    int parent;
    Vector3d offset;
  };
  const std::vector<Bone> bones = {{"hip_center", -1, {0, 0, 0}},
                                   {"spine", 0, {0, 0.22, 0}},
                                   {"shoulder_center", 1, {0, 0.25, 0}},
                                   {"head", 2, {0, 0.19, 0.04}},
                                   {"left_shoulder", 2, {0.17, -0.02, 0}},
                                   {"left_elbow", 4, {0, -0.24, 0}},
                                   {"left_wrist", 5, {0, -0.24, 0}},
                                   {"left_hand", 6, {0, -0.08, 0}},
                                   {"right_shoulder", 2, {-0.17, -0.02, 0}},
                                   {"right_elbow", 8, {0, -0.24, 0}},
                                   {"right_wrist", 9, {0, -0.24, 0}},
                                   {"right_hand", 10, {0, -0.08, 0}},
                                   {"left_hip", 0, {0.10, 0, 0}},
                                   {"left_knee", 12, {0, -0.40, 0}},
                                   {"left_ankle", 13, {0, -0.40, 0}},
                                   {"left_foot", 14, {0, -0.05, 0.17}},
                                   {"right_hip", 0, {-0.10, 0, 0}},
                                   {"right_knee", 16, {0, -0.40, 0}},
                                   {"right_ankle", 17, {0, -0.40, 0}},
                                   {"right_foot", 18, {0, -0.05, 0.17}}};
  const double arm = 0.3 + 0.6 * random.Uniform(), leg = 0.2 + 0.3 * random.Uniform();
  const double pace = 5.0 + 2.0 * random.Uniform(), phase = 6.0 * random.Uniform();
  const double raise = 1.5 * random.Uniform();
  take.positions = JointPositions(options.frames, static_cast<int>(bones.size()));
  take.confidence.assign(static_cast<std::size_t>(options.frames) * bones.size(), 1.0);
  for (const Bone& bone : bones) {
    take.names.emplace_back(bone.name);
    take.parents.push_back(bone.parent);
    take.rest_lengths.push_back(bone.offset.norm());
  }
  for (int f = 0; f < options.frames; ++f) {
    const double t = f / options.rate_hz;
    take.time_s.push_back(t);
    const double swing = std::sin(pace * t + phase);
    Vector3d root(0.0, 0.86 * options.stature, options.walk * t);
    if (options.hop_s > 0.0) {
      const double cycle = 2.0 * options.hop_s;
      const double air = std::fmod(t, cycle);
      if (air < options.hop_s) root.y() += 0.5 * 9.81 * air * (options.hop_s - air);
      root.z() = 0.0;
    }
    for (std::size_t k = 0; k < bones.size(); ++k) {
      const std::string name = bones[k].name;
      const double side = name.rfind("left", 0) == 0 ? 1.0 : -1.0;
      double angle = 0.0;
      const bool below_shoulder = k >= 5 && k <= 11 && k != 8, below_hip = k >= 13 && k != 16;
      if (below_shoulder) angle = -raise * (side < 0 ? 1.0 : 0.3) + side * arm * swing;
      if (below_hip && options.hop_s <= 0.0) angle = -side * leg * swing;
      const Vector3d o = options.stature * bones[k].offset;
      const Vector3d turned(o.x(), std::cos(angle) * o.y() - std::sin(angle) * o.z(),
                            std::sin(angle) * o.y() + std::cos(angle) * o.z());
      const Vector3d from = bones[k].parent < 0 ? root : Vector3d(take.positions.at(f, bones[k].parent));
      take.positions.at(f, static_cast<int>(k)) = bones[k].parent < 0 ? root : Vector3d(from + turned);
    }
    if (options.hop_s > 0.0) continue;
    double lowest = 1e9;
    for (std::size_t k = 0; k < bones.size(); ++k)
      lowest = std::min(lowest, Vector3d(take.positions.at(f, static_cast<int>(k))).y());
    for (std::size_t k = 0; k < bones.size(); ++k) take.positions.at(f, static_cast<int>(k)).y() -= lowest;
  }
  for (double& value : take.positions.xyz) value += options.noise * random.Normal();
  return take;
}

/// Left and right change places in [begin, end).
inline void Exchange(Take& take, int begin, int end, bool arms, bool legs) {
  for (int f = begin; f < end; ++f) {
    for (std::size_t k = 0; k < take.names.size(); ++k) {
      if (take.names[k].rfind("left_", 0) != 0) continue;
      const bool leg = k >= 12;
      if (leg ? !legs : !arms) continue;
      const int other = take.Joint("right_" + take.names[k].substr(5));
      const Vector3d left = take.positions.at(f, static_cast<int>(k));
      take.positions.at(f, static_cast<int>(k)) = take.positions.at(f, other).eval();
      take.positions.at(f, other) = left;
    }
  }
}

}  // namespace mocurate::test
