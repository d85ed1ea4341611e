#include "core/motion/request.h"

#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"

namespace mocurate {
namespace {

constexpr const char* kSchema = "mocurate-request/1";

constexpr std::int64_t kMostNumber = 1000000;  // of a label or a count of frames

constexpr std::size_t kMostSteps = 10000;  // of a script

/// A whole number in [least, kMostNumber).
bool IsCount(const nlohmann::json& value, std::int64_t least) {
  return value.is_number_integer() && value.get<std::int64_t>() >= least && value.get<std::int64_t>() < kMostNumber;
}

Expected<ScriptStep> ParseStep(const nlohmann::json& json, const std::string& where) {
  ScriptStep step;
  const bool whole = json.is_object() && json.size() == 3 && IsCount(json.value("label", nlohmann::json()), 0) &&
                     IsCount(json.value("transition_frames", nlohmann::json()), 1) &&
                     IsCount(json.value("frames", nlohmann::json()), 1);
  if (!whole) {
    return Fail(ErrorCode::kMalformed, "a step of the script lacks a field or has an invalid one: " + json.dump(),
                where, "give label, transition_frames > 0 and frames > 0");
  }
  step.label = json["label"].get<int>();
  step.transition_frames = json["transition_frames"].get<int>();
  step.frames = json["frames"].get<int>();
  return step;
}

Expected<MotionRequest> ParseRequest(const nlohmann::json& json, const std::string& where) {
  MotionRequest request;
  if (!json.is_object()) return Fail(ErrorCode::kMalformed, "a request is not an object", where);
  for (const auto& [key, value] : json.items()) {
    if (key == "label" && IsCount(value, 0)) {
      request.label = value.get<int>();
    } else if (key == "frames" && IsCount(value, 1)) {
      request.frames = value.get<int>();
    } else if (key == "seed" && value.is_number_unsigned()) {
      request.seed = value.get<std::uint64_t>();
    } else if (key == "to_seed" && value.is_number_unsigned()) {
      request.to_seed = value.get<std::uint64_t>();
    } else if (key == "fraction" && value.is_number() && value.get<double>() >= 0.0 && value.get<double>() <= 1.0) {
      request.fraction = value.get<double>();
    } else if (key == "script" && value.is_array() && value.size() <= kMostSteps) {
      for (const nlohmann::json& item : value) {
        const auto step = ParseStep(item, where);
        if (!step) return Forward(step);
        request.script.push_back(*step);
      }
    } else if (key == "previous_clip" && value.is_string()) {
      request.previous_clip = value.get<std::string>();
    } else if (key == "source_clip" && value.is_string()) {
      request.source_clip = value.get<std::string>();
    } else if (key == "bone_length" && value.is_array()) {
      for (const nlohmann::json& length : value) {
        if (!length.is_number() || length.get<double>() < 0.0) {
          return Fail(ErrorCode::kMalformed, "bone_length holds " + length.dump() + ", not a length in metres", where);
        }
        request.bone_length.push_back(length.get<double>());
      }
    } else if (key == "first_pose" && value.is_array()) {
      for (const nlohmann::json& number : value) {
        if (!number.is_number()) {
          return Fail(ErrorCode::kMalformed, "first_pose holds " + number.dump() + ", not a number in metres", where);
        }
        request.first_pose.push_back(number.get<double>());
      }
    } else {
      return Fail(ErrorCode::kMalformed, "'" + key + "' is unknown or has an invalid value", where,
                  "label, frames > 0, seed >= 0, to_seed >= 0, fraction 0 to 1, bone_length [metres], first_pose "
                  "[metres], source_clip, script [{label, transition_frames, frames}], previous_clip");
    }
  }
  return request;
}

}  // namespace

void to_json(nlohmann::json& json, const MotionRequest& request) {
  json = {{"label", request.label}, {"frames", request.frames}, {"seed", request.seed}};
  if (request.fraction > 0.0) {
    json["to_seed"] = request.to_seed;
    json["fraction"] = request.fraction;
  }
  if (!request.bone_length.empty()) json["bone_length"] = request.bone_length;
  if (!request.first_pose.empty()) json["first_pose"] = request.first_pose;
  if (!request.source_clip.empty()) json["source_clip"] = request.source_clip;
  for (const ScriptStep& step : request.script) {
    json["script"].push_back(
        {{"label", step.label}, {"transition_frames", step.transition_frames}, {"frames", step.frames}});
  }
  if (!request.previous_clip.empty()) json["previous_clip"] = request.previous_clip;
}

std::int64_t MotionRequest::answered_frames() const {
  std::int64_t all = previous_clip.empty() && !previous ? frames : 0;
  for (const ScriptStep& step : script) all += std::int64_t{step.transition_frames} + step.frames;
  return all;
}

Status WriteRequests(const std::vector<MotionRequest>& requests, const std::filesystem::path& path) {
  const nlohmann::json json = {{"schema", kSchema}, {"requests", requests}};
  return WriteFile(path, json.dump() + "\n");
}

Expected<std::vector<MotionRequest>> ReadRequests(const std::filesystem::path& path) {
  const Expected<nlohmann::json> json = ReadJson(path);
  if (!json) return Forward(json);
  const std::string where = DisplayPath(path);
  if (!json->is_object() || json->value("schema", nlohmann::json()) != kSchema || !json->contains("requests") ||
      !json->at("requests").is_array()) {
    return Fail(ErrorCode::kMalformed, std::string("the file is not a request of schema ") + kSchema, where);
  }
  std::vector<MotionRequest> requests;
  for (const nlohmann::json& item : json->at("requests")) {
    Expected<MotionRequest> request = ParseRequest(item, where + ": request " + std::to_string(requests.size()));
    if (!request) return Forward(request);
    requests.push_back(std::move(*request));
  }
  return requests;
}

}  // namespace mocurate
