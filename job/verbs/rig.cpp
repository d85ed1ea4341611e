#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "fitting/options.h"
#include "fitting/stages.h"
#include "job/config_loading.h"
#include "job/job_checks.h"
#include "job/job_items.h"
#include "job/machine.h"
#include "job/main_job.h"
#include "job/run_folder.h"
#include "job/stage_runs.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// A job whose evidence is keypoints of several cameras.
Expected<JobOptions> RigJobOf(const RigAuditArguments& arguments, const ConfigRules& rules) {
  Expected<LoadedJob> job = LoadJob(arguments.config, arguments.assignments, rules);
  if (!job) return Forward(job);
  JobOptions options = std::move(job->options);
  const auto refused = [](const std::string& what, const std::string& where, const char* hint) {
    return Fail(ErrorCode::kConfig, what, where, hint);
  };
  if (!options.data.empty()) {
    return refused("the job is about several sets", "data", "name the config of one set");
  }
  if (!options.fitting.keypoints.rig.empty()) {
    LogWarning("fitting.keypoints.rig is not used: the audit is of the calibration, not of an earlier audit's file");
    options.fitting.keypoints.rig.clear();
  }
  if (Status named = CheckNames(options, JobStage::kProportions); !named) return Forward(named);
  const FitMethod method = options.fitting.method;
  if (method != FitMethod::kKeypoints && method != FitMethod::kKeypointsAndClouds) {
    const ConfigNode* fitting = job->node.Find("fitting");
    const ConfigNode* written = fitting == nullptr ? nullptr : fitting->Find("method");
    const std::string where = written == nullptr ? "" : written->origin.Text() + ": ";
    return refused("only rigs of keypoint cameras are written to files; the method is " +
                       OptionsToJson(options.fitting).at("method").get<std::string>(),
                   where + "fitting.method",
                   "audit a configuration of keypoints, with method keypoints or keypoints_and_clouds; depth cameras "
                   "are audited in each fit, see fitting.point_clouds.audit");
  }
  return options;
}

/// Checks before any work that the output can be written.
Status CheckRigOutput(const fs::path& output) {
  std::error_code unknown;
  if (output.empty() || fs::is_directory(output, unknown)) {
    return Fail(ErrorCode::kUsage, output.empty() ? "the output has no name" : "the output is a folder",
                output.empty() ? "-o" : DisplayPath(output), "name a file, as -o rig.yaml");
  }
  const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
  if (fs::is_directory(folder, unknown) && access(folder.c_str(), W_OK) == 0) return {};
  return Fail(ErrorCode::kCannotWrite,
              fs::is_directory(folder, unknown) ? "the folder of the output is read-only"
                                                : "the folder of the output does not exist",
              DisplayPath(output), "make the folder, or name another file with -o");
}

/// Evidence of the stage `ingest`, by item.
std::vector<StageInput> EvidenceOf(const JobResult& result) {
  std::vector<StageInput> evidence;
  for (const ClipRecord& clip : result.clips) {
    if (!clip.evidence.artifact.empty()) evidence.push_back(InputFrom("evidence", clip.evidence));
  }
  return evidence;
}

/// Why the first clip could not be read.
Error WhyNoEvidence(const JobResult& result, const JobOptions& options) {
  for (const ClipRecord& clip : result.clips) {
    if (clip.ended() == nullptr || clip.ended()->outcome.error.what.empty()) continue;
    Error error = clip.ended()->outcome.error;
    if (error.where.empty()) error.where = clip.item;
    return error;
  }
  return {ErrorCode::kInconsistent, "no take could be read", DisplayPath(options.ingest.path), ""};
}

void PrintRig(const nlohmann::json& summary, const fs::path& output) {
  for (const auto& [name, camera] : summary.at("cameras").items()) {
    std::string line = name + ": " + camera.at("verdict").get<std::string>();
    const double moved = camera.at("moved_mm").get<double>(), turned = camera.at("rotated_deg").get<double>();
    if (moved > 0.0 || turned > 0.0) {
      line += ", " + RoundedText(moved, 3) + " mm and " + RoundedText(turned, 2) + " degrees from its calibrated pose";
    }
    if (const double clock = camera.at("clock_ms").get<double>(); clock != 0.0) {
      line += ", clock offset " + RoundedText(clock, 3) + " ms";
    }
    if (const std::string files = camera.at("files_of").get<std::string>(); files != name) {
      line += ", its keypoints are in the files of " + files;
    }
    if (const double scale = camera.at("pixel_scale").get<double>(); scale != 1.0) {
      line += ", pixels times " + RoundedText(scale, 3);
    }
    if (const double unit = camera.at("unit_scale").get<double>(); unit != 1.0) {
      line += ", lengths of the calibration divided by " + RoundedText(unit, 4);
    }
    if (camera.at("mirrored").get<bool>()) line += ", mirrored";
    if (camera.at("sides_exchanged").get<bool>()) line += ", left and right exchanged";
    if (!camera.at("confidence").is_null()) {
      const std::string of = camera.at("confidence_of").get<std::string>();
      const std::string percent = RoundedText(100.0 * camera.at("confidence").get<double>(), 4) + " %";
      line += "; confidence " + percent;
      if (of != "model") line += of == "takes" ? " between takes" : " within this take";
    }
    Print("%s\n", line.c_str());
  }
  const nlohmann::json& takes = summary.at("takes");
  for (const nlohmann::json& take : takes) {
    if (takes.size() == 1) break;
    std::string line;
    for (const auto& [camera, verdict] : take.at("verdicts").items()) {
      if (verdict != "kept") line += (line.empty() ? "" : ", ") + camera + " " + verdict.get<std::string>();
    }
    if (take.at("verdicts").empty()) line = "no verdicts of its own";
    Print("%s alone: %s\n", take.at("name").get<std::string>().c_str(), line.empty() ? "all kept" : line.c_str());
  }
  for (const auto& [test, action] : summary.at("audit").items()) {
    if (action == "off") Print("not tested, because fitting.keypoints.audit.%s is off\n", test.c_str());
  }
  Print("%s in %s\n", Counted(static_cast<long long>(takes.size()), "take").c_str(), DisplayPath(output).c_str());
}

}  // namespace

Status RigAuditVerb(CommonArguments& common, const RigAuditArguments& arguments) {
  ChooseBlasKernels();
  if (Status named = CheckRigOutput(arguments.output); !named) return named;
  if (Status free = CheckOutputs({arguments.output}, {arguments.config}, arguments.force); !free) return free;
  const Expected<JobOptions> options = RigJobOf(arguments, {common.allow_include});
  if (!options) return Forward(options);
  auto stages = VerbStages::Make(common, arguments.jobs);
  if (!stages) return Forward(stages);
  const Expected<JobResult> result = RunMainJob(*options, JobStage::kIngest, (*stages)->runner(), arguments.clips);
  if (!result) return Forward(result);
  const RigStageOptions of_rig{arguments.config.filename().string(), options->fitting.skeleton,
                               options->fitting.keypoints};
  ItemSpec item{"rig", OptionsToJson(of_rig), EvidenceOf(*result)};
  if (item.inputs.empty()) return tl::unexpected<Error>(WhyNoEvidence(*result, *options));
  item.inputs.push_back(SkeletonInput(options->fitting.skeleton));
  const Expected<ItemResult> rig = (*stages)->One(RigDeclaration(), std::move(item));
  if (!rig) return Forward(rig);
  if (Status copied = CopyWhole(rig->artifact, arguments.output); !copied) return copied;
  WarnOf(rig->outcome.findings);
  nlohmann::json answer = rig->summary;
  answer["rig"] = DisplayPath(arguments.output);
  answer["findings"] = rig->outcome.findings;
  if (AnswersInText(common, answer)) PrintRig(rig->summary, arguments.output);
  if (result->counts.failed == 0) return {};
  Error error = WhyNoEvidence(*result, *options);
  error.what = Counted(result->counts.failed, "take") + " could not be read; the first: " + error.what;
  error.code = ErrorCode::kTooManyFailures;
  return tl::unexpected<Error>(error);
}

}  // namespace mocurate
