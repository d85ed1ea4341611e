#include "job/verbs/inspect_artifact.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/pipeline/journal.h"
#include "core/pipeline/lock.h"
#include "core/pipeline/progress.h"
#include "core/store/store.h"
#include "ingest/discover.h"
#include "job/curation_log.h"
#include "job/run_file.h"
#include "train/checkpoint/checkpoint.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::string_view kHdf5Signature = "\x89HDF\r\n\x1a\n";
constexpr const char* kRunSchema = "mocurate-run";
constexpr const char* kRunsSchema = "mocurate-runs";

bool IsHdf5(const fs::path& path) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return false;
  char head[8] = {};
  const std::size_t read = std::fread(head, 1, sizeof(head), file);
  std::fclose(file);
  return std::string_view(head, read) == kHdf5Signature;
}

std::vector<Json> JsonLines(const fs::path& path) {
  std::vector<Json> lines;
  ForEachLine(path, [&lines](const Json& line) { lines.push_back(line); });
  return lines;
}

/// Items of each stage by outcome, in the order of the stages, since `started`.
Json StagesOf(const fs::path& folder, const std::string& started) {
  Json stages = Json::array();
  std::map<std::string, std::size_t> places;
  for (const Json& entry : JsonLines(folder / "journal.jsonl")) {
    if (entry.value("time", "") < started) continue;
    const std::string name = entry.value("stage", "");
    const auto [place, added] = places.emplace(name, stages.size());
    if (added) stages.push_back({{"stage", name}, {"items", 0}, {"outcomes", Json::object()}, {"from_cache", 0}});
    Json& stage = stages[place->second];
    stage["items"] = stage["items"].get<int>() + 1;
    Json& count = stage["outcomes"][entry.value("outcome", "")];
    count = count.is_null() ? 1 : count.get<int>() + 1;
    if (entry.value("from_cache", false)) stage["from_cache"] = stage["from_cache"].get<int>() + 1;
  }
  return stages;
}

bool IsFolderLine(const Json& line) {
  const Json findings = line.value("findings", Json::array());
  return !line.contains("evidence_sha256") && !findings.empty() && findings.back().value("code", "") == kFolderNotRead;
}

/// Counts of the decisions; folders are counted separately.
Json DecisionsOf(const std::vector<Json>& lines) {
  Json decisions = Json::object();
  for (const Json& line : lines) {
    if (IsFolderLine(line)) continue;
    Json& count = decisions[line.value("decision", "")];
    count = count.is_null() ? 1 : count.get<int>() + 1;
  }
  return decisions;
}

/// Of a described run.
ClipCounts CountsOf(const Json& run) {
  const Json& decisions = run.at("clips");
  ClipCounts counts;
  counts.kept = decisions.value("kept", 0);
  counts.suspect = run.value("suspect", 0);
  counts.replaces_rotations = run.value("replaces_rotations", 0);
  counts.excluded = decisions.value("excluded", 0);
  counts.failed = decisions.value("dropped", 0);
  counts.undecided = decisions.value("undecided", 0);
  counts.folders = run.at("folders");
  counts.clips = counts.kept + counts.excluded + counts.failed + counts.undecided;
  return counts;
}

/// Outputs of a successful run that no longer exist.
Json MissingOf(const fs::path& folder, const Json& run, const Json& stages) {
  Json missing = Json::array();
  const Json ended = run.value("ended", Json::object());
  const int exit_code = ended.value("exit_code", -1);
  if (exit_code != 0 && exit_code != 1) return missing;
  const std::pair<const char*, const char*> written[] = {{"ingest", "curation_log.jsonl"},
                                                         {"assemble", "dataset.h5"},
                                                         {"score", "metrics.json"},
                                                         {"report", "report/index.html"}};
  for (const auto& [name, file] : written) {
    std::error_code ignored;
    if (fs::exists(folder / file, ignored)) continue;
    for (const Json& stage : stages) {
      const Json& outcomes = stage.at("outcomes");
      const bool gave = outcomes.contains("done") || outcomes.contains("suspect");
      if (stage.at("stage") == name && gave) missing.push_back(file);
    }
  }
  return missing;
}

/// "at_work", "ended", "cut_short" (neither at work nor ended), or "unknown" where the file has no state.
const char* StateOf(const fs::path& folder, const Json& run) {
  std::error_code ignored;
  if (fs::exists(folder / "lock", ignored)) {
    const auto lock = FileLock::TryTake(folder / "lock");
    if (lock && !lock->has_value()) return "at_work";
  }
  if (!run.contains("started")) return "unknown";
  return run.contains("ended") ? "ended" : "cut_short";
}

/// Adds items at work, or that were when the run was cut short: {"item", "share", "text", "time", "stage"}. A file that
/// is no such record is passed over.
void AddAtWork(const fs::path& folder, const std::string& started, Json& items) {
  const auto record = ReadJson(folder / kProgressFile);
  if (!record || !record->is_object() || !record->value("items", Json()).is_array()) return;
  const auto text = [](const Json& json, const char* key) {
    return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
  };
  for (const Json& item : record->at("items")) {
    if (!item.is_object() || !item.value("share", Json()).is_number() || text(item, "time") < started) continue;
    items.push_back({{"item", text(item, "item")},
                     {"share", item["share"]},
                     {"text", text(item, "text")},
                     {"time", text(item, "time")},
                     {"stage", text(*record, "stage")}});
  }
}

/// Of the run, and of its sets.
Json AtWork(const fs::path& folder, const std::string& started) {
  Json items = Json::array();
  AddAtWork(folder, started, items);
  std::error_code missing;
  for (fs::directory_iterator set(folder / "data", missing), end; !missing && set != end; set.increment(missing)) {
    AddAtWork(set->path(), started, items);
  }
  return items;
}

/// How a run ended, null for an unfinished one.
Json EndOf(const Json& run) {
  if (!run.contains("ended")) return nullptr;
  const Json& ended = run.at("ended");
  return {{"time", ended.value("time", "")},
          {"exit_code", ended.value("exit_code", 0)},
          {"message", ended.value("message", "")}};
}

Json DescribeRun(const fs::path& folder) {
  const Json run = ReadRunFile(folder);
  const std::string started = run.value("started", "");
  Json json = {{"schema", kRunSchema},
               {"created_by", run.at("created_by")},
               {"name", run.at("options").value("name", "")},
               {"description", run.at("options").value("description", "")},
               {"to", run.value("to", "report")},
               {"started", started},
               {"ended", EndOf(run)},
               {"state", StateOf(folder, run)},
               {"stages", StagesOf(folder, started)},
               {"at_work", AtWork(folder, started)},
               {"clips", Json::object()},
               {"folders", 0},
               {"files", Json::array()},
               {"stale", Json::array()}};
  const std::vector<StaleOutput> stale = StaleOutputs(folder);
  for (const StaleOutput& output : stale) json["stale"].push_back({{"file", output.file}, {"stage", output.stage}});
  json["missing"] = MissingOf(folder, run, json["stages"]);
  if (!IsStale(stale, "curation_log.jsonl")) {
    const std::vector<Json> lines = JsonLines(folder / "curation_log.jsonl");
    json["clips"] = DecisionsOf(lines);
    json["folders"] = std::count_if(lines.begin(), lines.end(), IsFolderLine);
    for (const char* flag : {"suspect", "replaces_rotations"}) {
      json[flag] = std::count_if(lines.begin(), lines.end(), [&](const Json& line) { return line.value(flag, false); });
    }
  }
  std::error_code ignored;
  const std::map<std::string, OutputFile> outputs = OutputsIn(folder);
  const bool trained = std::any_of(outputs.begin(), outputs.end(), [&](const auto& output) {
    return output.first.rfind("checkpoints/", 0) == 0 && !IsStale(stale, DisplayPath(output.first));
  });
  for (const char* name :
       {"dataset.h5", "curation_log.jsonl", "tables/table.md", "metrics.json", "checkpoints", "report/index.html"}) {
    const bool own = name == std::string("checkpoints") ? trained : outputs.count(name) != 0 && !IsStale(stale, name);
    if (own) json["files"].push_back(name);
  }
  if (fs::exists(folder / "dataset.h5", ignored)) {
    const auto dataset = DescribeStore(folder / "dataset.h5");
    json["dataset"] = dataset ? *dataset : Json{{"error", dataset.error().Message()}};
  }
  return json;
}

std::string StateText(const Json& run) {
  const std::string state = run.at("state");
  if (state == "at_work") return "at work";
  if (state == "unknown") return "";
  if (state == "cut_short") return "cut short; run it again to continue";
  const Json& ended = run.at("ended");
  const std::string text =
      "ended " + ended.at("time").get<std::string>() + " with exit code " + ended.at("exit_code").dump();
  const std::string message = ended.at("message");
  return message.empty() ? text : text + ": " + message;
}

/// "14 done, 1 suspect".
std::string CountsText(const Json& counts) {
  std::string text;
  for (const auto& [name, count] : counts.items()) text += (text.empty() ? "" : ", ") + count.dump() + " " + name;
  return text;
}

/// "a, b" and, if there are any, the remark.
std::string ListText(const Json& names, const std::string& remark = "") {
  std::string text;
  for (const Json& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
  return text.empty() ? text : text + remark;
}

std::string RunText(const Json& run) {
  const std::string name = run.at("name");
  const std::string description = run.at("description");
  std::string text =
      (name == "run" ? "a run" : "a run of " + name) + (description.empty() ? "" : ": " + description) + "\n";
  text += DescriptionLine("made by", run.at("created_by"));
  text += DescriptionLine("started", run.at("started"));
  text += DescriptionLine("state", StateText(run));
  text += DescriptionLine("up to stage", run.at("to"));
  for (const Json& stage : run.at("stages")) {
    text +=
        DescriptionLine("  " + stage.at("stage").get<std::string>(),
                        Counted(stage.at("items").get<long long>(), "item") + ": " + CountsText(stage.at("outcomes")) +
                            ", " + stage.at("from_cache").dump() + " from the cache");
  }
  for (const Json& item : run.at("at_work")) {
    const std::string share = std::to_string(static_cast<int>(100.0 * item.at("share").get<double>())) + " % ";
    text +=
        DescriptionLine(run.at("state") == "at_work" ? "at work" : "was at work",
                        item.at("stage").get<std::string>() + " " + item.at("item").get<std::string>() + ": " + share +
                            item.at("text").get<std::string>() + " (" + item.at("time").get<std::string>() + ")");
  }
  if (!run.at("clips").empty()) {
    text += DescriptionLine("clips", ClipsText(CountsOf(run)));
  }
  text += DescriptionLine("files", ListText(run.at("files")));
  Json stale = Json::array();
  bool own_dataset = true;
  for (const Json& output : run.at("stale")) {
    const std::string file = output.at("file");
    own_dataset = own_dataset && file != "dataset.h5";
    stale.push_back(file + " (" + output.at("stage").get<std::string>() + ")");
  }
  text += DescriptionLine("stale", ListText(stale, ": of an earlier run, until they are made again"));
  text += DescriptionLine("missing", ListText(run.at("missing"), ": written by this run and removed since"));
  if (!run.contains("dataset")) return text;
  const Json& dataset = run.at("dataset");
  return text + (own_dataset ? "dataset.h5: " : "dataset.h5 of an earlier run: ") +
         (dataset.contains("error") ? dataset.at("error").get<std::string>() + "\n" : StoreText(dataset));
}

/// Run folders directly below a folder, by name; empty where the folder itself has files (captures, for example).
std::vector<fs::path> RunsBelow(const fs::path& folder) {
  std::vector<fs::path> runs;
  std::error_code problem;
  for (fs::directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
    std::error_code ignored;
    const bool hidden = at->path().filename().native()[0] == '.';
    if (!hidden && at->is_regular_file(ignored)) return {};
    if (at->is_directory(ignored) && ReadRunFile(at->path()).is_object()) runs.push_back(at->path());
  }
  std::sort(runs.begin(), runs.end());
  return runs;
}

Json DescribeRuns(const fs::path& folder) {
  Json json = {{"schema", kRunsSchema}, {"runs", Json::array()}};
  for (const fs::path& path : RunsBelow(folder)) {
    const Json run = ReadRunFile(path);
    json["runs"].push_back({{"folder", DisplayPath(path.filename())},
                            {"name", run.at("options").value("name", "")},
                            {"to", run.value("to", "report")},
                            {"started", run.value("started", "")},
                            {"ended", EndOf(run)},
                            {"state", StateOf(path, run)}});
  }
  return json;
}

std::string RunsText(const Json& description) {
  const Json& runs = description.at("runs");
  std::string text = "a folder of " + Counted(static_cast<long long>(runs.size()), "run") + "\n";
  for (const Json& run : runs) {
    text += DescriptionLine("  " + run.at("folder").get<std::string>(),
                            run.at("name").get<std::string>() + " up to " + run.at("to").get<std::string>() +
                                ", started " + run.at("started").get<std::string>() + ", " + StateText(run));
  }
  return text;
}

/// The folder of the run whose record, log or page this file is. Empty for other files.
fs::path RunOfFile(const fs::path& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  const std::string name = whole.filename().native();
  const fs::path parent = whole.parent_path();
  const bool page = name == "index.html" && parent.filename() == "report";
  if (!page && name != "run.json" && name != "curation_log.jsonl") return {};
  const fs::path folder = page ? parent.parent_path() : parent;
  return ReadRunFile(folder).is_object() ? folder : fs::path();
}

std::string CheckpointText(const Json& checkpoint) {
  std::string text = "a trained network, " + checkpoint.at("schema").get<std::string>() + "\n";
  text += DescriptionLine("network", checkpoint.at("network").get<std::string>() + ", " +
                                         Counted(checkpoint.at("parameters").get<long long>(), "parameter"));
  const bool epochs = checkpoint.at("step") == "epoch";
  text += DescriptionLine("trained",
                          Counted(checkpoint.at("steps").get<long long>(), checkpoint.at("step").get<std::string>()) +
                              (epochs ? " in all (selection, then refit)" : "") +
                              (checkpoint.at("finished").get<bool>() ? "" : ", not finished"));
  if (const Json& skeleton = checkpoint.at("skeleton"); skeleton.is_object()) {
    text += DescriptionLine("skeleton", skeleton.at("name").get<std::string>() + ", " +
                                            Counted(skeleton.at("joints").get<long long>(), "joint"));
  }
  std::string labels;
  for (const Json& label : checkpoint.at("labels")) labels += (labels.empty() ? "" : ", ") + label.get<std::string>();
  text += DescriptionLine("classes", std::to_string(checkpoint.at("labels").size()) + ": " + labels);
  text += DescriptionLine("dataset", "SHA-256 " + checkpoint.at("dataset_sha256").get<std::string>());
  return text;
}

/// `describe(folder)`, which reads run.json, journal.jsonl and curation_log.jsonl.
Expected<Json> TryDescribe(Json (*describe)(const fs::path& folder), const fs::path& folder) {
  return GuardJson("a record of " + DisplayPath(folder), [&] { return describe(folder); });
}

}  // namespace

bool IsMade(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return IsHdf5(path) || !RunOfFile(path).empty();
  return ReadRunFile(path).is_object() || !RunsBelow(path).empty();
}

Expected<Json> DescribeMade(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    return TryDescribe(ReadRunFile(path).is_object() ? DescribeRun : DescribeRuns, path);
  }
  if (const fs::path run = RunOfFile(path); !run.empty()) return TryDescribe(DescribeRun, run);
  return IsCheckpoint(path) ? DescribeCheckpoint(path) : DescribeStore(path);
}

std::string MadeText(const fs::path& path, const Json& description) {
  const std::string schema = description.at("schema");
  const std::string head = DisplayPath(path) + ": ";
  if (schema == kRunsSchema) return head + RunsText(description);
  std::error_code ignored;
  const char* part = fs::is_directory(path, ignored) ? "" : "of ";  // a file of a run
  if (schema == kRunSchema) return head + part + RunText(description);
  return head + (description.contains("network") ? CheckpointText(description) : StoreText(description));
}

}  // namespace mocurate
