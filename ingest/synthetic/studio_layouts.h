#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ingest/synthetic/studio_folder.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// Writes a folder in the layout of a real set, and studio.json with its options. Beside it lies the truth per subject:
/// truth/SUBJECT.h5 by the clip id that the set's declaration in configs/sources gives, in that clip's world. The same
/// options give the same bytes for any number of jobs. Errors: kCannotWrite for a folder that is not empty, kConfig for
/// an unknown action, those of ReadBodyTemplate.
Expected<StudioFolder::Counts> WriteStudioLayout(const StudioOptions& options, const std::filesystem::path& folder,
                                                 int jobs, const StudioFolder::Progress& progress = {});

/// How a written capture is read.
struct WrittenSource {
  std::string name;    ///< source declaration of configs/sources
  std::string folder;  ///< below the written one
};
std::vector<WrittenSource> SourcesOf(StudioLayout layout, bool with_depth);

/// Estimated size of a layout with depth images; all 0 for others, which take seconds.
struct StudioEstimate {
  std::size_t images = 0;
  double bytes = 0.0;
  double seconds = 0.0;  ///< with this number of jobs
};

/// From the plan of the takes and one rendered image. Errors of WriteStudioLayout.
Expected<StudioEstimate> EstimateStudioLayout(const StudioOptions& options, int jobs);

}  // namespace mocurate
