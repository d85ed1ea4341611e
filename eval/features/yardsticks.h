#pragma once

#include "core/store/store.h"
#include "eval/options.h"
#include "eval/stages.h"

namespace mocurate {

/// Answers requests as a yardstick does, from the training part of the set: a clip of the label, drawn by the request's
/// seed; a clip of any label; or the label's mean pose for the requested frames: means of joints about the root and of
/// the root's height, chordal means of rotations. Of samples of two actions the part alone. `set` must outlive the
/// answers. Error kInconsistent where a label has no training clip, and those of TrainingRows.
Expected<AnswerRequests> AnswersOf(Yardstick yardstick, const Dataset& set, const FeaturesOptions& options);

}  // namespace mocurate
