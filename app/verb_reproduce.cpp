#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/named_configs.h"
#include "app/network_scores.h"
#include "app/paper_items.h"
#include "app/paper_pictures.h"
#include "app/released_rows.h"
#include "app/run_folder.h"
#include "app/time_budget.h"
#include "app/verbs.h"
#include "canon/options.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/resources.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "core/store/store.h"
#include "eval/tables/comparison.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDefaultProfile = "small";

Status ListItems(CommonArguments& common, const ReproduceArguments& arguments) {
  nlohmann::json items = nlohmann::json::array();
  for (const std::string& id : PaperIds()) {
    auto options = ReadPaperItem(id);
    if (!options) return Forward(options);
    std::vector<std::string> of_job;  // of others the set is none
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
  if (common.json) {
    common.answered = true;
    std::printf("%s\n", items.dump(1).c_str());
    return {};
  }
  std::printf("%-20s %-8s %-6s %-6s %-6s %s\n", "item", "kind", "smoke", "small", "paper",
              "what it shows; what is missing");
  const auto hours = [](const nlohmann::json& item, const char* profile) {
    const nlohmann::json value = item.at("profiles").value(profile, nlohmann::json());
    return value.is_number() ? RoundedText(value.get<double>(), 2) + "h" : std::string("-");
  };
  for (const nlohmann::json& item : items) {
    std::string missing;
    for (const nlohmann::json& one : item.at("missing")) {
      missing += (missing.empty() ? "; missing: " : ", ") + one.at("name").get<std::string>();
    }
    std::printf("%-20s %-8s %-6s %-6s %-6s %s%s\n", item.at("id").get<std::string>().c_str(),
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

/// Clips by class and fine class, and in all: of the dataset that a run made, else as the recipe expects them.
Expected<nlohmann::json> ClassRows(const std::string& recipe, const fs::path& dataset) {
  nlohmann::json rows = nlohmann::json::array();
  std::error_code unknown;
  if (fs::is_regular_file(dataset, unknown)) {
    const auto set = ReadDataset(dataset);
    if (!set) return Forward(set);
    for (const std::string& label : set->labels) {
      const auto of_label = [&](const Clip& clip) { return clip.label == label; };
      rows.push_back(CountRow(label, "clips", double(std::count_if(set->clips.begin(), set->clips.end(), of_label))));
    }
    rows.push_back(CountRow("all", "clips", static_cast<double>(set->clips.size())));
    return rows;
  }
  const std::string file = "recipes/" + recipe + ".yaml";
  const auto node = LoadConfig(ConfigSource{std::string(FindResource(file).value_or("")), "resource:" + file, {}});
  if (!node) return Forward(node);
  const ConfigNode* assemble = node->Find("assemble");
  if (assemble == nullptr) return Fail(ErrorCode::kConfig, "the recipe has no classes", recipe, "name another one");
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

/// Parameters by part of a network, as the table of its run has them.
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

nlohmann::json ReadJson(const fs::path& file) {
  const auto text = ReadFile(file);
  const nlohmann::json json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
  return json.is_object() ? json : nlohmann::json::object();
}

class Reproduction {
 public:
  Reproduction(CommonArguments& common, const ReproduceArguments& arguments, LoadedJob job, fs::path folder)
      : common_(common),
        arguments_(arguments),
        job_(std::move(job)),
        folder_(std::move(folder)),
        name_(arguments.id.substr(arguments.id.find('/') + 1)) {}

  Status Run() {
    Status outcome = RunJob();
    if (!outcome) {
      const ErrorCode code = outcome.error().code;
      // Tables and pictures of what there is are made of a run that lost some of its networks, not of one that is cut.
      if (code != ErrorCode::kTooManyFailures) return outcome;
    }
    if (arguments_.dry_run) return outcome;
    if (Status compared = Compare(); !compared) return outcome ? compared : outcome;
    auto pictures = MakePaperPictures(job_.options, {folder_, common_, arguments_.jobs});
    if (!pictures) return outcome ? Status(Forward(pictures)) : outcome;
    pictures_ = std::move(*pictures);
    Answer();
    return outcome;
  }

 private:
  const ReproduceOptions& item() const { return job_.options.reproduce; }
  std::string profile() const { return job_.options.profile; }

  /// Nothing is run of an item that only counts what a recipe says.
  bool CountsRecipe() const {
    return !item().recipe.empty() && std::all_of(job_.options.data.begin(), job_.options.data.end(),
                                                 [](const DataSetOptions& set) { return set.path.empty(); });
  }

  Status RunJob() {
    if (CountsRecipe()) return {};
    RunArguments run;
    run.config = "papers/" + arguments_.id;
    run.output = folder_;
    run.assignments = arguments_.assignments;
    run.assignments.insert(run.assignments.begin(), "profile=" + profile());
    run.data = arguments_.data;
    run.jobs = arguments_.jobs;
    run.dry_run = arguments_.dry_run;
    if (!item().recipe.empty()) run.to = "assemble";
    if (!arguments_.time_budget.empty() && !arguments_.dry_run) {
      const auto budget = Budget();
      if (!budget) return Forward(budget);
      run.budget = budget->factor;
      if (budget->recogniser_epochs > 0) {
        run.assignments.push_back("train.most_epochs=" + std::to_string(budget->recogniser_epochs));
      }
    }
    CommonArguments own = common_;
    own.json = false;
    own.quiet = common_.quiet || common_.json;
    return RunVerb(own, run);
  }

  Expected<TimeBudget> Budget() const {
    const auto seconds = ParseQuantity(arguments_.time_budget, Unit::kSecond);
    if (!seconds) {
      return Fail(ErrorCode::kUsage, seconds.error().what, "--time-budget " + arguments_.time_budget, "20 min, 3 h");
    }
    if (!(*seconds > 0.0)) {
      return Fail(ErrorCode::kUsage, "no time at all", "--time-budget " + arguments_.time_budget, "20 min, 3 h");
    }
    RunnerOptions settings;
    settings.run_folder = folder_;
    settings.jobs = arguments_.jobs;
    settings.quiet = common_.quiet || common_.json;
    if (Status made = MakeFolder(folder_); !made) return Forward(made);
    return MakeTimeBudget(*seconds, job_.options, settings);
  }

  /// Rows and published numbers of a set, as ComparePublished takes them; none where the run has no table of it.
  Expected<nlohmann::json> ResultOf(const DataSetOptions& set) const {
    const fs::path own = folder_ / "data" / set.name;
    nlohmann::json result = ReadJson(own / "tables/table.json");
    if (const nlohmann::json recognition = ReadJson(own / "tables/recognition.json");
        !job_.options.evaluate.generators && recognition.contains("rows")) {
      result = recognition;
    }
    const auto published = PublishedOfItem(job_.options, set);
    if (!published) return Forward(published);
    if (!item().recipe.empty()) {
      auto rows = ClassRows(item().recipe, own / "dataset.h5");
      if (!rows) return Forward(rows);
      result = {{"rows", std::move(*rows)}};
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

  Status Compare() {
    if (item().kind != PaperItem::kTable && item().curve.empty()) return {};  // pictures alone
    std::string markdown = "# " + arguments_.id + "\n\n" + item().shows + "\n\n", csv, latex;
    json_ = {{"id", arguments_.id},   {"kind", Name(item().kind)},       {"profile", profile()},
             {"shows", item().shows}, {"conclusion", item().conclusion}, {"sets", nlohmann::json::array()}};
    bool any = false;
    for (const DataSetOptions& set : job_.options.data) {
      const auto result = ResultOf(set);
      if (!result) return Forward(result);
      if (result->at("rows").empty()) continue;
      any = true;
      const bool exact = CountsRecipe() || !item().parts_of.empty();
      const std::string stands_in = set.path.empty() && !exact ? set.substitute : std::string();
      const std::string& own = set.like.empty() ? set.name : set.like;
      ComparisonOptions options;
      options.title = (set.published.empty() ? set.name : set.published) + (set.like.empty() ? "" : ", " + set.name);
      options.profile = exact || !item().recipe.empty() ? "" : profile();
      options.published_as = item().published_as;
      for (const ReleasedMotionsOptions& released : item().released) {
        options.published_as[released.name] = released.method;
      }
      Comparison comparison = ComparePublished(*result, options);
      Table& table = comparison.table;
      if (!stands_in.empty()) {
        table.title += " (substitute: synthetic motions in the layout " + stands_in + ")";
        table.notes.insert(table.notes.begin(), "Synthetic motions stand in for " + own +
                                                    ": orders of rows may be compared, numbers may not. --data " + own +
                                                    "=PATH gives your copy.");
      }
      if (!item().conclusion.empty()) table.notes.push_back("The paper concludes: " + item().conclusion);
      for (const nlohmann::json& note : result->value("notes", nlohmann::json::array())) {
        table.notes.push_back(note.get<std::string>());
      }
      markdown += ToMarkdown(table) + "\n";
      csv += "# " + set.name + "\n" + ToCsv(table) + "\n";
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
        {".md", markdown}, {".csv", csv}, {".tex", latex}, {".json", json_.dump(1) + "\n"}};
    for (const auto& [ending, text] : files) {
      const fs::path file = tables / (name_ + ending);
      if (Status written = WriteFile(file, text); !written) return written;
      if (ending == std::string(".md")) table_ = file;
    }
    text_ = markdown;
    return {};
  }

  void Answer() {
    if (common_.json) {
      common_.answered = true;
      json_["run"] = DisplayPath(folder_);
      json_["table"] = table_.empty() ? nlohmann::json() : nlohmann::json(DisplayPath(table_));
      json_["pictures"] = nlohmann::json::array();
      for (const fs::path& file : pictures_) json_["pictures"].push_back(DisplayPath(file));
      std::printf("%s\n", json_.dump(1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
      return;
    }
    if (common_.quiet) return;
    if (!text_.empty()) std::printf("\n%s", text_.c_str());
    if (!table_.empty()) std::printf("table     %s\n", DisplayPath(table_).c_str());
    for (const fs::path& file : pictures_) std::printf("picture   %s\n", DisplayPath(file).c_str());
  }

  CommonArguments& common_;
  const ReproduceArguments& arguments_;
  LoadedJob job_;
  fs::path folder_;
  std::string name_;
  nlohmann::json json_;
  std::string text_;
  fs::path table_;
  std::vector<fs::path> pictures_;
};

}  // namespace

Status ReproduceVerb(CommonArguments& common, const ReproduceArguments& arguments) {
  if (arguments.id == "list") return ListItems(common, arguments);
  const std::string profile = arguments.profile.empty() ? kDefaultProfile : arguments.profile;
  auto job = LoadPaperItem(arguments.id, profile, arguments.assignments);
  if (!job) return Forward(job);
  if (job->options.reproduce.kind == PaperItem::kDiagram) {
    return Fail(ErrorCode::kUsage, "the item is a drawing of the method, nothing of it can be computed", arguments.id,
                job->options.reproduce.shows + "; docs/training.md says how mocurate builds it");
  }
  if (Status given = TakeData(arguments.data, job->options); !given) return given;
  if (Status sets = ResolveDataSets(job->options.data); !sets) return sets;
  const auto folder = RunFolder(arguments.output, job->options.name + "_" + profile);
  if (!folder) return Forward(folder);
  if (Status ours = CheckRunFolder(*folder); !ours) return ours;
  return Reproduction(common, arguments, std::move(*job), *folder).Run();
}

}  // namespace mocurate
