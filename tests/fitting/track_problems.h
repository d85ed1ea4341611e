#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/base/text.h"
#include "core/motion/kinematics.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "tests/support/golden.h"

namespace mocurate {

/// Joint tracks with the truth they were made from.
struct ReferenceProblem {
  SkeletonTracks tracks;
  JointPositions truth;
  std::vector<Quaterniond> rotation;  ///< true, local
  std::vector<double> bone_length;    ///< true
  FrameRate rate;
};

/// Folder of the reference problems: MOCURATE_REFERENCE, or beside the goldens; empty if neither exists.
inline std::filesystem::path ReferenceFolder() {
  if (const char* folder = std::getenv("MOCURATE_REFERENCE")) return folder;
  const char* goldens = std::getenv("MOCURATE_GOLDENS");
  if (goldens == nullptr) return {};
  const std::filesystem::path beside = std::filesystem::path(goldens) / ".." / "reference" / "problems";
  return std::filesystem::exists(beside) ? beside : std::filesystem::path();
}

/// A stored skeleton-fit problem: a solver's input, and the truth separately.
inline ReferenceProblem ReadReferenceProblem(const std::filesystem::path& path) {
  const Golden file(path.string());
  const auto parents = file.Integers("skeleton/parents");
  const auto offsets = file.Doubles("skeleton/offsets");
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = "reference";
  for (std::size_t j = 0; j < parents.values.size(); ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = static_cast<int>(parents[j]);
    joint.mirror = static_cast<int>(j);
    joint.rest_offset = Vector3d(offsets.row(j)[0], offsets.row(j)[1], offsets.row(j)[2]);
    skeleton->joints.push_back(joint);
  }
  ReferenceProblem problem;
  problem.rate = FrameRate{30, 1};
  problem.tracks.skeleton = skeleton;
  const auto observed = file.Doubles("observed/joints");
  const auto frames = static_cast<int>(observed.rows());
  const auto joints = static_cast<int>(parents.values.size());
  problem.tracks.positions = JointPositions(frames, joints);
  problem.tracks.positions.xyz = observed.values;
  problem.tracks.confidence = file.Doubles("observed/confidence").values;
  for (int f = 0; f < frames; ++f) problem.tracks.time_s.push_back(problem.rate.FrameTime(f));
  problem.truth = JointPositions(frames, joints);
  problem.truth.xyz = file.Doubles("truth/joints").values;
  const auto true_offsets = file.Doubles("truth/offsets");
  for (int j = 0; j < joints; ++j) {
    problem.bone_length.push_back(
        Vector3d(true_offsets.row(j)[0], true_offsets.row(j)[1], true_offsets.row(j)[2]).norm());
  }
  return problem;
}

/// Root mean square distance over all frames and joints, metres.
inline double RmsError(const JointPositions& a, const JointPositions& b) {
  double square = 0.0;
  for (std::size_t i = 0; i < a.xyz.size(); ++i) square += (a.xyz[i] - b.xyz[i]) * (a.xyz[i] - b.xyz[i]);
  return std::sqrt(square * 3.0 / static_cast<double>(a.xyz.size()));
}

inline double LargestError(const JointPositions& a, const JointPositions& b) {
  double largest = 0.0;
  for (int f = 0; f < a.frames; ++f) {
    for (int j = 0; j < a.joints; ++j) largest = std::max(largest, (a.at(f, j) - b.at(f, j)).norm());
  }
  return largest;
}

/// KARD's text: 15 lines of x y z per frame, millimetres, left-handed (x to the image right), names as declared.
inline JointTracks ReadKardText(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  for (char& character : text) {
    if (character == '\n' || character == '\r') character = ' ';
  }
  std::vector<double> numbers;
  for (const std::string_view field : SplitBlanks(Trim(text))) numbers.push_back(*ParseDouble(field));
  JointTracks tracks;
  tracks.names = {"head",          "neck",       "right_shoulder", "right_elbow", "right_hand",
                  "left_shoulder", "left_elbow", "left_hand",      "torso",       "right_hip",
                  "right_knee",    "right_foot", "left_hip",       "left_knee",   "left_foot"};
  const auto frames = static_cast<int>(numbers.size() / 45);
  tracks.positions = JointPositions(frames, 15);
  tracks.confidence.assign(static_cast<std::size_t>(frames) * 15, 1.0);
  for (int f = 0; f < frames; ++f) {
    tracks.time_s.push_back(f / 30.0);
    for (int j = 0; j < 15; ++j) {
      const double* p = numbers.data() + 45 * f + 3 * j;
      // Left-handed x right, y up, z away from the sensor: z is negated to point to the sensor.
      tracks.positions.at(f, j) = Vector3d(1e-3 * p[0], 1e-3 * p[1], -1e-3 * p[2]);
    }
  }
  return tracks;
}

}  // namespace mocurate
