#include "app/time_budget.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/data_sets.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/base/units.h"

namespace mocurate {
namespace {

constexpr double kTrainingShare = 0.85;   // of the time; the rest is for datasets, scores and pictures
constexpr double kRecogniserShare = 0.5;  // of training, at most

/// Seconds of all cores that the networks of a job take, and what one step of each takes.
struct TrainingCost {
  double generators = 0.0, recognisers = 0.0, one_step = 0.0;
  double most_steps = 0.0;  ///< of a generator
};

TrainingCost CostOf(const DataSetsRun& run, const JobOptions& options) {
  TrainingCost cost;
  for (const SetResult& set : run.sets) {
    for (const auto& [item, measured] : set.result.training.items()) {
      if (!measured.contains("seconds_per_step")) continue;
      const double step = measured["seconds_per_step"].get<double>() * measured["threads"].get<double>();
      const double steps = measured["steps"].get<double>();
      const std::string name = item.substr(0, item.rfind('/'));
      const auto network = std::find_if(options.train.networks.begin(), options.train.networks.end(),
                                        [&](const NetworkOptions& one) { return one.name == name; });
      cost.one_step += step;
      const bool generator = network != options.train.networks.end() && GeneratesMotions(network->kind);
      (generator ? cost.generators : cost.recognisers) += step * steps;
      if (generator) cost.most_steps = std::max(cost.most_steps, steps);
    }
  }
  return cost;
}

std::int64_t MostEpochs(const TrainOptions& train) {
  std::int64_t most = 1;
  for (const NetworkOptions& network : train.networks) {
    if (!GeneratesMotions(network.kind)) most = std::max(most, network.recogniser.epochs);
  }
  return most;
}

}  // namespace

Expected<TimeBudget> MakeTimeBudget(double seconds, const JobOptions& options, const RunnerOptions& settings) {
  const std::filesystem::path file = settings.run_folder / "time_budget.json";
  const std::string key = Sha256Hex(OptionsToJson(options).dump() + QuantityText(seconds, Unit::kSecond));
  TimeBudget budget;
  if (const auto text = ReadFile(file)) {
    const nlohmann::json kept = nlohmann::json::parse(*text, nullptr, false);
    if (kept.is_object() && kept.value("key", std::string()) == key) {
      budget.factor = kept.value("factor", 1.0);
      budget.recogniser_epochs = kept.value("recogniser_epochs", std::int64_t{0});
      return budget;
    }
  }
  const auto made = RunOverSets(options, JobStage::kAssemble, 1.0, settings);
  if (!made) return Forward(made);
  if (!made->failed.empty()) return tl::unexpected<Error>(made->failed.front().second);
  RunnerOptions dry = settings;
  dry.dry_run = true;
  const auto measured = RunOverSets(options, JobStage::kTrain, 1.0, dry);
  if (!measured) return Forward(measured);
  const TrainingCost cost = CostOf(*measured, options);
  const double cores = settings.jobs > 0 ? settings.jobs : std::max(1U, std::thread::hardware_concurrency());
  const double time = kTrainingShare * seconds * cores;
  if (cost.one_step > time) {
    return Fail(ErrorCode::kUsage,
                "one step of each network takes " + RoundedText(cost.one_step / cores, 3) + " s, the time leaves " +
                    RoundedText(time / cores, 3) + " s for training",
                "--time-budget", "give more, or --profile smoke");
  }
  double recognisers = cost.recognisers;
  if (cost.recognisers > kRecogniserShare * time) {
    const double share = kRecogniserShare * time / cost.recognisers;
    const std::int64_t epochs = MostEpochs(options.train);
    budget.recogniser_epochs =
        std::max<std::int64_t>(1, static_cast<std::int64_t>(share * static_cast<double>(epochs)));
    recognisers *= static_cast<double>(budget.recogniser_epochs) / static_cast<double>(epochs);
  }
  if (cost.generators > 0.0) budget.factor = std::min(1.0, std::max(0.0, time - recognisers) / cost.generators);
  if (cost.generators > 0.0 && budget.factor * cost.most_steps < 1.0) {
    return Fail(ErrorCode::kUsage,
                "recognisers take " + RoundedText(recognisers / cores, 3) + " of " + RoundedText(seconds, 3) +
                    " s at their least, no step of a generator fits",
                "--time-budget", "give more, or --profile smoke");
  }
  LogInfo("time budget: generators are trained for " + RoundedText(100.0 * budget.factor, 3) +
          " % of their iterations" +
          (budget.recogniser_epochs > 0 ? ", recognisers for " + Counted(budget.recogniser_epochs, "epoch") + " at most"
                                        : ""));
  const nlohmann::json kept = {{"key", key},
                               {"seconds", seconds},
                               {"factor", budget.factor},
                               {"recogniser_epochs", budget.recogniser_epochs},
                               {"measured_hours", (cost.generators + cost.recognisers) / cores / 3600.0}};
  if (Status written = WriteFile(file, kept.dump(1) + "\n"); !written) return Forward(written);
  return budget;
}

}  // namespace mocurate
