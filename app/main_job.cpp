#include "app/main_job.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "app/curation_log.h"
#include "app/evaluation.h"
#include "app/job_checks.h"
#include "app/job_items.h"
#include "app/network_rows.h"
#include "app/protocols.h"
#include "app/report_run.h"
#include "app/run_outputs.h"
#include "app/scratch_folder.h"
#include "app/stage_runs.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "eval/tables/result_table.h"
#include "ingest/discover.h"
#include "ingest/set_contradictions.h"
#include "ingest/synthetic/capture_files.h"

namespace mocurate {
namespace {

/// Where the unfitted tracks go through the same stages, to compare.
constexpr const char* kFittedBranch = "fitted motion";
constexpr const char* kRawBranch = "raw tracks";

/// One run of the main job: holds what earlier stages gave to later ones.
class MainJob {
 public:
  MainJob(const JobOptions& options, JobStage last, Runner& runner, const std::vector<std::string>& only)
      : options_(options),
        last_(last),
        runner_(runner),
        only_(only),
        outputs_(runner.options().run_folder),
        runs_(runner, result_.stages) {}

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
    if (Status cleared = Clear(Next(last_), JobStage::kReport); !cleared) return Forward(cleared);
    for (const auto& [stage, step] : steps) {
      if (stage > last_) break;
      Status done = (this->*step)();
      if (stage <= JobStage::kAssemble && !DryRun() && !clips_.empty()) {
        const Status logged = WriteCurationLog(clips_, outputs_.Place("curation_log.jsonl"));
        if (!logged) return Forward(logged);
      }
      if (done) done = Clear(stage, stage);
      if (done) continue;
      if (!DryRun()) outputs_.WarnOfLeftovers();
      return Forward(done);
    }
    CountClips(clips_, result_);
    return result_;
  }

 private:
  std::filesystem::path folder() const { return runner_.options().run_folder; }
  bool DryRun() const { return runner_.options().dry_run; }

  static JobStage Next(JobStage stage) { return static_cast<JobStage>(static_cast<int>(stage) + 1); }

  /// What an earlier run left and these stages, which are over or will not run, did not write.
  Status Clear(JobStage first, JobStage last) const {
    return DryRun() ? Status() : outputs_.RemoveLeftovers(first, last);
  }

  void AddSetFindings(const std::vector<Finding>& findings) {
    for (const Finding& finding : findings)
      Log(finding.severity == Severity::kError ? LogLevel::kError : LogLevel::kWarning, finding.message);
    result_.set_findings.insert(result_.set_findings.end(), findings.begin(), findings.end());
  }

  static void AddInput(const StageInput& input, std::vector<ItemSpec>& items) {
    for (ItemSpec& item : items) item.inputs.push_back(input);
  }

  /// A folder that is given takes the place of the capture.
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
    LogLeftOut(discovery->left_out);
    AddSetFindings(discovery->findings);
    if (last_ >= JobStage::kAssemble) {
      if (Status groups = CheckSplitGroups(options_.assemble, *discovery); !groups) return groups;
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
    clips_ = RecordsOf(specs, report->items, std::move(discovery->left_out));
    if (!discovery->truth.empty()) {
      const auto truth = runs_.Run(TruthDeclaration(), std::move(discovery->truth));
      if (!truth) return Forward(truth);
      for (const ItemResult& item : truth->items) {
        if (!item.artifact.empty()) truth_.push_back(InputFrom("truth", item));
      }
    }
    return {};
  }

  /// Clips that show the same.
  Status FindDuplicates() {
    auto item = DuplicatesItem(clips_, OptionsToJson(options_.ingest.source.checks));
    if (!item) return {};
    const auto found = runs_.One(DuplicatesDeclaration(), *std::move(item));
    if (!found) return Forward(found);
    NoteDuplicates(*found, clips_);
    if (!found->outcome.findings.empty()) duplicates_ = InputFrom("findings", *found);
    return {};
  }

  bool Fits() const { return options_.fitting.method != FitMethod::kNone; }

  Status Proportions() {
    if (!Fits()) return {};
    std::vector<ItemSpec> items =
        ProportionItems(clips_, options_.proportions.body_of, OptionsToJson(ProportionsOf(options_)));
    AddInput(SkeletonInput(options_.proportions.skeleton), items);
    const auto report = runs_.Run(ProportionsDeclaration(), std::move(items));
    if (!report) return Forward(report);
    for (const ItemResult& item : report->items) persons_[item.item] = item;
    return {};
  }

  Status Fit() {
    if (!Fits() && !options_.fitting.contacts.remove_sliding) {
      for (ClipRecord& clip : clips_) clip.motion = clip.evidence;
      return {};
    }
    const nlohmann::json options = OptionsToJson(options_.fitting);
    FitItems fits = Fits() ? FittingItems(clips_, options_.proportions.body_of, persons_, options)
                           : GivenMotionItems(clips_, options);
    AddInput(SkeletonInput(options_.fitting.skeleton), fits.items);
    const auto report = runs_.Run(FittingDeclaration(), std::move(fits.items));
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < report->items.size(); ++i) fits.clips[i]->motion = report->items[i];
    return {};
  }

  Status ScoreFits() {
    auto item = Fits() ? FitErrorItem(clips_, truth_) : std::nullopt;
    if (!item) return {};
    const auto scored = runs_.One(FitErrorDeclaration(), *std::move(item));
    if (!scored) return Forward(scored);
    result_.fit_error = scored->outcome.summary;
    return scored->artifact.empty() ? Status() : NoteFitErrors(*scored, clips_);
  }

  /// The comparison with raw tracks never costs the dataset: where it cannot be made, a finding says so.
  void DropComparison(const std::string& why) {
    unfitted_ = false;
    comparison_.push_back(ComparisonDropped(why));
    LogWarning(comparison_.back().message);
  }

  /// Before the work, as far as the declaration of the source tells.
  void CheckComparison() {
    unfitted_ = options_.train.NeedsUnfitted();
    const std::string missing = unfitted_ ? JointsWithoutTrack(options_) : "";
    if (missing.empty() || last_ < JobStage::kCanon) return;
    DropComparison("the source tracks no " + missing + " of skeleton '" + options_.canon.skeleton + "'");
  }

  Status Canonicalise() {
    const bool both = unfitted_;
    Status done = CanonItems("motion", &ClipRecord::motion, &ClipRecord::canonical, both ? kFittedBranch : "");
    if (!done || !both) return done;
    return CanonItems("tracks", &ClipRecord::evidence, &ClipRecord::baseline, kRawBranch);
  }

  Status CanonItems(const char* role, ItemResult ClipRecord::*from, ItemResult ClipRecord::*to, const char* branch) {
    const nlohmann::json options = OptionsToJson(options_.canon);
    std::vector<ItemSpec> items;
    std::vector<ClipRecord*> records;
    for (ClipRecord& clip : clips_) {
      if ((clip.*from).artifact.empty()) continue;
      items.push_back({clip.item, options, {InputFrom(role, clip.*from)}});
      records.push_back(&clip);
    }
    AddInput(SkeletonInput(options_.canon.skeleton), items);
    auto report = runs_.Run(CanonDeclaration(), std::move(items), branch);
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < report->items.size(); ++i) records[i]->*to = report->items[i];
    if (to == &ClipRecord::canonical) AddSetFindings(UnmatchedDropLabels(options_.canon, report->items));
    return {};
  }

  Expected<ItemResult> AssembleFrom(const char* name, ItemResult ClipRecord::*from, const char* branch) {
    ItemSpec item{name, OptionsToJson(options_.assemble), {}};
    for (const ClipRecord& clip : clips_) {
      if (!(clip.*from).artifact.empty()) item.inputs.push_back(InputFrom("clip", clip.*from));
    }
    if (item.inputs.empty()) {
      if (runner_.options().dry_run) return ItemResult();
      const Error first = FirstReason(clips_, from);
      return Fail(first.code, "no clip is left for the dataset; " + first.Message(), DisplayPath(options_.ingest.path),
                  "curation_log.jsonl in the run folder says why each was dropped");
    }
    if (duplicates_) item.inputs.push_back(*duplicates_);
    return runs_.One(AssembleDeclaration(), std::move(item), branch);
  }

  Status Assemble() {
    const auto dataset = AssembleFrom("dataset", &ClipRecord::canonical, unfitted_ ? kFittedBranch : "");
    if (!dataset) return Forward(dataset);
    AddSetFindings(NoteLeftOutOfSet(*dataset, clips_));
    dataset_ = *dataset;
    if (unfitted_) {
      const auto baseline = AssembleFrom("baseline", &ClipRecord::baseline, kRawBranch);
      const ExitCode fault = baseline ? ExitCode::kDone : ExitCodeOf(baseline.error().code);
      if (fault > ExitCode::kInputUnusable) return Forward(baseline);
      if (baseline) baseline_ = *baseline;
      if (!baseline) DropComparison(baseline.error().Message());
    }
    result_.set_findings.insert(result_.set_findings.end(), comparison_.begin(), comparison_.end());
    if (dataset_.artifact.empty() || DryRun()) return {};
    result_.dataset = outputs_.Place("dataset.h5");
    return CopyWhole(dataset_.artifact, result_.dataset);
  }

  Status Audit() {
    if (dataset_.artifact.empty()) return {};
    const auto audit =
        runs_.One(AuditDeclaration(), {"audit", OptionsToJson(options_.audit), {InputFrom("dataset", dataset_)}});
    if (!audit) return Forward(audit);
    result_.audit = audit->outcome.summary;
    return {};
  }

  /// All networks at once; one that fails costs the others nothing, but those that go on from it.
  Status Train() {
    if (dataset_.artifact.empty() && DryRun() && !options_.train.networks.empty()) {
      LogInfo("hours of the networks are measured once the dataset is there: run --to assemble first");
    }
    if (dataset_.artifact.empty()) return {};
    TrainingInputs inputs{InputFrom("dataset", dataset_), std::nullopt};
    if (!baseline_.artifact.empty()) inputs.unfitted = InputFrom("dataset", baseline_);
    std::vector<TrainItem> waiting = TrainItems(options_.train, inputs);
    if (Status added = AddFiles(waiting); !added) return added;
    if (DryRun()) return MeasureNetworks(waiting);
    std::map<std::string, ItemResult> done;
    while (!waiting.empty()) {
      const auto ready = std::stable_partition(waiting.begin(), waiting.end(), [&](const TrainItem& item) {
        return item.after.empty() || done.count(item.after) > 0;
      });
      std::vector<TrainItem> items(waiting.begin(), ready);
      waiting.erase(waiting.begin(), ready);
      if (Status trained = TrainWave(std::move(items), done); !trained) return trained;
    }
    std::stable_sort(networks_.begin(), networks_.end(), [](const TrainedNetwork& a, const TrainedNetwork& b) {
      return a.network < b.network;  // as in the config, not as they were trained
    });
    return {};
  }

  /// Files that networks read beside the dataset: weights that were trained elsewhere, the body of a loss.
  Status AddFiles(std::vector<TrainItem>& items) const {
    for (TrainItem& item : items) {
      const NetworkOptions& network = options_.train.networks[item.network];
      const std::pair<const char*, const std::filesystem::path*> files[] = {
          {"weights", &network.learning.weights},
          {"start_from", &network.learning.start_from},
          {"body", &network.actor.body}};
      for (const auto& [role, file] : files) {
        if (file->empty()) continue;
        const Expected<std::string> sha256 = Sha256OfFile(*file);
        if (!sha256) return Forward(sha256);
        item.spec.inputs.push_back({role, file->filename().string(), *file, *sha256});
      }
    }
    return {};
  }

  /// A dry run trains nothing; a few steps of each network, elsewhere, say what it would take.
  Status MeasureNetworks(const std::vector<TrainItem>& items) {
    const ScratchFolder scratch;
    if (scratch.path().empty()) return scratch.Missing();
    RunnerOptions settings = runner_.options();
    settings.dry_run = false;
    settings.jobs = 1;
    settings.run_folder = scratch.path();
    settings.cache_folder = scratch.path() / "cache";
    auto runner = Runner::Make(settings);
    if (!runner) return Forward(runner);
    std::vector<ItemSpec> specs;
    for (const TrainItem& item : items) {
      const bool trained = options_.train.networks[item.network].learning.weights.empty();
      if (trained && item.spec.item.find('@') == std::string::npos) specs.push_back(item.spec);
    }
    const auto report = (*runner)->Run(TrainCostDeclaration(), std::move(specs));
    if (!report) return Forward(report);
    for (const ItemResult& item : report->items) {
      const nlohmann::json& cost = item.outcome.summary;
      if (item.artifact.empty()) {
        result_.untrained[item.item] = item.outcome.error;
        continue;
      }
      result_.training[item.item] = cost;
      const double step = cost.at("seconds_per_step").get<double>(), steps = cost.at("steps").get<double>();
      LogInfo(item.item + ": " + Counted(cost.at("steps").get<long long>(), "step") + " of " + RoundedText(step, 3) +
              " s with " + Counted(cost.at("threads").get<long long>(), "thread") + ", " +
              RoundedText(step * steps / 3600.0, 3) + " h; " +
              Counted(cost.at("parameters").get<long long>(), "parameter"));
    }
    return {};
  }

  Status TrainWave(std::vector<TrainItem> items, std::map<std::string, ItemResult>& done) {
    std::vector<ItemSpec> specs;
    std::vector<TrainItem> run;
    for (TrainItem& item : items) {
      if (!item.after.empty()) {
        const ItemResult& before = done.at(item.after);
        if (before.artifact.empty() && !DryRun()) {
          result_.untrained[item.spec.item] = before.outcome.error;
          done[item.spec.item] = before;
          continue;
        }
        if (!before.artifact.empty()) item.spec.inputs.push_back(InputFrom("start", before));
      }
      specs.push_back(item.spec);
      run.push_back(std::move(item));
    }
    const auto report = runs_.Run(TrainDeclaration(), std::move(specs));
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < run.size(); ++i) {
      const ItemResult item = i < report->items.size() ? report->items[i] : ItemResult();
      done[run[i].spec.item] = item;
      if (!item.artifact.empty()) {
        networks_.push_back({run[i].network, run[i].row, InputFrom("network", item)});
        result_.training[item.item] = item.outcome.summary;
        if (Status copied = CopyCheckpoint(item); !copied) return copied;
      } else if (!DryRun()) {
        result_.untrained[item.item] = item.outcome.error;
      }
    }
    return {};
  }

  Status CopyCheckpoint(const ItemResult& item) {
    if (DryRun()) return {};
    if (Status made = MakeFolder(folder() / "checkpoints"); !made) return made;
    return CopyWhole(item.artifact, outputs_.Place("checkpoints/" + FileNameOf(item.item) + ".h5"));
  }

  const NetworkOptions& OptionsOf(const TrainedNetwork& network) const {
    return options_.train.networks[network.network];
  }

  /// An evaluation that fails costs the table, not the report.
  Status ScoreNetworks() {
    const std::string recogniser = RecogniserOf(options_);
    const auto first = std::find_if(networks_.begin(), networks_.end(), [&](const TrainedNetwork& network) {
      return OptionsOf(network).name == recogniser;
    });
    if (dataset_.artifact.empty()) return {};
    if (Status scored = ScoreRecognisers(); !scored) return scored;
    const bool generates = std::any_of(networks_.begin(), networks_.end(), [&](const TrainedNetwork& network) {
      return GeneratesMotions(OptionsOf(network).kind);
    });
    if (generates && recogniser.empty()) {
      LogWarning("no table: no recogniser of train.networks gives features (add {kind: gru_recogniser})");
    }
    if (first == networks_.end()) return {};
    Evaluation evaluation;
    evaluation.extractor = OwnExtractor(OptionsOf(*first));
    evaluation.weights = first->checkpoint;
    evaluation.draw = options_.evaluate.draw();
    evaluation.metrics = options_.evaluate.metrics();
    evaluation.seed = options_.evaluate.seed;
    evaluation.real_part = options_.evaluate.test_reference ? RealPart::kTrain : options_.evaluate.real;
    evaluation.test_reference = options_.evaluate.test_reference;
    evaluation.split = options_.evaluate.split;
    const StageInput dataset = InputFrom("motions", dataset_);
    evaluation.real = ScoredSet{"Real", dataset, std::nullopt};
    for (const TrainedNetwork& network : networks_) {
      if (GeneratesMotions(OptionsOf(network).kind)) {
        evaluation.rows.push_back({network.row, dataset, network.checkpoint});
      }
    }
    auto evaluated = ::mocurate::Evaluate(evaluation, runs_);
    if (!evaluated) return Forward(evaluated);
    if (DryRun()) return {};
    if (!evaluated->failed.empty()) {
      const auto& [row, error] = *evaluated->failed.begin();
      result_.unevaluated = error;
      result_.unevaluated->where = "row '" + row + "'" + (error.where.empty() ? "" : ", " + error.where);
    }
    if (evaluated->rows.empty()) return {};
    result_.metrics["recognisers"] = std::move(recognisers_);
    result_.metrics["protocol"] = "own";
    result_.metrics["variant"] = "released";
    result_.metrics["extractor"] = first->checkpoint.name;
    result_.metrics["rows"] = std::move(evaluated->rows);
    result_.metrics["comparisons"] = std::move(evaluated->comparisons);
    result_.metrics["warnings"] = std::move(evaluated->warnings);
    const EvaluateOptions& evaluate = options_.evaluate;
    const auto published = PublishedNumbers(evaluate.paper, evaluate.published);
    if (!published) return Forward(published);
    result_.metrics["published"] = nlohmann::json::array();
    for (const nlohmann::json& value : *published) {
      const bool of_table = evaluate.table.empty() || value.at("table") == evaluate.table;
      if (value.at("paper") == evaluate.paper && of_table) result_.metrics["published"].push_back(value);
    }
    result_.metrics["notes"] = NotesOf(options_.evaluate);
    AddTraining({networks_, options_.train, result_.training, JournalOf(folder(), TrainDeclaration().name)},
                options_.evaluate.settled, result_.metrics["rows"]);
    return WriteMetrics();
  }

  /// A recogniser of ours says of itself how motions become what it reads; what a pass draws depends on this much.
  static ExtractorOptions OwnExtractor(const NetworkOptions& network) {
    const TrainingDataOptions& data = network.data;
    ExtractorOptions extractor;
    extractor.name = "own";
    if (network.kind == NetworkKind::kStGcn) {
      extractor.network = ExtractorNetwork::kStGcn;
      extractor.values = ExtractorValues::kRotation6DRows;
    }
    extractor.frames = data.frames;
    extractor.length = data.input == RecogniserInputKind::kResample ? LengthRule::kResample : LengthRule::kCrop;
    return extractor;
  }

  /// Accuracy and confusion of every recogniser on the test clips, by its name.
  Status ScoreRecognisers() {
    std::vector<const TrainedNetwork*> scored;
    std::vector<ItemSpec> items;
    for (const TrainedNetwork& network : networks_) {
      const NetworkOptions& own = OptionsOf(network);
      if (GeneratesMotions(own.kind)) continue;
      FeaturesOptions options;
      options.extractor = OwnExtractor(own);
      options.part = RealPart::kTest;
      options.split = options_.evaluate.split.empty() ? own.data.split : options_.evaluate.split;
      const bool unfitted = own.trained_on == TrainingSetChoice::kUnfitted;
      ItemSpec item{"features/" + network.checkpoint.name, OptionsToJson(options), {network.checkpoint}};
      item.inputs[0].role = "weights";
      item.inputs.push_back(InputFrom("motions", unfitted ? baseline_ : dataset_));
      items.push_back(std::move(item));
      scored.push_back(&network);
    }
    if (items.empty()) return {};
    const auto features = runs_.Run(FeaturesDeclaration(), std::move(items), "recognisers");
    if (!features) return Forward(features);
    items.clear();
    std::vector<const TrainedNetwork*> rows;
    for (std::size_t i = 0; i < features->items.size(); ++i) {
      const ItemResult& item = features->items[i];
      nlohmann::json& kind = recognisers_[OptionsOf(*scored[i]).name];
      if (item.artifact.empty()) {
        if (!DryRun()) kind["scored"] = item.outcome.error.what;
        continue;
      }
      ScoreOptions score;
      score.name = scored[i]->checkpoint.name;
      score.metrics = options_.evaluate.metrics();
      kind["labels"] = item.outcome.summary.at("classes");
      items.push_back({"score/" + score.name, OptionsToJson(score), {InputFrom("row", item)}});
      rows.push_back(scored[i]);
    }
    const auto scores = runs_.Run(ScoreDeclaration(), std::move(items), "recognisers");
    if (!scores) return Forward(scores);
    for (std::size_t i = 0; i < scores->items.size(); ++i) {
      if (!scores->items[i].artifact.empty()) AddRecogniser(OptionsOf(*rows[i]).name, scores->items[i].outcome.summary);
    }
    return {};
  }

  void AddRecogniser(const std::string& name, const nlohmann::json& row) {
    nlohmann::json& kind = recognisers_[name];
    const nlohmann::json& accuracy = row.at("metrics").at("accuracy").at("value");
    if (!accuracy.is_number()) return;
    kind["test_accuracy"].push_back(accuracy);
    kind["test_clips"] = row.at("motions");
    kind["scored"] = "test clips";
    double sum = 0.0;
    for (const nlohmann::json& value : kind["test_accuracy"]) sum += value.get<double>();
    kind["mean"] = sum / static_cast<double>(kind["test_accuracy"].size());
    nlohmann::json& confusion = kind["confusion"];
    const nlohmann::json& own = row.at("confusion");
    if (confusion.is_null()) {
      confusion = own;
    } else {
      for (std::size_t r = 0; r < own.size(); ++r) {
        for (std::size_t c = 0; c < own[r].size(); ++c)
          confusion[r][c] = confusion[r][c].get<int>() + own[r][c].get<int>();
      }
    }
  }

  Status WriteMetrics() {
    result_.metrics = WithNotes(std::move(result_.metrics), options_, result_);
    if (Status written = WriteFile(outputs_.Place("metrics.json"), result_.metrics.dump(1) + "\n"); !written) {
      return written;
    }
    const auto tables = WriteTables(result_.metrics, options_.name, folder() / "tables");
    if (!tables) return Forward(tables);
    result_.table = tables->markdown;
    result_.tables = tables->files;
    for (const auto& file : tables->files) outputs_.Place("tables/" + file.filename().native());
    return {};
  }

  Status Report() {
    if (dataset_.artifact.empty() || DryRun()) return {};
    if (Status made = MakeFolder(folder() / "report"); !made) return made;
    return WriteReport({options_, clips_, persons_, dataset_, networks_, Fits()}, runs_, outputs_, result_);
  }

  JobOptions options_;
  JobStage last_;
  bool synthetic_ = false;
  bool unfitted_ = false;  ///< the clips before fitting go through the same stages, to compare
  Runner& runner_;
  const std::vector<std::string>& only_;
  RunOutputs outputs_;
  JobResult result_;
  StageRuns runs_;
  std::vector<ClipRecord> clips_;
  std::optional<std::set<std::string>> captured_;  ///< files of the synthetic capture: others are not ours
  std::map<std::string, ItemResult> persons_;
  std::optional<StageInput> duplicates_;  ///< findings about clips that show the same
  std::vector<StageInput> truth_;
  std::vector<TrainedNetwork> networks_;
  nlohmann::json recognisers_ = nlohmann::json::object();  ///< accuracy by name of the network
  ItemResult dataset_, baseline_;
  std::vector<Finding> comparison_;  ///< why there is none
};

}  // namespace

Expected<JobResult> RunMainJob(const JobOptions& options, JobStage last, Runner& runner,
                               const std::vector<std::string>& only) {
  return MainJob(options, last, runner, only).Run();
}

}  // namespace mocurate
