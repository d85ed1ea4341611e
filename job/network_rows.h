#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "job/job_items.h"
#include "train/items.h"

namespace mocurate {

/// The networks of a run and their training.
struct NetworkTraining {
  const std::vector<TrainedNetwork>& networks;
  const TrainOptions& options;
  const nlohmann::json& summaries;                      ///< of the stage `train`, by item
  const std::map<std::string, nlohmann::json> journal;  ///< entries of the run's journal, by item
};

/// Adds to each row of a network `ours`: {"metrics", "checkpoint": sha256, "steps", "parameters", "seconds",
/// "peak_memory", "unconverged"}. Null: unknown, such as the seconds of a network from another run's cache.
/// `unconverged` is the reason why a network is not converged: a limit or budget ended it, or its FID changed by more
/// than the share `settled` since its last sample. Such a row has the same text under its own key `unconverged`.
void AddTraining(const NetworkTraining& training, double settled, nlohmann::json& rows);

}  // namespace mocurate
