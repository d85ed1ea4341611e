#include "app/main_job.h"

#include <algorithm>
#include <map>
#include <set>

#include "app/curation_log.h"
#include "app/job_items.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "eval/tables/table.h"
#include "ingest/discover.h"

namespace mocurate {
namespace {

struct StageName {
  const char* name;
  JobStage stage;
};

constexpr StageName kStages[] = {
    {"ingest", JobStage::kIngest}, {"proportions", JobStage::kProportions}, {"fitting", JobStage::kFitting},
    {"canon", JobStage::kCanon},   {"assemble", JobStage::kAssemble},       {"audit", JobStage::kAudit},
    {"train", JobStage::kTrain},   {"evaluate", JobStage::kEvaluate},       {"report", JobStage::kReport}};

/// One run of the main job: holds what earlier stages gave to later ones.
class MainJob {
 public:
  MainJob(const JobOptions& options, JobStage last, Runner& runner) : options_(options), last_(last), runner_(runner) {}

  Expected<JobResult> Run() {
    using Step = Status (MainJob::*)();
    const std::pair<JobStage, Step> steps[] = {{JobStage::kIngest, &MainJob::Capture},
                                               {JobStage::kIngest, &MainJob::Ingest},
                                               {JobStage::kProportions, &MainJob::Proportions},
                                               {JobStage::kFitting, &MainJob::Fit},
                                               {JobStage::kFitting, &MainJob::ScoreFits},
                                               {JobStage::kCanon, &MainJob::Canonicalise},
                                               {JobStage::kAssemble, &MainJob::Assemble},
                                               {JobStage::kAudit, &MainJob::Audit},
                                               {JobStage::kTrain, &MainJob::Train},
                                               {JobStage::kEvaluate, &MainJob::Evaluate},
                                               {JobStage::kReport, &MainJob::Report}};
    for (const auto& [stage, step] : steps) {
      if (stage > last_) break;
      const Status done = (this->*step)();
      const bool log_changed = stage <= JobStage::kCanon && !runner_.options().dry_run && !clips_.empty();
      if (log_changed) {
        if (Status logged = WriteCurationLog(clips_, folder() / "curation_log.jsonl"); !logged) return Forward(logged);
      }
      if (!done) return Forward(done);
    }
    for (const ClipRecord& clip : clips_) {
      ++result_.clips;
      result_.kept += clip.kept() ? 1 : 0;
      result_.failed += clip.failure() != nullptr ? 1 : 0;
    }
    return result_;
  }

 private:
  std::filesystem::path folder() const { return runner_.options().run_folder; }
  bool DryRun() const { return runner_.options().dry_run; }

  Expected<StageReport> RunStage(const StageDeclaration& stage, std::vector<ItemSpec> items) {
    auto report = runner_.Run(stage, std::move(items));
    if (report) result_.stages.push_back(*report);
    return report;
  }

  /// Runs one item whose artifact later stages cannot do without.
  Expected<ItemResult> RunOne(const StageDeclaration& stage, ItemSpec item) {
    auto report = RunStage(stage, {std::move(item)});
    if (!report) return Forward(report);
    if (report->items.empty()) return ItemResult();
    const ItemResult& result = report->items.front();
    if (result.artifact.empty() && !runner_.options().dry_run) {
      Error error = result.outcome.error;
      if (error.where.empty()) error.where = stage.name;
      return tl::unexpected<Error>(error);
    }
    return result;
  }

  static void AddInput(const StageInput& input, std::vector<ItemSpec>& items) {
    for (ItemSpec& item : items) item.inputs.push_back(input);
  }

  Status Capture() {
    if (!options_.ingest.synthetic.enabled) return {};
    const nlohmann::json options = OptionsToJson(options_.ingest.synthetic);
    const auto capture = RunOne(CaptureDeclaration(), {"capture", options, {}});
    if (!capture) return Forward(capture);
    options_.ingest.path = folder() / "capture";
    if (capture->artifact.empty() || DryRun()) {
      if (!std::filesystem::exists(options_.ingest.path)) options_.ingest.path.clear();
      if (options_.ingest.path.empty()) return {};
    }
    if (!DryRun()) {
      if (Status unpacked = UnpackCapture(capture->artifact, options_.ingest.path); !unpacked) return unpacked;
    }
    const auto truth = RunOne(TruthDeclaration(), {"truth", {{"synthetic", options}}, {}});
    if (!truth) return Forward(truth);
    truth_.push_back(InputFrom("truth", *truth));
    return {};
  }

  Status Ingest() {
    if (options_.ingest.synthetic.enabled && options_.ingest.path.empty()) return {};
    auto discovery = Discover(options_.ingest);
    if (!discovery) return Forward(discovery);
    left_out_ = discovery->findings;
    for (const Finding& finding : left_out_) LogWarning(finding.clip + ": " + finding.message);
    AddInput(SkeletonInput(options_.ingest.source.skeleton), discovery->items);
    const std::vector<ItemSpec> specs = discovery->items;
    const auto report = RunStage(IngestDeclaration(), std::move(discovery->items));
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < report->items.size(); ++i) {
      ClipRecord clip;
      clip.item = report->items[i].item;
      clip.evidence = report->items[i];
      for (const StageInput& input : specs[i].inputs) {
        if (input.role == "depth") clip.depth.push_back(input);
      }
      clips_.push_back(std::move(clip));
    }
    for (const Finding& finding : left_out_) {
      if (finding.severity != Severity::kError) continue;
      ClipRecord clip;
      clip.item = finding.clip;
      clip.evidence.item = finding.clip;
      clip.evidence.outcome.kind = OutcomeKind::kRefused;
      clip.evidence.outcome.findings = {finding};
      clip.evidence.outcome.error = Error{ErrorCode::kInconsistent, finding.message, finding.clip, finding.action};
      clips_.push_back(std::move(clip));
    }
    if (!discovery->truth.empty()) {
      const auto truth = RunStage(TruthDeclaration(), std::move(discovery->truth));
      if (!truth) return Forward(truth);
      for (const ItemResult& item : truth->items) {
        if (!item.artifact.empty()) truth_.push_back(InputFrom("truth", item));
      }
    }
    return {};
  }

  bool Fits() const { return options_.fitting.method != FitMethod::kNone; }

  Status Proportions() {
    if (!Fits()) return {};
    std::vector<ItemSpec> items = ProportionItems(clips_, OptionsToJson(options_.proportions));
    AddInput(SkeletonInput(options_.proportions.skeleton), items);
    const auto report = RunStage(ProportionsDeclaration(), std::move(items));
    if (!report) return Forward(report);
    for (const ItemResult& item : report->items) persons_[item.item] = item;
    return {};
  }

  Status Fit() {
    if (!Fits()) {
      for (ClipRecord& clip : clips_) clip.motion = clip.evidence;
      return {};
    }
    const nlohmann::json options = OptionsToJson(options_.fitting);
    std::vector<ItemSpec> items;
    std::vector<ClipRecord*> records;
    for (ClipRecord& clip : clips_) {
      if (clip.evidence.artifact.empty()) continue;
      const auto person = persons_.find(clip.person());
      if (person == persons_.end()) {
        clip.motion.outcome.kind = OutcomeKind::kRefused;
        clip.motion.outcome.error =
            Error{ErrorCode::kInconsistent, "nothing says who the person is", clip.item, "set ingest.source.person"};
        continue;
      }
      if (person->second.artifact.empty()) {
        clip.motion.outcome = person->second.outcome;
        continue;
      }
      items.push_back(
          {clip.item, options, {InputFrom("evidence", clip.evidence), InputFrom("proportions", person->second)}});
      items.back().inputs.insert(items.back().inputs.end(), clip.depth.begin(), clip.depth.end());
      records.push_back(&clip);
    }
    AddInput(SkeletonInput(options_.fitting.skeleton), items);
    auto report = RunStage(FittingDeclaration(), std::move(items));
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < report->items.size(); ++i) records[i]->motion = report->items[i];
    return {};
  }

  Status ScoreFits() {
    if (truth_.empty() || !Fits()) return {};
    ItemSpec item{"fit_error", nlohmann::json::object(), truth_};
    for (const ClipRecord& clip : clips_) {
      if (clip.motion.artifact.empty()) continue;
      item.inputs.push_back(InputFrom("fit", clip.motion));
      item.inputs.push_back(InputFrom("evidence", clip.evidence));
    }
    if (item.inputs.size() == truth_.size()) return {};
    const auto scored = RunOne(FitErrorDeclaration(), std::move(item));
    if (!scored) return Forward(scored);
    result_.fit_error = scored->outcome.summary;
    return {};
  }

  Status Canonicalise() {
    if (Status done = CanonItems("motion", &ClipRecord::motion, &ClipRecord::canonical); !done) return done;
    if (!options_.train.baseline) return {};
    return CanonItems("tracks", &ClipRecord::evidence, &ClipRecord::baseline);
  }

  Status CanonItems(const char* role, ItemResult ClipRecord::*from, ItemResult ClipRecord::*to) {
    const nlohmann::json options = OptionsToJson(options_.canon);
    std::vector<ItemSpec> items;
    std::vector<ClipRecord*> records;
    for (ClipRecord& clip : clips_) {
      if ((clip.*from).artifact.empty()) continue;
      items.push_back({clip.item, options, {InputFrom(role, clip.*from)}});
      records.push_back(&clip);
    }
    AddInput(SkeletonInput(options_.canon.skeleton), items);
    auto report = RunStage(CanonDeclaration(), std::move(items));
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < report->items.size(); ++i) records[i]->*to = report->items[i];
    return {};
  }

  Expected<ItemResult> AssembleFrom(const char* name, ItemResult ClipRecord::*from) {
    ItemSpec item{name, OptionsToJson(options_.assemble), {}};
    for (const ClipRecord& clip : clips_) {
      if (!(clip.*from).artifact.empty()) item.inputs.push_back(InputFrom("clip", clip.*from));
    }
    if (item.inputs.empty()) {
      if (runner_.options().dry_run) return ItemResult();
      const Error* first = nullptr;
      for (const ClipRecord& clip : clips_) {
        if (first == nullptr) first = clip.failure();
      }
      return Fail(
          first != nullptr ? first->code : ErrorCode::kInconsistent,
          "no clip is left for the dataset" + (first != nullptr ? "; the first failed with: " + first->Message() : ""),
          DisplayPath(options_.ingest.path), "curation_log.jsonl in the run folder says why each was dropped");
    }
    return RunOne(AssembleDeclaration(), std::move(item));
  }

  Status Assemble() {
    const auto dataset = AssembleFrom("dataset", &ClipRecord::canonical);
    if (!dataset) return Forward(dataset);
    for (const Finding& finding : dataset->outcome.findings) LogWarning(finding.message);
    dataset_ = *dataset;
    if (options_.train.baseline) {
      const auto baseline = AssembleFrom("baseline", &ClipRecord::baseline);
      if (!baseline) return Forward(baseline);
      baseline_ = *baseline;
    }
    if (dataset_.artifact.empty() || DryRun()) return {};
    result_.dataset = folder() / "dataset.h5";
    return CopyWhole(dataset_.artifact, result_.dataset);
  }

  Status Audit() {
    if (dataset_.artifact.empty()) return {};
    const auto audit =
        RunOne(AuditDeclaration(), {"audit", OptionsToJson(options_.audit), {InputFrom("dataset", dataset_)}});
    if (!audit) return Forward(audit);
    result_.audit = audit->outcome.summary;
    return {};
  }

  void AddRecognisers(const char* kind, const char* role, const ItemResult& dataset,
                      const RecogniserOptions& recogniser, std::vector<ItemSpec>& items) {
    if (dataset.artifact.empty()) return;
    for (const double seed : options_.train.seeds) {
      RecogniserOptions seeded = recogniser;
      seeded.seed = static_cast<std::int64_t>(seed);
      const std::string name = std::string(kind) + "/" + std::to_string(seeded.seed);
      items.push_back({name, OptionsToJson(seeded), {InputFrom("dataset", dataset)}});
      roles_.emplace_back(role);
    }
  }

  Status Train() {
    if (dataset_.artifact.empty()) return {};
    const TrainOptions& train = options_.train;
    std::vector<ItemSpec> items;
    roles_.clear();
    AddRecognisers("recogniser", "recogniser", dataset_, train.recogniser, items);
    if (train.baseline)
      AddRecognisers("baseline_recogniser", "baseline_recogniser", baseline_, train.recogniser, items);
    if (train.crop) {
      RecogniserOptions crop = train.recogniser;
      crop.input = RecogniserInputKind::kCrop;
      AddRecognisers("crop_recogniser", "crop_recogniser", dataset_, crop, items);
    }
    if (train.generator_enabled) {
      const auto generator = StartGenerator();
      if (!generator) return Forward(generator);
    }
    const auto report = RunStage(TrainRecogniserDeclaration(), std::move(items));
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < report->items.size(); ++i) {
      const ItemResult& item = report->items[i];
      if (item.artifact.empty()) {
        if (runner_.options().dry_run) continue;
        return tl::unexpected<Error>(item.outcome.error);
      }
      networks_.push_back(InputFrom(roles_[i].c_str(), item));
      result_.training[item.item] = item.outcome.summary;
      if (Status copied = CopyCheckpoint(item); !copied) return copied;
    }
    return {};
  }

  Status CopyCheckpoint(const ItemResult& item) {
    if (DryRun()) return {};
    std::string name = item.item;
    std::replace(name.begin(), name.end(), '/', '_');
    if (Status made = MakeFolder(folder() / "checkpoints"); !made) return made;
    return CopyWhole(item.artifact, folder() / "checkpoints" / (name + ".h5"));
  }

  Status StartGenerator() {
    const auto generator =
        RunOne(TrainGeneratorDeclaration(),
               {"Action2Motion", OptionsToJson(options_.train.generator), {InputFrom("dataset", dataset_)}});
    if (!generator) return Forward(generator);
    if (generator->artifact.empty()) return {};
    networks_.push_back(InputFrom("generator", *generator));
    result_.training[generator->item] = generator->outcome.summary;
    return CopyCheckpoint(*generator);
  }

  Status Evaluate() {
    if (dataset_.artifact.empty() || networks_.empty()) return {};
    ItemSpec item{"metrics", OptionsToJson(options_.evaluate), networks_};
    item.inputs.push_back(InputFrom("dataset", dataset_));
    if (!baseline_.artifact.empty()) item.inputs.push_back(InputFrom("baseline_dataset", baseline_));
    const auto evaluated = RunOne(EvaluateDeclaration(), std::move(item));
    if (!evaluated) return Forward(evaluated);
    if (evaluated->artifact.empty() || DryRun()) return {};
    const auto text = ReadFile(evaluated->artifact);
    if (!text) return Forward(text);
    result_.metrics = nlohmann::json::parse(*text);
    result_.metrics["generator_training"] = result_.training.value("Action2Motion", nlohmann::json());
    AddTrainingNotes();
    result_.metrics["nearest_neighbour"] = result_.audit.value("nearest_neighbour", nlohmann::json());
    if (Status written = WriteFile(folder() / "metrics.json", result_.metrics.dump(1) + "\n"); !written) return written;
    const auto tables = WriteTables(result_.metrics, options_.name, folder() / "tables");
    if (!tables) return Forward(tables);
    result_.table = tables->markdown;
    result_.tables = tables->files;
    return {};
  }

  /// What the generator was trained on, beside the table.
  void AddTrainingNotes() {
    const GeneratorOptions& generator = options_.train.generator;
    if (!options_.train.generator_enabled) return;
    result_.metrics["notes"].push_back(
        "Action2Motion: " + std::to_string(generator.iterations) + " iterations of " + std::to_string(generator.batch) +
        " clips on " +
        (generator.all_clips ? "all clips, test clips included, as published." : "training clips only."));
    if (generator.input != options_.train.recogniser.input) {
      result_.metrics["notes"].push_back(
          "The generator learns windows and the recogniser sees whole clips (or the reverse): FID and accuracy of the "
          "two "
          "rows are not like for like; set train.generator.input and train.recogniser.input alike.");
    }
  }

  Status Report() {
    if (dataset_.artifact.empty() || DryRun()) return {};
    const nlohmann::json run = RunSummary(options_, clips_, persons_, result_);
    if (Status written = WriteFile(folder() / "report_input.json", run.dump(1) + "\n"); !written) return written;
    ItemSpec item{"report", OptionsToJson(options_.report), {}};
    item.inputs.push_back({"run", "run.json", folder() / "report_input.json", ""});
    item.inputs.push_back(InputFrom("dataset", dataset_));
    for (const StageInput& network : networks_) item.inputs.push_back(network);
    for (const ClipRecord* clip : ClipsToDraw(clips_, static_cast<int>(options_.report.filmstrip_clips))) {
      item.inputs.push_back(InputFrom("evidence", clip->evidence));
      if (Fits()) item.inputs.push_back(InputFrom("fit", clip->motion));
      item.inputs.insert(item.inputs.end(), clip->depth.begin(), clip->depth.end());
    }
    const auto page = RunOne(ReportDeclaration(), std::move(item));
    if (!page) return Forward(page);
    if (page->artifact.empty()) return {};
    if (Status made = MakeFolder(folder() / "report"); !made) return made;
    result_.report = folder() / "report" / "index.html";
    if (Status copied = CopyWhole(page->artifact, result_.report); !copied) return copied;
    return Fits() ? Pictures() : Status();
  }

  /// The middle fit of the report as pictures beside the page.
  Status Pictures() {
    const auto drawn = ClipsToDraw(clips_, 3);
    if (drawn.empty()) return {};
    const ClipRecord& clip = *drawn[drawn.size() / 2];
    std::vector<ItemSpec> items;
    for (const char* kind : {"clip", "overlay", "cloud"}) {
      if (clip.depth.empty() && std::string(kind) != "clip") continue;
      ItemSpec item{kind, {{"kind", kind}}, {InputFrom("evidence", clip.evidence), InputFrom("fit", clip.motion)}};
      item.inputs.insert(item.inputs.end(), clip.depth.begin(), clip.depth.end());
      items.push_back(std::move(item));
    }
    const auto report = RunStage(PictureDeclaration(), std::move(items));
    if (!report) return Forward(report);
    for (const ItemResult& item : report->items) {
      if (item.artifact.empty()) continue;
      if (Status copied = CopyWhole(item.artifact, folder() / "report" / (item.item + ".png")); !copied) return copied;
    }
    return {};
  }

  JobOptions options_;
  JobStage last_;
  Runner& runner_;
  JobResult result_;
  std::vector<ClipRecord> clips_;
  std::vector<Finding> left_out_;
  std::map<std::string, ItemResult> persons_;
  std::vector<StageInput> truth_;
  std::vector<StageInput> networks_;
  std::vector<std::string> roles_;
  ItemResult dataset_, baseline_;
};

}  // namespace

Expected<JobStage> JobStageFromName(const std::string& name) {
  std::string known;
  for (const StageName& stage : kStages) {
    if (name == stage.name) return stage.stage;
    known += std::string(known.empty() ? "" : ", ") + stage.name;
  }
  return Fail(ErrorCode::kUsage, "there is no stage '" + name + "'", "--to", "the stages are: " + known);
}

Expected<JobResult> RunMainJob(const JobOptions& options, JobStage last, Runner& runner) {
  return MainJob(options, last, runner).Run();
}

}  // namespace mocurate
