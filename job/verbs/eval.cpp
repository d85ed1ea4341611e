#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/resources.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "eval/published/published.h"
#include "eval/tables/result_table.h"
#include "ingest/stages.h"
#include "job/evaluation.h"
#include "job/machine.h"
#include "job/motion_files.h"
#include "job/protocols.h"
#include "job/run_file.h"
#include "job/run_folder.h"
#include "job/stage_runs.h"
#include "job/verbs/dose_response.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"
#include "train/items.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

Status CheckExists(const fs::path& path, const char* option) {
  std::error_code unknown;
  if (path.empty() || fs::exists(path, unknown)) return {};
  return Fail(ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(path), option);
}

Status CheckArguments(const EvalArguments& arguments) {
  if (!arguments.truth.empty()) {
    return Fail(ErrorCode::kUsage, "--truth is given without --fits", "command line", "add --fits DATASET");
  }
  if (arguments.protocol.empty()) {
    return Fail(
        ErrorCode::kUsage, "neither --protocol nor --fits is given", "command line",
        "give --protocol NAME to score motions, or --fits DATASET --truth FILE to compare fits with their truth");
  }
  if (Status sound = CheckDoseArguments(arguments); !sound) return sound;
  if (arguments.values == "joints" && !arguments.bone_lengths.empty()) {
    return Fail(ErrorCode::kUsage, "--bone-lengths is for Lie parameters, but --values is joints", "command line",
                "remove one of them");
  }
  if (arguments.values == "lie" && arguments.bone_lengths.empty()) {
    return Fail(ErrorCode::kUsage, "Lie parameters have no bone lengths", "--values lie",
                "give --bone-lengths FILE with motions as positions, whose median lengths are used");
  }
  for (const auto& [files, option] : {std::pair(&arguments.labels, "--labels"), {&arguments.lengths, "--lengths"}}) {
    if (files->size() > 1 && files->size() != arguments.generated.size()) {
      return Fail(ErrorCode::kUsage,
                  Counted(static_cast<long long>(files->size()), "file") + " for " +
                      Counted(static_cast<long long>(arguments.generated.size()), "set"),
                  option, "give one for all sets, or one for each in their order");
    }
    for (const fs::path& file : *files) {
      if (Status there = CheckExists(file, option); !there) return there;
    }
  }
  if (!arguments.lengths.empty() && arguments.padding == "keep") {
    return Fail(ErrorCode::kUsage, "--lengths cuts the motions, --padding keep does not", "command line",
                "remove one of them");
  }
  for (const auto& [path, option] : {std::pair<const fs::path&, const char*>{arguments.bone_lengths, "--bone-lengths"},
                                     {arguments.real, "--real"},
                                     {arguments.damaged_real, "--dose-response"},
                                     {arguments.real_labels, "--real-labels"},
                                     {arguments.run, "--run"}}) {
    if (Status there = CheckExists(path, option); !there) return there;
  }
  return {};
}

/// The recogniser whose features the run used, else the one of that name with the smallest seed. Outputs of earlier
/// runs of the folder are not used.
Expected<fs::path> FirstRecogniser(const fs::path& run, const std::vector<StaleOutput>& stale) {
  std::error_code unknown;
  if (const auto metrics = ReadJson(run / "metrics.json"); metrics && !IsStale(stale, "metrics.json")) {
    const nlohmann::json extractor = metrics->is_object() ? metrics->value("extractor", nlohmann::json()) : nullptr;
    if (extractor.is_string()) {
      const fs::path file = run / "checkpoints" / (FileNameOf(extractor.get<std::string>()) + ".h5");
      if (fs::is_regular_file(file, unknown)) return file;
    }
  }
  std::vector<fs::path> found;
  std::error_code problem;
  std::string earlier_run;
  for (fs::directory_iterator it(run / "checkpoints", problem), end; !problem && it != end; it.increment(problem)) {
    const std::string name = it->path().filename().string();
    if (name.rfind("recogniser_", 0) != 0) continue;
    if (IsStale(stale, "checkpoints/" + name)) {
      earlier_run += (earlier_run.empty() ? "" : ", ") + name;
    } else {
      found.push_back(it->path());
    }
  }
  const auto earlier = [](const fs::path& a, const fs::path& b) {  // recogniser_2.h5 before recogniser_10.h5
    const std::string first = a.filename().string(), second = b.filename().string();
    return std::make_pair(first.size(), first) < std::make_pair(second.size(), second);
  };
  if (!found.empty()) return *std::min_element(found.begin(), found.end(), earlier);
  return Fail(ErrorCode::kNotFound,
              "the run has no recogniser" + (earlier_run.empty() ? "" : "; of an earlier run: " + earlier_run),
              DisplayPath(run / "checkpoints"), "run the stage train, or give --extractor CHECKPOINT");
}

/// Sets and extractor of an evaluation, from the command line.
struct EvalPlan {
  ProtocolOptions protocol;
  ExtractorOptions extractor;
  fs::path weights;
  fs::path real;
  PaddingAction padding = PaddingAction::kCut;
};

Expected<EvalPlan> PlanOf(const EvalArguments& arguments, const ConfigRules& rules) {
  if (Status sound = CheckArguments(arguments); !sound) return Forward(sound);
  EvalPlan plan;
  if (arguments.padding == "keep") plan.padding = PaddingAction::kKeep;
  const std::string prefix = "extractor.";
  std::vector<std::string> of_protocol, of_extractor;
  for (const std::string& text : arguments.assignments) {
    const bool extractor = text.compare(0, prefix.size(), prefix) == 0;
    (extractor ? of_extractor : of_protocol).push_back(extractor ? text.substr(prefix.size()) : text);
  }
  auto protocol = LoadProtocol(arguments.protocol, of_protocol, rules);
  if (!protocol) return Forward(protocol);
  plan.protocol = std::move(*protocol);
  std::string name = arguments.extractor.empty() ? plan.protocol.extractor : arguments.extractor;
  plan.real = arguments.dose_response ? arguments.damaged_real : arguments.real;
  if (!arguments.run.empty()) {
    const std::vector<StaleOutput> stale = StaleOutputs(arguments.run);
    if (arguments.extractor.empty()) {
      const auto recogniser = FirstRecogniser(arguments.run, stale);
      if (!recogniser) return Forward(recogniser);
      name = recogniser->string();
    }
    if (plan.real.empty() && IsStale(stale, "dataset.h5")) {
      return Fail(ErrorCode::kInconsistent, "the dataset is of an earlier run of the folder",
                  DisplayPath(arguments.run / "dataset.h5"), "run the stage assemble, or give --real DATASET");
    }
    if (plan.real.empty()) plan.real = arguments.run / "dataset.h5";
  }
  if (name.empty()) {
    return Fail(ErrorCode::kUsage, "protocol '" + plan.protocol.name + "' has no extractor", "--protocol",
                "give --run RUN or --extractor CHECKPOINT");
  }
  auto extractor = LoadExtractor(name, of_extractor, rules);
  if (!extractor) return Forward(extractor);
  plan.extractor = std::move(*extractor);
  const auto weights = FindWeights(plan.extractor);
  if (!weights) return Forward(weights);
  plan.weights = *weights;
  return plan;
}

/// Motions as one file: a dataset or MotionSet unchanged, other files through the stage `motions`.
struct MotionsRead {
  std::map<std::string, StageInput> sets;
  std::map<std::string, Error> failed;
  std::set<std::string> bare_arrays;     ///< sets read in the extractor's frame
  std::set<std::string> stores;          ///< sets read from their own files
  std::vector<nlohmann::json> warnings;  ///< unreadable motions and padding of a set
};

Expected<MotionsRead> ReadSets(const std::vector<std::pair<NamedPath, MotionFiles>>& sets, const EvalPlan& plan,
                               StageRuns& runs) {
  MotionsRead read;
  std::vector<ItemSpec> items;
  std::vector<std::string> names;
  for (const auto& [named, files] : sets) {
    if (Status there = CheckExists(named.path, "--generated"); !there) {
      read.failed[named.name] = there.error();
      continue;
    }
    const bool as_it_is = files.labels.empty() && files.lengths.empty() && files.source.empty();
    if (IsMotionStore(files.path) && as_it_is && files.lie_bone_lengths.empty()) {
      read.sets[named.name] = {"motions", named.name, files.path, ""};
      read.stores.insert(named.name);
      continue;
    }
    auto item = MakeMotionsItem(named.name, files, plan.extractor);
    if (!item) {
      read.failed[named.name] = item.error();
      continue;
    }
    if (files.source.empty() && AreBareArrays(files.path) && !DeclarationBeside(files.path))
      read.bare_arrays.insert(named.name);
    for (const RefusedClip& file : item->unreadable) {
      read.warnings.push_back({{"code", "clip_refused"}, {"row", named.name}, {"message", file.error.Message()}});
    }
    items.push_back(std::move(item->item));
    names.push_back(named.name);
  }
  if (items.empty()) return read;
  const auto report = runs.Run(MotionsDeclaration(), std::move(items));
  if (!report) return Forward(report);
  for (std::size_t i = 0; i < report->items.size(); ++i) {
    const ItemResult& item = report->items[i];
    if (item.artifact.empty()) {
      read.failed[names[i]] = item.outcome.error;
      continue;
    }
    read.sets[names[i]] = {"motions", names[i], item.artifact, item.sha256};
    if (auto padding = PaddingWarning(names[i], item.summary, plan.padding)) read.warnings.push_back(*padding);
    for (const Finding& finding : item.outcome.findings) {
      read.warnings.push_back(
          {{"code", finding.code}, {"row", names[i]}, {"message", finding.clip + ": " + finding.message}});
    }
  }
  return read;
}

Status WriteResults(const nlohmann::json& result, const EvaluationResult& evaluated, const fs::path& folder) {
  if (Status made = MakeFolder(folder / "features"); !made) return made;
  for (const auto& [name, file] : evaluated.features) {
    if (Status copied = CopyWhole(file, folder / "features" / (FileNameOf(name) + ".h5")); !copied) return copied;
  }
  if (Status written = WriteFile(folder / "metrics.json", result.dump(1) + "\n"); !written) return written;
  const Table table = ResultTable(result, result.at("protocol").get<std::string>());
  const auto tables = WriteTables(result, table, folder / "tables");
  return tables ? Status() : Forward(tables);
}

/// `instead`: text instead of the table of rows, or empty.
void PrintEvaluation(const nlohmann::json& result, const std::string& instead) {
  const Table table = ResultTable(result, result.at("protocol").get<std::string>() + ", variant " +
                                              result.at("variant").get<std::string>() + ", extractor " +
                                              result.at("extractor").get<std::string>());
  Print("%s", (instead.empty() ? ToMarkdown(table) : instead).c_str());
  for (const nlohmann::json& warning : result.at("warnings")) {
    const std::string row = warning.at("row").get<std::string>();
    LogWarning((row.empty() ? "" : row + ": ") + warning.at("message").get<std::string>());
  }
}

/// What the run says of its recogniser: that it recognises less than a nearest neighbour.
std::vector<nlohmann::json> UnfitExtractorOf(const fs::path& run) {
  std::vector<nlohmann::json> warnings;
  const auto metrics = ReadJson(run / "metrics.json");
  if (!metrics || !metrics->is_object()) return warnings;
  const nlohmann::json stated = metrics->value("warnings", nlohmann::json::array());
  for (const nlohmann::json& warning : stated) {
    if (warning.is_object() && warning.value("code", nlohmann::json()) == "unfit_extractor" &&
        warning.value("message", nlohmann::json()).is_string()) {
      warnings.push_back({{"code", "unfit_extractor"}, {"row", ""}, {"message", warning["message"]}});
    }
  }
  return warnings;
}

}  // namespace

Status EvalVerb(CommonArguments& common, const EvalArguments& arguments) {
  if (!arguments.fits.empty()) return EvalFitsVerb(common, arguments);
  ChooseBlasKernels();
  const ConfigRules rules{common.allow_include};
  if (Status known = CheckTolerated(arguments.tolerate); !known) return known;
  auto plan = PlanOf(arguments, rules);
  if (!plan) return Forward(plan);
  if (!arguments.output.empty()) {
    if (Status plain = CheckRunFiles(arguments.output); !plain) return plain;
    if (fs::exists(arguments.output / "run.json")) {
      return Fail(ErrorCode::kUsage, "the folder holds a run, whose metrics and tables would be replaced",
                  DisplayPath(arguments.output),
                  "give another folder, e.g. -o " + (arguments.output / "eval").string());
    }
    if (Status made = MakeFolder(arguments.output); !made) return made;
  }
  auto stages = VerbStages::Make(common, arguments.jobs, arguments.output);
  if (!stages) return Forward(stages);
  StageRuns& runs = (*stages)->runs();

  std::vector<std::pair<NamedPath, MotionFiles>> sets;
  std::set<std::string> taken = {"Real", "Real-test", "reference", "reference_test"};
  std::vector<double> bone_lengths;
  if (!arguments.bone_lengths.empty()) {
    auto lengths = MedianBoneLengths(arguments.bone_lengths, plan->extractor);
    if (!lengths) return Forward(lengths);
    bone_lengths = std::move(*lengths);
  }
  for (const std::string& text : arguments.generated) {
    const NamedPath named = NamedRow(text, taken);
    const auto own = [&](const std::vector<fs::path>& files) {
      return files.empty() ? fs::path() : files[files.size() > 1 ? sets.size() : 0];
    };
    sets.push_back({named,
                    {named.path, arguments.source, own(arguments.labels), bone_lengths, own(arguments.lengths),
                     plan->padding, rules, arguments.tolerate}});
  }
  if (!plan->real.empty()) {
    sets.push_back(
        {{"Real", plan->real},
         {plan->real, arguments.real_source, arguments.real_labels, {}, {}, plan->padding, rules, arguments.tolerate}});
  }
  auto read = ReadSets(sets, *plan, runs);
  if (!read) return Forward(read);

  Evaluation evaluation;
  evaluation.extractor = plan->extractor;
  evaluation.extractor.weights.clear();  // a path; the key contains the file's content
  evaluation.weights = {"weights", plan->weights.filename().string(), plan->weights, ""};
  evaluation.draw = plan->protocol.draw();
  evaluation.metrics = plan->protocol.metrics;
  evaluation.measures = plan->protocol.measures;
  evaluation.equivalent = plan->protocol.equivalent;
  evaluation.seed = plan->protocol.seed;
  if (!plan->protocol.paper.empty()) evaluation.protocol_motions = plan->protocol.released.motions;
  evaluation.test_reference = plan->protocol.test_reference;
  evaluation.split = plan->protocol.split;
  evaluation.part = plan->protocol.part;
  for (const auto& [named, files] : sets) {
    const auto set = read->sets.find(named.name);
    if (set == read->sets.end()) continue;
    ScoredSet scored{named.name, set->second, std::nullopt, read->bare_arrays.count(named.name) > 0};
    if (read->stores.count(named.name) > 0) scored.padding = plan->padding;
    if (named.name == "Real") {
      evaluation.real = std::move(scored);
    } else {
      evaluation.rows.push_back(std::move(scored));
    }
  }
  std::vector<DoseSeries> doses;
  if (arguments.dose_response) {
    if (!evaluation.real) return NoMotionsToDamage(read->failed.at("Real"));
    auto series = AddDoseRows(arguments, (*stages)->folder() / "doses", evaluation, read->warnings);
    if (!series) return Forward(series);
    doses = std::move(*series);
  }
  auto evaluated = Evaluate(evaluation, runs);
  if (!evaluated) return Forward(evaluated);
  evaluated->failed.insert(read->failed.begin(), read->failed.end());
  for (nlohmann::json& warning : read->warnings) evaluated->warnings.push_back(std::move(warning));
  if (!arguments.run.empty()) {
    for (nlohmann::json& warning : UnfitExtractorOf(arguments.run)) evaluated->warnings.push_back(std::move(warning));
  }
  if (plan->real.empty()) {
    evaluated->warnings.push_back(
        {{"code", "no_real_motions"},
         {"row", ""},
         {"message", "without --real there is no FID, KID, density, coverage or nearest_train: give --real PATH" +
                         (plan->protocol.recipe.empty() ? std::string()
                                                        : ", e.g. the dataset of recipe " + plan->protocol.recipe)}});
  }
  auto published = PublishedNumbers(plan->protocol.paper, plan->protocol.dataset);
  if (!published) return Forward(published);
  nlohmann::json result = {{"protocol", plan->protocol.name},
                           {"paper", plan->protocol.paper},
                           {"variant", OptionsToJson(plan->protocol).at("variant")},
                           {"extractor", plan->extractor.name},
                           {"rows", evaluated->rows},
                           {"comparisons", evaluated->comparisons},
                           {"published", OfTransitions(*published, plan->protocol.part == ClipPart::kTransition)},
                           {"notes", plan->protocol.notes},
                           {"warnings", evaluated->warnings},
                           {"failed", nlohmann::json::object()}};
  for (const auto& [name, error] : evaluated->failed) result["failed"][name] = error.Message();
  const std::vector<double>& sizes = plan->protocol.original_clips;
  result["original_data"] = plan->protocol.original_data && plan->protocol.variant == ProtocolVariant::kReleased &&
                            std::find(sizes.begin(), sizes.end(), evaluated->real_clips) != sizes.end();
  if (evaluated->rows.empty() && !evaluated->failed.empty()) {
    return tl::unexpected<Error>(evaluated->failed.begin()->second);
  }
  if (arguments.dose_response) AddDoseResponse(doses, result);
  if (!arguments.output.empty()) {
    if (Status written = WriteResults(result, *evaluated, arguments.output); !written) return written;
    Status written = arguments.dose_response ? WriteDoseResponse(doses, result, arguments.output) : Status();
    if (!written) return written;
  }
  if (AnswersInText(common, result)) {
    PrintEvaluation(result, arguments.dose_response ? DoseResponseText(doses, result) : "");
  }
  if (evaluated->failed.empty()) return {};
  const auto& [name, error] = *evaluated->failed.begin();
  return Fail(ErrorCode::kTooManyFailures,
              Counted(static_cast<long long>(evaluated->failed.size()), "set") + " could not be scored; " + name +
                  ": " + error.what,
              error.where, error.hint);
}

Status DoctorProtocolVerb(CommonArguments& common, const DoctorArguments& arguments) {
  const auto protocol = LoadProtocol(arguments.protocol, {}, {common.allow_include});
  if (!protocol) return Forward(protocol);
  nlohmann::json answer = {{"protocol", protocol->name}, {"extractor", protocol->extractor}};
  if (protocol->extractor.empty()) {
    answer["weights"] = nullptr;
    if (AnswersInText(common, answer)) {
      PrintLine("protocol 'own' scores with a recogniser of yours: --run RUN or --extractor FILE");
    }
    return {};
  }
  const auto extractor = LoadExtractor(protocol->extractor, {}, {common.allow_include});
  if (!extractor) return Forward(extractor);
  const auto weights = FindWeights(*extractor);
  const char* folder = std::getenv("MOCURATE_WEIGHTS");
  answer["weights"] = extractor->weights;
  answer["looked_in"] = folder == nullptr ? nlohmann::json() : nlohmann::json(folder);
  answer["found"] = weights ? nlohmann::json(DisplayPath(*weights)) : nlohmann::json();
  answer["obtain"] = extractor->obtain;
  answer["recipe"] = protocol->recipe;
  if (AnswersInText(common, answer)) {
    Print(
        "protocol   %s (%s on %s)\nextractor  %s\nweights    %s\nfolder     %s\nfound      %s\nobtain     %s\nreal     "
        "  "
        "recipe %s\n",
        protocol->name.c_str(), protocol->paper.c_str(), protocol->dataset.c_str(), protocol->extractor.c_str(),
        extractor->weights.c_str(), folder == nullptr ? "MOCURATE_WEIGHTS is not set" : folder,
        weights ? DisplayPath(*weights).c_str() : "no", extractor->obtain.c_str(), protocol->recipe.c_str());
  }
  return weights ? Status() : Forward(weights);
}

}  // namespace mocurate
