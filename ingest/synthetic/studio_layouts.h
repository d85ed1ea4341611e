#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ingest/synthetic/studio_folder.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// Writes a folder in the layout of a real set, per subject the truth beside it (truth/SUBJECT.h5 by the id that the
/// set's declaration in configs/sources gives a clip, in that clip's world), and studio.json, what it was made with.
/// The same options give the same bytes for any number of jobs. Errors: kCannotWrite where the folder holds something
/// already, kConfig for an unknown action, those of ReadBodyTemplate.
Expected<StudioFolder::Counts> WriteStudioLayout(const StudioOptions& options, const std::filesystem::path& folder,
                                                 int jobs, const StudioFolder::Progress& progress = {});

/// How a folder of a written capture is read.
struct WrittenSource {
  std::string name;    ///< source declaration of configs/sources
  std::string folder;  ///< below the written one
};
std::vector<WrittenSource> SourcesOf(StudioLayout layout, bool with_depth);

/// What a layout with depth images will take; all 0 for others, which take seconds.
struct StudioEstimate {
  std::size_t images = 0;
  double bytes = 0.0;
  double seconds = 0.0;  ///< with so many jobs
};

/// From the plan of the takes and one image that is rendered. Errors of WriteStudioLayout.
Expected<StudioEstimate> EstimateStudioLayout(const StudioOptions& options, int jobs);

}  // namespace mocurate
