#pragma once

#include <vector>

#include "core/motion/request.h"
#include "core/store/store.h"
#include "eval/options.h"

namespace mocurate {

/// The split of that name, the first one for an empty name; null in a dataset without splits. Error kConfig.
Expected<const Split*> ChooseSplit(const Dataset& dataset, const std::string& name);

/// Rows of a part of a split; without a split all. Training clips include the validation part. Errors of ChooseSplit;
/// kInconsistent for a part without clips.
Expected<std::vector<int>> RowsOfPart(const Dataset& dataset, RealPart part, const std::string& split = {});

/// The training part of a split, without its validation part; all rows without one. Errors of ChooseSplit.
Expected<std::vector<int>> TrainingRows(const Dataset& dataset, const std::string& split = {});

/// Indices in [0, size) of one repetition's draw: `count` of them, all where it is 0 or, without replacement, where
/// there are no more. Same seed, purpose and repetition, same draw. [a2m_actor.md D.6]
std::vector<int> DrawPositions(int size, int count, bool replacement, std::uint64_t seed, int repetition,
                               const std::string& purpose);

/// At most `per_label` indices of each label, without replacement, without unlabelled ones (-1); ascending.
/// [multiact.md E]
std::vector<int> DrawPerLabel(const std::vector<int>& labels, int per_label, std::uint64_t seed, int repetition,
                              const std::string& purpose);

/// Requests of a repetition. Labels are uniform over the classes that have clips, or copied from the rows drawn as real
/// motions. Bone lengths come from the first frame of a random training clip of any class, first poses from one of the
/// label, so that no scored motion is given away. `rows`: the real motions; `training`: those that networks learned
/// from. Length: `frames`, or that of the part of the clip whose label is copied. As many as drawn real motions without
/// replacement, else `options.motions`. [a2m_actor.md B.7, D.6]
std::vector<MotionRequest> DrawRequests(const Dataset& dataset, const std::vector<int>& rows,
                                        const std::vector<int>& training, const FeaturesOptions& options, int frames,
                                        int repetition);

/// Requests of a repetition for networks that generate scripts, from samples of two actions (multiact.md A.5).
/// kAfterSample: transition and action of each drawn sample, after its own previous motion. kAfterGenerated: after a
/// generated motion of its previous label and length, where that label is a class, else of one that precedes the action
/// in some sample. kChain: as many chains as samples are drawn, of `steps` actions. The first one is uniform over the
/// classes of the samples, each further one uniform over the actions that follow it in some sample (else over all).
/// Lengths are the truncated means of the label over all clips. `rows`: the samples; bones of motions that continue
/// none are those of a clip of `training`. Error kInconsistent for a clip that is not a sample.
Expected<std::vector<MotionRequest>> DrawScripts(const Dataset& dataset, const std::vector<int>& rows,
                                                 const std::vector<int>& training, const FeaturesOptions& options,
                                                 int repetition);

/// A step of a generated script, from 1: its transition or its action, in the canonical frame of the last frame before
/// it (multiact.md B.1). 0: the generated action before the script, as it is.
Motion StepOfAnswer(const Motion& answer, const MotionRequest& request, int step, ClipPart part);

}  // namespace mocurate
