#pragma once

#include "train/checkpoint/checkpoint.h"
#include "train/networks/action2motion.h"
#include "train/options.h"

namespace mocurate {

/// Sizes and rules of the network that `options` ask for on a skeleton (protocol switch resolved).
Action2MotionConfig ConfigOf(const GeneratorOptions& options, const Skeleton& skeleton, int classes);
double SelfFeedProbability(const GeneratorOptions& options);

/// The same from a checkpoint. Error kInconsistent when parameters do not fit.
Expected<Action2MotionConfig> ConfigOf(const Checkpoint& checkpoint, const std::string& where);

}  // namespace mocurate
