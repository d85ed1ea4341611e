#include "job/training_run.h"

#include <algorithm>
#include <set>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "job/main_job.h"
#include "job/run_folder.h"
#include "job/stage_runs.h"
#include "train/stages.h"

namespace mocurate {
namespace {

class TrainingRun {
 public:
  TrainingRun(const TrainOptions& options, const TrainingPlace& place) : options_(options), place_(place) {}

  Expected<TrainedNetworks> Run(std::vector<TrainItem> waiting) {
    if (Status added = AddFiles(waiting); !added) return Forward(added);
    if (place_.runner.options().dry_run) {
      if (Status measured = Measure(waiting); !measured) return Forward(measured);
      return trained_;
    }
    while (!waiting.empty()) {
      const auto ready = std::stable_partition(waiting.begin(), waiting.end(), [&](const TrainItem& item) {
        const auto there = [&](const std::string& needed) { return needed.empty() || done_.count(needed) > 0; };
        return there(item.after) && there(item.from) && (!item.made || there(item.made->generator_item));
      });
      if (ready == waiting.begin()) return LeaveWaiting(waiting);
      std::vector<TrainItem> items(waiting.begin(), ready);
      waiting.erase(waiting.begin(), ready);
      if (Status made = MakeSets(items); !made) return Forward(made);
      if (Status done = Wave(std::move(items)); !done) return Forward(done);
    }
    std::stable_sort(trained_.networks.begin(), trained_.networks.end(),
                     [](const TrainedNetwork& a, const TrainedNetwork& b) { return a.network < b.network; });
    return std::move(trained_);
  }

 private:
  /// Adds files that networks read beside the dataset: pretrained weights, the body of a loss.
  Status AddFiles(std::vector<TrainItem>& items) const {
    for (TrainItem& item : items) {
      const NetworkOptions& network = options_.networks[item.network];
      const std::pair<const char*, const std::filesystem::path*> files[] = {
          {"weights", &network.learning.weights},
          {"start_from", &network.learning.start_from},
          {"body", &network.body()}};
      for (const auto& [role, file] : files) {
        if (file->empty()) continue;
        const Expected<std::string> sha256 = Sha256OfFile(*file);
        if (!sha256) return Forward(sha256);
        item.spec.inputs.push_back({role, file->filename().string(), *file, *sha256});
      }
    }
    return {};
  }

  /// In a dry run: measures a few steps of each network in a temporary folder, and logs the expected time.
  Status Measure(const std::vector<TrainItem>& items) {
    const TemporaryFolder scratch;
    if (scratch.path().empty()) return scratch.Missing();
    RunnerOptions settings = place_.runner.options();
    settings.dry_run = false;
    settings.jobs = 1;
    settings.run_folder = scratch.path();
    settings.cache_folder = scratch.path() / "cache";
    auto runner = Runner::Make(settings);
    if (!runner) return Forward(runner);
    std::vector<ItemSpec> specs, known;
    for (const TrainItem& item : items) {
      if (item.after.empty() && item.from.empty() && !item.made) known.push_back(item.spec);
    }
    const auto predicted_decrease = place_.runs.Run(TrainDeclaration(), std::move(known));
    if (!predicted_decrease) return Forward(predicted_decrease);
    std::set<std::string> cached;
    for (const ItemResult& item : predicted_decrease->items) {
      if (item.from_cache) cached.insert(item.item);
    }
    for (const TrainItem& item : items) {
      if (cached.count(item.spec.item) > 0) continue;
      const bool trained = options_.networks[item.network].learning.weights.empty();
      if (item.made) {
        LogInfo(item.spec.item + ": not measured, '" + item.made->generator_item +
                "' has not generated its motions yet");
      } else if (trained && !item.IsSample()) {
        specs.push_back(item.spec);
      }
    }
    const auto report = (*runner)->Run(TrainCostDeclaration(), std::move(specs));
    if (!report) return Forward(report);
    for (const ItemResult& item : report->items) {
      const nlohmann::json cost = item.summary;
      if (item.artifact.empty()) {
        place_.result.untrained[item.item] = item.outcome.error;
        continue;
      }
      place_.result.training[item.item] = cost;
      const double step = cost.at("seconds_per_step").get<double>(), steps = cost.at("steps").get<double>();
      LogInfo(item.item + ": " + Counted(cost.at("steps").get<long long>(), "step") + " of " + RoundedText(step, 3) +
              " s with " + Counted(cost.at("threads").get<long long>(), "thread") + ", " +
              RoundedText(step * steps / 3600.0, 3) + " h; " +
              Counted(cost.at("parameters").get<long long>(), "parameter"));
    }
    return {};
  }

  /// Generates the motions that these networks train on, each set once and sequentially, as each uses all threads and
  /// the memory of a whole set.
  Status MakeSets(const std::vector<TrainItem>& items) {
    for (const TrainItem& item : items) {
      if (!item.made || made_.count(item.made->item()) > 0) continue;
      const ItemResult& generator = done_.at(item.made->generator_item);
      if (generator.artifact.empty()) continue;
      RemakeOptions options;
      options.rule = item.made->rule;
      options.seed = static_cast<std::int64_t>(item.made->seed());
      options.training_windows = true;
      StageInput motions = item.spec.inputs.front();
      motions.role = "motions";
      const auto report = place_.runs.Run(
          GenerateDeclaration(),
          {{item.made->item(), OptionsToJson(options), {InputFrom("generator", generator), std::move(motions)}}});
      if (!report) return Forward(report);
      const ItemResult& set = report->items.front();
      made_[set.item] = set;
      if (options.rule != RemakeRule::kDenoise || set.artifact.empty()) continue;
      trained_.denoised.push_back({item.made->generator_item, NetworkOf(item.made->generator), set});
    }
    return {};
  }

  std::size_t NetworkOf(const std::string& name) const {
    const auto found = std::find_if(options_.networks.begin(), options_.networks.end(),
                                    [&](const NetworkOptions& network) { return network.name == name; });
    return static_cast<std::size_t>(found - options_.networks.begin());
  }

  /// Reports networks that need one which is not trained here (of raw tracks that could not be compared).
  Expected<TrainedNetworks> LeaveWaiting(const std::vector<TrainItem>& waiting) {
    for (const TrainItem& item : waiting) {
      const std::string needed = item.made ? item.made->generator_item : item.from;
      place_.result.untrained[item.spec.item] = {ErrorCode::kInconsistent,
                                                 "the network needs '" + needed + "', which is not trained in this run",
                                                 item.spec.item, "see the warnings above"};
    }
    return std::move(trained_);
  }

  /// Whether an input of the item failed; the item then fails for the same reason.
  bool Refused(const TrainItem& item, const ItemResult& needed) {
    if (!needed.artifact.empty()) return false;
    place_.result.untrained[item.spec.item] = needed.outcome.error;
    done_[item.spec.item] = needed;
    return true;
  }

  Status Wave(std::vector<TrainItem> items) {
    std::vector<ItemSpec> specs;
    std::vector<TrainItem> run;
    for (TrainItem& item : items) {
      if (!item.after.empty()) {
        if (Refused(item, done_.at(item.after))) continue;
        item.spec.inputs.push_back(InputFrom("start", done_.at(item.after)));
      }
      if (!item.from.empty()) {
        if (Refused(item, done_.at(item.from))) continue;
        item.spec.inputs.push_back(InputFrom("start_from", done_.at(item.from)));
      }
      if (item.made) {
        if (Refused(item, done_.at(item.made->generator_item)) || Refused(item, made_.at(item.made->item()))) continue;
        const StageInput made = InputFrom(item.mixed ? "made" : "dataset", made_.at(item.made->item()));
        if (!item.mixed) item.spec.inputs.front() = made;
        if (item.mixed) item.spec.inputs.push_back(made);
      }
      specs.push_back(item.spec);
      run.push_back(std::move(item));
    }
    const auto report = place_.runs.Run(TrainDeclaration(), std::move(specs));
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < run.size(); ++i) {
      const ItemResult item = i < report->items.size() ? report->items[i] : ItemResult();
      done_[run[i].spec.item] = item;
      if (item.artifact.empty()) {
        place_.result.untrained[item.item] = item.outcome.error;
        continue;
      }
      trained_.networks.push_back({run[i].network, run[i].row, InputFrom("network", item)});
      place_.result.training[item.item] = item.summary;
      if (Status copied = CopyCheckpoint(item); !copied) return copied;
    }
    return {};
  }

  Status CopyCheckpoint(const ItemResult& item) {
    const std::filesystem::path folder = place_.runner.options().run_folder / "checkpoints";
    if (Status made = MakeFolder(folder); !made) return made;
    return CopyWhole(item.artifact, folder / (FileNameOf(item.item) + ".h5"));
  }

  const TrainOptions& options_;
  const TrainingPlace& place_;
  std::map<std::string, ItemResult> done_;  ///< trained networks by item
  std::map<std::string, ItemResult> made_;  ///< sets that they generated
  TrainedNetworks trained_;
};

}  // namespace

Expected<TrainedNetworks> TrainNetworks(const TrainOptions& options, const TrainingInputs& inputs,
                                        const TrainingPlace& place) {
  return TrainingRun(options, place).Run(TrainItems(options, inputs));
}

}  // namespace mocurate
