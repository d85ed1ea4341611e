#pragma once

#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "train/options.h"

namespace mocurate {

/// Which networks a job trains: its group `train`.
struct TrainOptions {
  RecogniserOptions recogniser;
  std::vector<double> seeds{1, 2, 3};  ///< one recogniser each; the first gives the features of the metrics
  bool baseline = false;               ///< the same recogniser on unfitted tracks
  bool crop = false;                   ///< the same recogniser on the papers' window of consecutive frames
  bool generator_enabled = true;
  GeneratorOptions generator;

  void Declare(OptionVisitor& v);
};

enum class NetworkKind { kRecogniser, kAction2Motion };

/// Options of one item of the stage `train`: which network it is, and the options of that network alone, so that an
/// item's key does not move with options of another.
struct NetworkOptions {
  NetworkKind network = NetworkKind::kRecogniser;
  RecogniserOptions recogniser;  ///< with kRecogniser
  GeneratorOptions generator;    ///< with kAction2Motion

  void Declare(OptionVisitor& v);
};

/// The data sets that the items of a job train on.
struct TrainingInputs {
  StageInput dataset;
  std::optional<StageInput> baseline;  ///< the same clips before fitting
};

/// One network of a job, and what it is to the stages after it.
struct TrainItem {
  ItemSpec spec;     ///< item "recogniser/SEED", "baseline_recogniser/SEED", "crop_recogniser/SEED" or "Action2Motion"
  std::string role;  ///< of its checkpoint: "recogniser", "baseline_recogniser", "crop_recogniser" or "generator"
};

/// The items of the stage `train`, the one that takes longest (the generator) first. Seeds are decided here: one
/// recogniser per number of `seeds`, whatever `recogniser.seed` says.
std::vector<TrainItem> TrainItems(const TrainOptions& options, const TrainingInputs& inputs);

/// A recogniser is named after its seed: error kConfig for a seed that is not whole or stands twice in `seeds`.
Status CheckSeeds(const TrainOptions& options);

/// Multiplies the generator's iterations by `budget`. Error kUsage when the product is more than the option allows.
Status ScaleTraining(double budget, TrainOptions& options);

/// What stands below a table of results about how its networks were trained: sentences.
std::vector<std::string> TrainingNotes(const TrainOptions& options);

}  // namespace mocurate
