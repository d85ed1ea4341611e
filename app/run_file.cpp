#include "app/run_file.h"

#include "app/machine_facts.h"
#include "core/base/file.h"
#include "core/base/version.h"
#include "core/pipeline/journal.h"

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

}  // namespace mocurate
