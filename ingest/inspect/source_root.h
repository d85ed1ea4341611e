#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ingest/inspect/clip_consensus.h"
#include "ingest/inspect/file_names.h"

namespace mocurate {

/// The folder that a source stands in: the one that was asked about, or the one above where that holds what belongs to
/// its clips.
struct SourceRoot {
  std::filesystem::path folder;
  std::string prefix;  ///< of the names below the folder that was asked about: empty, or "single/"
};

/// Of motions whose skeletons (fact "skeleton_file") lie in the folder above all of them.
SourceRoot RootOfSkeletons(const ClipConsensus& source, const std::filesystem::path& folder);

/// Where no cameras are in the inspection: those of the files directly in the folder above, added to it, if there are.
SourceRoot RootOfCameras(const std::filesystem::path& folder, Inspection& inspection);

/// ingest.source.skeleton_files, from where the skeletons lie below `root`: fields of `guessed` (whose names have no
/// prefix) if they give each, else the one file that all share. Nothing where neither does.
std::optional<std::string> EstimateSkeletonFiles(const ClipConsensus& source, const SourceRoot& root,
                                                 const NamePatternEstimate& guessed);

}  // namespace mocurate
