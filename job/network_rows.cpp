#include "job/network_rows.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/text.h"

namespace mocurate {
namespace {

struct TrainingEffort {
  bool known = false;  ///< whether this run folder has records of all training
  double seconds = 0.0;
  double peak_memory = 0.0;  ///< bytes, largest of the workers that trained it
};

/// STEP of "NAME/SEED@STEP", for a checkpoint sample of `base` ("NAME/SEED").
std::optional<long long> StepOfSample(const std::string& item, const std::string& base) {
  const std::size_t at = item.rfind('@');
  if (at == std::string::npos || item.substr(0, at) != base) return std::nullopt;
  return ParseInteger(item.substr(at + 1));
}

/// Effort of a network and of the samples it continued from.
TrainingEffort EffortOf(const std::map<std::string, nlohmann::json>& journal, const std::string& item,
                        std::int64_t steps) {
  TrainingEffort effort;
  bool all = true;
  for (const auto& [name, entry] : journal) {
    const auto step = StepOfSample(name, item.substr(0, item.rfind('@')));
    if (name != item && !(step && *step < steps)) continue;
    all = all && !entry.value("from_cache", false);
    effort.known = true;
    effort.seconds += entry.value("seconds", 0.0);
    effort.peak_memory = std::max(effort.peak_memory, entry.value("peak_memory_bytes", 0.0));
  }
  effort.known = effort.known && all;
  return effort;
}

/// "NAME/SEED@STEP" of a row, independent of its display name.
std::string NetworkOfRow(const nlohmann::json& row) {
  return row.contains("network") ? row["network"].get<std::string>() : row.at("name").get<std::string>();
}

/// FID of a row; empty without one.
std::optional<double> FidOfRow(const nlohmann::json& row) {
  const nlohmann::json fid = row.at("metrics").value("FID_train", nlohmann::json::object());
  if (!fid.is_object() || !fid.contains("value") || !fid["value"].is_number()) return std::nullopt;
  return fid["value"].get<double>();
}

/// Why a network that ended at `steps` has not converged; empty for a converged one.
std::string Unconverged(const NetworkOptions& options, const nlohmann::json& row, std::int64_t steps, double settled,
                        const nlohmann::json& rows) {
  if (options.learning.planned > steps) {
    return Counted(steps, "step") + " of " + std::to_string(options.learning.planned);
  }
  const auto fid = FidOfRow(row);
  std::optional<double> before;
  long long last = 0;
  for (const nlohmann::json& sample : rows) {
    if (sample.value("frames", 0) != row.value("frames", 0)) continue;
    const auto step = StepOfSample(NetworkOfRow(sample), NetworkOfRow(row));
    if (!step || *step < last) continue;
    last = *step;
    before = FidOfRow(sample);
  }
  if (!fid || !before || std::abs(*fid - *before) <= settled * *before) return "";
  return "FID went from " + RoundedText(*before, 3) + " at step " + std::to_string(last) + " to " +
         RoundedText(*fid, 3) + " at step " + std::to_string(steps);
}

}  // namespace

void AddTraining(const NetworkTraining& training, double settled, nlohmann::json& rows) {
  for (nlohmann::json& row : rows) {
    nlohmann::json ours = {{"metrics", row.at("metrics")}, {"checkpoint", nullptr},  {"steps", nullptr},
                           {"seconds", nullptr},           {"peak_memory", nullptr}, {"unconverged", nullptr}};
    for (const TrainedNetwork& network : training.networks) {
      const NetworkOptions& options = training.options.networks[network.network];
      if (network.row != NetworkOfRow(row) || !GeneratesMotions(options.kind)) continue;
      const nlohmann::json& summary = training.summaries.at(network.checkpoint.name);
      const auto steps = summary.at("iterations").get<std::int64_t>();
      ours["checkpoint"] = network.checkpoint.sha256;
      ours["steps"] = steps;
      ours["parameters"] = summary.at("parameters_of");
      if (const std::string why = Unconverged(options, row, steps, settled, rows); !why.empty()) {
        ours["unconverged"] = row["unconverged"] = why;
      }
      const TrainingEffort effort = EffortOf(training.journal, network.checkpoint.name, steps);
      if (!effort.known) continue;
      ours["seconds"] = effort.seconds + summary.value("seconds_before", 0.0);
      if (effort.peak_memory > 0.0) ours["peak_memory"] = effort.peak_memory;
    }
    row["ours"] = std::move(ours);
  }
}

}  // namespace mocurate
