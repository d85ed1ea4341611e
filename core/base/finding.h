#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace mocurate {

enum class Severity { kInfo, kWarning, kError };

std::string_view Name(Severity severity);

/// What was done about a finding. Its text, Name(action), is stored in JSON and in datasets.
enum class FindingAction {
  kFlagged,       ///< nothing: it is reported
  kKept,          ///< the data are used unchanged
  kDropped,       ///< frames are lost, or a clip is refused, because of it
  kMissing,       ///< samples are set to missing
  kInterpolated,  ///< samples come from neighbouring frames
  kRepaired,      ///< samples or labels were changed
  kExcluded,      ///< a file, a camera, a person or a label is not used
  kRefused,       ///< the clip is refused
  kAudited,       ///< reported by `mocurate audit`, which replaces its earlier findings
};

std::string_view Name(FindingAction action);
/// Inverse of Name; kFlagged for another text.
FindingAction FindingActionFromName(std::string_view name);

/// Something wrong or suspect about a clip. `value` is the measured number that `message` explains. Frames are
/// [frame_begin, frame_end) of the clip; an empty span (0, 0) means the whole clip. `joint` is empty when it is not
/// about a single joint.
struct Finding {
  std::string clip;
  std::string code;  ///< stable text, e.g. "handedness_contradiction"
  Severity severity = Severity::kWarning;
  int frame_begin = 0;
  int frame_end = 0;
  std::string joint;
  double value = 0.0;
  double limit = 0.0;  ///< that `value` crossed; 0: none
  std::string message;
  FindingAction action = FindingAction::kFlagged;
};

/// One about a whole file or clip.
Finding MakeFinding(std::string code, Severity severity, double value, std::string message,
                    FindingAction action = FindingAction::kFlagged, std::string clip = "");

/// A warning about frames [begin, end).
Finding FindingOfFrames(std::string code, int begin, int end, double value, std::string message, FindingAction action);

bool operator==(const Finding& a, const Finding& b);

void to_json(nlohmann::json& json, const Finding& finding);
void from_json(const nlohmann::json& json, Finding& finding);

}  // namespace mocurate
