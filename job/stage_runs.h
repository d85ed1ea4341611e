#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/pipeline/runner.h"

namespace mocurate {

/// Runs the stages of a job one after the other and keeps their counts.
class StageRuns {
 public:
  StageRuns(Runner& runner, std::vector<StageCounts>& counts) : runner_(runner), counts_(counts) {}

  Expected<StageReport> Run(const StageDeclaration& stage, std::vector<ItemSpec> items,
                            const std::string& branch = {}) {
    auto report = runner_.Run(stage, std::move(items), branch);
    if (report) counts_.push_back(*report);
    return report;
  }

  /// Runs one item whose artifact later stages require.
  Expected<ItemResult> One(const StageDeclaration& stage, ItemSpec item, const std::string& branch = {}) {
    auto report = Run(stage, {std::move(item)}, branch);
    if (!report) return Forward(report);
    if (report->items.empty()) return ItemResult();
    const ItemResult& result = report->items.front();
    if (result.artifact.empty() && !runner_.options().dry_run) {
      Error error = result.outcome.error;
      if (error.where.empty()) error.where = stage.name;
      return tl::unexpected<Error>(error);
    }
    return result;
  }

 private:
  Runner& runner_;
  std::vector<StageCounts>& counts_;
};

/// A temporary folder of a verb, removed with its contents.
class TemporaryFolder {
 public:
  /// Empty path when it cannot be created.
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "mocurate-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

  /// Error of a folder that could not be created.
  static Status Missing() {
    std::error_code unknown;
    return Fail(ErrorCode::kCannotWrite, "a folder for intermediate files cannot be created",
                DisplayPath(std::filesystem::temp_directory_path(unknown)), "free space there, or set TMPDIR");
  }

 private:
  std::filesystem::path path_;
};

}  // namespace mocurate
