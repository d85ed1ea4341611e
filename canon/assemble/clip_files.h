#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/pipeline/stage.h"
#include "core/store/dataset_clips.h"

namespace mocurate {

/// Dataset files whose clips become one set. Clips are in memory without frames; frames are read when they are written,
/// one clip at a time.
class ClipFiles {
 public:
  /// Appends the clips of a file, without frames, and its findings to `set`. Errors of DatasetClips; kInconsistent
  /// where one file has joints only and another rotations.
  Status Add(const StageInput& input, Dataset& set);

  /// Name of the input of each clip, by its id.
  const std::map<std::string, std::string>& items() const { return items_; }

  /// Motion hash of each clip of the set that its motion tells apart (DistinguishedByMotion); empty for the others.
  Expected<std::vector<std::string>> Contents(const Dataset& set) const;

  /// The clip with its frames; skeleton, labels and the rest unchanged.
  Expected<Clip> WithFrames(const Clip& clip);

  /// Writes the set; clips that have their frames in memory are written as they are. Errors of DatasetWriter.
  Status Write(const Dataset& set, const std::filesystem::path& path);

 private:
  struct Place {
    std::size_t file = 0;
    std::size_t row = 0;
    std::uint8_t optional_fields = 0;
  };

  Expected<const DatasetClips*> Opened(std::size_t file);
  SkeletonPtr Shared(SkeletonPtr skeleton);

  std::deque<SkeletonPtr> skeletons_;  ///< different ones of the files read last
  std::vector<PathText> files_;
  std::map<std::string, Place> places_;  ///< by clip id
  std::map<std::string, std::string> items_;
  std::optional<std::pair<std::size_t, DatasetClips>> opened_;  ///< the file read last, checked in full
};

}  // namespace mocurate
