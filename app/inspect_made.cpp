#include "app/inspect_made.h"

#include <cstdio>
#include <map>

#include "app/run_file.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/pipeline/lock.h"
#include "core/store/describe_text.h"
#include "core/store/store.h"
#include "train/checkpoint/describe.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::string_view kHdf5Signature = "\x89HDF\r\n\x1a\n";
constexpr const char* kRunSchema = "mocurate-run";

bool IsHdf5(const fs::path& path) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return false;
  char head[8] = {};
  const std::size_t read = std::fread(head, 1, sizeof(head), file);
  std::fclose(file);
  return std::string_view(head, read) == kHdf5Signature;
}

/// The lines of a file that are JSON objects; none when there is no file.
std::vector<Json> JsonLines(const fs::path& path) {
  std::vector<Json> lines;
  const auto text = ReadFile(path);
  if (!text) return lines;
  for (const std::string_view line : SplitText(*text, '\n')) {
    Json json = Json::parse(line, nullptr, false);
    if (json.is_object()) lines.push_back(std::move(json));
  }
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

Json DecisionsOf(const fs::path& folder) {
  Json decisions = Json::object();
  for (const Json& line : JsonLines(folder / "curation_log.jsonl")) {
    Json& count = decisions[line.value("decision", "")];
    count = count.is_null() ? 1 : count.get<int>() + 1;
  }
  return decisions;
}

/// "at_work", "ended", "cut_short" (neither at work nor ended), or "unknown" where the file does not say.
const char* StateOf(const fs::path& folder, const Json& run) {
  std::error_code ignored;
  if (fs::exists(folder / "lock", ignored)) {
    const auto lock = FileLock::TryTake(folder / "lock");
    if (lock && !lock->has_value()) return "at_work";
  }
  if (!run.contains("started")) return "unknown";
  return run.contains("ended") ? "ended" : "cut_short";
}

/// How a run ended, null when it has not.
Json EndOf(const Json& run) {
  if (!run.contains("ended")) return nullptr;
  const Json& ended = run.at("ended");
  return {{"time", ended.value("time", "")},
          {"exit_code", ended.value("exit_code", 0)},
          {"message", ended.value("message", "")}};
}

Json DescribeRun(const fs::path& folder, const Json& run) {
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
               {"clips", DecisionsOf(folder)},
               {"files", Json::array()}};
  std::error_code ignored;
  for (const char* name :
       {"dataset.h5", "curation_log.jsonl", "tables/table.md", "metrics.json", "checkpoints", "report/index.html"}) {
    if (fs::exists(folder / name, ignored)) json["files"].push_back(name);
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
  if (state == "cut_short") return "cut short; run it again to go on";
  const Json& ended = run.at("ended");
  const std::string text =
      "ended " + ended.at("time").get<std::string>() + " with exit code " + ended.at("exit_code").dump();
  const std::string message = ended.at("message");
  return message.empty() ? text : text + ": " + message;
}

/// "14 done, 1 doubtful".
std::string CountsText(const Json& counts) {
  std::string text;
  for (const auto& [name, count] : counts.items()) text += (text.empty() ? "" : ", ") + count.dump() + " " + name;
  return text;
}

std::string RunText(const Json& run) {
  const std::string description = run.at("description");
  std::string text =
      "a run of " + run.at("name").get<std::string>() + (description.empty() ? "" : ": " + description) + "\n";
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
  text += DescriptionLine("clips", CountsText(run.at("clips")));
  std::string files;
  for (const Json& file : run.at("files")) files += (files.empty() ? "" : ", ") + file.get<std::string>();
  text += DescriptionLine("files", files);
  if (!run.contains("dataset")) return text;
  const Json& dataset = run.at("dataset");
  return text + "dataset.h5: " +
         (dataset.contains("error") ? dataset.at("error").get<std::string>() + "\n" : StoreText(dataset));
}

std::string CheckpointText(const Json& checkpoint) {
  std::string text = "a trained network, " + checkpoint.at("schema").get<std::string>() + "\n";
  text += DescriptionLine("network", checkpoint.at("network").get<std::string>() + ", " +
                                         Counted(checkpoint.at("parameters").get<long long>(), "parameter"));
  text += DescriptionLine("trained",
                          Counted(checkpoint.at("steps").get<long long>(), checkpoint.at("step").get<std::string>()) +
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

}  // namespace

bool IsMade(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? ReadRunFile(path).is_object() : IsHdf5(path);
}

Expected<Json> DescribeMade(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    try {
      return DescribeRun(path, ReadRunFile(path));
    } catch (const Json::exception& error) {
      return Fail(ErrorCode::kMalformed, std::string("is no record of a run: ") + error.what(),
                  DisplayPath(path / "run.json"));
    }
  }
  return IsCheckpoint(path) ? DescribeCheckpoint(path) : DescribeStore(path);
}

std::string MadeText(const fs::path& path, const Json& description) {
  const std::string schema = description.at("schema");
  const std::string head = DisplayPath(path) + ": ";
  if (schema == kRunSchema) return head + RunText(description);
  return head + (description.contains("network") ? CheckpointText(description) : StoreText(description));
}

}  // namespace mocurate
