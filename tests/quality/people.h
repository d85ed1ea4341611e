#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/random.h"
#include "core/quality/tracked_points.h"

namespace mocurate::test {

/// A take of one person: 20 joints of the Kinect v1, metres, y up.
struct Take {
  JointPositions positions;
  std::vector<double> confidence;
  std::vector<double> time_s;
  std::vector<std::string> names;
  std::vector<int> parents;
  std::vector<double> rest_lengths;

  TrackedPoints view() const { return {positions, confidence, time_s, names, parents, rest_lengths, Body()}; }
  BodyLandmarks Body() const {
    return FindHandednessPoints([&](std::string_view name) -> std::optional<int> {
      const int joint = Joint(std::string(name));
      return joint < 0 ? std::nullopt : std::optional<int>(joint);
    });
  }
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
  double hop_s = 0.0;    ///< of each flight of a hopping person; 0: stays on the floor
};

/// A person who walks (or hops on the spot) and swings arms and legs with a style given by `seed`.
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

/// A person who walks as an inverted pendulum: over each foot in turn the centre of mass keeps to x'' = g x / h,
/// for `step` metres to either side. Arms hang.
inline Take WalkAsAPendulum(double rate_hz, double seconds, double step = 0.28, double noise = 0.001) {
  TakeOptions options;
  options.frames = static_cast<int>(seconds * rate_hz);
  options.rate_hz = rate_hz;
  options.walk = 0.0;
  options.noise = 0.0;
  Take take = Perform(1, options);
  const double height = 1.0, omega = std::sqrt(9.81 / height), stance_s = 0.55;
  const double scale = step / std::sinh(0.5 * omega * stance_s);
  Random random(5, "pendulum", "");
  const auto put = [&](int f, const char* name, const Vector3d& place) {
    take.positions.at(f, take.Joint(name)) = place;
  };
  for (int f = 0; f < options.frames; ++f) {
    const double t = f / rate_hz;
    const int number = static_cast<int>(t / stance_s);
    const double in_step = t - number * stance_s;
    const double stand_z = 2.0 * step * number;
    const double z = stand_z + scale * std::sinh(omega * (in_step - 0.5 * stance_s));
    const double swing = 0.5 - 0.5 * std::cos(M_PI * in_step / stance_s);
    for (int side = 0; side < 2; ++side) {
      const bool stands = number % 2 == side;
      const double x = side == 0 ? 0.02 : -0.02;
      const double foot_z = stands ? stand_z : stand_z - 2.0 * step + 4.0 * step * swing;
      const double lift = stands ? 0.0 : 0.1 * std::sin(M_PI * in_step / stance_s);
      const std::string s = side == 0 ? "left_" : "right_";
      put(f, (s + "hip").c_str(), {5.0 * x, 0.9, z});
      put(f, (s + "knee").c_str(), {x, 0.5 + 0.5 * lift, z});
      put(f, (s + "ankle").c_str(), {x, 0.08 + lift, foot_z - 0.06});
      put(f, (s + "foot").c_str(), {x, 0.03 + lift, foot_z + 0.06});
      put(f, (s + "shoulder").c_str(), {8.0 * x, 1.4, z});
      put(f, (s + "elbow").c_str(), {9.0 * x, 1.15, z});
      put(f, (s + "wrist").c_str(), {10.0 * x, 0.9, z});
      put(f, (s + "hand").c_str(), {10.0 * x, 0.82, z});
    }
    put(f, "hip_center", {0, 0.9, z});
    put(f, "spine", {0, 1.1, z});
    put(f, "shoulder_center", {0, 1.42, z});
    put(f, "head", {0, 1.6, z});
    for (int k = 0; k < take.positions.joints; ++k) {
      for (int axis = 0; axis < 3; ++axis) take.positions.at(f, k)[axis] += noise * random.Normal();
    }
  }
  return take;
}

/// Exchanges left and right in [begin, end).
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
