#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/store/store.h"
#include "eval/options.h"
#include "eval/protocols/draws.h"
#include "eval/stages.h"
#include "train/recognisers/recogniser.h"

namespace mocurate {

/// All repetitions of a table: {"Real": {"fid": [...], "accuracy": [...], "diversity": [...], "multimodality": [...]},
/// NAME:
/// ...}, one value per repetition. In each repetition one draw of real motions is the reference, a second one the row
/// Real, and every generator answers the same requests. [a2m_actor.md D] Errors: a generator that answers another
/// number of motions than it was asked for, those of the generators, of the recogniser and of the metrics; kInterrupted
/// between two repetitions.
Expected<nlohmann::json> EvaluateTable(const EvaluateOptions& options, const Dataset& dataset,
                                       const Recogniser& recogniser, const RealSet& real,
                                       const std::map<std::string, AnswerRequests>& generators);

}  // namespace mocurate
