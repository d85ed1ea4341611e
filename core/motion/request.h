#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/motion/clip.h"

namespace mocurate {

/// An action of a script, after the transition that leads to it.
struct ScriptStep {
  int label = 0;  ///< class index
  int transition_frames = 0;
  int frames = 0;  ///< of the action
};

/// One motion that a protocol wants generated. Any program may answer a list of them with a MotionSet.
struct MotionRequest {
  int label = 0;  ///< class index
  int frames = 60;
  std::uint64_t seed = 0;     ///< of this motion alone: its neighbours in the list change no more than the rounding
  std::uint64_t to_seed = 0;  ///< of another latent; interpolated towards it by `fraction`
  double fraction = 0.0;      ///< 0: none of it; networks with a latent of a whole motion only
  std::vector<double> bone_length;  ///< (J) metres, bone that ends at the joint, 0 for the root; empty: rest lengths
  std::vector<double> first_pose;   ///< (3J) metres, root at the origin, for networks that start from one; or empty
  std::string source_clip;          ///< id of the clip the bone lengths come from, or empty
  std::vector<ScriptStep> script;   ///< actions that follow the first one; one motion answers all
  std::string previous_clip;        ///< id of a motion that takes the place of the first action, or empty
  std::shared_ptr<const Clip> previous;  ///< that motion; the answer begins behind it

  /// Frames of the answer.
  std::int64_t answered_frames() const;
};

void to_json(nlohmann::json& json, const MotionRequest& request);

/// A request file: {"schema": "mocurate-request/1", "requests": [{label, frames, seed, bone_length, first_pose,
/// source_clip, script: [{label, transition_frames, frames}], previous_clip}]}.
Status WriteRequests(const std::vector<MotionRequest>& requests, const std::filesystem::path& path);
/// Error kNotFound, kUnreadable; kMalformed naming the request and the field.
Expected<std::vector<MotionRequest>> ReadRequests(const std::filesystem::path& path);

}  // namespace mocurate
