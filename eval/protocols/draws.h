#pragma once

#include <vector>

#include "core/motion/request.h"
#include "core/store/store.h"
#include "eval/options.h"

namespace mocurate {

/// The real motions of a table: rows of the dataset that take part, with their class. Clips without a label are left
/// out.
struct RealSet {
  std::vector<int> rows;    ///< into Dataset::clips
  std::vector<int> labels;  ///< class index of each
};

/// Error kInconsistent if a class of the dataset has no clip in the chosen part (metrics would be undefined).
/// `split` empty: the first one. Error kConfig for a split the dataset does not have.
Expected<RealSet> ChooseReal(const Dataset& dataset, RealPart part, const std::string& split = {});

/// The split of that name, the first one for an empty name; null in a dataset without splits. Error kConfig.
Expected<const Split*> ChooseSplit(const Dataset& dataset, const std::string& name);

/// Positions in `real` of one repetition's draw: `count` with replacement, natural label frequencies. [a2m_actor.md
/// D.6]
std::vector<int> DrawReal(const RealSet& real, int count, std::uint64_t seed, int repetition, const char* purpose);

/// What a repetition wants generated: labels uniform over classes or copied from the drawn real motions; bone lengths
/// of the first frame of a real clip drawn for each motion, of any class. [a2m_actor.md B.7]
std::vector<MotionRequest> DrawRequests(const Dataset& dataset, const RealSet& real, const std::vector<int>& drawn_real,
                                        const EvaluateOptions& options, int frames, int repetition);

}  // namespace mocurate
