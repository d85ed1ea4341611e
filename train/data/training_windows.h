#pragma once

#include "core/store/store.h"
#include "train/options.h"

namespace mocurate {

/// The clips that a network learns from, cut into windows of its `frames` one after the other, what is left at the end
/// dropped; a shorter clip stays whole, or is left out where the network has one length. They are the training part of
/// the set's one split, as those of the validation part are its validation part; with `test`, those of the test part
/// its test part. Clips of these two without a motion or a label of the set are left out. Errors of SelectTrainingRows.
Expected<Dataset> TrainingWindows(Dataset set, const NetworkOptions& network, bool test);

}  // namespace mocurate
