#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

enum class Severity { kInfo, kWarning, kError };

std::string_view Name(Severity severity);

/// Something wrong or doubtful about a clip. `value` is the measured number that `message` explains; `action` says what
/// was done about it ("kept", "dropped", "flagged", "interpolated"). Frames are [frame_begin, frame_end) of the clip;
/// an empty span (0, 0) means the whole clip. `joint` is empty when no single joint is meant.
struct Finding {
  std::string clip;
  std::string code;  ///< stable text, e.g. "handedness_contradiction"
  Severity severity = Severity::kWarning;
  int frame_begin = 0;
  int frame_end = 0;
  std::string joint;
  double value = 0.0;
  std::string message;
  std::string action;
};

bool operator==(const Finding& a, const Finding& b);

void to_json(nlohmann::json& json, const Finding& finding);
void from_json(const nlohmann::json& json, Finding& finding);

}  // namespace mocurate
