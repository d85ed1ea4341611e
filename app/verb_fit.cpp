#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "app/blas_kernels.h"
#include "app/config_loading.h"
#include "app/fit_answer.h"
#include "app/job_checks.h"
#include "app/main_job.h"
#include "app/motion_files.h"
#include "app/named_configs.h"
#include "app/output_checks.h"
#include "app/scratch_folder.h"
#include "app/verbs.h"
#include "canon/recipes/classes.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/geometry/axes.h"
#include "core/store/store.h"
#include "ingest/formats/driver.h"
#include "ingest/sense/inspect.h"
#include "ingest/sense/source_declaration.h"
#include "ingest/unnamed_files.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// How the files are declared, and what is still unknown of them.
struct Declared {
  ConfigSource config;
  std::vector<std::string> unknown;  ///< options of ingest.source
  fs::path path;                     ///< where they stand, if not where was asked for: the folder above
};

/// What was guessed of numbers that no format names, unless the command line says it.
void TellGuesses(const FitArguments& arguments, const Inspection& inspection) {
  const std::set<std::string> telling = {"least_confidence", "columns", "layout"};
  for (const std::string& text : arguments.assignments)
    if (text.rfind("ingest.source.", 0) == 0 && telling.count(text.substr(14, text.find('=') - 14)) != 0) return;
  for (const Finding& finding : inspection.findings) {
    if (finding.code != "confidence_guessed") continue;
    return LogWarning(finding.clip + ": " + finding.message);
  }
}

Expected<Declared> Declare(const FitArguments& arguments) {
  if (!arguments.source.empty()) {
    const Expected<ConfigSource> source = SourceOf(arguments.source);
    if (!source) return Forward(source);
    return Declared{*source, {}, {}};
  }
  if (IsMotionStore(arguments.path)) return Declared{MotionStoreConfig(arguments.path), {}, {}};
  Inspection inspection = InspectPath(arguments.path, std::nullopt);
  if (Status known = ChooseClips(arguments.clips, inspection); !known) return Forward(known);
  const Expected<WrittenDeclaration> written = DeclareSource(inspection, arguments.path, "fit");
  if (!written) return Forward(written);
  TellGuesses(arguments, inspection);
  for (const std::string& other : written->others) {
    LogWarning(DisplayPath(arguments.path) + ": " + other + " stay out, they are another source's; --clip chooses one");
  }
  return Declared{{written->yaml, "what the files show", fs::current_path()}, written->unknown, written->path};
}

/// What nothing tells has to be told.
Status CheckUnknown(const FitArguments& arguments, const Declared& declared) {
  std::vector<std::string> open;
  for (const std::string& option : declared.unknown) {
    const std::string key = "ingest.source." + option + "=";
    const bool told = std::any_of(arguments.assignments.begin(), arguments.assignments.end(),
                                  [&](const std::string& assignment) { return assignment.rfind(key, 0) == 0; });
    if (!told) open.push_back(option);
  }
  if (open.empty()) return {};
  std::string names, example;
  for (const std::string& option : open) {
    names += (names.empty() ? "" : ", ") + option;
    const char* value = option == "rate" ? "'30 Hz'" : option == "axes" ? "AXES" : option == "units" ? "m" : "...";
    example += (example.empty() ? "" : " ") + std::string("--set ingest.source.") + option + "=" + value;
  }
  const bool axes = std::find(open.begin(), open.end(), "axes") != open.end();
  return Fail(ErrorCode::kUsage, "nothing in the files tells " + names, DisplayPath(arguments.path),
              "take --source with the name of a source declaration or a config, or add " + example +
                  (axes ? "; AXES says where the file's x, y and z point for a person who faces +z with the left at "
                          "+x, such as '-x +y -z' (docs/conventions.md): wrong ones mirror the person"
                        : "") +
                  "; `mocurate inspect` shows why");
}

/// Whether the clips come with rotations. Motions of a store have them or not.
bool HasRotations(const IngestOptions& ingest) {
  const FormatDriver& driver = DriverOf(ingest.source.format);
  if (!driver.stored) return driver.rotations;
  return HasStoredRotations(ingest.path);
}

bool IsAssigned(const FitArguments& arguments, const std::string& option) {
  return std::any_of(arguments.assignments.begin(), arguments.assignments.end(),
                     [&](const std::string& text) { return text.rfind(option + "=", 0) == 0; });
}

/// Where nothing tells who performs, each recording is of a body of its own. `unnamed`: nor does its declaration.
void ChooseBodies(const FitArguments& arguments, bool unnamed, JobOptions& options) {
  if (!(arguments.source.empty() || unnamed) || options.ingest.source.person != kUnknownPerson) return;
  if (!IsAssigned(arguments, "proportions.body_of")) options.proportions.body_of = BodyOf::kRecording;
}

/// Evidence and skeleton as the command line and the files have them.
Status ChooseMethod(const FitArguments& arguments, JobOptions& options) {
  if (IsAssigned(arguments, "fitting.method")) return {};
  options.fitting.method = MethodFor(GivesOf(options.ingest.source));
  if (!HasRotations(options.ingest) || !arguments.skeleton.empty()) return {};
  if (!options.fitting.contacts.remove_sliding) {
    return Fail(ErrorCode::kUsage, "the motion has rotations already: there is nothing to fit",
                DisplayPath(arguments.path),
                "--skeleton NAME fits another skeleton to its joints, --contacts removes foot sliding");
  }
  options.fitting.method = FitMethod::kNone;
  return {};
}

/// Axes that nobody told and that mirror: the files show left and right exchanged, which names may be as well.
void TellOfMirror(const FitArguments& arguments, const SourceOptions& source) {
  const bool told = !arguments.source.empty() ||
                    std::any_of(arguments.assignments.begin(), arguments.assignments.end(),
                                [](const std::string& text) { return text.rfind("ingest.source.axes=", 0) == 0; });
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (told || !axes || axes->handedness() == Handedness::kRight) return;
  AxisConvention right = *axes;
  right.canonical_from_source.col(0) *= -1.0;
  LogWarning(DisplayPath(arguments.path) +
             ": by their names left and right are exchanged: read as a left-handed world, axes '" + source.axes +
             "', which mirrors it; if the names are wrong instead, mend them, or keep them as they are with --set "
             "ingest.source.axes='" +
             right.Text() + "'");
}

Expected<JobOptions> FitOptionsOf(const FitArguments& arguments) {
  const Expected<Declared> declared = Declare(arguments);
  if (!declared) return Forward(declared);
  if (Status known = CheckUnknown(arguments, *declared); !known) return Forward(known);
  for (const std::string& assignment : arguments.assignments) {
    for (const char* group : {"canon.", "assemble.", "audit.", "train.", "evaluate.", "report."}) {
      if (assignment.rfind(group, 0) != 0) continue;
      return Fail(ErrorCode::kUsage, "'" + assignment + "' does nothing here: this verb ends with the fit", "--set",
                  "`mocurate run` with a job goes on; `mocurate config init` writes one");
    }
  }
  std::error_code unknown;
  const fs::path path = fs::absolute(arguments.path, unknown).lexically_normal();
  // The method is chosen below: a declaration keeps recorded rotations, this verb may be asked to fit others.
  std::vector<std::string> assignments = {"ingest.path=.", "fitting.other_joints=leave_out",
                                          "fitting.method=joint_tracks"};
  if (!arguments.skeleton.empty()) assignments.push_back("skeleton=" + arguments.skeleton);
  if (arguments.contacts) assignments.push_back("fitting.contacts.remove_sliding=true");
  assignments.insert(assignments.end(), arguments.assignments.begin(), arguments.assignments.end());
  Expected<LoadedJob> job = LoadJob(declared->config, assignments);
  if (!job) return Forward(job);
  JobOptions options = std::move(job->options);
  // Not by way of YAML: a path may hold any bytes.
  options.ingest.path = declared->path.empty() || fs::is_regular_file(path, unknown) ? path : declared->path;
  std::optional<std::string> unnamed;
  if (!IsMotionStore(path)) unnamed = TakeUnnamed(IsAssigned(arguments, "ingest.source.files"), options.ingest);
  if (unnamed) LogInfo(*unnamed);
  if (!IsMotionStore(path)) TellOfMirror(arguments, options.ingest.source);
  if (Status chosen = ChooseMethod(arguments, options); !chosen) return Forward(chosen);
  ChooseBodies(arguments, unnamed.has_value(), options);
  if (Status named = CheckNames(options, JobStage::kFitting); !named) return Forward(named);
  return options;
}

/// The fits of a run as one dataset, sorted by id.
Expected<Dataset> Gather(const StageReport& fits, const std::vector<std::string>& label_order) {
  Dataset whole;
  whole.created_by = CreatedBy();
  whole.recipe = "mocurate fit";
  for (const ItemResult& item : fits.items) {
    if (item.artifact.empty()) continue;
    Expected<Dataset> part = ReadDataset(item.artifact);
    if (!part) return Forward(part);
    whole.skeleton = part->skeleton;
    whole.joints_only = part->joints_only;
    std::move(part->clips.begin(), part->clips.end(), std::back_inserter(whole.clips));
    std::move(part->findings.begin(), part->findings.end(), std::back_inserter(whole.findings));
  }
  std::sort(whole.clips.begin(), whole.clips.end(), [](const Clip& a, const Clip& b) { return a.id() < b.id(); });
  std::set<std::string> labels;
  for (const Clip& clip : whole.clips) labels.insert(clip.label);
  whole.labels = OrderedLabels(label_order, labels);
  return whole;
}

/// Why clips could not be fitted, each reason once; never empty.
std::vector<Error> Failures(const JobResult& result) {
  std::vector<Error> failures;
  std::set<std::string> told;
  for (const StageReport& stage : result.stages) {
    for (const ItemResult& item : stage.items) {
      if (!item.artifact.empty() || item.outcome.error.what.empty()) continue;
      Error error = item.outcome.error;
      if (error.where.empty()) error.where = item.item;
      if (told.insert(error.Message()).second) failures.push_back(std::move(error));
    }
  }
  if (failures.empty()) failures.push_back({ErrorCode::kInconsistent, "nothing could be fitted", "", ""});
  return failures;
}

/// The first failure is what the verb ends with; the others are told before.
Error FirstFailure(const JobResult& result) {
  const std::vector<Error> failures = Failures(result);
  for (std::size_t i = 1; i < failures.size(); ++i) LogWarning(failures[i].Message());
  return failures[0];
}

/// What is said of clips that were fitted and are doubtful.
std::string DoubtsOf(int clips) {
  const bool one = clips == 1;
  return Counted(clips, "clip") + (one ? " contradicts" : " contradict") + " what is declared of the source, or " +
         (one ? "fails" : "fail") + " a check";
}

}  // namespace

Status FitVerb(CommonArguments& common, const FitArguments& arguments) {
  ChooseBlasKernels();
  std::error_code unknown;
  if (!fs::exists(arguments.path, unknown)) {
    return Fail(ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(arguments.path));
  }
  if (Status free = CheckOutputs({arguments.output}, {arguments.path}, arguments.force); !free) return free;
  const Expected<JobOptions> options = FitOptionsOf(arguments);
  if (!options) return Forward(options);
  const ScratchFolder scratch;
  RunnerOptions settings;
  settings.run_folder = scratch.path();
  settings.jobs = arguments.jobs;
  settings.quiet = common.quiet;
  settings.tell_failures = false;
  if (settings.run_folder.empty()) {
    return ScratchFolder::Missing();
  }
  auto runner = Runner::Make(settings);
  if (!runner) return Forward(runner);
  const Expected<JobResult> result = RunMainJob(*options, JobStage::kFitting, **runner, arguments.clips);
  if (!result) return Forward(result);
  const auto fits = std::find_if(result->stages.begin(), result->stages.end(),
                                 [](const StageReport& stage) { return stage.stage == "fitting"; });
  const bool any =
      fits != result->stages.end() && std::any_of(fits->items.begin(), fits->items.end(),
                                                  [](const ItemResult& item) { return !item.artifact.empty(); });
  if (!any) return tl::unexpected<Error>(FirstFailure(*result));
  const Expected<Dataset> whole = Gather(*fits, options->assemble.label_order);
  if (!whole) return Forward(whole);
  if (Status written = WriteDataset(*whole, arguments.output); !written) return written;
  if (common.json) {
    common.answered = true;
    std::printf("%s\n", AnswerOf(*result, *fits, arguments.output)
                            .dump(1, ' ', false, nlohmann::json::error_handler_t::replace)
                            .c_str());
  } else {
    for (const ItemResult& item : fits->items) {
      if (!item.artifact.empty()) PrintFit(*result, item);
    }
    PrintSharedBodies(*result);
    std::printf("%s in %s\n", Counted(static_cast<long long>(whole->clips.size()), "clip").c_str(),
                DisplayPath(arguments.output).c_str());
  }
  if (result->counts.failed == 0 && result->counts.doubtful == 0) return {};
  if (result->counts.failed == 0) {
    return Fail(ErrorCode::kTooManyFailures, DoubtsOf(result->counts.doubtful), DisplayPath(arguments.path),
                "the findings above say which; the fits were written all the same");
  }
  Error error = FirstFailure(*result);
  error.code = ErrorCode::kTooManyFailures;
  error.what = Counted(result->counts.failed, "clip") + " could not be fitted; the first: " + error.what;
  return tl::unexpected<Error>(error);
}

}  // namespace mocurate
