#include "job/run_file.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/pipeline/journal.h"
#include "job/machine.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostNamed = 8;

nlohmann::json JsonOf(const std::vector<StaleOutput>& stale) {
  nlohmann::json list = nlohmann::json::array();
  for (const StaleOutput& output : stale) list.push_back({{"file", output.file}, {"stage", output.stage}});
  return list;
}

void WarnOfStale(const std::vector<StaleOutput>& stale) {
  if (stale.empty()) return;
  std::string names;
  for (std::size_t i = 0; i < std::min(kMostNamed, stale.size()); ++i) {
    names += (i == 0 ? "" : ", ") + stale[i].file + " (" + stale[i].stage + ")";
  }
  if (stale.size() > kMostNamed) names += " and " + std::to_string(stale.size() - kMostNamed) + " more";
  LogWarning("stale, of an earlier run of this folder: " + names + "; they stay until a run makes them again");
}

Status WriteJson(const fs::path& folder, const nlohmann::json& run) {
  return WriteFile(folder / "run.json", run.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace

RunFile::RunFile(const LoadedJob& job, double budget, JobStage last, const fs::path& folder)
    : folder_(folder),
      earlier_(OutputsIn(folder)),
      previous_(ReadFile(folder / "run.json").value_or("")),
      run_({{"created_by", CreatedBy()},
            {"job", {{"name", job.options.name}, {"config", job.config}}},
            {"options", OptionsToJson(job.options)},
            {"config", ShowOptions(job.options, job.node, true)},
            {"budget", budget},
            {"to", Name(last)}}) {}

Status RunFile::Begin() {
  run_["machine"] = MachineFacts();
  run_["started"] = TimeNow();
  run_["stale"] = JsonOf(Stale(earlier_));
  return WriteJson(folder_, run_);
}

std::vector<StaleOutput> RunFile::Stale(const std::map<std::string, OutputFile>& now) const {
  std::vector<StaleOutput> stale;
  for (const auto& [name, output] : earlier_) {
    const auto present = now.find(name);
    if (present != now.end() && present->second == output) stale.push_back({DisplayPath(name), Name(output.stage)});
  }
  return stale;
}

Status RunFile::End(const Status& outcome) {
  const ExitCode code = outcome ? ExitCode::kDone : ExitCodeOf(outcome.error().code);
  run_["ended"] = {{"time", TimeNow()},
                   {"exit_code", static_cast<int>(code)},
                   {"message", outcome ? std::string() : outcome.error().Message()}};
  const std::vector<StaleOutput> stale = Stale(OutputsIn(folder_));
  const bool nothing_done = code == ExitCode::kUsage && !stale.empty() && stale.size() == earlier_.size();
  if (nothing_done && !previous_.empty()) return WriteFile(folder_ / "run.json", previous_);
  run_["stale"] = JsonOf(stale);
  WarnOfStale(stale);
  return WriteJson(folder_, run_);
}

nlohmann::json ReadRunFile(const fs::path& folder) {
  std::error_code unknown;
  const auto path = folder / "run.json";
  if (!fs::is_regular_file(path, unknown)) return nullptr;
  nlohmann::json run = ReadJson(path).value_or(nullptr);
  if (!run.is_object() || !run.contains("options") || !run.at("options").is_object()) return nullptr;
  return TextField(run, "created_by").rfind("mocurate ", 0) == 0 ? run : nlohmann::json();
}

std::vector<StaleOutput> StaleOutputs(const fs::path& folder) {
  const nlohmann::json run = ReadRunFile(folder);
  std::vector<StaleOutput> stale;
  if (!run.is_object()) return stale;
  if (run.contains("ended") && run.contains("stale")) {
    for (const nlohmann::json& output : run.at("stale")) {
      std::error_code unknown;
      const std::string file = TextField(output, "file");
      const bool exists = !file.empty() && fs::exists(folder / PathFromText(file), unknown);
      if (exists) stale.push_back({file, TextField(output, "stage")});
    }
    return stale;
  }
  std::error_code gone;
  const fs::file_time_type begun = fs::last_write_time(folder / "run.json", gone);
  for (const auto& [name, output] : OutputsIn(folder)) {
    if (output.written < begun) stale.push_back({DisplayPath(name), Name(output.stage)});
  }
  return stale;
}

bool IsStale(const std::vector<StaleOutput>& stale, const std::string& file) {
  return std::any_of(stale.begin(), stale.end(), [&](const StaleOutput& output) { return output.file == file; });
}

Status AddStale(const fs::path& folder, const std::vector<StaleOutput>& stale) {
  if (stale.empty()) return {};
  nlohmann::json run = ReadRunFile(folder);
  if (!run.is_object()) return {};
  nlohmann::json& list = run["stale"];
  if (!list.is_array()) list = nlohmann::json::array();
  for (nlohmann::json& output : JsonOf(stale)) list.push_back(std::move(output));
  WarnOfStale(stale);
  return WriteJson(folder, run);
}

}  // namespace mocurate
