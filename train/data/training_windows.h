#pragma once

#include "core/store/store.h"
#include "train/options.h"

namespace mocurate {

/// The training clips of a network, cut into consecutive windows of its `frames`; the remainder is dropped. Of a clip
/// with inferred frames the longest stretch without them is cut; one of nothing else is left out. Of these the set's
/// one finding states the number, "inferred_frames". A shorter clip stays whole, or is excluded where the network has a
/// fixed length. They are the training part of the set's one
/// split; clips of the validation part become its validation part, and with `test` those of the test part its test
/// part. Clips of these two without a motion or a label of the set are excluded. Errors of SelectTrainingRows.
Expected<Dataset> TrainingWindows(Dataset set, const NetworkOptions& network, bool test);

}  // namespace mocurate
