#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/skin/skin.h"
#include "train/checkpoint/checkpoint.h"
#include "train/data/training_set.h"
#include "train/options.h"

namespace mocurate {

/// How a training meets the outside world. None of it changes the result.
struct TrainingControl {
  std::filesystem::path scratch;     ///< folder for the state of an unfinished training; empty: none is kept
  std::string dataset_sha256;        ///< content of the training data; another content starts anew
  std::filesystem::path start;       ///< a checkpoint of the same training after fewer steps, or empty
  std::shared_ptr<const Skin> skin;  ///< body of the vertex loss, over the set's skeleton; or null
  std::filesystem::path start_from;  ///< weights that a training begins with; or empty
  std::filesystem::path weights;     ///< of a network trained elsewhere: nothing is trained; or empty
  int threads = 1;                   ///< shards that are worked on at once
  std::function<bool()> stop = [] { return false; };  ///< asked between steps
  std::function<void(double, const std::string&)> progress = [](double, const std::string&) {};
  std::function<void(double)> resumed = [](double) {};  ///< gets the seconds of the runs that it goes on from
};

/// Trains one network. Generators take `iterations` steps on the training part. Recognisers take epochs on it less a
/// validation fold; then, with `refit`, as many steps as were chosen on all of it: with `anneal` all, since a rate that
/// is annealed is meant to end, otherwise those of the best validation accuracy (ties: lower loss). Goes on from
/// scratch bit for bit, with any number of threads. Errors: kInterrupted (state is saved); kInconsistent where the loss
/// is not finite (the batch is saved in scratch); kMissingOnHost for a device that is not here; those of
/// SelectTrainingRows.
Expected<Checkpoint> TrainNetwork(const TrainingSet& set, const NetworkOptions& options,
                                  const TrainingControl& control);

/// What training would cost here: seconds a step, as the mean of a few.
struct TrainingCost {
  double seconds_per_step = 0.0;
  std::int64_t steps = 0;
  std::int64_t parameters = 0;
};
Expected<TrainingCost> MeasureCost(const TrainingSet& set, const NetworkOptions& options,
                                   std::shared_ptr<const Skin> skin, int threads);

}  // namespace mocurate
