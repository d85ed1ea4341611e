#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/pipeline/runner.h"
#include "job/temporary_folder.h"
#include "job/verbs/verbs.h"

namespace mocurate {

/// Checks that a path is a dataset or MotionSet of mocurate. Errors kNotFound, kInconsistent.
Status CheckIsDataset(const std::filesystem::path& path);

/// Runs stages on one dataset for a verb, in a temporary folder.
class DatasetStages {
 public:
  /// Error kCannotWrite if the folder cannot be created, and those of Runner::Make.
  static Expected<std::unique_ptr<DatasetStages>> Make(const CommonArguments& common);

  /// Runs one item: its artifact and outcome.
  Expected<ItemResult> One(const StageDeclaration& stage, ItemSpec item);

  const std::filesystem::path& folder() const { return scratch_.path(); }

 private:
  DatasetStages() = default;

  TemporaryFolder scratch_;
  std::unique_ptr<Runner> runner_;
  std::vector<StageCounts> counts_;
};

}  // namespace mocurate
