#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <set>

#include "canon/recipes/classes.h"
#include "canon/values/set_files.h"
#include "canon/values/subset.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/geometry/axes.h"
#include "core/store/store.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/inspect.h"
#include "ingest/inspect/source_declaration.h"
#include "ingest/relaxed_pattern.h"
#include "job/config_loading.h"
#include "job/job_checks.h"
#include "job/machine.h"
#include "job/main_job.h"
#include "job/motion_files.h"
#include "job/named_configs.h"
#include "job/stage_runs.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// Findings of ingest about the clip, then those of its fit.
std::vector<Finding> FindingsOf(const ClipRecord& clip) {
  std::vector<Finding> findings;
  if (clip.evidence.sha256 != clip.motion.sha256) findings = clip.evidence.outcome.findings;
  findings.insert(findings.end(), clip.motion.outcome.findings.begin(), clip.motion.outcome.findings.end());
  return findings;
}

/// Repairs and exclusions before the fit, with their number of frames; the clip's findings have the places.
void PrintRepairs(const ItemResult& item) {
  std::map<std::string, std::set<int>> frames;
  for (const Finding& finding : item.outcome.findings) {
    if (finding.action != FindingAction::kRepaired && finding.action != FindingAction::kMissing) continue;
    for (int f = finding.frame_begin; f < finding.frame_end; ++f) frames[finding.code].insert(f);
  }
  std::string text;
  for (const auto& [code, of_code] : frames) {
    if (of_code.empty()) continue;
    text += (text.empty() ? "" : ", ") + code + " in " + Counted(static_cast<long long>(of_code.size()), "frame");
  }
  if (!text.empty()) Print("  repaired: %s (places: see the clip's findings)\n", text.c_str());
}

/// Clips fitted as one body: the body's name and their number, for several clips.
std::map<std::string, int> SharedBodies(const JobResult& result) {
  std::map<std::string, int> shared;
  for (const auto& [body, item] : result.bodies) {
    const int clips = item.summary.value("clips", 0);
    if (clips > 1) shared[body] = clips;
  }
  return shared;
}

bool IsFitted(const ClipRecord& clip) { return !clip.motion.artifact.empty(); }

/// Prints a fitted clip: residuals, changes, findings.
void PrintFit(const ClipRecord& clip) {
  const nlohmann::json fit = clip.motion.summary;
  Print("%s\n", clip.item.c_str());
  const auto number = [](const nlohmann::json& from, const char* key) {
    return from.is_object() && from.contains(key) && from[key].is_number() ? from[key].get<double>() : 0.0;
  };
  if (fit.value("method", "none") != "none") {
    if (const auto check = fit.find("check"); check != fit.end()) {
      Print("  also solved by %s: joints %.3g mm apart at most, cost %.2g\n", check->value("solver", "").c_str(),
            number(*check, "joint_worst_mm"), number(*check, "cost_difference"));
    }
    Print("  residual %.1f mm RMS, %.1f mm 95 %%, %.1f %% rejected\n", number(fit, "residual_rms_mm"),
          number(fit, "residual_p95_mm"), 100.0 * number(fit, "rejected_share"));
  }
  if (fit.contains("before")) {
    const nlohmann::json& before = fit["before"];
    const nlohmann::json& after = fit["after"];
    Print("  bones change by %.1f -> %.1f mm, jerk %.0f -> %.0f m/s3\n", number(before, "bone_spread_mm"),
          number(after, "bone_spread_mm"), number(before, "jerk"), number(after, "jerk"));
  }
  if (fit.contains("contacts")) {
    const nlohmann::json& contacts = fit["contacts"];
    Print(
        "  standing feet slide %.3f -> %.3f m/s, the fastest %.2f -> %.2f (they stand %.0f %% of the time); the "
        "largest change is %.0f mm (%s, "
        "frame %d), %.1f degrees\n",
        number(contacts, "sliding_before"), number(contacts, "sliding_after"), number(contacts, "fastest_before"),
        number(contacts, "fastest_after"), 100.0 * number(contacts, "contact_share"),
        number(contacts, "largest_shift_mm"), contacts.value("joint", "").c_str(), contacts.value("frame", 0),
        number(contacts, "largest_turn_deg"));
  }
  PrintRepairs(clip.motion);
  for (const Finding& finding : FindingsOf(clip)) {
    if (finding.severity == Severity::kInfo) continue;
    const char* mark = finding.severity == Severity::kError ? "error: " : "";
    Print("  %s%s: %s\n", mark, finding.code.c_str(), finding.message.c_str());
  }
}

/// Prints the bodies shared by several clips.
void PrintSharedBodies(const JobResult& result) {
  for (const auto& [body, clips] : SharedBodies(result)) {
    Print("%s were measured as one body, %s (--set proportions.body_of=recording measures each separately)\n",
          Counted(clips, "clip").c_str(), body.c_str());
  }
}

/// {"output", "clips": [{"clip", "fitted", "error", "fit", "findings"}], "findings": `of_set`, "shared_bodies": {body:
/// clips}, "failed"}
nlohmann::json AnswerOf(const JobResult& result, const std::filesystem::path& output,
                        const std::vector<Finding>& of_set) {
  nlohmann::json clips = nlohmann::json::array();
  for (const ClipRecord& clip : result.clips) {
    if (clip.motion.item.empty()) continue;
    nlohmann::json findings = nlohmann::json::array();
    for (const Finding& finding : FindingsOf(clip)) {
      findings.push_back({{"code", finding.code},
                          {"severity", std::string(Name(finding.severity))},
                          {"message", finding.message},
                          {"value", finding.value}});
    }
    clips.push_back({{"clip", clip.item},
                     {"fitted", IsFitted(clip)},
                     {"error", IsFitted(clip) ? std::string() : clip.motion.outcome.error.Message()},
                     {"fit", clip.motion.summary},
                     {"findings", findings}});
  }
  return {{"output", DisplayPath(output)},
          {"clips", clips},
          {"findings", of_set},
          {"shared_bodies", SharedBodies(result)},
          {"failed", result.counts.failed}};
}

/// Declaration of the files, and options that are still unknown.
struct Declared {
  ConfigSource config;
  std::vector<std::string> unknown;  ///< options of ingest.source
};

bool IsAssigned(const FitArguments& arguments, const std::string& option) {
  return std::any_of(arguments.assignments.begin(), arguments.assignments.end(),
                     [&](const std::string& text) { return text.rfind(option + "=", 0) == 0; });
}

/// `findings`: what is left out.
Expected<Declared> Declare(const FitArguments& arguments, std::vector<Finding>& findings) {
  if (!arguments.source.empty()) {
    const Expected<ConfigSource> source = SourceOf(arguments.source);
    if (!source) return Forward(source);
    return Declared{*source, {}};
  }
  if (const auto beside = DeclarationBeside(arguments.path)) {
    const Expected<ConfigSource> source = SourceOf(beside->string());
    if (!source) return Forward(source);
    return Declared{*source, {}};
  }
  if (IsMotionStore(arguments.path)) return Declared{MotionStoreConfig(arguments.path), {}};
  Inspection inspection = InspectPath(arguments.path, std::nullopt);
  if (Status known = ChooseClips(arguments.clips, inspection); !known) return Forward(known);
  const Expected<WrittenDeclaration> written = DeclareSource(inspection, arguments.path, "fit", NamesOfClips::kNone);
  if (!written) return Forward(written);
  for (const std::string& other : written->others) {
    findings.push_back(MakeFinding(
        "other_sources", Severity::kWarning, 0.0,
        DisplayPath(arguments.path) + ": " + other + " belong to other sources and are skipped; choose one with --clip",
        FindingAction::kExcluded));
  }
  return Declared{{written->yaml, "what the files show", fs::current_path()}, written->unknown};
}

/// Every unknown option must be declared on the command line.
Status CheckUnknown(const FitArguments& arguments, const Declared& declared) {
  std::vector<std::string> open;
  for (const std::string& option : declared.unknown) {
    if (!IsAssigned(arguments, "ingest.source." + option)) open.push_back(option);
  }
  if (open.empty()) return {};
  std::string example;
  for (const std::string& option : open) {
    const char* value = option == "rate"      ? "'30 Hz'"
                        : option == "axes"    ? "AXES"
                        : option == "units"   ? "m"
                        : option == "columns" ? "'[x, y, z, confidence]'"
                                              : "...";
    example += (example.empty() ? "" : " ") + std::string("--set ingest.source.") + option + "=" + value;
  }
  const bool axes = std::find(open.begin(), open.end(), "axes") != open.end();
  return Fail(
      ErrorCode::kUsage, "the files do not declare " + JoinTexts(open), DisplayPath(arguments.path),
      "give --source with the name of a source declaration or a config, or add " + example +
          (axes ? "; AXES are the directions of the file's x, y and z for a person who faces +z with the left at "
                  "+x, e.g. '-x +y -z' (docs/conventions.md); wrong axes mirror the person"
                : "") +
          "; see `mocurate inspect`");
}

/// Whether the clips have rotations. Motions of a dataset or MotionSet may or may not.
bool HasRotations(const IngestOptions& ingest) {
  const FormatDriver& driver = DriverOf(ingest.source.format);
  if (!driver.stored) return driver.rotations;
  return HasStoredRotations(ingest.path);
}

/// Without a known person, each recording is a body of its own. `unnamed`: the declaration does not name one either.
void ChooseBodies(const FitArguments& arguments, bool unnamed, JobOptions& options) {
  if (!(arguments.source.empty() || unnamed) || options.ingest.source.person != kUnknownPerson) return;
  if (!IsAssigned(arguments, "proportions.body_of")) options.proportions.body_of = BodyOf::kRecording;
}

/// Method and skeleton, from the command line and the files.
Status ChooseMethod(const FitArguments& arguments, JobOptions& options) {
  if (IsAssigned(arguments, "fitting.method")) return {};
  options.fitting.method = MethodFor(EvidenceKindOf(options.ingest.source));
  if (!HasRotations(options.ingest) || !arguments.skeleton.empty()) return {};
  if (!options.fitting.contacts.remove_sliding) {
    return Fail(ErrorCode::kUsage, "the motion has rotations already, so there is nothing to fit",
                DisplayPath(arguments.path),
                "use --skeleton NAME to fit another skeleton to its joints, or --contacts to remove foot sliding");
  }
  options.fitting.method = FitMethod::kNone;
  return {};
}

/// Estimated axes that mirror: the files show left and right exchanged, and their joint names may be wrong instead.
std::optional<Finding> FindMirror(const FitArguments& arguments, const SourceOptions& source) {
  const bool axes_declared = !arguments.source.empty() || IsAssigned(arguments, "ingest.source.axes");
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (axes_declared || !axes || axes->handedness() == Handedness::kRight) return std::nullopt;
  AxisConvention right = *axes;
  right.canonical_from_source.col(0) *= -1.0;
  return MakeFinding(
      "axes_mirrored", Severity::kWarning, 0.0,
      DisplayPath(arguments.path) +
          ": left and right are exchanged by the joint names, so the files are read as a left-handed world, axes '" +
          source.axes +
          "'. If the names are wrong instead, correct them, or keep them with --set "
          "ingest.source.axes='" +
          right.Text() + "'");
}

/// `findings`: what is assumed of the files, and what of them is left out.
Expected<JobOptions> FitOptionsOf(const FitArguments& arguments, const ConfigRules& rules,
                                  std::vector<Finding>& findings) {
  const Expected<Declared> declared = Declare(arguments, findings);
  if (!declared) return Forward(declared);
  if (Status known = CheckUnknown(arguments, *declared); !known) return Forward(known);
  for (const std::string& assignment : arguments.assignments) {
    for (const char* group : {"canon.", "assemble.", "audit.", "train.", "evaluate.", "report."}) {
      if (assignment.rfind(group, 0) != 0) continue;
      return Fail(ErrorCode::kUsage, "'" + assignment + "' has no effect: this verb ends with the fit", "--set",
                  "use `mocurate run` with a config, which `mocurate config init` writes");
    }
  }
  std::error_code unknown;
  const fs::path path = fs::absolute(arguments.path, unknown).lexically_normal();
  // The method is chosen below: a declaration keeps recorded rotations, and this verb may fit others.
  std::vector<std::string> assignments = {"ingest.path=.", "fitting.other_joints=exclude",
                                          "fitting.method=joint_tracks"};
  if (!arguments.skeleton.empty()) assignments.push_back("skeleton=" + arguments.skeleton);
  if (arguments.contacts) assignments.push_back("fitting.contacts.remove_sliding=true");
  assignments.insert(assignments.end(), arguments.assignments.begin(), arguments.assignments.end());
  Expected<LoadedJob> job = LoadJob(declared->config, assignments, rules);
  if (!job) return Forward(job);
  JobOptions options = std::move(job->options);
  // Not through YAML, as a path may contain any bytes.
  options.ingest.path = path;
  std::optional<std::string> unnamed;
  if (!IsMotionStore(path)) unnamed = RelaxFilePattern(options.ingest);
  if (unnamed) LogInfo(*unnamed);
  auto mirrored = IsMotionStore(path) ? std::nullopt : FindMirror(arguments, options.ingest.source);
  if (mirrored) findings.push_back(*std::move(mirrored));
  if (Status chosen = ChooseMethod(arguments, options); !chosen) return Forward(chosen);
  ChooseBodies(arguments, unnamed.has_value(), options);
  if (Status named = CheckNames(options, JobStage::kFitting); !named) return Forward(named);
  return options;
}

/// The fits of a run as one dataset, sorted by id.
Expected<Dataset> CollectFits(const std::vector<ClipRecord>& clips, const std::vector<std::string>& label_order) {
  Dataset whole;
  whole.created_by = CreatedBy();
  whole.recipe = "mocurate fit";
  for (const ClipRecord& clip : clips) {
    if (!IsFitted(clip)) continue;
    Expected<Dataset> part = ReadDataset(clip.motion.artifact);
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

/// The dataset whose clips are fitted; empty for files of other programs.
fs::path DatasetOf(const JobOptions& options) {
  const SourceOptions& source = options.ingest.source;
  if (!DriverOf(source.format).stored) return {};
  std::error_code unknown;
  return fs::is_regular_file(options.ingest.path, unknown) ? options.ingest.path
                                                           : options.ingest.path / source.container;
}

/// "fitted by mocurate fit: skeleton smpl24, feet stand", for the recipe.
std::string HowText(const JobOptions& options) {
  std::string how = "fitted by mocurate fit:";
  how += options.fitting.method == FitMethod::kNone ? " given motions" : " skeleton " + options.fitting.skeleton;
  return how + (options.fitting.contacts.remove_sliding ? ", sliding of standing feet removed" : "");
}

/// Writes `fits` as that dataset with its motions fitted again. Returns the dataset, and adds to `findings` what is
/// about it as a whole.
Expected<Dataset> WriteRefitted(const fs::path& path, Dataset fits, const JobOptions& options, const JobResult& result,
                                const fs::path& output, std::vector<Finding>& findings) {
  const auto files = OpenDatasetFiles({path});
  if (!files) return Forward(files);
  std::map<std::string, std::string> failed;
  for (const ClipRecord& clip : result.clips) {
    if (IsFitted(clip)) continue;
    const ItemResult* ended = clip.ended();
    failed[clip.item] = ended == nullptr ? "it was not fitted" : ended->outcome.error.Message();
  }
  ChangedDataset refitted = RefitDataset(files->front().outline, std::move(fits), failed, HowText(options));
  const auto dropped = WriteFromFiles(refitted.dataset, WholeClips(refitted.rows, *files), *files, output);
  if (!dropped) return Forward(dropped);
  findings.insert(findings.end(), refitted.findings.begin(), refitted.findings.end());
  findings.insert(findings.end(), dropped->begin(), dropped->end());
  return std::move(refitted.dataset);
}

/// Reasons for clips that could not be fitted, each once; never empty.
std::vector<Error> Failures(const JobResult& result) {
  std::vector<Error> failures;
  std::set<std::string> reported;
  for (const ClipRecord& clip : result.clips) {
    const ItemResult* ended = clip.ended();
    if (ended == nullptr || ended->outcome.error.what.empty()) continue;
    Error error = ended->outcome.error;
    if (error.where.empty()) error.where = clip.item;
    if (reported.insert(error.Message()).second) failures.push_back(std::move(error));
  }
  if (failures.empty()) failures.push_back({ErrorCode::kInconsistent, "no clip could be fitted", "", ""});
  return failures;
}

/// The first failure is the verb's error; the others are logged before.
Error FirstFailure(const JobResult& result) {
  const std::vector<Error> failures = Failures(result);
  for (std::size_t i = 1; i < failures.size(); ++i) LogWarning(failures[i].Message());
  return failures[0];
}

/// Text about fitted clips that are suspect.
std::string SuspectClipsText(int clips) {
  const bool one = clips == 1;
  return Counted(clips, "clip") + (one ? " contradicts" : " contradict") + " the declaration of the source, or " +
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
  std::vector<Finding> findings;
  const Expected<JobOptions> options = FitOptionsOf(arguments, {common.allow_include}, findings);
  WarnOf(findings);
  if (!options) return Forward(options);
  auto stages = VerbStages::Make(common, arguments.jobs);
  if (!stages) return Forward(stages);
  const Expected<JobResult> result = RunMainJob(*options, JobStage::kFitting, (*stages)->runner(), arguments.clips);
  if (!result) return Forward(result);
  if (std::none_of(result->clips.begin(), result->clips.end(), IsFitted)) {
    return tl::unexpected<Error>(FirstFailure(*result));
  }
  Expected<Dataset> whole = CollectFits(result->clips, options->assemble.label_order);
  if (!whole) return Forward(whole);
  whole->findings.insert(whole->findings.end(), findings.begin(), findings.end());
  const std::size_t logged = findings.size();
  const fs::path dataset = DatasetOf(*options);
  if (!dataset.empty()) {
    whole = WriteRefitted(dataset, *std::move(whole), *options, *result, arguments.output, findings);
    if (!whole) return Forward(whole);
  } else if (Status written = WriteDataset(*whole, arguments.output); !written) {
    return written;
  }
  WarnOf({findings.begin() + static_cast<std::ptrdiff_t>(logged), findings.end()});
  if (AnswersInText(common, AnswerOf(*result, arguments.output, findings))) {
    for (const ClipRecord& clip : result->clips) {
      if (IsFitted(clip)) PrintFit(clip);
    }
    PrintSharedBodies(*result);
    Print("%s in %s\n", Counted(static_cast<long long>(whole->clips.size()), "clip").c_str(),
          DisplayPath(arguments.output).c_str());
  }
  if (result->counts.failed == 0 && result->counts.suspect == 0) return {};
  if (result->counts.failed == 0) {
    return Fail(ErrorCode::kTooManyFailures, SuspectClipsText(result->counts.suspect), DisplayPath(arguments.path),
                "see the findings above; the fits were written all the same");
  }
  Error error = dataset.empty() ? FirstFailure(*result) : Failures(*result).front();  // or they are findings
  error.code = ErrorCode::kTooManyFailures;
  error.what = Counted(result->counts.failed, "clip") + " could not be fitted; the first: " + error.what;
  return tl::unexpected<Error>(error);
}

}  // namespace mocurate
