#include "train/stages.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/motion/action_parts.h"
#include "core/motion/operations.h"
#include "core/pipeline/worker.h"
#include "train/data/batches.h"
#include "train/generators/long_motion.h"
#include "train/options.h"
#include "train/trainer/trainer.h"

namespace mocurate {
namespace {

nlohmann::json LastOf(const Checkpoint& checkpoint, const std::string& column) {
  const auto found = checkpoint.history.find(column);
  return found == checkpoint.history.end() || found->second.empty() ? nlohmann::json()
                                                                    : nlohmann::json(found->second.back());
}

/// Columns of the history; missing values are null.
nlohmann::json HistoryOf(const Checkpoint& checkpoint) {
  nlohmann::json history = nlohmann::json::object();
  for (const auto& [name, column] : checkpoint.history) {
    nlohmann::json& values = history[name] = nlohmann::json::array();
    for (const double value : column) values.push_back(std::isfinite(value) ? nlohmann::json(value) : nlohmann::json());
  }
  return history;
}

nlohmann::json SummaryOf(const Checkpoint& checkpoint, const NetworkOptions& options) {
  nlohmann::json summary = {{"kind", checkpoint.kind},
                            {"name", options.name},
                            {"seed", options.seed()},
                            {"iterations", checkpoint.step},
                            {"batch", checkpoint.facts.at("batch")},
                            {"clips", checkpoint.facts.at("clips")},
                            {"parameters", checkpoint.facts.at("parameters")},
                            {"parameters_of", CountByPart(checkpoint.parameters)},
                            {"split", checkpoint.facts.at("split")},
                            {"classes", checkpoint.labels.size()},
                            {"loss", LastOf(checkpoint, "loss")},
                            {"history", HistoryOf(checkpoint)}};
  if (!options.recognises()) return summary;
  summary["validation_rule"] = checkpoint.facts.at("validation_rule");
  summary["validation_accuracy"] = nullptr;
  if (options.recogniser.selects()) summary["validation_accuracy"] = checkpoint.facts.at("best_accuracy");
  summary["chosen_epoch"] = checkpoint.facts.at("best_epoch");
  summary["epochs"] = options.recogniser.epochs;
  summary["refit"] = options.recogniser.refits();
  summary["train_accuracy"] = LastOf(checkpoint, "accuracy");
  return summary;
}

struct TrainingInput {
  NetworkOptions options;
  TrainingSet set;
  std::string sha256;  ///< of what it is trained on
  std::shared_ptr<const Skin> skin;
};

Expected<TrainingInput> InputOfTraining(const StageRequest& request) {
  Expected<NetworkOptions> options = OptionsFromJson<NetworkOptions>(request.options);
  if (!options) return Forward(options);
  const StageInput* dataset = FindInput(request, "dataset");
  if (dataset == nullptr) {
    return Fail(ErrorCode::kInternal, "the stage has no input of role 'dataset'", request.stage + " " + request.item);
  }
  Expected<TrainingSet> set = ReadTrainingSet(dataset->path, NeedsOf(*options));
  if (!set) return Forward(set);
  std::string sha256 = dataset->sha256;
  if (const StageInput* made = FindInput(request, "made")) {
    const Expected<TrainingSet> clips = ReadTrainingSet(made->path, NeedsOf(*options));
    if (!clips) return Forward(clips);
    if (Status added = AddMade(*clips, *set); !added) return Forward(added);
    sha256 = Sha256Hex(sha256 + made->sha256);
  }
  TrainingInput input{std::move(*options), std::move(*set), std::move(sha256), nullptr};
  if (const StageInput* body = FindInput(request, "body")) {
    if (IsOfOneGender(body->name)) {
      return Fail(ErrorCode::kInconsistent, "the body is of one gender, the loss is on the neutral one", body->name,
                  "use SMPL_NEUTRAL.pkl");
    }
    Expected<Skin> skin = ReadSkin(body->path, *input.set.skeleton);
    if (!skin) return Forward(skin);
    input.skin = std::make_shared<const Skin>(std::move(*skin));
  }
  return input;
}

/// The file's requests, with the motions that they continue: the first part of a sample, else the whole clip.
Expected<std::vector<MotionRequest>> RequestsOf(const StageRequest& request, const StageInput& file) {
  auto requests = ReadRequests(file.path);
  if (!requests) return Forward(requests);
  const StageInput* previous = FindInput(request, "previous");
  if (previous == nullptr) return requests;
  const auto set = ReadDataset(previous->path);
  if (!set) return Forward(set);
  std::map<std::string, std::shared_ptr<const Clip>> clips;
  for (MotionRequest& one : *requests) {
    if (one.previous_clip.empty()) continue;
    std::shared_ptr<const Clip>& clip = clips[one.previous_clip];
    const auto found = std::find_if(set->clips.begin(), set->clips.end(),
                                    [&](const Clip& candidate) { return candidate.id() == one.previous_clip; });
    if (found == set->clips.end() || !found->motion) {
      return Fail(ErrorCode::kInconsistent, "the set has no motion '" + one.previous_clip + "'", previous->name,
                  "use a clip of the set");
    }
    if (clip == nullptr) {
      const auto parts = PartsOf(*found);
      const int end = parts && parts->frames[0] > 0 ? parts->frames[0] : found->motion->frame_count();
      auto cut = Cut(*found, 0, end);
      if (!cut) return Forward(cut);
      clip = std::make_shared<const Clip>(std::move(*cut));
    }
    one.previous = clip;
  }
  return requests;
}

/// Networks that generate scripts together with the first one.
Status OpenPartners(const StageRequest& request, LongMotionNetworks& networks) {
  if (FindInput(request, "motions") == nullptr && !request.options.empty()) {
    const auto options = OptionsFromJson<LongMotionOptions>(request.options);
    if (!options) return Forward(options);
    networks.align = options->align;
    networks.snap = options->snap;
    networks.keep_previous = options->keep_previous;
  }
  for (const auto& [role, network] : {std::pair("first", &networks.first), std::pair("fill", &networks.fill)}) {
    const StageInput* file = FindInput(request, role);
    if (file == nullptr) continue;
    auto loaded = MotionGenerator::Load(file->path);
    if (!loaded) return Forward(loaded);
    *network = std::move(*loaded);
  }
  return {};
}

}  // namespace

Expected<StageOutcome> TrainStage(const StageRequest& request) {
  const Expected<TrainingInput> input = InputOfTraining(request);
  if (!input) return Forward(input);
  TrainingControl control;
  control.scratch = request.scratch;
  control.dataset_sha256 = input->sha256;
  control.skin = input->skin;
  control.threads = request.threads;
  control.stop = [] { return StopRequested(); };
  control.progress = [](double fraction, const std::string& text) { ReportProgress(fraction, text); };
  if (const StageInput* start = FindInput(request, "start")) control.start = start->path;
  if (const StageInput* weights = FindInput(request, "weights")) control.weights = weights->path;
  if (const StageInput* first = FindInput(request, "start_from")) control.start_from = first->path;
  double seconds_before = 0.0;
  control.resumed = [&](double seconds) { seconds_before = seconds; };
  StageOutcome outcome;
  control.report = [&](Finding finding) { outcome.findings.push_back(std::move(finding)); };
  const Expected<Checkpoint> checkpoint = TrainNetwork(input->set, input->options, control);
  if (!checkpoint) return Forward(checkpoint);
  if (Status written = WriteCheckpoint(*checkpoint, request.output); !written) return Forward(written);
  outcome.summary = SummaryOf(*checkpoint, input->options);
  if (auto about = input->set.inferred.About()) outcome.findings.push_back(*std::move(about));
  if (seconds_before > 0.0) outcome.summary["seconds_before"] = seconds_before;
  return outcome;
}

Expected<StageOutcome> TrainCostStage(const StageRequest& request) {
  const Expected<TrainingInput> input = InputOfTraining(request);
  if (!input) return Forward(input);
  const Expected<TrainingCost> cost = MeasureCost(input->set, input->options, input->skin, request.threads);
  if (!cost) return Forward(cost);
  StageOutcome outcome;
  outcome.summary = {{"steps", cost->steps},
                     {"seconds_per_step", cost->seconds_per_step},
                     {"parameters", cost->parameters},
                     {"threads", request.threads}};
  if (Status written = WriteFile(request.output, outcome.summary.dump() + "\n"); !written) return Forward(written);
  return outcome;
}

Expected<StageOutcome> GenerateStage(const StageRequest& request) {
  const StageInput *network = FindInput(request, "generator"), *asked = FindInput(request, "requests");
  const StageInput* noisy = FindInput(request, "motions");
  if (network == nullptr || (asked == nullptr) == (noisy == nullptr)) {
    return Fail(ErrorCode::kInternal, "the stage needs 'generator', and 'requests' or 'motions'", request.item);
  }
  auto loaded = MotionGenerator::Load(network->path);
  if (!loaded) return Forward(loaded);
  const std::shared_ptr<const MotionGenerator> generator = std::move(*loaded);
  Expected<Dataset> set = Dataset();
  StageOutcome outcome;
  if (noisy != nullptr) {
    const auto options = OptionsFromJson<RemakeOptions>(request.options);
    if (!options) return Forward(options);
    auto read = ReadDataset(noisy->path);
    if (!read) return Forward(read);
    const auto placed = [&](const Error& error) {  // error in the file, not in "motions"
      Error own = error;
      if (own.where == "motions") own.where = noisy->name;
      return tl::unexpected<Error>(own);
    };
    if (options->training_windows) {
      read = TrainingWindows(std::move(*read), generator->options(), options->rule == RemakeRule::kDenoise);
      if (!read) return Forward(read);
      outcome.findings = read->findings;
    }
    set = generator->Remake(std::move(*read), *options, request.threads, [](double part) {
      ReportProgress(part, "motions");
      return !StopRequested();
    });
    if (!set) return placed(set.error());
  } else {
    const auto requests = RequestsOf(request, *asked);
    if (!requests) return Forward(requests);
    LongMotionNetworks networks;
    networks.main = generator;
    if (Status opened = OpenPartners(request, networks); !opened) return Forward(opened);
    set = GenerateLongMotions(networks, *requests, request.threads, [](double part) {
      ReportProgress(part, "motions");
      return !StopRequested();
    });
  }
  if (!set) return Forward(set);
  if (Status written = WriteDataset(*set, request.output); !written) return Forward(written);
  outcome.summary = {{"motions", set->clips.size()}};
  return outcome;
}

}  // namespace mocurate
