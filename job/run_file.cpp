#include "job/run_file.h"

#include "core/base/file.h"
#include "core/base/version.h"
#include "core/pipeline/journal.h"
#include "job/machine_facts.h"

namespace mocurate {

RunFile::RunFile(const LoadedJob& job, double budget, JobStage last, const std::filesystem::path& folder)
    : path_(folder / "run.json"),
      run_({{"created_by", CreatedBy()},
            {"options", OptionsToJson(job.options)},
            {"config", ShowOptions(job.options, job.node, true)},
            {"budget", budget},
            {"to", Name(last)}}) {}

Status RunFile::Begin() {
  run_["machine"] = MachineFacts();
  run_["started"] = TimeNow();
  return Write();
}

Status RunFile::End(const Status& outcome) {
  const ExitCode code = outcome ? ExitCode::kDone : ExitCodeOf(outcome.error().code);
  run_["ended"] = {{"time", TimeNow()},
                   {"exit_code", static_cast<int>(code)},
                   {"message", outcome ? std::string() : outcome.error().Message()}};
  return Write();
}

Status RunFile::Write() const {
  return WriteFile(path_, run_.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

nlohmann::json ReadRunFile(const std::filesystem::path& folder) {
  std::error_code unknown;
  const auto path = folder / "run.json";
  const auto text =
      std::filesystem::is_regular_file(path, unknown)
          ? ReadFile(path)
          : Expected<std::string>(Fail(ErrorCode::kNotFound, "the file does not exist", DisplayPath(path)));
  if (!text) return nullptr;
  nlohmann::json run = nlohmann::json::parse(*text, nullptr, false);
  if (!run.is_object() || !run.contains("options") || !run.at("options").is_object()) return nullptr;
  const auto maker = run.find("created_by");
  const bool ours = maker != run.end() && maker->is_string() && maker->get<std::string>().rfind("mocurate ", 0) == 0;
  return ours ? run : nlohmann::json();
}

}  // namespace mocurate
