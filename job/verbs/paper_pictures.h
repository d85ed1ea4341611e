#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "job/job_options.h"
#include "job/run_file.h"
#include "job/verbs/verbs.h"

namespace mocurate {

/// The run that pictures are made from.
struct ReproducedRun {
  std::filesystem::path folder;
  const CommonArguments& common;
  const SetsOfRun& sets;
  const std::vector<StaleOutput>& stale;  ///< outputs of the folder that are not used
};

/// Pictures, and rows or surveys that could not be made.
struct PaperPictures {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> lost;  ///< missing parts, each with a warning
};

/// The pictures of a paper's item from the networks and datasets of its run: motions/NAME_ROW.h5, pictures/NAME.svg and
/// .png, pictures/curves.svg of rows that are points of a curve, survey/KIND/ of its studies. Overwrites files of these
/// names. Errors kInterrupted, kCannotWrite.
Expected<PaperPictures> MakePaperPictures(const JobOptions& options, const ReproducedRun& run);

}  // namespace mocurate
