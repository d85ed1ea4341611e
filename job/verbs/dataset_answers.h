#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/store/store.h"
#include "job/verbs/verbs.h"

namespace mocurate {

/// Reports a dataset that a verb wrote: warnings on stderr; then `text`, or with --json {"clips", "frames", "labels",
/// "splits": [{name, train, validation, test, leak_check}], "findings", and the fields of `more`}.
void AnswerWithDataset(CommonArguments& common, const Dataset& dataset, const std::vector<Finding>& findings,
                       const std::string& text, const nlohmann::json& more);

}  // namespace mocurate
