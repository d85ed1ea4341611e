#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "train/options.h"

namespace mocurate {

/// The networks that a job trains: its group `train`.
struct TrainOptions {
  std::vector<NetworkOptions> networks;
  std::int64_t most_iterations = 0;  ///< of every generator; 0: no bound
  std::int64_t most_epochs = 0;      ///< of every recogniser; 0: no bound

  void Declare(OptionVisitor& v);
  /// Whether a network is trained on the clips before fitting.
  bool NeedsUnfitted() const;
};

/// The data sets for the training items of a job.
struct TrainingInputs {
  StageInput dataset;
  std::optional<StageInput> unfitted;  ///< the same clips before fitting
};

/// Motions that a network of a job generates from its training clips.
struct MadeSet {
  std::string generator;       ///< name of the network
  std::string generator_item;  ///< of its seed: "ACTOR/1"
  RemakeRule rule = RemakeRule::kDenoise;
  std::string item() const;    ///< of the stage `generate`: "ACTOR/1 denoised"
  std::uint64_t seed() const;  ///< the generator's
};

/// One network of a job: one seed, perhaps at an intermediate step.
struct TrainItem {
  ItemSpec spec;
  std::size_t network = 0;      ///< position in TrainOptions::networks
  std::string row;              ///< of a generator in tables: NAME, NAME/SEED where it has several, NAME@STEP
  std::string after;            ///< item whose checkpoint it continues, its input of role "start"; or empty
  std::string from;             ///< item whose weights it starts from, its input of role "start_from"; or empty
  std::optional<MadeSet> made;  ///< replaces the dataset, or is mixed with it as the input "made"
  bool mixed = false;           ///< `made` is mixed with the dataset

  bool IsSample() const { return row.find('@') != std::string::npos; }  ///< of samples_at, on the way to its end
};

/// The items of the stage `train`, generators first because they take longest: item "NAME/SEED", or "NAME/SEED@STEP"
/// for a network kept at that step, be it of `samples_at` or `until`: both are one training. Networks on unfitted clips
/// only where `inputs` has them.
std::vector<TrainItem> TrainItems(const TrainOptions& options, const TrainingInputs& inputs);

/// The item of a network's last step: "NAME/SEED", or "NAME/SEED@STEP" where `until` ends it before its iterations.
std::string EndItem(const NetworkOptions& network, std::uint64_t seed);

/// SEED of the item "NAME/SEED" or "NAME/SEED@STEP".
std::string SeedOfItem(const std::string& item);

/// Name of the file of an item: "Ours w/o Lie/1" -> "Ours w_o Lie_1".
std::string FileNameOf(std::string item);

/// Limits iterations and epochs, and removes samples beyond the limits.
void BoundTraining(TrainOptions& options);

/// Error kConfig for seeds that are not whole or repeated, for names that are repeated or not valid file names, and for
/// steps of `samples_at` that do not rise. `first_split`: the set's default for an empty `split`.
Status CheckNetworks(const TrainOptions& options, const std::string& first_split = {});

/// Whether the sizes of a network are consistent. Error kConfig.
Status CheckSizes(const NetworkOptions& network, const std::string& where);

/// Multiplies the generators' iterations by `budget`. Error kUsage when a product is more than the option allows.
Status ScaleTraining(double budget, TrainOptions& options);

/// Notes below a table of results about the training of its networks: sentences. `recogniser`: the network of the
/// features.
std::vector<std::string> TrainingNotes(const TrainOptions& options, const std::string& recogniser);

}  // namespace mocurate
