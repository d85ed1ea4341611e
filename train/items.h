#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "train/options.h"

namespace mocurate {

/// Which networks a job trains: its group `train`.
struct TrainOptions {
  std::vector<NetworkOptions> networks;
  std::int64_t most_iterations = 0;  ///< of every generator; 0: no bound
  std::int64_t most_epochs = 0;      ///< of every recogniser; 0: no bound

  void Declare(OptionVisitor& v);
  /// Whether a network is trained on the clips before fitting.
  bool NeedsUnfitted() const;
};

/// The data sets that the items of a job train on.
struct TrainingInputs {
  StageInput dataset;
  std::optional<StageInput> unfitted;  ///< the same clips before fitting
};

/// Motions that a network of a job makes of the clips it learned from.
struct MadeSet {
  std::string generator;       ///< name of the network
  std::string generator_item;  ///< of its seed: "ACTOR/1"
  RemakeRule rule = RemakeRule::kDenoise;
  std::string item() const;    ///< of the stage `generate`: "ACTOR/1 denoised"
  std::uint64_t seed() const;  ///< the generator's
};

/// One network of a job: a seed of it, perhaps after some of its steps.
struct TrainItem {
  ItemSpec spec;
  std::size_t network = 0;      ///< position in TrainOptions::networks
  std::string row;              ///< of a generator in tables: NAME, NAME/SEED where it has several, NAME@STEP
  std::string after;            ///< item whose checkpoint it goes on from, its input of role "start"; or empty
  std::string from;             ///< item whose weights it begins with, its input of role "start_from"; or empty
  std::optional<MadeSet> made;  ///< what takes the place of the dataset, or is mixed with it as the input "made"
  bool mixed = false;           ///< the dataset stays, `made` is mixed with it
};

/// The items of the stage `train`, generators, which take longest, first: item "NAME/SEED", or "NAME/SEED@STEP" for a
/// network that is kept after so many steps. Networks on unfitted clips only where `inputs` has them.
std::vector<TrainItem> TrainItems(const TrainOptions& options, const TrainingInputs& inputs);

/// Name of the file of an item: "Ours w/o Lie/1" -> "Ours w_o Lie_1".
std::string FileNameOf(std::string item);

/// Lowers iterations and epochs to the bounds, and leaves out samples beyond them.
void BoundTraining(TrainOptions& options);

/// Error kConfig for a seed that is not whole or stands twice, for names that stand twice or are no names of files, and
/// for steps of `samples_at` that do not rise.
/// `first_split`: of the set, which an empty `split` means.
Status CheckNetworks(const TrainOptions& options, const std::string& first_split = {});

/// Whether the sizes of a network fit each other. Error kConfig.
Status CheckSizes(const NetworkOptions& network, const std::string& where);

/// Multiplies the generators' iterations by `budget`. Error kUsage when a product is more than the option allows.
Status ScaleTraining(double budget, TrainOptions& options);

/// What stands below a table of results about how its networks were trained: sentences. `recogniser`: the network that
/// gives the features.
std::vector<std::string> TrainingNotes(const TrainOptions& options, const std::string& recogniser);

}  // namespace mocurate
