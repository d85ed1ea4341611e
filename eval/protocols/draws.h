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

/// Indices in [0, size) of one repetition's draw: `count` of them, all where it is 0 or, without replacement, where
/// there are no more. Same seed, purpose and repetition, same draw. [a2m_actor.md D.6]
std::vector<int> DrawPositions(int size, int count, bool replacement, std::uint64_t seed, int repetition,
                               const std::string& purpose);

/// At most `per_label` indices of each label, without replacement, without unlabelled ones (-1); ascending.
/// [multiact.md E]
std::vector<int> DrawPerLabel(const std::vector<int>& labels, int per_label, std::uint64_t seed, int repetition,
                              const std::string& purpose);

/// Requests of a repetition. Labels are uniform over the classes that have clips, or copied from the rows drawn as real
/// motions. Bone lengths come from the first frame of a random real clip of any class. `rows`: the real motions.
/// Length: `frames`, or that of the part of the clip whose label is copied. [a2m_actor.md B.7]
std::vector<MotionRequest> DrawRequests(const Dataset& dataset, const std::vector<int>& rows,
                                        const FeaturesOptions& options, int frames, int repetition);

}  // namespace mocurate
