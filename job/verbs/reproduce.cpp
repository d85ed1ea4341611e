#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "canon/options.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/resources.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "core/store/store.h"
#include "eval/tables/comparison.h"
#include "job/config_loading.h"
#include "job/machine.h"
#include "job/named_configs.h"
#include "job/network_scores.h"
#include "job/run_file.h"
#include "job/run_folder.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/reproduce.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDefaultProfile = "small";
// Limits for a run within a time budget, whose networks are far from converged; the papers' 20 repetitions of 3,000
// motions take hours.
constexpr std::int64_t kBudgetRepetitions = 5, kBudgetMotions = 1000;

Status ListItems(CommonArguments& common, const ReproduceArguments& arguments) {
  nlohmann::json items = nlohmann::json::array();
  std::set<std::string> known, given_sets;
  for (const std::string& text : arguments.data) given_sets.insert(text.substr(0, text.find('=')));
  for (const std::string& id : PaperIds()) {
    const auto node = LoadConfig(*NamedJob("papers/" + id));  // files of its networks are not searched
    if (!node) return Forward(node);
    auto options = OptionsFromConfig<JobOptions>(*node);
    if (!options) return Forward(options);
    for (const DataSetOptions& set : options->data) known.insert(set.name);
    std::vector<std::string> of_job;  // the set is none of the other items
    for (const std::string& text : arguments.data) {
      const std::string name = text.substr(0, text.find('='));
      const auto& sets = options->data;
      const bool own =
          std::any_of(sets.begin(), sets.end(), [&](const DataSetOptions& set) { return set.name == name; });
      if (own) of_job.push_back(text);
    }
    if (Status given = TakeData(of_job, *options); !given) return given;
    items.push_back(DescribePaperItem(id, *options));
  }
  for (const std::string& name : given_sets) {
    if (known.count(name) > 0) continue;
    const auto near = Nearest(name, std::vector<std::string>(known.begin(), known.end()));
    return Fail(
        ErrorCode::kUsage, "no item has a set '" + name + "'", "--data",
        near ? "did you mean '" + *near + "=PATH'?" : "write NAME=PATH with a set that the list names as missing");
  }
  if (!AnswersInText(common, items)) return {};
  Print("%-20s %-8s %-6s %-6s %-6s %s\n", "item", "kind", "smoke", "small", "paper", "content; missing parts");
  const auto hours = [](const nlohmann::json& item, const char* profile) {
    const nlohmann::json value = item.at("profiles").value(profile, nlohmann::json());
    return value.is_number() ? RoundedText(value.get<double>(), 2) + "h" : std::string("-");
  };
  for (const nlohmann::json& item : items) {
    std::string missing;
    for (const nlohmann::json& one : item.at("missing")) {
      missing += (missing.empty() ? "; missing: " : ", ") + one.at("name").get<std::string>();
    }
    Print("%-20s %-8s %-6s %-6s %-6s %s%s\n", item.at("id").get<std::string>().c_str(),
          item.at("kind").get<std::string>().c_str(), hours(item, "smoke").c_str(), hours(item, "small").c_str(),
          hours(item, "paper").c_str(), item.at("shows").get<std::string>().c_str(), missing.c_str());
  }
  return {};
}

/// The published numbers of a job's table for a set.
Expected<nlohmann::json> PublishedOfItem(const JobOptions& options, const DataSetOptions& set) {
  EvaluateOptions evaluate = options.evaluate;
  evaluate.published = set.published;
  return PublishedOfTable(evaluate);
}

nlohmann::json CountRow(const std::string& name, const char* metric, double value) {
  return {{"name", name}, {"metrics", {{metric, {{"value", value}, {"interval", nullptr}}}}}};
}

/// Clips by class, and in all, of a dataset.
Expected<nlohmann::json> CountedRows(const fs::path& dataset) {
  const auto set = ReadDataset(dataset);
  if (!set) return Forward(set);
  nlohmann::json rows = nlohmann::json::array();
  for (const std::string& label : set->labels) {
    const auto of_label = [&](const Clip& clip) { return clip.label == label; };
    rows.push_back(CountRow(label, "clips", double(std::count_if(set->clips.begin(), set->clips.end(), of_label))));
  }
  rows.push_back(CountRow("all", "clips", static_cast<double>(set->clips.size())));
  return rows;
}

/// Clips by class that a recipe expects.
Expected<nlohmann::json> ExpectedRows(const std::string& recipe) {
  nlohmann::json rows = nlohmann::json::array();
  const auto node = LoadNamed("recipes/", "recipe", recipe, {}, {});
  if (!node) return Forward(node);
  const ConfigNode* assemble = node->Find("assemble");
  if (assemble == nullptr) return Fail(ErrorCode::kConfig, "the recipe has no classes", recipe, "use another recipe");
  const auto options = OptionsFromConfig<AssembleOptions>(*assemble);
  if (!options) return Forward(options);
  double all = 0.0;
  for (const ClassOptions& one : options->classes) {
    rows.push_back(CountRow(one.name, "clips", static_cast<double>(one.clips.value_or(0))));
    all += static_cast<double>(one.clips.value_or(0));
  }
  rows.push_back(CountRow("all", "clips", all));
  return rows;
}

/// Parameters by part of a network, from the table of its run.
nlohmann::json PartRows(const nlohmann::json& table, const std::string& network) {
  nlohmann::json rows = nlohmann::json::array();
  for (const nlohmann::json& row : table.value("rows", nlohmann::json::array())) {
    if (row.at("name") != network) continue;
    const nlohmann::json ours = row.value("ours", nlohmann::json::object());
    const nlohmann::json parts = ours.value("parameters", nlohmann::json::object());
    for (const auto& [part, count] : parts.items()) {
      rows.push_back(CountRow(part, "parameters", count.get<double>()));
    }
  }
  return rows;
}

/// An object; empty for an unreadable file.
nlohmann::json ObjectIn(const fs::path& file) {
  const auto json = ReadJson(file);
  return json && json->is_object() ? *json : nlohmann::json::object();
}

class Reproduction {
 public:
  Reproduction(CommonArguments& common, const ReproduceArguments& arguments, LoadedJob job, fs::path folder)
      : common_(common),
        arguments_(arguments),
        job_(std::move(job)),
        folder_(std::move(folder)),
        name_(arguments.id.substr(arguments.id.find('/') + 1)),
        json_({{"id", arguments.id},
               {"kind", OptionsToJson(item()).at("kind")},
               {"profile", profile()},
               {"shows", item().shows},
               {"conclusion", item().conclusion},
               {"run", DisplayPath(folder_)},
               {"dry_run", arguments.dry_run},
               {"table", nullptr},
               {"pictures", nlohmann::json::array()},
               {"missing", nlohmann::json::array()},
               {"sets", nlohmann::json::array()}}) {}

  Status Run() {
    if (Status data = CheckData(); !data) return data;
    if (Status ours = CheckOutputNames(); !ours) return ours;
    const auto seconds = BudgetSeconds();
    if (!seconds) return Forward(seconds);
    Status outcome = CountsRecipe() ? RecordRun() : RunJob(*seconds);
    // If a run lost a network, a row or a set, tables and pictures contain the others.
    if (!outcome && Ends(outcome.error().code)) return outcome;
    if (!arguments_.dry_run) {
      stale_ = StaleOutputs(folder_);
      try {
        if (Status compared = Compare(); !compared) return outcome ? compared : outcome;
        const auto pictures = MakePaperPictures(job_.options, {folder_, common_, sets_, stale_});
        if (!pictures) return outcome ? Status(Forward(pictures)) : outcome;
        for (const fs::path& file : pictures->files) json_["pictures"].push_back(DisplayPath(file));
        for (const std::string& part : pictures->lost) json_["missing"].push_back(part);
        if (Status noted = NoteEarlier(pictures->files); !noted) return noted;
        if (outcome && !pictures->lost.empty()) {
          outcome = Fail(ErrorCode::kTooManyFailures,
                         Counted(static_cast<long long>(pictures->lost.size()), "part") + " missing",
                         pictures->lost.front(), "see the warnings; everything else was made");
        }
      } catch (const nlohmann::json::exception& problem) {
        return Fail(ErrorCode::kMalformed, std::string("a table is not in the format of mocurate: ") + problem.what(),
                    DisplayPath(folder_), "remove data/SET/tables and run again; the rest comes from the cache");
      }
    }
    Answer();
    return outcome;
  }

 private:
  const ReproduceOptions& item() const { return job_.options.reproduce; }
  std::string profile() const { return job_.options.profile; }

  static bool Ends(ErrorCode code) {
    return code == ErrorCode::kUsage || code == ErrorCode::kConfig || code == ErrorCode::kInterrupted ||
           code == ErrorCode::kCannotWrite || code == ErrorCode::kInternal;
  }

  /// Whether the item only counts clips of a recipe and needs no run.
  bool CountsRecipe() const {
    return !item().recipe.empty() && std::all_of(job_.options.data.begin(), job_.options.data.end(),
                                                 [](const DataSetOptions& set) { return set.path.empty(); });
  }

  /// Checks paths before anything changes.
  Status CheckData() const {
    for (const PaperSurveyOptions& survey : item().surveys) {
      if (survey.skeleton.empty() || !FindBody().empty()) continue;
      return Fail(ErrorCode::kMissingOnHost, "the study shows skinned bodies, and no body is found", arguments_.id,
                  "put SMPL_NEUTRAL.pkl or body_cc0.h5 below the folder MOCURATE_WEIGHTS");
    }
    for (const DataSetOptions& set : job_.options.data) {
      std::error_code unknown;
      if (set.path.empty() || fs::exists(set.path, unknown)) continue;
      return Fail(ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(set.path),
                  "--data " + set.name + "=PATH must be your copy of the set");
    }
    return {};
  }

  /// A folder without run.json may contain files of the user with names of outputs: they are not overwritten.
  Status CheckOutputNames() const {
    if (ReadRunFile(folder_).is_object()) return {};
    std::error_code unknown;
    const std::vector<std::string> names = {"tables/" + name_ + ".md",
                                            "tables/" + name_ + ".csv",
                                            "tables/" + name_ + ".tex",
                                            "tables/" + name_ + ".json",
                                            "pictures",
                                            "motions",
                                            "survey",
                                            "released"};
    for (const std::string& name : names) {
      if (!fs::exists(folder_ / name, unknown)) continue;
      return Fail(ErrorCode::kUsage,
                  "the folder is not a run folder, and contains '" + name + "', which would be overwritten",
                  DisplayPath(folder_), "use -o to name another folder");
    }
    return {};
  }

  /// Empty without --time-budget.
  Expected<std::optional<double>> BudgetSeconds() const {
    if (arguments_.time_budget.empty()) return std::nullopt;
    const auto seconds = ParseQuantity(arguments_.time_budget, Unit::kSecond);
    if (seconds && *seconds > 0.0) return std::optional<double>(*seconds);
    return Fail(ErrorCode::kUsage, seconds ? "the time budget is 0" : seconds.error().what,
                "--time-budget " + arguments_.time_budget, "write e.g. 20min or 3h");
  }

  /// The run.json of an item that runs no stage.
  Status RecordRun() {
    if (arguments_.dry_run) return {};
    if (Status made = MakeFolder(folder_); !made) return made;
    RunFile file(job_, 1.0, JobStage::kAssemble, folder_);
    if (Status begun = file.Begin(); !begun) return begun;
    return file.End({});
  }

  Status RunJob(const std::optional<double>& seconds) {
    RunArguments run;
    run.config = "papers/" + arguments_.id;
    run.output = folder_;
    run.assignments = arguments_.assignments;
    run.assignments.insert(run.assignments.begin(), "profile=" + profile());
    run.data = arguments_.data;
    run.jobs = arguments_.jobs;
    run.dry_run = arguments_.dry_run;
    run.replace = arguments_.replace;
    if (!item().recipe.empty()) run.to = "assemble";
    if (seconds && !arguments_.dry_run) {
      ChooseBlasKernels();  // before any measurement
      RunnerOptions settings;
      settings.jobs = arguments_.jobs;
      settings.quiet = common_.quiet || common_.json;
      const auto budget = MakeTimeBudget(*seconds, job_.options, settings, folder_);
      if (!budget) return Forward(budget);
      run.budget = budget->factor;
      const EvaluateOptions& evaluate = job_.options.evaluate;  // scoring takes time as well
      run.assignments.push_back("evaluate.repetitions=" +
                                std::to_string(std::min(kBudgetRepetitions, evaluate.repetitions)));
      if (evaluate.motions > kBudgetMotions) {
        run.assignments.push_back("evaluate.motions=" + std::to_string(kBudgetMotions));
      }
      if (budget->recogniser_epochs > 0) {
        run.assignments.push_back("train.most_epochs=" + std::to_string(budget->recogniser_epochs));
      }
    }
    CommonArguments own = common_;
    own.json = false;
    own.quiet = common_.quiet || common_.json;
    return RunVerb(own, run, &sets_);
  }

  /// Rows and published numbers of a set, for ComparePublished; empty where the run has no table of it.
  Expected<nlohmann::json> ResultOf(const DataSetOptions& set) const {
    const fs::path own = folder_ / "data" / set.name;
    const bool ended = sets_.done.count(set.name) > 0;  // else its tables are from an earlier run
    const auto read = [&](const char* table) {
      const bool now = ended && !IsStale(stale_, "data/" + set.name + "/tables/" + table);
      return now ? ObjectIn(own / "tables" / table) : nlohmann::json::object();
    };
    nlohmann::json result = read("table.json");
    if (const nlohmann::json recognition = read("recognition.json");
        !job_.options.evaluate.generators && recognition.contains("rows")) {
      result = recognition;
    }
    const auto published = PublishedOfItem(job_.options, set);
    if (!published) return Forward(published);
    if (!item().recipe.empty()) {
      const bool now = ended && !IsStale(stale_, "data/" + set.name + "/dataset.h5");
      auto counted = set.path.empty() ? ExpectedRows(item().recipe)
                     : now            ? CountedRows(own / "dataset.h5")
                                      : Expected<nlohmann::json>(nlohmann::json::array());
      if (!counted) return Forward(counted);
      result = {{"rows", std::move(*counted)}};
    } else if (!item().parts_of.empty()) {
      result = {{"rows", PartRows(result, item().parts_of)}};
    }
    auto rows = ReleasedRows(item(), set.name, folder_, common_);
    if (!rows) return Forward(rows);
    for (nlohmann::json& row : result["rows"]) rows->push_back(std::move(row));
    result["rows"] = std::move(*rows);
    result["published"] = *published;
    return result;
  }

  /// The table alone, without paths and status of this run.
  nlohmann::json TableJson() const {
    nlohmann::json table = json_;
    for (const char* key : {"run", "dry_run", "table", "pictures", "missing"}) table.erase(key);
    return table;
  }

  Status Compare() {
    if (item().kind != PaperItem::kTable && item().curve.empty()) return {};  // pictures only
    std::string markdown = "# " + arguments_.id + "\n\n" + item().shows + "\n\n", csv = ComparisonCsvHead(), latex;
    const nlohmann::json described = DescribePaperItem(arguments_.id, job_.options);
    for (const nlohmann::json& missing : described.at("missing")) {
      markdown +=
          "- Missing: " + missing.at("name").get<std::string>() + ". " + missing.at("how").get<std::string>() + ".\n";
    }
    json_["needs"] = described.at("missing");
    if (!described.at("missing").empty()) markdown += "\n";
    bool any = false;
    for (const DataSetOptions& set : job_.options.data) {
      const auto result = ResultOf(set);
      if (!result) return Forward(result);
      const auto failed = sets_.failed.find(set.name);
      if (failed != sets_.failed.end()) {
        const std::string why = "Set " + set.name + " is missing: " + failed->second;
        markdown += why + "\n\n";
        json_["missing"].push_back(why);
      }
      if (result->at("rows").empty()) continue;
      any = any || failed == sets_.failed.end();
      const bool exact = CountsRecipe() || !item().parts_of.empty();
      const std::string stands_in = set.path.empty() && !exact ? set.substitute : std::string();
      const std::string& own = set.like.empty() ? set.name : set.like;
      ComparisonOptions options;
      options.title = set.published.empty() ? set.name : set.published;
      options.profile = exact || !item().recipe.empty() ? "" : profile();
      options.published_as = item().published_as;
      for (const ReleasedMotionsOptions& released : item().released) {
        options.published_as[released.name] = released.method;
      }
      Comparison comparison = ComparePublished(*result, options);
      Table& table = comparison.table;
      if (!stands_in.empty()) {
        table.title += " (substitute: synthetic motions in the layout " + stands_in + ")";
        table.notes.insert(table.notes.begin(),
                           "Synthetic motions replace " + own +
                               ": compare orders of rows, not numbers. Give your copy with --data " + own + "=PATH.");
      }
      if (const auto done = sets_.done.find(set.name); done != sets_.done.end()) {
        for (const std::string& finding : done->second) table.notes.push_back("Of the set: " + finding + ".");
      }
      if (CountsRecipe()) {
        table.notes.push_back("Ours are the counts that configs/recipes/" + item().recipe +
                              ".yaml expects, which a run checks; --data " + set.name +
                              "=PATH counts the clips of your copy.");
      }
      if (profile() == "smoke" && !exact) {
        table.notes.push_back("Profile smoke only tests that the item runs; its numbers and orders are meaningless.");
      }
      if (!item().conclusion.empty()) table.notes.push_back("The paper concludes: " + item().conclusion);
      for (const nlohmann::json& note : result->value("notes", nlohmann::json::array())) {
        table.notes.push_back(note.get<std::string>());
      }
      markdown += ToMarkdown(table) + "\n";
      csv += ComparisonCsv(set.name, comparison);
      latex += "% " + set.name + "\n" + ToLatex(table) + "\n";
      json_["sets"].push_back({{"set", set.name},
                               {"published", set.published},
                               {"substitute", stands_in.empty() ? nlohmann::json() : nlohmann::json(stands_in)},
                               {"rows", comparison.rows},
                               {"order", comparison.order},
                               {"notes", table.notes}});
    }
    if (!any) return {};
    const fs::path tables = folder_ / "tables";
    if (Status made = MakeFolder(tables); !made) return made;
    const std::pair<const char*, std::string> files[] = {
        {".md", markdown}, {".csv", csv}, {".tex", latex}, {".json", TableJson().dump(1) + "\n"}};
    for (const auto& [ending, text] : files) {
      const fs::path file = tables / (name_ + ending);
      if (Status written = WriteFile(file, text); !written) return written;
      if (ending == std::string(".md")) json_["table"] = DisplayPath(file);
    }
    text_ = markdown;
    return {};
  }

  /// The table and pictures of an earlier run of the folder that this one did not make stay, and are noted as stale.
  Status NoteEarlier(const std::vector<fs::path>& made) const {
    std::vector<StaleOutput> earlier;
    const auto note = [&](const std::string& file, bool own, JobStage stage) {
      std::error_code unknown;
      if (!own && fs::exists(folder_ / file, unknown)) earlier.push_back({file, Name(stage)});
    };
    for (const char* ending : {".md", ".csv", ".tex", ".json"}) {
      note("tables/" + name_ + ending, json_.at("table").is_string(), JobStage::kTable);
    }
    std::map<std::string, std::string> pictures;  // file -> the picture or page that it was made with
    for (const char* ending : {".svg", ".json"})
      pictures[std::string("pictures/curves") + ending] = "pictures/curves.svg";
    for (const DrawnMotionsOptions& picture : item().pictures) {
      const std::string name = "pictures/" + picture.name;
      for (const char* ending : {".svg", ".png", ".json"}) pictures[name + ending] = name + ".svg";
    }
    for (const PaperSurveyOptions& survey : item().surveys) {
      const std::string name = "survey/" + survey.kind, screen = "pictures/" + survey.kind + "_page.png";
      for (const char* file : {"/survey.html", "/key.json", "/tally/figure.svg"}) {
        pictures[name + file] = name + "/survey.html";
      }
      pictures[screen] = screen;
    }
    for (const auto& [file, of] : pictures) {
      note(file, std::find(made.begin(), made.end(), folder_ / of) != made.end(), JobStage::kReport);
    }
    return AddStale(folder_, earlier);
  }

  void Answer() {
    if (!AnswersInText(common_, json_) || arguments_.dry_run) return;
    if (!text_.empty()) Print("\n%s", text_.c_str());
    if (json_["table"].is_string()) Print("table     %s\n", json_["table"].get<std::string>().c_str());
    for (const nlohmann::json& file : json_["pictures"]) Print("picture   %s\n", file.get<std::string>().c_str());
  }

  CommonArguments& common_;
  const ReproduceArguments& arguments_;
  LoadedJob job_;
  fs::path folder_;
  std::string name_;
  nlohmann::json json_;  ///< the answer
  std::string text_;     ///< the table
  SetsOfRun sets_;
  std::vector<StaleOutput> stale_;  ///< outputs of the folder that are of an earlier run
};

}  // namespace

Status ReproduceVerb(CommonArguments& common, const ReproduceArguments& arguments) {
  if (arguments.id == "list") return ListItems(common, arguments);
  const std::string profile = arguments.profile.empty() ? kDefaultProfile : arguments.profile;
  auto job = LoadPaperItem(arguments.id, profile, arguments.assignments);
  if (!job) return Forward(job);
  if (job->options.reproduce.kind == PaperItem::kDiagram) {
    return Fail(ErrorCode::kUsage, "the item is a drawing of the method, which cannot be computed", arguments.id,
                job->options.reproduce.shows + "; docs/training.md describes mocurate's implementation");
  }
  if (Status given = TakeData(arguments.data, job->options); !given) return given;
  if (Status sets = ResolveDataSets(job->options.data); !sets) return sets;
  const auto folder = RunFolder(arguments.output, job->options.name + "_" + profile);
  if (!folder) return Forward(folder);
  if (Status ours = CheckRunFolder(*folder, *job, arguments.replace); !ours) return ours;
  return Reproduction(common, arguments, std::move(*job), *folder).Run();
}

}  // namespace mocurate
