#include "job/run_folder.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/links.h"
#include "core/base/text.h"
#include "job/run_file.h"
#include "job/run_outputs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

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
