#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/config_loading.h"
#include "app/machine_facts.h"
#include "app/main_job.h"
#include "app/verbs.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/version.h"

namespace mocurate {
namespace {

/// run.json: what was run, with what, where. Times and hardware live here and nowhere else.
Status WriteRunFile(const LoadedJob& job, const RunArguments& arguments, const std::filesystem::path& folder) {
  const nlohmann::json run = {{"created_by", CreatedBy()},
                              {"options", OptionsToJson(job.options)},
                              {"config", ShowOptions(job.options, job.node, true)},
                              {"budget", arguments.budget},
                              {"machine", MachineFacts()}};
  return WriteFile(folder / "run.json", run.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

nlohmann::json StagesJson(const JobResult& result) {
  nlohmann::json stages = nlohmann::json::array();
  for (const StageReport& stage : result.stages) {
    stages.push_back({{"stage", stage.stage},
                      {"items", stage.items.size()},
                      {"done", stage.done},
                      {"doubtful", stage.doubtful},
                      {"left_out", stage.left_out},
                      {"refused", stage.refused},
                      {"crashed", stage.crashed},
                      {"from_cache", stage.from_cache},
                      {"seconds", stage.seconds}});
  }
  return stages;
}

nlohmann::json UntrainedJson(const JobResult& result) {
  nlohmann::json untrained = nlohmann::json::object();
  for (const auto& [item, error] : result.untrained) untrained[item] = error.Message();
  return untrained;
}

nlohmann::json UnevaluatedJson(const JobResult& result) {
  if (!result.unevaluated) return nullptr;
  return {{"code", Name(result.unevaluated->code)}, {"message", result.unevaluated->Message()}};
}

int Executed(const JobResult& result) {
  int count = 0;
  for (const StageReport& stage : result.stages) count += static_cast<int>(stage.items.size()) - stage.from_cache;
  return count;
}

/// What a dry run has found. The report is drawn from results, which a dry run has not.
std::string Foreseen(const JobResult& result, JobStage last) {
  const int count = Executed(result);
  if (count == 0) {
    return std::string(last == JobStage::kReport ? "nothing before the report would run" : "nothing would run") +
           ": every item is in the cache";
  }
  return std::to_string(count) + " items would run, and what follows from them";
}

nlohmann::json ResultJson(const JobResult& result, const std::filesystem::path& folder, double seconds) {
  return {{"run", DisplayPath(folder)},
          {"executed", Executed(result)},
          {"dataset", DisplayPath(result.dataset)},
          {"report", DisplayPath(result.report)},
          {"clips", result.clips},
          {"kept", result.kept},
          {"left_out", result.left_out},
          {"failed", result.failed},
          {"findings", result.findings},
          {"fit_error", result.fit_error},
          {"audit", result.audit},
          {"metrics", result.metrics},
          {"untrained", UntrainedJson(result)},
          {"unevaluated", UnevaluatedJson(result)},
          {"stages", StagesJson(result)},
          {"seconds", seconds}};
}

void PrintFigures(const JobResult& result) {
  if (result.audit.contains("nearest_neighbour") && result.audit["nearest_neighbour"].value("count", 0) > 0) {
    const nlohmann::json& neighbour = result.audit["nearest_neighbour"];
    std::printf("1-nearest-neighbour accuracy %.3f (%d test clips)\n", neighbour.value("accuracy", 0.0),
                neighbour.value("count", 0));
  }
  for (const char* kind : {"recogniser", "baseline_recogniser", "crop_recogniser"}) {
    if (!result.metrics.is_object() || !result.metrics.contains(kind)) continue;
    const nlohmann::json& recogniser = result.metrics[kind];
    if (!recogniser.contains("mean") || !recogniser["mean"].is_number()) {
      std::printf("%-20s not scored: %s\n", kind, recogniser.value("scored", "").c_str());
      continue;
    }
    std::printf("%-20s accuracy %.3f on %s, mean of %zu seeds\n", kind, recogniser.value("mean", 0.0),
                recogniser.value("scored", "").c_str(),
                recogniser.value("test_accuracy", std::vector<double>()).size());
  }
  if (result.fit_error.is_object()) {
    const double evidence_mm = result.fit_error.value("evidence_mm", 0.0);
    std::printf("error against the truth: ");
    if (evidence_mm > 0.0) std::printf("joints %.1f mm in the evidence, ", evidence_mm);
    std::printf("joints %.1f mm after fitting, rotations %.1f degrees\n", result.fit_error.value("joint_mm", 0.0),
                result.fit_error.value("rotation_deg", 0.0));
    if (result.fit_error.contains("within_one_sigma")) {
      std::printf(
          "stated uncertainty: %.1f %% of errors within one standard deviation (68.3 is right), %.1f %% within two "
          "(95.4)\n",
          100.0 * result.fit_error.value("within_one_sigma", 0.0),
          100.0 * result.fit_error.value("within_two_sigma", 0.0));
    }
  }
}

void PrintResult(const JobResult& result, double seconds) {
  for (const StageReport& stage : result.stages) {
    std::printf(
        "%-20s %5zu items  %5d done  %4d doubtful  %4d left out  %4d refused  %4d crashed  %5d from cache  %7.1f s\n",
        stage.stage.c_str(), stage.items.size(), stage.done, stage.doubtful, stage.left_out, stage.refused,
        stage.crashed, stage.from_cache, stage.seconds);
  }
  std::printf("%d clips, %d kept, left out by rule: %d, %d failed, %.1f s\n", result.clips, result.kept,
              result.left_out, result.failed, seconds);
  for (const auto& [code, count] : result.findings) {
    std::printf("%-26s %d of %d clips (curation_log.jsonl says which)\n", code.c_str(), count, result.clips);
  }
  PrintFigures(result);
  if (!result.table.empty()) std::printf("\n%s\n", result.table.c_str());
  if (!result.dataset.empty()) std::printf("dataset  %s\n", DisplayPath(result.dataset).c_str());
  for (const auto& table : result.tables) std::printf("table    %s\n", DisplayPath(table).c_str());
  if (!result.report.empty()) std::printf("report   %s\n", DisplayPath(result.report).c_str());
}

/// The run came to its end without the table that it was to make.
Status CheckEvaluation(const JobResult& result) {
  if (!result.unevaluated) return {};
  const Error& error = *result.unevaluated;
  return Fail(error.code, "the evaluation failed, there is no table; " + error.what, error.where, error.hint);
}

/// A network that was asked for and is not there is a failure, whatever the others gave.
Status CheckNetworks(const JobResult& result) {
  if (result.untrained.empty()) return {};
  const auto& [item, error] = *result.untrained.begin();
  const std::size_t all = result.training.size() + result.untrained.size();
  return Fail(result.training.empty() ? error.code : ErrorCode::kTooManyFailures,
              std::to_string(result.untrained.size()) + " of " + std::to_string(all) + " networks were not trained; " +
                  item + ": " + error.what,
              error.where, error.hint.empty() ? "the page of the run lists them" : error.hint);
}

/// Of the clips that were to be kept, those that failed.
Status CheckFailures(const JobOptions& options, const JobResult& result) {
  const int wanted = result.clips - result.left_out;
  const double tolerated = options.tolerated_failures * wanted;
  if (wanted == 0 || result.failed <= tolerated) return {};
  return Fail(ErrorCode::kTooManyFailures,
              std::to_string(result.failed) + " of " + std::to_string(wanted) +
                  " clips failed, tolerated_failures is " + std::to_string(static_cast<int>(std::floor(tolerated))) +
                  " clips",
              "run", "curation_log.jsonl says why each failed; the others are in the dataset");
}

}  // namespace

Status RunVerb(CommonArguments& common, const RunArguments& arguments) {
  const auto started = std::chrono::steady_clock::now();
  auto job = LoadJob(arguments.config, arguments.assignments);
  if (!job) return Forward(job);
  const auto last = JobStageFromName(arguments.to.empty() ? "report" : arguments.to);
  if (!last) return Forward(last);
  if (Status scaled = ScaleTraining(arguments.budget, job->options.train); !scaled) return scaled;

  RunnerOptions options;
  options.run_folder = arguments.output.empty() ? std::filesystem::path("runs") / job->options.name : arguments.output;
  options.jobs = arguments.jobs;
  options.dry_run = arguments.dry_run;
  options.progress = !common.quiet;
  options.time_factor = std::max(1.0, arguments.budget);
  options.item_timeout_s = job->options.pipeline.item_timeout_s;
  if (const auto bytes = job->options.pipeline.item_memory_bytes) {
    options.item_memory_bytes = static_cast<std::uint64_t>(*bytes);
  }
  if (!job->options.takes.empty()) LogInfo(job->options.name + " takes " + job->options.takes);
  if (!arguments.dry_run) {
    if (Status made = MakeFolder(options.run_folder); !made) return made;
  }
  auto runner = Runner::Make(options);
  if (!runner) return Forward(runner);
  if (!arguments.dry_run) {
    if (Status written = WriteRunFile(*job, arguments, options.run_folder); !written) return written;
  }
  const auto result = RunMainJob(job->options, *last, **runner);
  if (!result) return Forward(result);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  if (common.json) {
    common.answered = true;
    std::printf("%s\n", ResultJson(*result, options.run_folder, seconds)
                            .dump(1, ' ', false, nlohmann::json::error_handler_t::replace)
                            .c_str());
  } else {
    PrintResult(*result, seconds);
    if (arguments.dry_run) std::printf("dry run: %s\n", Foreseen(*result, *last).c_str());
  }
  if (Status evaluation = CheckEvaluation(*result); !evaluation) return evaluation;
  if (Status networks = CheckNetworks(*result); !networks) return networks;
  return CheckFailures(job->options, *result);
}

}  // namespace mocurate
