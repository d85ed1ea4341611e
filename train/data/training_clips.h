#pragma once

#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/store/store.h"
#include "train/networks/action2motion.h"
#include "train/options.h"
#include "train/recognisers/gru_recogniser.h"

namespace mocurate {

/// A clip as training sees it; the motion stays in the dataset, which must outlive this.
struct TrainingClip {
  const Clip* clip = nullptr;
  int label = 0;
};

/// Clips of a dataset in the parts of a training. Order is that of the dataset.
struct TrainingClips {
  std::vector<TrainingClip> train;
  std::vector<TrainingClip> validation;  ///< drawn from the training part of the split, never from its test part
  std::string split;                     ///< name, or empty without one
  std::string validation_rule;           ///< in words
};

/// Clips of the training part of `split` (empty: the first split, or all clips); with `all` every clip. With
/// `held_out`, the split's own validation part or else all clips of one training person (chosen by `seed`) or else a
/// fraction `smallest_validation` of the clips becomes the validation part. Errors: kConfig (unknown split),
/// kInconsistent (clip without label or motion, fewer than 2 training clips).
Expected<TrainingClips> SelectTrainingClips(const Dataset& dataset, const std::string& split, bool all, bool held_out,
                                            std::uint64_t seed, double smallest_validation);

/// Positions 0..count-1 in the order of one pass, drawn by Fisher-Yates.
std::vector<int> ShuffledOrder(int count, Random random);

/// Frame-major batch of recogniser inputs of `clips[rows]`. With `augment`, changes are keyed by (seed, clip, pass).
GruRecogniserBatch MakeRecogniserBatch(const RecogniserOptions& options, const std::vector<TrainingClip>& clips,
                                       const std::vector<int>& rows, std::int64_t pass, bool augment);

/// One training batch of Action2Motion: windows (a2m_actor.md A.7), noise and the feeding coin, all keyed by
/// (seed, iteration).
Action2MotionBatch MakeGeneratorBatch(const GeneratorOptions& options, const Action2MotionConfig& config,
                                      double self_feed_probability, const std::vector<TrainingClip>& clips,
                                      const std::vector<int>& rows, std::int64_t iteration);

/// Chains of a skeleton: its own, or derived from the tree when it declares none (first child continues a chain, raw
/// offsets are the directions of the rest pose).
LieChains ChainsOf(const Skeleton& skeleton);

}  // namespace mocurate
