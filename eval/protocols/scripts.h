#pragma once

#include <vector>

#include "core/motion/request.h"
#include "core/store/store.h"
#include "eval/options.h"

namespace mocurate {

/// Requests of a repetition for networks that generate scripts, from samples of two actions (multiact.md A.5).
/// kAfterSample: transition and action of each drawn sample, after its own previous motion. kAfterGenerated: after a
/// generated motion of its previous label and length, where that label is a class, else of one that precedes the action
/// in some sample. kChain: as many chains as samples are drawn. The first action is uniform over the classes of the
/// samples, each further one uniform over the actions that follow it in some sample (else over all). Lengths are the
/// truncated means of the label over all clips. `rows`: the samples. Error kInconsistent for a clip that is not a
/// sample.
/// of the label over all clips. `rows`: the samples. Error kInconsistent for a clip that is no sample.
Expected<std::vector<MotionRequest>> DrawScripts(const Dataset& dataset, const std::vector<int>& rows,
                                                 const FeaturesOptions& options, int repetition);

/// A step of a generated script, from 1: its transition or its action, in the canonical frame of the last frame before
/// it (multiact.md B.1).
Motion StepOfAnswer(const Motion& answer, const MotionRequest& request, int step, ClipPart part);

}  // namespace mocurate
