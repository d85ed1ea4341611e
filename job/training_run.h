#pragma once

#include <map>
#include <string>
#include <vector>

#include "job/job_items.h"
#include "job/stage_runs.h"

namespace mocurate {

/// Outputs of a training: stages, the run folder, the summaries of the run.
struct TrainingPlace {
  Runner& runner;
  StageRuns& runs;
  JobResult& result;
};

/// A set that a network encoded and decoded.
struct DenoisedSet {
  std::string item;         ///< of the network: "ACTOR/1"
  std::size_t network = 0;  ///< position in TrainOptions::networks
  ItemResult set;
};

struct TrainedNetworks {
  std::vector<TrainedNetwork> networks;  ///< in the order of the config
  std::vector<DenoisedSet> denoised;     ///< recognisers are scored on their test parts too
};

/// Trains the networks of a job in order of their dependencies, and generates the motions that later ones train on in
/// between. A network that fails only stops those that depend on it. Copies checkpoints into the run folder; adds
/// summaries, and reasons for untrained networks, to the result. A dry run measures a few steps of each instead.
/// Errors: kInterrupted, kCannotWrite, an unreadable file of a network.
Expected<TrainedNetworks> TrainNetworks(const TrainOptions& options, const TrainingInputs& inputs,
                                        const TrainingPlace& place);

}  // namespace mocurate
