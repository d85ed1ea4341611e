#include "job/verbs/reproduce.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "job/data_sets.h"
#include "job/stage_runs.h"

namespace mocurate {
namespace {

constexpr double kTrainingShare = 0.85;   // of the time; the rest is for datasets, scores and pictures
constexpr double kRecogniserShare = 0.5;  // of training, at most

/// Measured training time of a network.
struct Cost {
  std::string set;
  NetworkKind kind = NetworkKind::kAction2Motion;
  double step_s = 0.0, threads = 1.0, steps = 0.0;
  double epochs = 1.0;  ///< of a recogniser

  bool generator() const { return GeneratesMotions(kind); }
  double StepsOf(const TimeBudget& budget) const {
    if (generator()) return std::max(1.0, std::round(budget.factor * steps));
    const double most = budget.recogniser_epochs > 0 ? static_cast<double>(budget.recogniser_epochs) : epochs;
    return steps * std::min(1.0, most / epochs);
  }
};

/// Costs from measurements; a network trained on motions of another one, which do not exist yet, gets the cost of one
/// of its kind.
std::vector<Cost> CostsOf(const DataSetsRun& run, const JobOptions& options) {
  std::vector<Cost> costs;
  for (const SetResult& set : run.sets) {
    std::map<NetworkKind, Cost> of_kind;
    std::set<std::string> known;
    for (const auto& [item, measured] : set.result.training.items()) {
      const std::string name = item.substr(0, item.rfind('/'));
      for (const NetworkOptions& network : options.train.networks) {
        if (network.name != name || !measured.contains("seconds_per_step")) continue;
        known.insert(name);
        costs.push_back({set.set.name, network.kind, measured["seconds_per_step"].get<double>(),
                         measured["threads"].get<double>(), measured["steps"].get<double>(),
                         static_cast<double>(std::max<std::int64_t>(1, network.recogniser.epochs))});
        of_kind[network.kind] = costs.back();
      }
    }
    for (const NetworkOptions& network : options.train.networks) {
      const auto alike = of_kind.find(network.kind);
      if (network.generator.empty() || known.count(network.name) > 0 || alike == of_kind.end()) continue;
      costs.push_back(alike->second);
    }
  }
  return costs;
}

/// Seconds of training: sets are sequential, networks of a set run in parallel, none faster than its own steps.
double SecondsOf(const std::vector<Cost>& costs, const TimeBudget& budget, double cores, bool generators,
                 bool recognisers) {
  std::map<std::string, double> all, longest;
  for (const Cost& cost : costs) {
    if (!(cost.generator() ? generators : recognisers)) continue;
    const double steps = cost.StepsOf(budget);
    all[cost.set] += cost.step_s * std::min(cost.threads, cores) * steps / cores;
    longest[cost.set] = std::max(longest[cost.set], cost.step_s * steps);
  }
  double seconds = 0.0;
  for (const auto& [set, of_all] : all) seconds += std::max(of_all, longest[set]);
  return seconds;
}

/// The largest epochs and factor within a time.
TimeBudget Shared(const std::vector<Cost>& costs, double time, double cores) {
  TimeBudget budget;
  double most = 1.0;
  for (const Cost& cost : costs) most = std::max(most, cost.generator() ? 1.0 : cost.epochs);
  if (SecondsOf(costs, budget, cores, false, true) > kRecogniserShare * time) {
    std::int64_t low = 1, high = static_cast<std::int64_t>(most);
    while (low < high) {
      budget.recogniser_epochs = (low + high + 1) / 2;
      const bool fits = SecondsOf(costs, budget, cores, false, true) <= kRecogniserShare * time;
      (fits ? low : high) = fits ? budget.recogniser_epochs : budget.recogniser_epochs - 1;
    }
    budget.recogniser_epochs = low;
  }
  if (SecondsOf(costs, budget, cores, true, true) <= time) return budget;
  double low = 0.0, high = 1.0;
  for (int k = 0; k < 40; ++k) {
    budget.factor = 0.5 * (low + high);
    (SecondsOf(costs, budget, cores, true, true) <= time ? low : high) = budget.factor;
  }
  budget.factor = std::max(low, 1e-9);  // where only one step of each fits
  return budget;
}

/// A budget that an earlier run saved for the same job and time; empty for another job's or an edited file.
std::optional<TimeBudget> SavedBudget(const std::filesystem::path& file, const std::string& key) {
  const nlohmann::json kept = ReadJson(file).value_or(nullptr);
  const bool sound = kept.is_object() && kept.contains("key") && kept["key"] == key && kept.contains("factor") &&
                     kept["factor"].is_number() && kept.contains("recogniser_epochs") &&
                     kept["recogniser_epochs"].is_number_integer();
  if (!sound) return std::nullopt;
  const TimeBudget budget{kept["factor"].get<double>(), kept["recogniser_epochs"].get<std::int64_t>()};
  if (!(budget.factor > 0.0 && budget.factor <= 1.0) || budget.recogniser_epochs < 0) return std::nullopt;
  return budget;
}

}  // namespace

Expected<TimeBudget> MakeTimeBudget(double seconds, const JobOptions& options, const RunnerOptions& settings,
                                    const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "time_budget.json";
  const std::string key = Sha256Hex(OptionsToJson(options).dump() + QuantityText(seconds, Unit::kSecond));
  const double cores = std::min<double>(settings.jobs > 0 ? settings.jobs : 1e9, AvailableCores());
  if (const auto kept = SavedBudget(file, key)) {
    LogInfo("time budget: read from " + DisplayPath(file));
    return *kept;
  }
  const TemporaryFolder scratch;  // measuring does not change files of a run
  if (scratch.path().empty()) return Forward(scratch.Missing());
  RunnerOptions own = settings;
  own.run_folder = scratch.path();
  const auto made = RunOverSets(options, JobStage::kAssemble, 1.0, own);
  if (!made) return Forward(made);
  if (made->sets.empty()) return tl::unexpected<Error>(made->failed.front().second);
  own.dry_run = true;
  const auto measured = RunOverSets(options, JobStage::kTrain, 1.0, own);
  if (!measured) return Forward(measured);
  const std::vector<Cost> costs = CostsOf(*measured, options);
  const double time = kTrainingShare * seconds;
  const double whole = SecondsOf(costs, TimeBudget(), cores, true, true);
  const double least = SecondsOf(costs, {0.0, 1}, cores, true, true);
  if (least > time) {
    return Fail(ErrorCode::kUsage,
                "one step of each generator and one epoch of each recogniser need " + RoundedText(least, 3) +
                    " s, but the budget allows " + RoundedText(time, 3) + " s for training",
                "--time-budget", "give a longer time, or use --profile smoke");
  }
  const TimeBudget budget = Shared(costs, time, cores);
  LogInfo("time budget: all trainings take " + RoundedText(whole / 3600.0, 3) + " h; generators are trained for " +
          RoundedText(100.0 * budget.factor, 3) + " % of their iterations" +
          (budget.recogniser_epochs > 0 ? ", recognisers for " + Counted(budget.recogniser_epochs, "epoch") + " at most"
                                        : ""));
  const nlohmann::json kept = {{"key", key},
                               {"seconds", seconds},
                               {"cores", cores},
                               {"factor", budget.factor},
                               {"recogniser_epochs", budget.recogniser_epochs},
                               {"hours_of_all", whole / 3600.0}};
  if (Status there = MakeFolder(folder); !there) return Forward(there);
  if (Status written = WriteFile(file, kept.dump(1) + "\n"); !written) return Forward(written);
  return budget;
}

}  // namespace mocurate
