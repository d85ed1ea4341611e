#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/uestc_info.h"

namespace mocurate {

/// The videos of a cache by UESTC's info/, in the cache's order.
struct UestcFolder {
  std::vector<UestcVideo> videos;
  std::vector<int> frames;           ///< (videos) maximum number of frames of the clip
  std::vector<std::string> actions;  ///< (40)
};

/// info/ of the folder with the cache. Errors of the formats ("info/names.txt:3"); kNotFound names the missing file.
Expected<UestcFolder> ReadUestcFolder(const std::filesystem::path& folder);

/// "count_contradiction" where more frames are declared than the track of video `entry` (from 0) has. Fewer are
/// correct: the set counts the frames that all its recordings of a video share.
std::optional<Finding> CheckFrameCount(int declared, std::size_t frames, int entry);

}  // namespace mocurate
