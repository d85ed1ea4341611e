#pragma once

#include "canon/options.h"
#include "core/store/store.h"

namespace mocurate {

/// Assigns every clip to train, validation or test by the stated rule and checks what leaks: persons, styles or
/// recordings in two parts, and clips of equal content. Error kConfig names persons or styles of the options that no
/// clip has.
Expected<Split> MakeSplit(const SplitOptions& options, const Dataset& dataset);

}  // namespace mocurate
