#include "job/data_sets.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/sha256.h"
#include "core/base/table_text.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "ingest/synthetic/studio_layouts.h"
#include "job/job_checks.h"
#include "job/named_configs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// The studio's options for a substitute: its layout, with the run's assignments ("subjects=3").
Expected<StudioOptions> StudioOf(const DataSetOptions& set, const std::vector<std::string>& assignments) {
  std::vector<std::string> all = {"layout=" + set.substitute};
  all.insert(all.end(), assignments.begin(), assignments.end());
  const Expected<ConfigNode> node = LoadConfig(ConfigSource{"", "substitute of " + set.name, {}}, all);
  if (!node) return Forward(node);
  return OptionsFromConfig<StudioOptions>(*node);
}

/// A folder in the layout of a missing set, written once; its studio.json records the options. A dry run writes none:
/// an empty path without an existing one.
Expected<fs::path> Substitute(const DataSetOptions& set, const std::vector<std::string>& assignments,
                              const fs::path& folder, int jobs, bool dry_run) {
  const Expected<StudioOptions> studio = StudioOf(set, assignments);
  if (!studio) return Forward(studio);
  const std::string key = Sha256Hex(OptionsToJson(*studio).dump() + std::string(CreatedBy())).substr(0, 12);
  const fs::path made = folder / ("substitute_" + key);
  std::error_code unknown;
  if (!fs::is_regular_file(made / "studio.json", unknown)) {
    if (dry_run) return fs::path();
    const fs::path part = folder / ("substitute_" + key + ".part");
    fs::remove_all(part, unknown);
    const auto written = WriteStudioLayout(*studio, part, jobs);
    if (!written) return Forward(written);
    fs::rename(part, made, unknown);
    if (unknown) return Fail(ErrorCode::kCannotWrite, "cannot be renamed: " + unknown.message(), DisplayPath(part));
  }
  const std::vector<WrittenSource> sources = SourcesOf(studio->layout, studio->depth.enabled);
  if (sources.empty()) return made;
  const auto own =
      std::find_if(sources.begin(), sources.end(), [&](const WrittenSource& source) { return source.name == set.job; });
  const WrittenSource& source = own == sources.end() ? sources.front() : *own;
  return source.folder == "." ? made : made / source.folder;
}

/// "KEY=VALUE" into an option group; false where it has no such option.
template <class Options>
Expected<bool> Assign(const std::string& text, const std::string& where, Options& options) {
  const std::size_t equals = text.find('=');
  nlohmann::json json = OptionsToJson(options);
  const std::string key = text.substr(0, equals);
  if (equals == std::string::npos || !json.contains(key)) return false;
  json[key] = ParseJson(text.substr(equals + 1), where).value_or(nlohmann::json(text.substr(equals + 1)));
  auto changed = OptionsFromJson<Options>(json, where);
  if (!changed) return Forward(changed);
  options = std::move(*changed);
  return true;
}

/// Whether a name is a kind of networks; the job need not contain one.
bool IsKind(const std::string& name) {
  return OptionsFromJson<NetworkOptions>(nlohmann::json{{"kind", name}}, "kind").has_value();
}

/// Options of networks from a run or a set: "Ours.kl_weight=0.01", of a kind "actor.layers=4", of all. Options of a
/// kind that the job does not train are ignored.
Status SetNetworks(const std::vector<std::string>& texts, const std::string& option, TrainOptions& train) {
  for (const std::string& text : texts) {
    const std::string where = option + ": " + text;
    const std::size_t equals = text.find('='), dot = text.rfind('.', equals);
    const std::string name = dot == std::string::npos ? std::string() : text.substr(0, dot);
    const std::size_t begin = dot == std::string::npos ? 0 : dot + 1;
    bool found = false, named = name.empty();
    for (NetworkOptions& network : train.networks) {
      const bool meant = name.empty() || network.name == name || OptionsToJson(network).at("kind") == name;
      if (!meant) continue;
      named = true;
      const LearningOptions before = network.learning;
      const auto assigned = Assign(text.substr(begin), where, network);
      if (!assigned) return Forward(assigned);
      if (network.learning.iterations == before.iterations) network.learning.planned = before.planned;
      found = found || *assigned;
    }
    const bool other_kind = !named && IsKind(name);
    if (!found && !other_kind) {
      return Fail(ErrorCode::kConfig, "no network of train.networks has this option", where,
                  "write NETWORK.OPTION=VALUE or KIND.OPTION=VALUE, e.g. Ours.kl_weight=0.01");
    }
  }
  return {};
}

Status SetEvaluation(const DataSetOptions& set, EvaluateOptions& evaluate) {
  for (const std::string& text : set.evaluate) {
    const std::string where = "data." + set.name + ".evaluate: " + text;
    const auto assigned = Assign(text, where, evaluate);
    if (!assigned) return Forward(assigned);
    if (!*assigned) {
      return Fail(ErrorCode::kConfig, "`evaluate` has no such option", where,
                  "write OPTION=VALUE, e.g. test_reference=true");
    }
  }
  return {};
}

/// The job of a set with the networks and the evaluation of the run.
Expected<JobOptions> JobOfSet(const JobOptions& options, const DataSetOptions& set, double budget) {
  const bool stands_in = set.path.empty() && !set.substitute_job.empty();
  auto job = LoadJob(fs::path(stands_in ? set.substitute_job : set.job), {}, {options.allow_include});
  if (!job) return Forward(job);
  JobOptions own = std::move(job->options);
  own.name = set.name;
  own.train = options.train;
  Status given = SetNetworks(options.network_options, "network_options", own.train);
  if (given) given = SetNetworks(set.networks, "data." + set.name + ".networks", own.train);
  if (!given) return Forward(given);
  BoundTraining(own.train);
  if (Status scaled = ScaleTraining(budget, own.train); !scaled) return Forward(scaled);
  own.evaluate = options.evaluate;
  const std::string recogniser = RecogniserOf(options);
  for (const NetworkOptions& network : options.train.networks) {  // the set determines its split
    if (network.name == recogniser && network.data.split == own.evaluate.split) own.evaluate.split.clear();
  }
  if (Status evaluation = SetEvaluation(set, own.evaluate); !evaluation) return Forward(evaluation);
  own.evaluate.published = set.published;
  own.report = options.report;
  own.pipeline = options.pipeline;
  own.ingest.path = set.path;
  own.ingest.synthetic.enabled = false;
  if (Status networks = ResolveNetworks(own); !networks) return Forward(networks);
  ResolveDefaults(own);
  return own;
}

/// Heading of the table of a set, with the data it is based on.
std::string HeadOf(const SetResult& set) {
  std::string head = "## " + MarkdownText(set.set.name) + "\n\n";
  if (!set.substitute) return head;
  const std::string& own = set.set.like.empty() ? set.set.name : set.set.like;
  return head + "**Substitute**: synthetic motions in the layout `" + set.set.substitute + "`, not " + own +
         ": no figure below is comparable with the published ones. `--data " + own + "=PATH` gives your copy.\n\n";
}

/// A table over all sets, from the sets' tables: "table" of generators, "recognition" of recognisers.
struct CollectedTable {
  std::string name;
  std::string markdown, csv, latex;
  nlohmann::json json = {
      {"rows", nlohmann::json::array()}, {"published", nlohmann::json::array()}, {"notes", nlohmann::json::array()}};

  /// Adds the rows of a set from `folder`; nothing where its run wrote no table there.
  void Add(const SetResult& set, const std::filesystem::path& folder) {
    const std::string file = name + ".json";
    const std::vector<fs::path>& written = set.result.tables;
    const bool there =
        std::any_of(written.begin(), written.end(), [&](const fs::path& table) { return table.filename() == file; });
    const nlohmann::json own = there ? ReadJson(folder / file).value_or(nullptr) : nlohmann::json();
    if (!own.is_object()) {  // not scored, or a dry run
      if (name == "table") markdown += HeadOf(set) + "\n";
      return;
    }
    for (const nlohmann::json& row : own.at("rows")) {
      json["rows"].push_back({{"method", row.at("name")},
                              {"dataset", set.set.name},
                              {"substitute", set.substitute ? nlohmann::json(set.set.substitute) : nlohmann::json()},
                              {"ours", row.value("ours", nlohmann::json::object())}});
    }
    for (const nlohmann::json& value : own.at("published")) json["published"].push_back(value);
    const std::pair<const char*, std::string*> parts[] = {{".csv", &csv}, {".tex", &latex}, {".md", &markdown}};
    for (const auto& [ending, all] : parts) {
      const auto part = ReadFile(folder / (name + ending));
      if (!part) continue;
      const std::string head = all == &csv     ? "# " + set.set.name + "\n"
                               : all == &latex ? "% " + set.set.name + "\n"
                                               : HeadOf(set);
      *all += head + *part + "\n";
    }
  }
};

}  // namespace

Expected<DataSetsRun> RunOverSets(const JobOptions& options, JobStage last, double budget,
                                  const RunnerOptions& settings) {
  DataSetsRun run;
  CollectedTable tables[2];
  tables[0].name = "table";
  tables[1].name = "recognition";
  std::vector<JobOptions> jobs;  // an error in the last is reported before the first is trained
  for (const DataSetOptions& set : options.data) {
    auto job = JobOfSet(options, set, budget);
    if (!job) return Forward(job);
    if (Status named = CheckNames(*job, last); !named) return Forward(named);
    jobs.push_back(std::move(*job));
  }
  for (std::size_t i = 0; i < options.data.size(); ++i) {
    const DataSetOptions& set = options.data[i];
    JobOptions& job = jobs[i];
    SetResult one{set, false, {}};
    RunnerOptions own = settings;
    own.run_folder = settings.run_folder / "data" / set.name;
    if (!own.dry_run) {
      if (Status made = MakeFolder(own.run_folder); !made) return Forward(made);
    }
    LogInfo(set.name);
    if (set.path.empty()) {
      if (set.substitute.empty()) {
        run.failed.emplace_back(set.name, Error{ErrorCode::kMissingOnHost, "the set has no path and no substitute",
                                                "data", "give --data " + set.name + "=PATH"});
        continue;
      }
      auto folder =
          Substitute(set, options.substitutes, settings.run_folder / "data", std::max(1, own.jobs), own.dry_run);
      if (!folder) return Forward(folder);
      if (folder->empty()) {
        std::string networks;
        for (const NetworkOptions& network : job.train.networks) {
          if (network.enabled) networks += (networks.empty() ? "" : ", ") + network.name;
        }
        LogInfo(set.name + ": the set has no path; a run would write synthetic motions in the layout '" +
                set.substitute + "' and train " + networks + ". --data " + set.name +
                "=PATH names your copy, whose training time is then measured");
        continue;
      }
      job.ingest.path = std::move(*folder);
      one.substitute = true;
    }
    auto runner = Runner::Make(own);
    if (!runner) return Forward(runner);
    auto result = RunMainJob(job, last, **runner);
    if (!result) {
      const ErrorCode code = result.error().code;
      if (code == ErrorCode::kInterrupted || code == ErrorCode::kCannotWrite) return Forward(result);
      LogWarning(set.name + ": " + result.error().Message());
      run.failed.emplace_back(set.name, result.error());
      continue;
    }
    one.result = std::move(*result);
    for (CollectedTable& table : tables) table.Add(one, own.run_folder / "tables");
    run.sets.push_back(std::move(one));
  }
  run.table = tables[0].json;
  if (settings.dry_run || last < JobStage::kTable) return run;
  const fs::path folder = settings.run_folder / "tables";
  if (Status made = MakeFolder(folder); !made) return Forward(made);
  for (const CollectedTable& table : tables) {
    const bool none = table.json.at("rows").empty() && table.name != "table";
    const std::pair<const char*, std::string> files[] = {
        {".md", "# " + MarkdownText(options.name) + "\n\n" + table.markdown},
        {".csv", table.csv},
        {".tex", table.latex},
        {".json", table.json.dump(1) + "\n"}};
    for (const auto& [ending, text] : files) {
      if (none) continue;
      if (Status written = WriteFile(folder / (table.name + ending), text); !written) return Forward(written);
    }
  }
  return run;
}

}  // namespace mocurate
