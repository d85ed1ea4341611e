#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/store/store.h"
#include "train/checkpoint/checkpoint.h"
#include "train/options.h"

namespace mocurate {

/// How a training meets the outside world. None of it changes the result.
struct TrainingControl {
  std::filesystem::path scratch;  ///< folder for the state of an unfinished training; empty: none is kept
  std::string dataset_sha256;     ///< content of the training data; another content starts anew
  std::function<bool()> stop = [] { return false; };  ///< asked between steps
  std::function<void(double, const std::string&)> progress = [](double, const std::string&) {};
};

/// Trains a recogniser: epochs on the training clips less a validation fold, then, with `refit`, once more on all
/// training clips for as many epochs as were chosen: with `anneal` all of them, since a rate that is annealed is meant
/// to end; otherwise those of the best validation accuracy (ties: lower loss). One thread; goes on from scratch bit for
/// bit. Errors: kInterrupted (state is saved), those of SelectTrainingClips.
Expected<Checkpoint> TrainRecogniser(const Dataset& dataset, const RecogniserOptions& options,
                                     const TrainingControl& control);

/// Trains Action2Motion by iterations (a2m_actor.md B.6). As above.
Expected<Checkpoint> TrainGenerator(const Dataset& dataset, const GeneratorOptions& options,
                                    const TrainingControl& control);

/// State of an unfinished training in `scratch`, or nothing when there is none of this kind, options and data.
std::optional<Checkpoint> ResumeFrom(const TrainingControl& control, const std::string& kind,
                                     const nlohmann::json& options);
/// Saves the state; does nothing without scratch.
Status SaveState(const TrainingControl& control, const Checkpoint& checkpoint);

}  // namespace mocurate
