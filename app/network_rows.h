#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/job_items.h"
#include "train/items.h"

namespace mocurate {

/// The networks of a run and what their training was.
struct NetworkTraining {
  const std::vector<TrainedNetwork>& networks;
  const TrainOptions& options;
  const nlohmann::json& summaries;                      ///< of the stage `train`, by item
  const std::map<std::string, nlohmann::json> journal;  ///< entries of the run's journal, by item
};

/// Gives each row of a network `ours`: {"metrics", "checkpoint": sha256, "steps", "parameters", "seconds",
/// "peak_memory", "unconverged"}. Null: not known, as the seconds of a network that came from the cache of another run.
/// `unconverged` says why a network counts as not converged: a bound or budget cut it short, or its FID changed by more
/// than the share `settled` since its last sample. Such a row has the same text under its own key `unconverged`.
void AddTraining(const NetworkTraining& training, double settled, nlohmann::json& rows);

}  // namespace mocurate
