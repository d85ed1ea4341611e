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

/// Where a clip comes from: a file, its row there, and its frames [begin, end) in that clip.
struct ClipOrigin {
  std::size_t file = 0;
  std::size_t row = 0;
  int begin = 0;
  int end = 0;
};

/// All frames of a clip.
ClipOrigin WholeClip(std::size_t file, std::size_t row, const std::vector<DatasetFile>& files);
/// All frames of these rows of the only file, or of all its rows.
std::vector<ClipOrigin> WholeClips(const std::vector<std::size_t>& rows, const std::vector<DatasetFile>& files);
std::vector<ClipOrigin> WholeClips(const std::vector<DatasetFile>& files);

/// Writes a dataset whose clips come from files, one at a time. Frames are those of `made`, or where it has none, of
/// the files. Skeletons, rates and bone lengths are those of `made`. Fields that the format does not name follow as
/// FieldKeeper does it. Returns the findings about those that are dropped, which `made` gets as well. Errors of
/// DatasetWriter and DatasetClips::Read.
Expected<std::vector<Finding>> WriteFromFiles(Dataset& made, const std::vector<ClipOrigin>& origins,
                                              const std::vector<DatasetFile>& files, const std::filesystem::path& to,
                                              const std::vector<std::pair<ClipOrigin, ClipOrigin>>& repeated = {});

}  // namespace mocurate
