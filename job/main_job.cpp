#include "job/main_job.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "canon/review/review.h"
#include "canon/stages.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "eval/stages.h"
#include "eval/tables/result_table.h"
#include "eval/tables/seeds.h"
#include "fitting/rig_file.h"
#include "fitting/stages.h"
#include "ingest/discover.h"
#include "ingest/inspect/comparison.h"
#include "ingest/stages.h"
#include "ingest/synthetic/studio.h"
#include "job/canon_items.h"
#include "job/curation_log.h"
#include "job/job_checks.h"
#include "job/job_items.h"
#include "job/network_scores.h"
#include "job/report_run.h"
#include "job/run_folder.h"
#include "job/stage_runs.h"
#include "job/training_run.h"
#include "report/charts.h"
#include "train/stages.h"

namespace mocurate {
namespace {

/// Name of the branch in which unfitted tracks run through the same stages, for comparison.
constexpr const char* kFittedBranch = "fitted motion";
constexpr const char* kRawBranch = "raw tracks";

/// One run of the main job: keeps results of earlier stages for later ones.
class MainJob {
 public:
  MainJob(const JobOptions& options, JobStage last, Runner& runner, const std::vector<std::string>& only)
      : options_(options), last_(last), runner_(runner), only_(only), runs_(runner, result_.stages) {}

  Expected<JobResult> Run() {
    using Step = Status (MainJob::*)();
    const std::pair<JobStage, Step> steps[] = {
        {JobStage::kIngest, &MainJob::Capture},        {JobStage::kIngest, &MainJob::Ingest},
        {JobStage::kIngest, &MainJob::FindDuplicates}, {JobStage::kProportions, &MainJob::Proportions},
        {JobStage::kFitting, &MainJob::Fit},           {JobStage::kFitting, &MainJob::ScoreFits},
        {JobStage::kCanon, &MainJob::Canonicalise},    {JobStage::kAssemble, &MainJob::Assemble},
        {JobStage::kAudit, &MainJob::Audit},           {JobStage::kTrain, &MainJob::Train},
        {JobStage::kTable, &MainJob::ScoreNetworks},   {JobStage::kReport, &MainJob::Report}};
    CheckComparison();
    if (!options_.canon.review.empty() && last_ >= JobStage::kAssemble) {
      if (const auto review = ReadReview(options_.canon.review); !review) return Forward(review);
    }
    if (last_ >= JobStage::kCanon) {
      if (Status canon = CheckCanon(options_.canon); !canon) return Forward(canon);
    }
    for (const auto& [stage, step] : steps) {
      if (stage > last_) break;
      Status done = (this->*step)();
      const bool decided = stage == std::min(last_, JobStage::kAssemble);
      if ((decided || !done) && stage <= JobStage::kAssemble && !DryRun() && !clips_.empty()) {
        const Status logged = WriteCurationLog(clips_, folder() / "curation_log.jsonl");
        if (!logged) return Forward(logged);
      }
      if (!done) return Forward(done);
    }
    CountClips(clips_, result_);
    result_.clips = std::move(clips_);
    result_.bodies = std::move(persons_);
    return std::move(result_);
  }

 private:
  std::filesystem::path folder() const { return runner_.options().run_folder; }
  bool DryRun() const { return runner_.options().dry_run; }

  void AddSetFindings(const std::vector<Finding>& findings) {
    for (const Finding& finding : findings) {
      const LogLevel levels[] = {LogLevel::kInfo, LogLevel::kWarning, LogLevel::kError};
      Log(levels[static_cast<int>(finding.severity)],
          (finding.clip.empty() ? "" : DisplayPath(finding.clip) + ": ") + finding.message);
    }
    result_.set_findings.insert(result_.set_findings.end(), findings.begin(), findings.end());
  }

  static void AddInput(const StageInput& input, std::vector<ItemSpec>& items) {
    for (ItemSpec& item : items) item.inputs.push_back(input);
  }

  /// A given folder replaces the synthetic capture.
  Status Capture() {
    synthetic_ = options_.ingest.synthetic.enabled && options_.ingest.path.empty();
    if (!synthetic_) return {};
    const nlohmann::json options = OptionsToJson(options_.ingest.synthetic);
    const auto capture = runs_.One(CaptureDeclaration(), {"capture", options, {}});
    if (!capture) return Forward(capture);
    options_.ingest.path = folder() / "capture";
    if (!capture->artifact.empty()) {
      auto names = CaptureFileNames(capture->artifact);
      if (!names) return Forward(names);
      captured_ = *std::move(names);
      Status unpacked = DryRun() ? Status() : UnpackCapture(capture->artifact, options_.ingest.path);
      if (!unpacked) return unpacked;
    }
    if (!std::filesystem::exists(options_.ingest.path)) options_.ingest.path.clear();
    if (options_.ingest.path.empty()) return {};
    const auto truth = runs_.One(TruthDeclaration(), {"truth", {{"synthetic", options}}, {}});
    if (!truth) return Forward(truth);
    truth_.push_back(InputFrom("truth", *truth));
    return {};
  }

  Status Ingest() {
    if (synthetic_ && options_.ingest.path.empty()) return {};
    auto discovery = Discover(options_.ingest, captured_);
    if (!discovery) return Forward(discovery);
    if (Status taken = TakeOnly(only_, *discovery); !taken) return taken;
    LogExcluded(discovery->excluded);
    AddSetFindings(discovery->findings);
    if (last_ >= JobStage::kAssemble) {
      std::vector<Finding> findings;
      const auto& roles = options_.ingest.source.roles;
      if (Status groups = CheckSplitGroups(options_.assemble, roles, *discovery, findings); !groups) return groups;
      AddSetFindings(findings);
    }
    const StageInput skeleton = SkeletonInput(options_.ingest.source.skeleton);
    for (auto* items : {&discovery->items, &discovery->truth}) AddInput(skeleton, *items);
    auto beside = TruthInputs(options_.ingest.truth);
    if (!beside) return Forward(beside);
    truth_.insert(truth_.end(), beside->begin(), beside->end());
    const std::vector<ItemSpec> specs = discovery->items;
    auto report = runs_.Run(IngestDeclaration(), std::move(discovery->items));
    if (!report) return Forward(report);
    AddSetFindings(FindSetContradictions(options_.ingest.source, report->items));
    clips_ = RecordsOf(specs, std::move(report->items), std::move(discovery->excluded));
    if (!discovery->truth.empty()) {
      const auto truth = runs_.Run(TruthDeclaration(), std::move(discovery->truth));
      if (!truth) return Forward(truth);
      for (const ItemResult& item : truth->items) {
        if (!item.artifact.empty()) truth_.push_back(InputFrom("truth", item));
      }
    }
    return {};
  }

  /// Finds clips with equal motion.
  Status FindDuplicates() {
    auto item = DuplicatesItem(clips_, OptionsToJson(options_.ingest.source.checks));
    if (!item) return {};
    const auto found = runs_.One(DuplicatesDeclaration(), *std::move(item));
    if (!found) return Forward(found);
    NoteDuplicates(*found, clips_);
    if (!found->outcome.findings.empty()) duplicates_ = InputFrom("findings", *found);
    return {};
  }

  /// The content of the audited rig, not its path, is part of the keys.
  void AddRig(std::vector<ItemSpec>& items) const {
    const std::filesystem::path& rig = options_.fitting.keypoints.rig;
    if (!rig.empty()) AddInput({kRigRole, kRigRole, rig, ""}, items);
  }

  bool Fits() const { return options_.fitting.method != FitMethod::kNone; }

  Status Proportions() {
    if (!Fits()) return {};
    std::vector<ItemSpec> items =
        ProportionItems(clips_, options_.proportions.body_of, ProportionsItemOptions(options_));
    AddRig(items);
    AddInput(SkeletonInput(options_.proportions.skeleton), items);
    auto report = runs_.Run(ProportionsDeclaration(), std::move(items));
    if (!report) return Forward(report);
    for (ItemResult& item : report->items) persons_[item.item] = std::move(item);
    return {};
  }

  Status Fit() {
    if (!Fits() && !options_.fitting.contacts.remove_sliding) {
      for (ClipRecord& clip : clips_) clip.motion = clip.evidence;
      return {};
    }
    const ItemOptions options = FittingItemOptions(options_);
    FitItems fits = Fits() ? FittingItems(clips_, options_.proportions.body_of, persons_, options)
                           : GivenMotionItems(clips_, options);
    AddRig(fits.items);
    AddInput(SkeletonInput(options_.fitting.skeleton), fits.items);
    auto report = runs_.Run(FittingDeclaration(), std::move(fits.items));
    if (!report) return Forward(report);
    if (Fits() && options_.fitting.check > 0.0) result_.check = CheckOf(report->items);
    for (std::size_t i = 0; i < report->items.size(); ++i) fits.clips[i]->motion = std::move(report->items[i]);
    return {};
  }

  /// How far apart both solvers ended, over the clips that both solved.
  static nlohmann::json CheckOf(const std::vector<ItemResult>& items) {
    nlohmann::json all = {
        {"clips", 0}, {"of", items.size()}, {"differ", 0}, {"joint_worst_mm", 0.0}, {"cost_difference", 0.0}};
    for (const ItemResult& item : items) {
      const nlohmann::json summary = item.summary;
      if (!summary.is_object() || !summary.contains("check")) continue;
      const nlohmann::json& check = summary["check"];
      all["clips"] = all["clips"].get<int>() + 1;
      if (check.at("differ").get<bool>()) all["differ"] = all["differ"].get<int>() + 1;
      for (const char* key : {"joint_worst_mm", "cost_difference"})
        all[key] = std::max(all[key].get<double>(), check.value(key, 0.0));
    }
    return all;
  }

  Status ScoreFits() {
    auto item = Fits() ? FitErrorItem(clips_, truth_) : std::nullopt;
    if (!item) return {};
    const auto scored = runs_.One(FitErrorDeclaration(), *std::move(item));
    if (!scored) return Forward(scored);
    result_.fit_error = scored->summary;
    return scored->artifact.empty() ? Status() : NoteFitErrors(*scored, clips_);
  }

  /// A failed comparison with raw tracks does not stop the dataset; a finding reports it.
  void DropComparison(const std::string& why) {
    unfitted_ = false;
    comparison_.push_back(ComparisonDropped(why));
    LogWarning(comparison_.back().message);
  }

  /// Before the work, as far as the source declaration allows.
  void CheckComparison() {
    unfitted_ = options_.train.NeedsUnfitted();
    const std::string missing = unfitted_ ? JointsWithoutTrack(options_) : "";
    if (missing.empty() || last_ < JobStage::kCanon) return;
    DropComparison("the source has no tracks of " + missing + " of skeleton '" + options_.canon.skeleton + "'");
  }

  /// Floors are those of the motions, also for the unfitted tracks.
  Status FindFloors() {
    if (options_.canon.level.rule == FloorRule::kNone) return {};
    const auto report = runs_.Run(LevelDeclaration(), LevelItems(clips_, options_.canon.level));
    if (!report) return Forward(report);
    for (const ItemResult& item : report->items) {
      floors_[item.item] = item;
      AddSetFindings(item.outcome.findings);
    }
    return {};
  }

  Status Canonicalise() {
    if (Status found = FindFloors(); !found) return found;
    const bool both = unfitted_;
    Status done = CanonItems("motion", &ClipRecord::motion, &ClipRecord::canonical, both ? kFittedBranch : "");
    if (!done || !both) return done;
    return CanonItems("tracks", &ClipRecord::evidence, &ClipRecord::baseline, kRawBranch);
  }

  Status CanonItems(const char* role, ItemResult ClipRecord::*from, ItemResult ClipRecord::*to, const char* branch) {
    const ItemOptions options = CanonItemOptions(options_);
    std::vector<ItemSpec> items;
    std::vector<ClipRecord*> records;
    for (ClipRecord& clip : clips_) {
      if ((clip.*from).artifact.empty()) continue;
      items.push_back({clip.item, options, {InputFrom(role, clip.*from)}});
      const auto floor = floors_.find(FloorGroup(clip, options_.canon.level.of));
      if (floor != floors_.end() && !floor->second.artifact.empty()) {
        items.back().inputs.push_back(InputFrom(kFloorRole, floor->second));
      }
      records.push_back(&clip);
    }
    AddInput(SkeletonInput(options_.canon.skeleton), items);
    if (const auto spans = SpansInput(options_.canon.trim)) AddInput(*spans, items);
    if (options_.canon.trim.rule == TrimRule::kByExample) {
      const auto examples = ExampleInputs(options_.canon, clips_, floors_);
      if (!examples) return Forward(examples);
      for (const StageInput& example : *examples) AddInput(example, items);
    }
    auto report = runs_.Run(CanonDeclaration(), std::move(items), branch);
    if (!report) return Forward(report);
    if (to == &ClipRecord::canonical) {
      AddSetFindings(UnmatchedDropLabels(options_.canon, report->items));
      LogSpansOutside(report->items);
    }
    for (std::size_t i = 0; i < report->items.size(); ++i) records[i]->*to = std::move(report->items[i]);
    if (to != &ClipRecord::canonical) return {};
    auto unmatched = UnmatchedSpans(options_.canon, clips_);
    if (!unmatched) return Forward(unmatched);
    AddSetFindings(*unmatched);
    return {};
  }

  void AddReview(const char* role, ItemSpec& item) const {
    const std::filesystem::path& review = options_.canon.review;
    if (!review.empty()) item.inputs.push_back({role, DisplayPath(review), review, ""});
  }

  Expected<ItemResult> AssembleFrom(const char* name, ItemResult ClipRecord::*from, const char* branch) {
    AssembleOptions assemble = options_.assemble;
    assemble.recipe += (assemble.recipe.empty() ? "" : "\n") + CanonText(options_.canon);
    ItemSpec item{name, OptionsToJson(assemble), {}};
    for (const ClipRecord& clip : clips_) {
      if (!(clip.*from).artifact.empty()) item.inputs.push_back(InputFrom("clip", clip.*from));
    }
    if (item.inputs.empty()) {
      if (runner_.options().dry_run) return ItemResult();
      const Error first = FirstReason(clips_, from);
      return Fail(first.code, "no clip remains for the dataset; " + first.Message(), DisplayPath(options_.ingest.path),
                  "curation_log.jsonl in the run folder has the reason of each");
    }
    if (duplicates_) item.inputs.push_back(*duplicates_);
    if (Status recorded = AddFindingsOfSet(item); !recorded) return Forward(recorded);
    AddReview(from == &ClipRecord::canonical ? kReviewRole : kReviewByIdRole, item);
    return runs_.One(AssembleDeclaration(), std::move(item), branch);
  }

  /// What was found about the set so far becomes part of the dataset's findings.
  Status AddFindingsOfSet(ItemSpec& item) const {
    if (set_findings_.empty()) return {};
    const std::string text = nlohmann::json(set_findings_).dump(1) + "\n";
    const std::filesystem::path path = folder() / kSetFindings;
    if (!DryRun()) {
      if (Status written = WriteFile(path, text); !written) return written;
    }
    item.inputs.push_back({"findings", kSetFindings, path, Sha256Hex(text)});
    return {};
  }

  Status Assemble() {
    set_findings_ = result_.set_findings;
    const auto dataset = AssembleFrom("dataset", &ClipRecord::canonical, unfitted_ ? kFittedBranch : "");
    if (!dataset) return Forward(dataset);
    AddSetFindings(NoteExcludedFromSet(*dataset, clips_));
    dataset_ = *dataset;
    result_.dataset_clips = dataset_.summary.value("clips", std::size_t{0});
    if (unfitted_) {
      const auto baseline = AssembleFrom("baseline", &ClipRecord::baseline, kRawBranch);
      const ExitCode fault = baseline ? ExitCode::kDone : ExitCodeOf(baseline.error().code);
      if (fault > ExitCode::kInputUnusable) return Forward(baseline);
      if (baseline) baseline_ = *baseline;
      if (!baseline) DropComparison(baseline.error().Message());
    }
    result_.set_findings.insert(result_.set_findings.end(), comparison_.begin(), comparison_.end());
    if (dataset_.artifact.empty() || DryRun()) return {};
    result_.dataset = folder() / "dataset.h5";
    return CopyWhole(dataset_.artifact, result_.dataset);
  }

  Status Audit() {
    if (dataset_.artifact.empty()) return {};
    ItemSpec item{"audit", OptionsToJson(options_.audit), {InputFrom("dataset", dataset_)}};
    AddReview(kReviewRole, item);
    const auto audit = runs_.One(AuditDeclaration(), std::move(item));
    if (!audit) return Forward(audit);
    result_.audit = audit->summary;
    audit_ = *audit;
    return {};
  }

  /// A network that fails only stops those that start from it or train on its motions.
  Status Train() {
    if (dataset_.artifact.empty() && DryRun() && !options_.train.networks.empty()) {
      LogInfo("training hours can be measured once the dataset exists: run --to assemble first");
    }
    if (dataset_.artifact.empty()) return {};
    TrainingInputs inputs{InputFrom("dataset", dataset_), std::nullopt};
    if (!baseline_.artifact.empty()) inputs.unfitted = InputFrom("dataset", baseline_);
    auto trained = TrainNetworks(options_.train, inputs, {runner_, runs_, result_});
    if (!trained) return Forward(trained);
    networks_ = std::move(trained->networks);
    denoised_ = std::move(trained->denoised);
    return {};
  }

  /// An evaluation that fails stops the table, not the report.
  Status ScoreNetworks() {
    if (dataset_.artifact.empty()) return {};
    auto recognisers = ScoreRecognisers(networks_, options_, {dataset_, baseline_, denoised_}, runs_);
    if (!recognisers) return Forward(recognisers);
    const auto published = PublishedOfTable(options_.evaluate);
    if (!published) return Forward(published);
    auto scored = ScoreGenerators(networks_, options_, dataset_, runs_);
    if (!scored) return Forward(scored);
    if (DryRun()) return {};
    result_.unevaluated = scored->unevaluated;
    recognition_ = RecognitionRows(options_.train, *recognisers, *published);
    if (scored->metrics.at("rows").empty() && recognition_.at("rows").empty()) return {};
    result_.metrics = std::move(scored->metrics);
    result_.metrics["recognisers"] = std::move(*recognisers);
    result_.metrics["published"] = WithoutRecognisers(*published);
    result_.metrics["notes"] = NotesOf(options_.evaluate);
    if (const std::string recogniser = RecogniserOf(options_); !recogniser.empty()) {
      result_.metrics["notes"].push_back("Features by " + recogniser + ".");
    }
    const auto& networks = options_.train.networks;
    if (options_.skeleton != "smplh52" && std::any_of(networks.begin(), networks.end(), [](const NetworkOptions& one) {
          return one.kind == NetworkKind::kMacvae;
        })) {
      result_.metrics["notes"].push_back("Joints of " + options_.skeleton +
                                         "; MultiAct's networks read the 52 of SMPL-H, hands included.");
    }
    for (const nlohmann::json& note : result_.metrics.value("own_notes", nlohmann::json::array())) {
      result_.metrics["notes"].push_back(note);
    }
    result_.metrics.erase("own_notes");
    AddTraining(networks_, options_, result_.training, JournalOf(folder(), TrainDeclaration().name),
                result_.metrics["rows"]);
    MergeSeeds(result_.metrics["rows"]);
    result_.metrics["orders"] = OrdersOfSeeds(result_.metrics["rows"]);
    return WriteMetrics();
  }

  Status WriteMetrics() {
    result_.metrics = WithNotes(std::move(result_.metrics), options_, result_);
    if (Status written = WriteFile(folder() / "metrics.json", result_.metrics.dump(1) + "\n"); !written) {
      return written;
    }
    if (!result_.metrics.at("rows").empty()) {
      if (Status written = WriteTable(result_.metrics, "table", result_.table); !written) return written;
    }
    if (const auto learning = LearningSheet(result_.metrics.at("rows"), options_.name)) {
      const std::filesystem::path file = folder() / "tables" / "learning.svg";
      if (Status written = WriteFile(file, ToSvg(learning->Draw())); !written) return written;
      result_.tables.push_back(file);
    }
    if (recognition_.at("rows").empty()) return {};
    recognition_["notes"] = TrainingNotes(options_.train, RecogniserOf(options_));
    for (const DenoisedSet& denoised : denoised_) {
      recognition_["notes"].push_back("Denoised: windows of the test clips, encoded and decoded by " + denoised.item +
                                      ".");
    }
    return WriteTable(recognition_, "recognition", result_.recognition);
  }

  Status WriteTable(const nlohmann::json& result, const char* name, Table& table) {
    table = ResultTable(result, options_.name);
    const auto written = WriteTables(result, table, folder() / "tables", name);
    if (!written) return Forward(written);
    result_.tables.insert(result_.tables.end(), written->begin(), written->end());
    return {};
  }

  Status Report() {
    if (dataset_.artifact.empty() || DryRun()) return {};
    if (Status made = MakeFolder(folder() / "report"); !made) return made;
    return WriteReport({options_, clips_, persons_, dataset_, audit_, truth_, networks_, Fits()}, runs_, folder(),
                       result_);
  }

  JobOptions options_;
  JobStage last_;
  bool synthetic_ = false;
  std::vector<Finding> set_findings_;  ///< until the dataset is assembled
  bool unfitted_ = false;              ///< clips before fitting run through the same stages, for comparison
  Runner& runner_;
  const std::vector<std::string>& only_;
  JobResult result_;
  StageRuns runs_;
  std::vector<ClipRecord> clips_;
  std::optional<std::set<std::string>>
      captured_;  ///< files of the synthetic capture; others in its folder are not ours
  std::map<std::string, ItemResult> persons_;
  std::map<std::string, ItemResult> floors_;  ///< by FloorGroup
  std::optional<StageInput> duplicates_;      ///< findings about clips with equal motion
  std::vector<StageInput> truth_;
  std::vector<TrainedNetwork> networks_;
  std::vector<DenoisedSet> denoised_;  ///< the dataset encoded and decoded by networks
  nlohmann::json recognition_;         ///< rows of the table of recognisers
  ItemResult dataset_, baseline_, audit_;
  std::vector<Finding> comparison_;  ///< why there is no comparison
};

}  // namespace

Expected<JobResult> RunMainJob(const JobOptions& options, JobStage last, Runner& runner,
                               const std::vector<std::string>& only) {
  return MainJob(options, last, runner, only).Run();
}

}  // namespace mocurate
