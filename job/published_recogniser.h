#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/base/config.h"
#include "job/evaluation.h"

namespace mocurate {

/// The rows' metrics by the published recogniser of a protocol as well, as METRIC_published; an entry of "own_notes"
/// where its weights are not at hand or it cannot read the motions. Nothing for an empty name.
Status AddPublishedRecogniser(const std::string& protocol_name, const ConfigRules& rules, Evaluation evaluation,
                              StageRuns& runs, nlohmann::json& metrics);

}  // namespace mocurate
