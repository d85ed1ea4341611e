#include "core/base/finding.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace mocurate {

std::string_view Name(Severity severity) {
  switch (severity) {
    case Severity::kInfo:
      return "info";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      return "error";
  }
  return "warning";
}

bool operator==(const Finding& a, const Finding& b) {
  const bool same_value = a.value == b.value || (std::isnan(a.value) && std::isnan(b.value));
  return same_value && a.clip == b.clip && a.code == b.code && a.severity == b.severity &&
         a.frame_begin == b.frame_begin && a.frame_end == b.frame_end && a.joint == b.joint && a.message == b.message &&
         a.action == b.action;
}

void to_json(nlohmann::json& json, const Finding& finding) {
  json = {{"clip", finding.clip},
          {"code", finding.code},
          {"severity", std::string(Name(finding.severity))},
          {"frame_begin", finding.frame_begin},
          {"frame_end", finding.frame_end},
          {"joint", finding.joint},
          {"value", finding.value},
          {"message", finding.message},
          {"action", finding.action}};
  if (!std::isfinite(finding.value)) json["value"] = nullptr;  // JSON has no other way to say it
}

void from_json(const nlohmann::json& json, Finding& finding) {
  json.at("clip").get_to(finding.clip);
  json.at("code").get_to(finding.code);
  const std::string severity = json.at("severity").get<std::string>();
  finding.severity = severity == "info" ? Severity::kInfo : severity == "error" ? Severity::kError : Severity::kWarning;
  json.at("frame_begin").get_to(finding.frame_begin);
  json.at("frame_end").get_to(finding.frame_end);
  json.at("joint").get_to(finding.joint);
  const nlohmann::json& value = json.at("value");
  finding.value = value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
  json.at("message").get_to(finding.message);
  json.at("action").get_to(finding.action);
}

}  // namespace mocurate
