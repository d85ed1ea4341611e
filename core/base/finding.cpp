#include "core/base/finding.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

namespace mocurate {

std::string_view Name(Severity severity) {
  constexpr std::string_view kNames[] = {"info", "warning", "error"};
  return kNames[static_cast<std::size_t>(severity)];
}

namespace {

constexpr std::string_view kActions[] = {"flagged",  "kept",     "dropped", "taken as missing",    "interpolated",
                                         "repaired", "excluded", "refused", "reported by an audit"};

}  // namespace

std::string_view Name(FindingAction action) { return kActions[static_cast<std::size_t>(action)]; }

FindingAction FindingActionFromName(std::string_view name) {
  const auto* const found = std::find(std::begin(kActions), std::end(kActions), name);
  return found == std::end(kActions) ? FindingAction::kFlagged : static_cast<FindingAction>(found - kActions);
}

Finding MakeFinding(std::string code, Severity severity, double value, std::string message, FindingAction action,
                    std::string clip) {
  Finding finding;
  finding.clip = std::move(clip);
  finding.code = std::move(code);
  finding.severity = severity;
  finding.value = value;
  finding.message = std::move(message);
  finding.action = action;
  return finding;
}

Finding FindingOfFrames(std::string code, int begin, int end, double value, std::string message, FindingAction action) {
  Finding finding = MakeFinding(std::move(code), Severity::kWarning, value, std::move(message), action);
  finding.frame_begin = begin;
  finding.frame_end = end;
  return finding;
}

bool operator==(const Finding& a, const Finding& b) {
  const bool same_value = a.value == b.value || (std::isnan(a.value) && std::isnan(b.value));
  return same_value && a.clip == b.clip && a.code == b.code && a.severity == b.severity &&
         a.frame_begin == b.frame_begin && a.frame_end == b.frame_end && a.joint == b.joint && a.limit == b.limit &&
         a.message == b.message && a.action == b.action;
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
          {"action", std::string(Name(finding.action))}};
  if (finding.limit != 0.0) json["limit"] = finding.limit;
  if (!std::isfinite(finding.value)) json["value"] = nullptr;  // JSON has no non-finite numbers
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
  finding.limit = json.value("limit", 0.0);
  json.at("message").get_to(finding.message);
  finding.action = FindingActionFromName(json.at("action").get<std::string>());
}

}  // namespace mocurate
