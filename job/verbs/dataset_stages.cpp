#include "job/verbs/dataset_stages.h"

#include "core/base/file.h"
#include "job/motion_files.h"
#include "job/stage_runs.h"

namespace mocurate {

Status CheckIsDataset(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown)) {
    return Fail(ErrorCode::kNotFound, "no such file", DisplayPath(path),
                "give a dataset: RUN/dataset.h5, or what `mocurate fit` wrote");
  }
  if (IsMotionStore(path)) return {};
  return Fail(ErrorCode::kInconsistent, "the file is not a dataset of mocurate", DisplayPath(path),
              "create one with `mocurate config init`, then `mocurate run CONFIG --to assemble`");
}

Expected<std::unique_ptr<DatasetStages>> DatasetStages::Make(const CommonArguments& common) {
  auto made = std::unique_ptr<DatasetStages>(new DatasetStages());
  if (made->scratch_.path().empty()) return Forward(TemporaryFolder::Missing());
  RunnerOptions settings;
  settings.run_folder = made->scratch_.path();
  settings.quiet = common.quiet;
  settings.log_failures = false;
  auto runner = Runner::Make(settings);
  if (!runner) return Forward(runner);
  made->runner_ = std::move(*runner);
  return made;
}

Expected<ItemResult> DatasetStages::One(const StageDeclaration& stage, ItemSpec item) {
  return StageRuns(*runner_, counts_).One(stage, std::move(item));
}

}  // namespace mocurate
