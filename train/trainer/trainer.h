#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/base/finding.h"
#include "core/skin/skin.h"
#include "train/checkpoint/checkpoint.h"
#include "train/data/training_set.h"
#include "train/options.h"

namespace mocurate {

/// Environment of a training. None of it changes the result.
struct TrainingControl {
  std::filesystem::path scratch;     ///< folder for the state of an unfinished training; empty: none is kept
  std::string dataset_sha256;        ///< content of the training data; another content starts anew
  std::filesystem::path start;       ///< a checkpoint of the same training at an earlier step, or empty
  std::shared_ptr<const Skin> skin;  ///< body of the vertex loss, over the set's skeleton; or null
  std::filesystem::path start_from;  ///< initial weights; or empty
  std::filesystem::path weights;     ///< of a network trained elsewhere, without training; or empty
  int threads = 1;                   ///< shards that are processed at once
  std::function<bool()> stop = [] { return false; };  ///< checked between steps
  std::function<void(double, const std::string&)> progress = [](double, const std::string&) {};
  std::function<void(double)> resumed = [](double) {
  };  ///< called with the seconds of the earlier runs of this training
  std::function<void(Finding)> report = [](Finding) {};  ///< receives findings about the training
};

/// Trains one network. Generators train `iterations` steps on the training part. Recognisers train epochs on it less a
/// validation fold. With `refit` they then train on all of it, for as many steps as chosen: with `anneal` all, because
/// an annealed rate has to reach its end, otherwise those of the best validation accuracy (ties: lower loss). Resumes
/// from scratch bit for bit, with any number of threads. Errors: kInterrupted (state is saved); kInconsistent where the
/// loss is not finite (the batch is saved in scratch); kMissingOnHost for a missing device; those of
/// SelectTrainingRows.
Expected<Checkpoint> TrainNetwork(const TrainingSet& set, const NetworkOptions& options,
                                  const TrainingControl& control);

/// Cost of training on this machine: seconds per step, as the mean of a few.
struct TrainingCost {
  double seconds_per_step = 0.0;
  std::int64_t steps = 0;
  std::int64_t parameters = 0;
};
Expected<TrainingCost> MeasureCost(const TrainingSet& set, const NetworkOptions& options,
                                   std::shared_ptr<const Skin> skin, int threads);

}  // namespace mocurate
