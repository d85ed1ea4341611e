#include "job/run_folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/links.h"
#include "core/base/text.h"
#include "core/pipeline/journal.h"
#include "core/pipeline/progress.h"
#include "job/run_file.h"
#include "train/items.h"
#include "train/stages.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// One output, or with `*` in its name one per clip.
struct Output {
  JobStage stage;
  const char* folder;
  std::string_view name;
};

constexpr Output kOutputs[] = {{JobStage::kCanon, "", "curation_log.jsonl"},
                               {JobStage::kAssemble, "", "dataset.h5"},
                               {JobStage::kAssemble, "", kSetFindings},
                               {JobStage::kTable, "", "metrics.json"},
                               {JobStage::kTable, "tables", "table.md"},
                               {JobStage::kTable, "tables", "table.csv"},
                               {JobStage::kTable, "tables", "table.tex"},
                               {JobStage::kTable, "tables", "table.json"},
                               {JobStage::kTable, "tables", "learning.svg"},
                               {JobStage::kTable, "tables", "recognition.md"},
                               {JobStage::kTable, "tables", "recognition.csv"},
                               {JobStage::kTable, "tables", "recognition.tex"},
                               {JobStage::kTable, "tables", "recognition.json"},
                               {JobStage::kReport, "", "report_input.json"},
                               {JobStage::kReport, "report", "index.html"},
                               {JobStage::kReport, "report", "viewer.html"},
                               {JobStage::kReport, "report", "generated.html"},
                               {JobStage::kReport, "report/viewer_files", "part_*.js"},
                               {JobStage::kReport, "report/generated_files", "part_*.js"},
                               {JobStage::kReport, "report", "clip_*.html"},
                               {JobStage::kReport, "report", "clip_*.mp4"}};

constexpr const char* kRecords[] = {"capture.json", "journal.jsonl", "lock", kProgressFile, "run.json"};

/// `*` stands for the digits of a clip.
bool Matches(std::string_view pattern, std::string_view name) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return name == pattern;
  const std::string_view head = pattern.substr(0, star);
  const std::string_view tail = pattern.substr(star + 1);
  if (name.size() <= head.size() + tail.size()) return false;
  const std::string_view seed = name.substr(star, name.size() - head.size() - tail.size());
  return name.substr(0, star) == head && name.substr(name.size() - tail.size()) == tail &&
         std::all_of(seed.begin(), seed.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Adds the outputs in `folder`/`below`; the names begin with `below`.
void AddOutputs(const fs::path& folder, const fs::path& below, std::map<std::string, OutputFile>& outputs) {
  const auto add = [&](JobStage stage, const fs::path& name) {
    std::error_code gone, unknown;
    const fs::file_status status = fs::symlink_status(folder / name, gone);
    if (!fs::is_regular_file(status) && !fs::is_symlink(status)) return;
    OutputFile& output = outputs[name.native()];
    output = {stage, fs::file_size(folder / name, unknown), fs::last_write_time(folder / name, gone)};
  };
  for (const Output& output : kOutputs) {
    std::error_code missing;
    for (fs::directory_iterator entry(folder / below / output.folder, missing), end; entry != end;
         entry.increment(missing)) {
      const fs::path file = entry->path().filename();
      if (Matches(output.name, file.native())) add(output.stage, below / output.folder / file);
    }
  }
  for (const auto& entry : JournalOf(folder / below, TrainDeclaration().name)) {
    add(JobStage::kTrain, below / "checkpoints" / (FileNameOf(entry.first) + ".h5"));
  }
}

/// What verbs write in a run folder, but for `capture` and `data`, which may hold files of others.
constexpr const char* kWritten[] = {"capture.json",
                                    "checkpoints",
                                    "curation_log.jsonl",
                                    "dataset.h5",
                                    "dose_response.svg",
                                    "doses",
                                    "features",
                                    "journal.jsonl",
                                    "lock",
                                    "metrics.json",
                                    "motions",
                                    "pictures",
                                    "plan",
                                    kProgressFile,
                                    "released",
                                    "report",
                                    "report_input.json",
                                    "run.json",
                                    kSetFindings,
                                    "slurm",
                                    "survey",
                                    "tables",
                                    "time_budget.json"};

/// Whether a file is left by a run that ended before it wrote run.json: a lock with a process number, an empty journal.
bool IsBeginning(const fs::path& folder, const std::string& name) {
  if (name != "lock" && name != "journal.jsonl") return false;
  std::error_code unknown;
  if (!fs::is_regular_file(folder / name, unknown) || fs::file_size(folder / name, unknown) > 32) return false;
  const auto text = ReadFile(folder / name);
  if (!text) return false;
  const std::string_view content = Trim(*text);
  const bool digits = std::all_of(content.begin(), content.end(), [](char c) { return c >= '0' && c <= '9'; });
  return name == "lock" ? digits : content.empty();
}

/// Whether two configurations are one: of one name, or one file by two paths.
bool SameConfig(const std::string& a, const std::string& b) {
  std::error_code unknown;
  return a == b || (fs::path(a).is_absolute() && fs::path(b).is_absolute() && fs::equivalent(a, b, unknown));
}

}  // namespace

std::map<std::string, OutputFile> OutputsIn(const fs::path& folder) {
  std::map<std::string, OutputFile> outputs;
  AddOutputs(folder, "", outputs);
  std::error_code missing;
  for (fs::directory_iterator set(folder / "data", missing), end; !missing && set != end; set.increment(missing)) {
    std::error_code unknown;  // a set has a journal; a substitute's files beside it are inputs
    if (!fs::exists(set->path() / "journal.jsonl", unknown)) continue;
    AddOutputs(folder, fs::path("data") / set->path().filename(), outputs);
  }
  return outputs;
}

std::vector<std::string> RunFilesIn(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& [name, output] : OutputsIn(folder)) names.insert(name);
  std::error_code missing;
  for (fs::directory_iterator entry(folder / "checkpoints", missing), end; entry != end; entry.increment(missing)) {
    if (entry->path().extension() == ".h5") names.insert("checkpoints/" + entry->path().filename().native());
  }
  for (const char* name : kRecords) {
    std::error_code unknown;
    const fs::file_status status = fs::symlink_status(folder / name, unknown);
    if (fs::exists(status) && !fs::is_directory(status)) names.emplace(name);
  }
  return {names.begin(), names.end()};
}

std::map<std::string, nlohmann::json> JournalOf(const fs::path& folder, const std::string& stage) {
  std::map<std::string, nlohmann::json> entries;
  ForEachLine(folder / "journal.jsonl", [&](const nlohmann::json& entry) {
    if (TextField(entry, "stage") != stage) return;
    nlohmann::json& known = entries[TextField(entry, "item")];
    if (known.is_null() || TextField(known, "key") != TextField(entry, "key")) {
      known = entry;
      return;
    }
    // A continued run adds to its previous time.
    const auto both = [&](const char* what, auto&& join) {
      const double before = NumberField(known, what), now = NumberField(entry, what);
      if (before > 0.0 || now > 0.0) known[what] = join(before, now);
    };
    if (const auto cached = entry.find("from_cache"); cached != entry.end() && *cached == true) return;
    both("seconds", [](double a, double b) { return a + b; });
    both("peak_memory_bytes", [](double a, double b) { return std::max(a, b); });
    known["from_cache"] = false;
  });
  return entries;
}

Status CopyWhole(const std::filesystem::path& from, const std::filesystem::path& to) {
  Expected<PendingFile> copy = PendingFile::CreateOutput(to);
  if (!copy) return Forward(copy);
  Status written;
  const Status read = ReadFileInParts(from, [&](std::string_view part) {
    if (written) written = copy->Write(part);
  });
  if (!read) return read;
  return written ? copy->Publish() : written;
}

Expected<fs::path> RunFolder(const std::optional<fs::path>& named, const std::string& name) {
  if (named && named->empty()) {
    return Fail(ErrorCode::kUsage, "the run folder is an empty text", "-o",
                "name a folder; -o . is the current one, without -o it is runs/NAME");
  }
  if (named) return *named;
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos) {
    return Fail(ErrorCode::kConfig, "'" + name + "' cannot be the name of a folder below runs/", "name",
                "choose a name without '/', or name the run folder with -o DIR");
  }
  return fs::path("runs") / name;
}

Status CheckRunFiles(const fs::path& folder) {
  for (const std::string name : kWritten) {
    // These may hold a file a task, which are opened without following links.
    const bool tasks = name == "plan" || name == "slurm";
    if (Status plain = tasks ? CheckNotLink(folder / name) : CheckNoLinks(folder / name); !plain) return plain;
    std::error_code missing;
    for (fs::directory_iterator at(folder / name, missing), end; tasks && !missing && at != end;
         at.increment(missing)) {
      if (Status plain = CheckNotLink(at->path()); !plain) return plain;
    }
  }
  return {};
}

Status CheckRunFolder(const fs::path& folder, const LoadedJob& job, bool replace) {
  if (Status plain = CheckRunFiles(folder); !plain) return plain;
  for (const DataSetOptions& set : job.options.data) {
    const fs::path all = folder / "data", own = all / set.name;
    for (const fs::path& place : {all, own}) {
      if (Status plain = CheckNotLink(place); !plain) return plain;
    }
    if (Status plain = CheckRunFiles(own); !plain) return plain;
  }
  if (const nlohmann::json run = ReadRunFile(folder); run.is_object()) {
    std::string name, config;
    const Status read = GuardJson(DisplayPath(folder / "run.json"), [&] {
      name = run.at("options").value("name", "");
      // earlier versions wrote no config
      config = run.value("job", nlohmann::json::object()).value("config", job.config);
    });
    if (!read) return read;
    if (replace || (name == job.options.name && SameConfig(config, job.config))) return {};
    return Fail(ErrorCode::kUsage,
                "the folder is of job '" + name + "' (" + config + "), this job is '" + job.options.name + "' (" +
                    job.config + ")",
                DisplayPath(folder),
                "choose another folder with -o; or add --replace: outputs of that job stay, marked as stale, until "
                "this one writes its own");
  }
  for (const std::string& name : RunFilesIn(folder)) {
    if (IsBeginning(folder, name)) continue;
    return Fail(ErrorCode::kUsage,
                "the folder is not a run folder (it has no run.json of mocurate), and this file has the name of an "
                "output, which would overwrite it",
                DisplayPath(folder / name), "choose another folder with -o: an empty or a new one");
  }
  return {};
}

}  // namespace mocurate
