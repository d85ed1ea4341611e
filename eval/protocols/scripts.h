#pragma once

#include <vector>

#include "core/motion/request.h"
#include "core/store/store.h"
#include "eval/options.h"

namespace mocurate {

/// What a repetition asks of networks that answer scripts, of samples of two actions (multiact.md A.5). kAfterSample:
/// transition and action of each drawn sample, after its own previous motion; kAfterGenerated: after a generated motion
/// of its previous label and length, where that label is a class, else of one that precedes the action in some sample.
/// kChain: as many chains as samples are drawn; the first action uniform over the classes of the samples, each further
/// one uniform over the actions that follow it in some sample (where none does: over all), lengths the truncated means
/// of the label over all clips. `rows`: the samples. Error kInconsistent for a clip that is no sample.
Expected<std::vector<MotionRequest>> DrawScripts(const Dataset& dataset, const std::vector<int>& rows,
                                                 const FeaturesOptions& options, int repetition);

/// A step of an answer, counted from 1: its transition or its action, in the canonical frame of the last frame before
/// it (multiact.md B.1).
Motion StepOfAnswer(const Motion& answer, const MotionRequest& request, int step, ClipPart part);

}  // namespace mocurate
