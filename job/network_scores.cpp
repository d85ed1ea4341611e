#include "job/network_scores.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/log.h"
#include "core/base/text.h"
#include "eval/published/published.h"
#include "eval/stages.h"
#include "eval/tables/result_table.h"
#include "job/evaluation.h"
#include "job/protocols.h"
#include "job/published_recogniser.h"

namespace mocurate {
namespace {

const NetworkOptions& NetworkOf(const JobOptions& options, const TrainedNetwork& network) {
  return options.train.networks[network.network];
}

/// A recogniser of mocurate declares its own preprocessing; the number of draws in a pass depends on it.
ExtractorOptions OwnExtractor(const NetworkOptions& network, const EvaluateOptions& evaluate) {
  const TrainingDataOptions& data = network.data;
  ExtractorOptions extractor;
  extractor.name = "own";
  extractor.real_root = evaluate.real_root;
  extractor.generated_root = evaluate.generated_root;
  if (network.kind == NetworkKind::kStGcn) {
    extractor.network = ExtractorNetwork::kStGcn;
    extractor.values = ExtractorValues::kRotation6DRows;
  }
  extractor.frames = data.frames;
  extractor.length = data.input == RecogniserInputKind::kResample ? LengthRule::kResample : LengthRule::kCrop;
  return extractor;
}

/// The network of that name with the seed of another one, else its first; empty without one.
std::optional<StageInput> PartnerOf(const std::string& name, const TrainedNetwork& of,
                                    const std::vector<TrainedNetwork>& networks, const JobOptions& options) {
  const auto seed = [](const TrainedNetwork& network) { return SeedOfItem(network.checkpoint.name); };
  const TrainedNetwork* found = nullptr;
  for (const TrainedNetwork& network : networks) {
    if (NetworkOf(options, network).name != name || network.IsSample()) continue;
    if (found == nullptr || seed(network) == seed(of)) found = &network;
  }
  if (found == nullptr) return std::nullopt;
  return found->checkpoint;
}

/// Rows of a network for `evaluate.rows`, one for each step of a chain.
std::vector<ScoredSet> ScriptRows(const TrainedNetwork& network, const std::vector<TrainedNetwork>& networks,
                                  const JobOptions& options, const StageInput& motions) {
  std::vector<ScoredSet> rows;
  const std::string& name = NetworkOf(options, network).name;
  for (const ScriptRowOptions& asked : options.evaluate.rows) {
    if (asked.network != name) continue;
    ScoredSet row{asked.name + network.row.substr(name.size()), motions, network.checkpoint};
    row.script = asked.script;
    row.align = asked.align;
    row.steps = asked.steps;
    row.first = PartnerOf(asked.first, network, networks, options);
    row.fill = PartnerOf(asked.fill, network, networks, options);
    const bool whole = asked.first.empty() == !row.first && asked.fill.empty() == !row.fill;
    if (!whole) LogWarning("no row '" + row.name + "': '" + asked.first + asked.fill + "' is not trained in this run");
    const std::string base = row.name;
    for (row.step = 1; whole && row.step <= asked.steps; ++row.step) {
      if (asked.steps > 1) row.name = base + ", step " + std::to_string(row.step);
      const bool first = asked.script == ScriptDraw::kChain && row.step == 1;  // which no transition precedes
      if (first && options.evaluate.part == ClipPart::kTransition) continue;
      rows.push_back(row);
    }
  }
  return rows;
}

/// Rows of the yardsticks, before those of the networks.
void AddYardsticks(const EvaluateOptions& evaluate, const StageInput& motions, std::vector<ScoredSet>& rows) {
  if (!evaluate.yardsticks) return;
  std::vector<ScoredSet> first;
  for (const auto& [name, yardstick] :
       {std::pair("Retrieval", Yardstick::kRetrieval), std::pair("Shuffled labels", Yardstick::kShuffledLabels),
        std::pair("Mean pose", Yardstick::kMeanPose)}) {
    first.push_back({name, motions, std::nullopt});
    first.back().yardstick = yardstick;
  }
  rows.insert(rows.begin(), first.begin(), first.end());
}

bool IsYardstick(const std::string& row, const Evaluation& evaluation) {
  return std::any_of(evaluation.rows.begin(), evaluation.rows.end(),
                     [&](const ScoredSet& set) { return set.name == row && set.yardstick != Yardstick::kNone; });
}

/// One recogniser on one set of test clips.
struct RecogniserTest {
  const TrainedNetwork* network = nullptr;
  bool denoised = false;
};

/// The denoised set whose test clips are used for a recogniser; null without one.
const DenoisedSet* DenoisedFor(const NetworkOptions& recogniser, const JobOptions& options,
                               const std::vector<DenoisedSet>& sets) {
  const DenoisedSet* found = nullptr;
  for (const DenoisedSet& set : sets) {
    const NetworkOptions& generator = options.train.networks[set.network];
    const bool same =
        !generator.data.all_clips && !recogniser.data.all_clips && generator.data.split == recogniser.data.split;
    if (same && generator.name == recogniser.generator) return &set;
    if (same && found == nullptr) found = &set;
  }
  return found;
}

/// Published numbers of recognisers include an accuracy on denoised clips.
bool OfRecogniser(const nlohmann::json& value, const nlohmann::json& published) {
  return std::any_of(published.begin(), published.end(), [&](const nlohmann::json& other) {
    return other.at("method") == value.at("method") && other.at("table") == value.at("table") &&
           other.at("metric") == "accuracy_denoised";
  });
}

/// The numbers of recognisers, or the others.
nlohmann::json Chosen(const nlohmann::json& published, bool of_recognisers) {
  nlohmann::json chosen = nlohmann::json::array();
  for (const nlohmann::json& value : published) {
    if (OfRecogniser(value, published) == of_recognisers) chosen.push_back(value);
  }
  return chosen;
}

void AddConfusion(const nlohmann::json& own, nlohmann::json& confusion) {
  if (confusion.is_null()) {
    confusion = own;
    return;
  }
  for (std::size_t r = 0; r < own.size(); ++r) {
    for (std::size_t c = 0; c < own[r].size(); ++c) confusion[r][c] = confusion[r][c].get<int>() + own[r][c].get<int>();
  }
}

void AddScore(const RecogniserTest& tested, const nlohmann::json& row, nlohmann::json& result) {
  const nlohmann::json& accuracy = row.at("metrics").at("accuracy").at("value");
  if (!accuracy.is_number()) return;
  if (tested.denoised) {
    result["denoised_accuracy"].push_back(accuracy);
    return;
  }
  result["test_accuracy"].push_back(accuracy);
  result["test_clips"] = row.at("motions");
  result["scored"] = "test clips";
  const auto all = result["test_accuracy"].get<std::vector<double>>();
  result["mean"] = std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
  AddConfusion(row.at("confusion"), result["confusion"]);
}

struct TrainingEffort {
  bool known = false;  ///< whether this run folder has records of all training
  double seconds = 0.0;
  double peak_memory = 0.0;  ///< bytes, largest of the workers that trained it
};

/// STEP of "NAME/SEED@STEP", for a checkpoint sample of `base` ("NAME/SEED").
std::optional<long long> StepOfSample(const std::string& item, const std::string& base) {
  const std::size_t at = item.rfind('@');
  if (at == std::string::npos || item.substr(0, at) != base) return std::nullopt;
  return ParseInteger(item.substr(at + 1));
}

/// Effort of a network and of the samples it continued from.
TrainingEffort EffortOf(const std::map<std::string, nlohmann::json>& journal, const std::string& item,
                        std::int64_t steps) {
  TrainingEffort effort;
  bool all = true;
  for (const auto& [name, entry] : journal) {
    const auto step = StepOfSample(name, item.substr(0, item.rfind('@')));
    if (name != item && !(step && *step < steps)) continue;
    all = all && !entry.value("from_cache", false);
    effort.known = true;
    effort.seconds += entry.value("seconds", 0.0);
    effort.peak_memory = std::max(effort.peak_memory, entry.value("peak_memory_bytes", 0.0));
  }
  effort.known = effort.known && all;
  return effort;
}

/// "NAME/SEED@STEP" of a row, independent of its display name.
std::string NetworkOfRow(const nlohmann::json& row) {
  return row.contains("network") ? row["network"].get<std::string>() : row.at("name").get<std::string>();
}

/// FID of a row; empty without one.
std::optional<double> FidOfRow(const nlohmann::json& row) {
  const nlohmann::json fid = row.at("metrics").value("FID_train", nlohmann::json::object());
  if (!fid.is_object() || !fid.contains("value") || !fid["value"].is_number()) return std::nullopt;
  return fid["value"].get<double>();
}

/// Why a network that ended at `steps` has not converged; empty for a converged one.
std::string Unconverged(const NetworkOptions& options, const nlohmann::json& row, std::int64_t steps, double settled,
                        const nlohmann::json& rows) {
  if (options.learning.planned > steps) {
    return Counted(steps, "step") + " of " + std::to_string(options.learning.planned);
  }
  const auto fid = FidOfRow(row);
  std::optional<double> before;
  long long last = 0;
  for (const nlohmann::json& sample : rows) {
    if (sample.value("frames", 0) != row.value("frames", 0)) continue;
    const auto step = StepOfSample(NetworkOfRow(sample), NetworkOfRow(row));
    if (!step || *step < last) continue;
    last = *step;
    before = FidOfRow(sample);
  }
  if (!fid || !before || std::abs(*fid - *before) <= settled * *before) return "";
  return "FID train went from " + RoundedText(*before, 3) + " at step " + std::to_string(last) + " to " +
         RoundedText(*fid, 3) + " at step " + std::to_string(steps);
}

nlohmann::json MetricOf(const std::vector<double>& seeds) {
  if (seeds.empty()) return {{"value", nullptr}, {"interval", nullptr}};
  const double mean = std::accumulate(seeds.begin(), seeds.end(), 0.0) / static_cast<double>(seeds.size());
  return {{"value", mean}, {"interval", nullptr}, {"repetitions", seeds}};
}

}  // namespace

Expected<nlohmann::json> ScoreRecognisers(const std::vector<TrainedNetwork>& networks, const JobOptions& options,
                                          const TestSets& sets, StageRuns& runs) {
  std::vector<RecogniserTest> recogniser_tests;
  std::vector<ItemSpec> items;
  nlohmann::json recognisers = nlohmann::json::object();
  for (const TrainedNetwork& network : networks) {
    const NetworkOptions& own = NetworkOf(options, network);
    if (GeneratesMotions(own.kind)) continue;
    FeaturesOptions features;
    features.extractor = OwnExtractor(own, options.evaluate);
    features.part = RealPart::kTest;
    features.crop = CropDraw::kReleased;  // as in training; irrelevant where whole clips are read
    features.seed = options.evaluate.seed;
    features.purpose = "recognisers";
    features.clip_part = own.data.part;
    features.split = options.evaluate.split.empty() ? own.data.split : options.evaluate.split;
    const bool unfitted = own.trained_on == TrainingSetChoice::kUnfitted;
    const auto add = [&](const std::string& item, const ItemResult& motions, bool denoised) {
      ItemSpec spec{item, OptionsToJson(features), {network.checkpoint, InputFrom("motions", motions)}};
      spec.inputs[0].role = "weights";
      items.push_back(std::move(spec));
      recogniser_tests.push_back({&network, denoised});
    };
    add("features/" + network.checkpoint.name, unfitted ? sets.unfitted : sets.dataset, false);
    const DenoisedSet* denoised = unfitted ? nullptr : DenoisedFor(own, options, sets.denoised);
    if (denoised == nullptr) continue;
    features.split.clear();  // the denoised set only has that split
    features.known_frame = true;
    add("features/" + network.checkpoint.name + " on denoised", denoised->set, true);
  }
  if (items.empty()) return recognisers;
  const auto features = runs.Run(FeaturesDeclaration(), std::move(items), "recognisers");
  if (!features) return Forward(features);
  items.clear();
  std::vector<RecogniserTest> scored;
  for (std::size_t i = 0; i < features->items.size(); ++i) {
    const ItemResult& item = features->items[i];
    nlohmann::json& result = recognisers[NetworkOf(options, *recogniser_tests[i].network).name];
    if (item.artifact.empty()) {
      if (!recogniser_tests[i].denoised && !item.outcome.error.what.empty()) result["scored"] = item.outcome.error.what;
      continue;
    }
    ScoreOptions score;
    score.name = recogniser_tests[i].network->checkpoint.name;
    score.metrics = options.evaluate.metrics();
    if (!recogniser_tests[i].denoised) result["labels"] = item.summary.at("classes");
    const std::string name = "score/" + score.name + (recogniser_tests[i].denoised ? " on denoised" : "");
    items.push_back({name, OptionsToJson(score), {InputFrom("row", item)}});
    scored.push_back(recogniser_tests[i]);
  }
  const auto scores = runs.Run(ScoreDeclaration(), std::move(items), "recognisers");
  if (!scores) return Forward(scores);
  for (std::size_t i = 0; i < scores->items.size(); ++i) {
    if (scores->items[i].artifact.empty()) continue;
    AddScore(scored[i], scores->items[i].summary, recognisers[NetworkOf(options, *scored[i].network).name]);
  }
  return recognisers;
}

nlohmann::json RecognitionRows(const TrainOptions& options, const nlohmann::json& recognisers,
                               const nlohmann::json& published) {
  nlohmann::json result = {{"rows", nlohmann::json::array()}, {"published", Chosen(published, true)}};
  for (const NetworkOptions& network : options.networks) {
    const auto found = recognisers.find(network.name);
    if (found == recognisers.end() || !found->contains("mean")) continue;
    const nlohmann::json& scores = *found;
    const nlohmann::json metrics = {
        {"accuracy", MetricOf(scores.at("test_accuracy").get<std::vector<double>>())},
        {"accuracy_denoised", MetricOf(scores.value("denoised_accuracy", std::vector<double>()))}};
    result["rows"].push_back({{"name", network.name}, {"metrics", metrics}, {"ours", {{"metrics", metrics}}}});
  }
  return result;
}

nlohmann::json WithoutRecognisers(const nlohmann::json& published) { return Chosen(published, false); }

Expected<nlohmann::json> PublishedOfTable(const EvaluateOptions& evaluate) {
  const auto published = PublishedNumbers(evaluate.paper, evaluate.published);
  if (!published) return Forward(published);
  nlohmann::json of_table = nlohmann::json::array();
  for (const nlohmann::json& value : *published) {
    const bool meant = evaluate.table.empty() || value.at("table") == evaluate.table;
    if (value.at("paper") != evaluate.paper || !meant) continue;
    of_table.push_back(value);
  }
  return OfTransitions(of_table, evaluate.part == ClipPart::kTransition);
}

Expected<GeneratorScores> ScoreGenerators(const std::vector<TrainedNetwork>& networks, const JobOptions& options,
                                          const ItemResult& dataset, StageRuns& runs) {
  GeneratorScores scores;
  scores.metrics = {{"protocol", "own"},
                    {"variant", "released"},
                    {"extractor", nullptr},
                    {"rows", nlohmann::json::array()},
                    {"comparisons", nlohmann::json::array()},
                    {"warnings", nlohmann::json::array()}};
  if (!options.evaluate.generators) return scores;
  const std::string recogniser = RecogniserOf(options);
  const auto generates = [&](const TrainedNetwork& network) {
    return GeneratesMotions(NetworkOf(options, network).kind);
  };
  if (recogniser.empty() && std::any_of(networks.begin(), networks.end(), generates)) {
    LogWarning("no table, because train.networks has no recogniser (add {kind: gru_recogniser})");
  }
  const auto first = std::find_if(networks.begin(), networks.end(), [&](const TrainedNetwork& network) {
    return NetworkOf(options, network).name == recogniser;
  });
  if (first == networks.end()) return scores;
  const EvaluateOptions& evaluate = options.evaluate;
  Evaluation evaluation;
  evaluation.extractor = OwnExtractor(NetworkOf(options, *first), evaluate);
  evaluation.weights = first->checkpoint;
  evaluation.draw = evaluate.draw();
  evaluation.metrics = evaluate.metrics();
  evaluation.measures = evaluate.measures;
  evaluation.seed = evaluate.seed;
  evaluation.real_part = evaluate.test_reference ? RealPart::kTrain : evaluate.real;
  evaluation.test_reference = evaluate.test_reference;
  evaluation.split = evaluate.split;
  evaluation.part = evaluate.part;
  evaluation.requests_of_test = evaluate.requests_of_test;
  if (!evaluate.protocol.empty()) {
    const auto protocol = LoadProtocol(evaluate.protocol, {}, {options.allow_include});
    if (!protocol) return Forward(protocol);
    evaluation.equivalent = protocol->equivalent;
    evaluation.metrics.divisor = protocol->metrics.divisor;
  }
  const StageInput motions = InputFrom("motions", dataset);
  evaluation.real = ScoredSet{"Real", motions, std::nullopt};
  std::map<std::string, std::pair<std::string, std::int64_t>> asked;  // by row: network and number of frames
  const std::vector<double> durations = evaluate.durations.empty() ? std::vector<double>{0.0} : evaluate.durations;
  for (const TrainedNetwork& network : networks) {
    if (!generates(network)) continue;
    if (!evaluate.rows.empty()) {
      for (ScoredSet& row : ScriptRows(network, networks, options, motions)) {
        asked[row.name] = {network.row, 0};
        evaluation.rows.push_back(std::move(row));
      }
      continue;
    }
    const NetworkOptions& own = NetworkOf(options, network);
    if (own.kind == NetworkKind::kSsmct) continue;  // it generates no actions
    if (own.kind == NetworkKind::kMacvae) {
      evaluation.rows.push_back({network.row, motions, network.checkpoint});
      evaluation.rows.back().script = ScriptDraw::kAfterSample;
      asked[network.row] = {network.row, 0};
      continue;
    }
    for (const double duration : durations) {
      const auto frames = static_cast<std::int64_t>(duration);
      const std::string row = network.row + (frames > 0 ? ", " + Counted(frames, "frame") : "");
      evaluation.rows.push_back({row, motions, network.checkpoint, false, frames});
      asked[row] = {network.row, frames};
    }
    for (const FilterRowOptions& filtered : evaluate.filters) {
      if (filtered.network != own.name) continue;
      const std::string row = filtered.name + network.row.substr(own.name.size());
      evaluation.rows.push_back({row, motions, network.checkpoint});
      evaluation.rows.back().filter = filtered.filter;
      asked[row] = {network.row, 0};
    }
  }
  AddYardsticks(evaluate, motions, evaluation.rows);
  auto evaluated = ::mocurate::Evaluate(evaluation, runs);
  if (!evaluated) return Forward(evaluated);
  if (!evaluated->failed.empty()) {
    const auto& [row, error] = *evaluated->failed.begin();
    scores.unevaluated = error;
    scores.unevaluated->where = "row '" + row + "'" + (error.where.empty() ? "" : ", " + error.where);
  }
  if (evaluated->rows.empty()) return scores;
  for (nlohmann::json& row : evaluated->rows) {
    if (IsYardstick(row.at("name").get<std::string>(), evaluation)) row["given"] = kGivenMotions;
    const auto found = asked.find(row.at("name").get<std::string>());
    if (found == asked.end()) continue;
    row["network"] = found->second.first;
    if (found->second.second > 0) row["frames"] = found->second.second;
  }
  scores.metrics["extractor"] = first->checkpoint.name;
  scores.metrics["rows"] = std::move(evaluated->rows);
  if (Status added = AddPublishedRecogniser(evaluate.published_protocol, {options.allow_include}, std::move(evaluation),
                                            runs, scores.metrics);
      !added) {
    return Forward(added);
  }
  scores.metrics["comparisons"] = std::move(evaluated->comparisons);
  scores.metrics["warnings"] = std::move(evaluated->warnings);
  return scores;
}

void AddTraining(const std::vector<TrainedNetwork>& networks, const JobOptions& options,
                 const nlohmann::json& summaries, const std::map<std::string, nlohmann::json>& journal,
                 nlohmann::json& rows) {
  for (nlohmann::json& row : rows) {
    nlohmann::json ours = {{"metrics", row.at("metrics")}, {"checkpoint", nullptr},  {"steps", nullptr},
                           {"seconds", nullptr},           {"peak_memory", nullptr}, {"unconverged", nullptr}};
    for (const TrainedNetwork& network : networks) {
      const NetworkOptions& own = NetworkOf(options, network);
      if (network.row != NetworkOfRow(row) || !GeneratesMotions(own.kind)) continue;
      const nlohmann::json& summary = summaries.at(network.checkpoint.name);
      const auto steps = summary.at("iterations").get<std::int64_t>();
      ours["checkpoint"] = network.checkpoint.sha256;
      ours["steps"] = steps;
      ours["parameters"] = summary.at("parameters_of");
      if (const std::string why = Unconverged(own, row, steps, options.evaluate.settled, rows); !why.empty()) {
        ours["unconverged"] = row["unconverged"] = why;
      }
      if (own.kind == NetworkKind::kCondGru && own.cond_gru.evaluation == CondGruEvaluation::kRollout) {
        row["given"] = kGivenFirstPose;
      }
      const TrainingEffort effort = EffortOf(journal, network.checkpoint.name, steps);
      if (!effort.known) continue;
      ours["seconds"] = effort.seconds + summary.value("seconds_before", 0.0);
      if (effort.peak_memory > 0.0) ours["peak_memory"] = effort.peak_memory;
    }
    row["ours"] = std::move(ours);
  }
}

}  // namespace mocurate
