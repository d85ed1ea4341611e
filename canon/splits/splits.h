#pragma once

#include "canon/options.h"
#include "core/store/store.h"

namespace mocurate {

/// Assigns every clip to train, validation or test by the stated rule and checks what leaks: persons, styles or
/// recordings in two parts, and clips of equal content. A name of the options that no clip has is a finding. When no
/// clip would test, or none would train, groups are drawn instead (options.absent) and the rule and a finding say so.
/// Error kConfig with `absent: refuse`: a name that no clip has; it lists those that the set has.
Expected<Split> MakeSplit(const SplitOptions& options, const Dataset& dataset, std::vector<Finding>& findings);

}  // namespace mocurate
