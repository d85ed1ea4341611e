#pragma once

#include <optional>
#include <string>

#include "canon/options.h"
#include "core/store/store.h"

namespace mocurate {

/// What a rule that MakeSplit wrote, or a merge of such rules, keeps apart; empty for other rules.
std::optional<SplitBy> KeptApart(const Split& split);

/// Assigns every clip to train, validation or test by the declared rule, and checks for leaks: persons, styles or
/// recordings in two parts, and clips of equal content. Named groups are assigned as in ResolveGroups, with its
/// findings and errors; the rule reports drawn ones. A split by role of clips without any is an error kConfig, or with
/// `absent: draw` a finding. `contents`, where given, holds a hash of the motion of each clip
/// whose source is unknown, so that its frames need not be in memory.
Expected<Split> MakeSplit(const SplitOptions& options, const Dataset& dataset, std::vector<Finding>& findings,
                          const std::vector<std::string>& contents = {});

}  // namespace mocurate
