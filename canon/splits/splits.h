#pragma once

#include "canon/options.h"
#include "core/store/store.h"

namespace mocurate {

/// Assigns every clip to train, validation or test by the stated rule and checks what leaks: persons, styles or
/// recordings in two parts, and clips of equal content. Who is named for a part plays it or the split is refused; a
/// name that no clip has is a finding. Where nobody of those named for a part is there, others are drawn, of those that
/// are not named, at least one while one is left to train (options.absent), and the rule and a finding say so. Error
/// kConfig as MeetGroups. `contents`, where given, holds a hash of the motion of each clip that does not know what it
/// was made from: frames of such clips need not be in memory then.
Expected<Split> MakeSplit(const SplitOptions& options, const Dataset& dataset, std::vector<Finding>& findings,
                          const std::vector<std::string>& contents = {});

}  // namespace mocurate
