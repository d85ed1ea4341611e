#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/store/dataset_clips.h"

namespace mocurate {

/// A dataset's file: everything except frames, and access to the frames clip by clip.
struct DatasetFile {
  std::string name;  ///< as NamesOfFiles
  Dataset outline;
  DatasetClips clips;
};

/// The shortest ends of paths that are unique, "kard/dataset.h5"; for "dataset.h5" always with the folder.
std::vector<std::string> NamesOfFiles(const std::vector<std::filesystem::path>& paths);

/// All parts are verified against the hashes of the files. Errors of ReadDataset.
Expected<std::vector<DatasetFile>> OpenDatasetFiles(const std::vector<std::filesystem::path>& paths);

/// Writes a dataset whose clips' frames come from files, one clip at a time; `origins` holds the file and the row of
/// each. Skeletons, rates and bone lengths are those of `outline`. Errors of DatasetWriter and DatasetClips::Read.
Status WriteFromFiles(const Dataset& outline, const std::vector<std::pair<std::size_t, std::size_t>>& origins,
                      const std::vector<DatasetFile>& files, const std::filesystem::path& to);

}  // namespace mocurate
