#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/job_options.h"
#include "app/verbs.h"

namespace mocurate {

/// The run that pictures are made of.
struct ReproducedRun {
  std::filesystem::path folder;
  const CommonArguments& common;
  const SetsOfRun& sets;
};

/// What was made, and rows or surveys that could not be.
struct PaperPictures {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> lost;  ///< what is missing, each with a warning
};

/// The pictures of a paper's item from the networks and datasets that its run left: motions/NAME_ROW.h5,
/// pictures/NAME.svg and .png, pictures/curves.svg of rows that are points of a curve, survey/KIND/ of its studies.
/// Files of these names are overwritten. Errors kInterrupted, kCannotWrite.
Expected<PaperPictures> MakePaperPictures(const JobOptions& options, const ReproducedRun& run);

}  // namespace mocurate
