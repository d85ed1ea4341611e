#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "job/config_loading.h"
#include "job/data_sets.h"
#include "job/job_checks.h"
#include "job/machine.h"
#include "job/main_job.h"
#include "job/report_run.h"
#include "job/run_file.h"
#include "job/run_folder.h"
#include "job/slurm_run.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/reproduce.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

void PrintFigures(const JobResult& result) {
  if (result.audit.contains("nearest_neighbour") && result.audit["nearest_neighbour"].value("count", 0) > 0) {
    const nlohmann::json& neighbour = result.audit["nearest_neighbour"];
    Print("1-nearest-neighbour accuracy %.3f (%s)\n", neighbour.value("accuracy", 0.0),
          Counted(neighbour.value("count", 0), "test clip").c_str());
  }
  const nlohmann::json none = nlohmann::json::object();
  const nlohmann::json found = result.audit.is_object() ? result.audit.value("findings", none) : none;
  std::string codes;
  for (const auto& [code, count] : found.items()) {
    codes += (codes.empty() ? "" : ", ") + std::to_string(count.get<int>()) + " " + code;
  }
  if (!codes.empty()) {
    Print("audit: %s (mocurate audit %s lists them)\n", codes.c_str(), DisplayPath(result.dataset).c_str());
  }
  const nlohmann::json& recognisers =
      result.metrics.is_object() && result.metrics.contains("recognisers") ? result.metrics["recognisers"] : none;
  for (const auto& [name, recogniser] : recognisers.items()) {
    if (!recogniser.contains("mean") || !recogniser["mean"].is_number()) {
      Print("%-20s not scored: %s\n", name.c_str(), recogniser.value("scored", "").c_str());
      continue;
    }
    const auto seeds = static_cast<long long>(recogniser.value("test_accuracy", std::vector<double>()).size());
    Print("%-20s accuracy %.3f on %s, mean of %s\n", name.c_str(), recogniser.value("mean", 0.0),
          recogniser.value("scored", "").c_str(), Counted(seeds, "seed").c_str());
  }
  if (result.check.is_object()) {
    Print("check: %d of %s solved by both solvers, %d differ (joints %.3g mm at most, costs %.2g)\n",
          result.check.value("clips", 0), Counted(result.check.value("of", 0), "clip").c_str(),
          result.check.value("differ", 0), result.check.value("joint_worst_mm", 0.0),
          result.check.value("cost_difference", 0.0));
  }
  if (result.fit_error.is_object()) {
    const double evidence_mm = result.fit_error.value("evidence_mm", 0.0);
    Print("error against the truth: ");
    if (evidence_mm > 0.0) Print("joints %.1f mm in the evidence, ", evidence_mm);
    Print("joints %.1f mm after fitting, rotations %.1f degrees\n", result.fit_error.value("joint_mm", 0.0),
          result.fit_error.value("rotation_deg", 0.0));
    if (result.fit_error.contains("within_one_sigma")) {
      Print(
          "stated uncertainty: %.1f %% of errors within one standard deviation (68.3 is right), %.1f %% within two "
          "(95.4)\n",
          100.0 * result.fit_error.value("within_one_sigma", 0.0),
          100.0 * result.fit_error.value("within_two_sigma", 0.0));
    }
  }
}

/// Number of items that the run has processed, or that a dry run would process.
int Executed(const JobResult& result) {
  int count = 0;
  for (const StageCounts& stage : result.stages) count += static_cast<int>(stage.total) - stage.from_cache;
  return count;
}

/// Prints counts of clips, figures and paths of outputs to stdout; the log has the stages.
void PrintResult(const JobResult& result, double seconds) {
  Print("%s, %.1f s\n", ClipsText(result.counts).c_str(), seconds);
  for (const auto& [code, count] : result.findings) {
    Print("%-26s %d of %s (listed in curation_log.jsonl)\n", code.c_str(), count,
          Counted(result.counts.clips, "clip").c_str());
  }
  PrintFigures(result);
  for (const Table* table : {&result.table, &result.recognition}) {
    if (!table->rows.empty()) Print("\n%s\n", ToMarkdown(*table).c_str());
  }
  if (!result.dataset.empty()) {
    Print("dataset  %s  (%s)\n", DisplayPath(result.dataset).c_str(),
          Counted(static_cast<long long>(result.dataset_clips), "clip").c_str());
  }
  for (const auto& table : result.tables) Print("table    %s\n", DisplayPath(table).c_str());
  if (!result.report.empty()) Print("report   %s\n", DisplayPath(result.report).c_str());
}

/// Prints for each stage to stdout how many items would run and how many are in the cache.
void PrintPlan(const JobResult& result, JobStage last) {
  Print("dry run: nothing is run and nothing is written\n");
  for (const StageCounts& stage : result.stages) {
    if (stage.total == 0) continue;  // of inputs that do not exist yet
    const auto all = static_cast<int>(stage.total);
    Print("%-24s %s from the cache, %d would run\n", stage.title().c_str(), Counted(stage.from_cache, "item").c_str(),
          all - stage.from_cache);
  }
  const int count = Executed(result);
  if (count == 0) {
    Print("dry run: %s would run: every item is in the cache\n",
          last == JobStage::kReport ? "nothing before the report" : "nothing");
    return;
  }
  Print("dry run: %s would run, and the items that depend on %s up to the stage %s\n", Counted(count, "item").c_str(),
        count == 1 ? "it" : "them", Name(last));
}

nlohmann::json StagesJson(const JobResult& result) {
  nlohmann::json stages = nlohmann::json::array();
  for (const StageCounts& stage : result.stages) {
    stages.push_back(StageSummary(stage));
    stages.back().update({{"from_cache", stage.from_cache}, {"seconds", stage.seconds}});
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

nlohmann::json ResultJson(const JobResult& result, const RunnerOptions& runner, double seconds) {
  return {{"run", DisplayPath(runner.run_folder)},
          {"dry_run", runner.dry_run},
          {"executed", Executed(result)},
          {"dataset", DisplayPath(result.dataset)},
          {"report", DisplayPath(result.report)},
          {"clips", result.counts.clips},
          {"kept", result.counts.kept},
          {"suspect", result.counts.suspect},
          {"excluded", result.counts.excluded},
          {"failed", result.counts.failed},
          {"undecided", result.counts.undecided},
          {"folders", result.counts.folders},
          {"replaces_rotations", result.counts.replaces_rotations},
          {"findings", result.findings},
          {"set_findings", result.set_findings},
          {"fit_error", result.fit_error},
          {"check", result.check},
          {"audit", result.audit},
          {"metrics", result.metrics},
          {"untrained", UntrainedJson(result)},
          {"unevaluated", UnevaluatedJson(result)},
          {"stages", StagesJson(result)},
          {"seconds", seconds}};
}

/// Error of a run that ended without the table that it was to make.
Status CheckEvaluation(const JobResult& result) {
  if (!result.unevaluated) return {};
  const Error& error = *result.unevaluated;
  return Fail(error.code, "the evaluation failed, so there is no table; " + error.what, error.where, error.hint);
}

/// A requested network that was not trained is a failure, whatever the others' results.
Status CheckNetworks(const JobResult& result) {
  if (result.untrained.empty()) return {};
  const auto& [item, error] = *result.untrained.begin();
  const auto failed = static_cast<long long>(result.untrained.size());
  const auto all = static_cast<long long>(result.training.size()) + failed;
  return Fail(ErrorCode::kTooManyFailures,
              std::to_string(failed) + " of " + Counted(all, "network") + (failed == 1 ? " was" : " were") +
                  " not trained; " + item + ": " + error.what,
              error.where, error.hint.empty() ? "see the page of the run" : error.hint);
}

/// " (11 less 2 excluded by rule, 3 failed)": how the clips of a share follow from all; empty where they are all.
std::string OfAllClips(const ClipCounts& counts, bool without_failed) {
  std::string text;
  if (counts.excluded > 0) text = std::to_string(counts.excluded) + " excluded by rule";
  if (without_failed && counts.failed > 0) {
    text += (text.empty() ? "" : ", ") + std::to_string(counts.failed) + " failed";
  }
  return text.empty() ? text : " (" + std::to_string(counts.clips) + " less " + text + ")";
}

/// Checks the share of failures among the clips that were not excluded.
Status CheckFailures(const JobOptions& options, const JobResult& result) {
  if (result.folders_failed > 0) {
    return Fail(ErrorCode::kTooManyFailures, Counted(result.folders_failed, "folder") + " skipped", "run",
                "ingest.source.other_files is error; correct ingest.source.files, or set it to finding or ignore");
  }
  const int wanted = result.counts.clips - result.counts.excluded;
  const double tolerated = options.tolerated_failures * wanted;
  if (wanted == 0 || result.counts.failed <= tolerated) return {};
  return Fail(ErrorCode::kTooManyFailures,
              std::to_string(result.counts.failed) + " of " + Counted(wanted, "clip") + " failed" +
                  OfAllClips(result.counts, false) + ", tolerated_failures is " +
                  Counted(static_cast<long long>(std::floor(tolerated)), "clip"),
              "run",
              std::string("curation_log.jsonl has the reason of each") +
                  (result.dataset.empty() ? "" : "; the other clips are in the dataset"));
}

/// Checks the share of clips with a finding of severity error among the processed ones.
Status CheckSuspectShare(const JobOptions& options, const JobResult& result) {
  const int all = result.counts.kept + result.counts.undecided;
  const double tolerated = options.tolerated_suspect * all;
  if (all == 0 || result.counts.suspect <= tolerated) return {};
  return Fail(
      ErrorCode::kTooManyFailures,
      std::to_string(result.counts.suspect) + " of " + Counted(all, "clip") +
          (result.counts.suspect == 1 ? " is" : " are") + " suspect" + OfAllClips(result.counts, true) +
          ", tolerated_suspect is " + Counted(static_cast<long long>(std::floor(tolerated)), "clip"),
      "run",
      "they contradict the source declaration or fail a check, see curation_log.jsonl; correct the declaration, or "
      "set tolerated_suspect: 1");
}

RunnerOptions RunnerOptionsOf(const CommonArguments& common, const RunArguments& arguments, const JobOptions& job,
                              const std::filesystem::path& folder) {
  RunnerOptions options;
  options.run_folder = folder;
  options.jobs = arguments.jobs;
  options.dry_run = arguments.dry_run;
  options.quiet = common.quiet;
  options.time_factor = std::max(1.0, arguments.budget);
  LimitItems(job.pipeline, options);
  return options;
}

/// The job's duration is only known for the whole of it.
void LogDuration(const JobOptions& options, JobStage last) {
  if (options.takes.empty()) return;
  if (last == JobStage::kReport) {
    LogInfo(options.name + " takes " + options.takes);
  } else {
    LogInfo(options.name + " as a whole takes " + options.takes + "; this run ends after the stage " + Name(last));
  }
}

/// Runs the job, prints its result and determines the exit status.
Status Perform(CommonArguments& common, const JobOptions& options, JobStage last, Runner& runner) {
  const auto started = std::chrono::steady_clock::now();
  const auto result = RunMainJob(options, last, runner);
  if (!result) return Forward(result);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  if (AnswersInText(common, ResultJson(*result, runner.options(), seconds))) {
    runner.options().dry_run ? PrintPlan(*result, last) : PrintResult(*result, seconds);
  }
  if (Status evaluation = CheckEvaluation(*result); !evaluation) return evaluation;
  if (Status networks = CheckNetworks(*result); !networks) return networks;
  if (Status failures = CheckFailures(options, *result); !failures) return failures;
  return CheckSuspectShare(options, *result);
}

/// A run over several sets: prints each, then the table over all.
Status RunSetsVerb(CommonArguments& common, const RunArguments& arguments, const LoadedJob& job, JobStage last,
                   SetsOfRun* sets_of_run) {
  const auto folder = RunFolder(arguments.output, job.options.name);
  if (!folder) return Forward(folder);
  if (Status ours = CheckRunFolder(*folder, job, arguments.replace); !ours) return ours;
  const RunnerOptions settings = RunnerOptionsOf(common, arguments, job.options, *folder);
  RunFile file(job, arguments.budget, last, settings.run_folder);
  if (!arguments.dry_run) {
    if (Status made = MakeFolder(settings.run_folder); !made) return made;
    if (Status begun = file.Begin(); !begun) return begun;
  }
  const auto started = std::chrono::steady_clock::now();
  const auto run = RunOverSets(job.options, last, arguments.budget, settings);
  Status outcome = run ? Status() : Forward(run);
  if (run) {
    if (sets_of_run != nullptr) {
      for (const SetResult& set : run->sets) {
        std::vector<std::string>& findings = sets_of_run->done[set.set.name];
        for (const Finding& finding : set.result.set_findings) {
          if (finding.severity != Severity::kInfo) findings.push_back(finding.message);
        }
      }
      for (const auto& [name, error] : run->failed) sets_of_run->failed[name] = error.Message();
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    nlohmann::json sets = nlohmann::json::object();
    for (const SetResult& set : run->sets) {
      RunnerOptions own = settings;
      own.run_folder = settings.run_folder / "data" / set.set.name;
      sets[set.set.name] = ResultJson(set.result, own, seconds);
    }
    const bool in_text =
        AnswersInText(common, {{"run", DisplayPath(settings.run_folder)}, {"sets", sets}, {"table", run->table}});
    for (const SetResult& set : run->sets) {
      if (in_text && !arguments.dry_run) {
        Print("\n%s%s\n", set.set.name.c_str(), set.substitute ? " (substitute: synthetic motions)" : "");
        PrintResult(set.result, seconds);
      }
      if (outcome) outcome = CheckEvaluation(set.result);
      if (outcome) outcome = CheckNetworks(set.result);
    }
    if (outcome && !run->failed.empty()) {
      const auto& [name, error] =
          run->failed.front();  // a failed set does not stop the others; a single set's error is the run's
      const ErrorCode code = run->sets.empty() ? error.code : ErrorCode::kTooManyFailures;
      outcome = Fail(code, "set " + name + " (--data " + name + "=PATH): " + error.what, error.where, error.hint);
    }
  }
  if (arguments.dry_run) return outcome;
  const Status ended = file.End(outcome);
  return outcome ? ended : outcome;
}

}  // namespace

Status RunVerb(CommonArguments& common, const RunArguments& arguments, SetsOfRun* sets_of_run) {
  ChooseBlasKernels();
  auto job = LoadJob(arguments.config, arguments.assignments, {common.allow_include});
  if (!job) return Forward(job);
  if (!arguments.executor.empty())
    job->options.executor = arguments.executor == "slurm" ? Executor::kSlurm : Executor::kLocal;
  const auto last = JobStageFromName(arguments.to.empty() ? "report" : arguments.to);
  if (!last) return Forward(last);
  if (Status given = TakeData(arguments.data, job->options); !given) return given;
  if (Status sets = ResolveDataSets(job->options.data); !sets) return sets;
  if (Status named = CheckNames(job->options, *last); !named) return named;

  if (job->options.executor == Executor::kSlurm && !arguments.dry_run) return SlurmRunVerb(common, arguments, *job);
  if (!job->options.data.empty()) return RunSetsVerb(common, arguments, *job, *last, sets_of_run);
  if (Status scaled = ScaleTraining(arguments.budget, job->options.train); !scaled) return scaled;
  const auto folder = RunFolder(arguments.output, job->options.name);
  if (!folder) return Forward(folder);
  if (Status ours = CheckRunFolder(*folder, *job, arguments.replace); !ours) return ours;
  const RunnerOptions options = RunnerOptionsOf(common, arguments, job->options, *folder);
  const bool in_job = std::getenv("SLURM_JOB_ID") != nullptr;
  if (const auto on_slurm = SlurmRun::Open(*folder); on_slurm && !on_slurm->Outcome() && !in_job)
    LogWarning("jobs of Slurm may be at work on this run: mocurate jobs " + DisplayPath(*folder));
  if (!arguments.dry_run) {
    LogDuration(job->options, *last);
    if (Status made = MakeFolder(options.run_folder); !made) return made;
  }
  auto runner = Runner::Make(options);
  if (!runner) return Forward(runner);
  if (arguments.dry_run) return Perform(common, job->options, *last, **runner);

  RunFile file(*job, arguments.budget, *last, options.run_folder);
  if (Status begun = file.Begin(); !begun) return begun;
  Status outcome = Perform(common, job->options, *last, **runner);
  const Status ended = file.End(outcome);
  return outcome ? ended : outcome;
}

}  // namespace mocurate
