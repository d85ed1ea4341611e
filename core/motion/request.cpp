#include "core/motion/request.h"

#include <nlohmann/json.hpp>

#include "core/base/file.h"

namespace mocurate {
namespace {

constexpr const char* kSchema = "mocurate-request/1";

Expected<MotionRequest> ParseRequest(const nlohmann::json& json, const std::string& where) {
  MotionRequest request;
  if (!json.is_object()) return Fail(ErrorCode::kMalformed, "a request is no object", where);
  for (const auto& [key, value] : json.items()) {
    const bool whole = value.is_number_integer();
    if (key == "label" && whole && value.get<std::int64_t>() >= 0 && value.get<std::int64_t>() < 1000000) {
      request.label = value.get<int>();
    } else if (key == "frames" && whole && value.get<std::int64_t>() > 0 && value.get<std::int64_t>() < 1000000) {
      request.frames = value.get<int>();
    } else if (key == "seed" && value.is_number_unsigned()) {
      request.seed = value.get<std::uint64_t>();
    } else if (key == "to_seed" && value.is_number_unsigned()) {
      request.to_seed = value.get<std::uint64_t>();
    } else if (key == "fraction" && value.is_number() && value.get<double>() >= 0.0 && value.get<double>() <= 1.0) {
      request.fraction = value.get<double>();
    } else if (key == "source_clip" && value.is_string()) {
      request.source_clip = value.get<std::string>();
    } else if (key == "bone_length" && value.is_array()) {
      for (const nlohmann::json& length : value) {
        if (!length.is_number() || length.get<double>() < 0.0) {
          return Fail(ErrorCode::kMalformed, "bone_length holds " + length.dump() + ", no length in metres", where);
        }
        request.bone_length.push_back(length.get<double>());
      }
    } else if (key == "first_pose" && value.is_array()) {
      for (const nlohmann::json& number : value) {
        if (!number.is_number()) {
          return Fail(ErrorCode::kMalformed, "first_pose holds " + number.dump() + ", no number in metres", where);
        }
        request.first_pose.push_back(number.get<double>());
      }
    } else {
      return Fail(ErrorCode::kMalformed, "'" + key + "' is unknown or has a value that it cannot have", where,
                  "label, frames > 0, seed >= 0, to_seed >= 0, fraction 0 to 1, bone_length [metres], first_pose "
                  "[metres], source_clip");
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
}

Status WriteRequests(const std::vector<MotionRequest>& requests, const std::filesystem::path& path) {
  const nlohmann::json json = {{"schema", kSchema}, {"requests", requests}};
  return WriteFile(path, json.dump() + "\n");
}

Expected<std::vector<MotionRequest>> ReadRequests(const std::filesystem::path& path) {
  const Expected<std::string> text = ReadFile(path);
  if (!text) return Forward(text);
  const std::string where = DisplayPath(path);
  const nlohmann::json json = nlohmann::json::parse(*text, nullptr, false);
  if (!json.is_object() || json.value("schema", nlohmann::json()) != kSchema || !json.contains("requests") ||
      !json["requests"].is_array()) {
    return Fail(ErrorCode::kMalformed, std::string("the file is no request of schema ") + kSchema, where);
  }
  std::vector<MotionRequest> requests;
  for (const nlohmann::json& item : json["requests"]) {
    Expected<MotionRequest> request = ParseRequest(item, where + ": request " + std::to_string(requests.size()));
    if (!request) return Forward(request);
    requests.push_back(std::move(*request));
  }
  return requests;
}

}  // namespace mocurate
