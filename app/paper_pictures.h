#pragma once

#include <filesystem>
#include <vector>

#include "app/job_options.h"
#include "app/verbs.h"

namespace mocurate {

/// The run that pictures are made of.
struct ReproducedRun {
  std::filesystem::path folder;
  const CommonArguments& common;
  int jobs = 0;
};

/// The pictures of a paper's item from the networks and datasets that its run left: motions/NAME_ROW.h5,
/// pictures/NAME.svg and .png, pictures/curves.svg of rows that are points of a curve, survey/KIND/ of its studies. A
/// row whose network is not there is left out with a warning. Errors of generating and drawing.
Expected<std::vector<std::filesystem::path>> MakePaperPictures(const JobOptions& options, const ReproducedRun& run);

}  // namespace mocurate
