#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/verbs.h"
#include "core/store/store.h"

namespace mocurate {

/// A document as it goes to stdout.
std::string JsonText(const nlohmann::json& document);

/// Reports a dataset that a verb has written: warnings on stderr; then `text`, or with --json {"clips", "frames",
/// "labels", "splits": [{name, train, validation, test, leak_check}], "findings", and the fields of `more`}.
void AnswerWithDataset(CommonArguments& common, const Dataset& dataset, const std::vector<Finding>& findings,
                       const std::string& text, const nlohmann::json& more);

}  // namespace mocurate
