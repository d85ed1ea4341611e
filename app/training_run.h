#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/job_items.h"
#include "app/run_outputs.h"
#include "app/stage_runs.h"

namespace mocurate {

/// What a training writes to: stages, the run folder, the summaries of the run.
struct TrainingPlace {
  Runner& runner;
  StageRuns& runs;
  RunOutputs& outputs;
  JobResult& result;
};

/// A set that a network made by encoding and decoding.
struct DenoisedSet {
  std::string item;         ///< of the network: "ACTOR/1"
  std::size_t network = 0;  ///< position in TrainOptions::networks
  ItemResult set;
};

struct TrainedNetworks {
  std::vector<TrainedNetwork> networks;  ///< in the order of the config
  std::vector<DenoisedSet> denoised;     ///< their test parts score recognisers too
};

/// Trains the networks of a job, first those that need no other one; what a generator makes for those after it is made
/// between. A network that fails costs only those that need it. Copies checkpoints into the run folder; summaries and
/// why a network is not trained go to the result. A dry run tells what a few steps of each would take instead. Errors:
/// kInterrupted, kCannotWrite, a file of a network that cannot be read.
Expected<TrainedNetworks> TrainNetworks(const TrainOptions& options, const TrainingInputs& inputs,
                                        const TrainingPlace& place);

}  // namespace mocurate
