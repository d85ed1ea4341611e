#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "app/scratch_folder.h"
#include "app/verbs.h"
#include "core/pipeline/runner.h"

namespace mocurate {

/// Whether a path is a dataset or MotionSet of ours. Errors kNotFound, kInconsistent.
Status CheckIsDataset(const std::filesystem::path& path);

/// Runs stages on one dataset for a verb, in a folder of its own that goes with it.
class DatasetStages {
 public:
  /// Error kCannotWrite without a place for the folder, and those of Runner::Make.
  static Expected<std::unique_ptr<DatasetStages>> Make(const CommonArguments& common);

  /// One item: its artifact and what the stage says of it.
  Expected<ItemResult> One(const StageDeclaration& stage, ItemSpec item);

  const std::filesystem::path& folder() const { return scratch_.path(); }

 private:
  DatasetStages() = default;

  ScratchFolder scratch_;
  std::unique_ptr<Runner> runner_;
  std::vector<StageReport> reports_;
};

}  // namespace mocurate
