#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ingest/sense/measure.h"

namespace mocurate {

/// Appends what core/quality finds wrong in the positions of a clip. `units` and `up` as told or measured; where one is
/// not known, only what needs neither is asked. A frame rate that nobody says is taken as 30 Hz for speeds.
void ReportChecks(const ObservedClip& clip, const std::string& units, const std::string& up, const std::string& where,
                  nlohmann::json& findings);

}  // namespace mocurate
