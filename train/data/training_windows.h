#pragma once

#include "core/store/store.h"
#include "train/options.h"

namespace mocurate {

/// The clips that a network learns from, cut into windows of its `frames` one after the other, what is left at the end
/// dropped; a shorter clip stays whole. They are the training part of the set's one split; with `test`, the windows of
/// the test part of the network's split are its test part. Errors of SelectTrainingRows.
Expected<Dataset> TrainingWindows(const Dataset& set, const NetworkOptions& network, bool test);

}  // namespace mocurate
