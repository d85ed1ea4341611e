#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/uestc_info.h"

namespace mocurate {

/// What UESTC's info/ says of the videos of a cache, in the cache's order.
struct UestcFolder {
  std::vector<UestcVideo> videos;
  std::vector<int> frames;           ///< (videos) at most so many are of the clip
  std::vector<std::string> actions;  ///< (40)
};

/// info/ of the folder that holds the cache. Errors of the formats ("info/names.txt:3"); kNotFound names the file that
/// is missing.
Expected<UestcFolder> ReadUestcFolder(const std::filesystem::path& folder);

/// "count_contradiction" where more frames are announced than the track of video `entry` (from 0) has. Fewer are none:
/// the set counts what all its recordings of a video have.
std::optional<Finding> DoubtFrameCount(int announced, std::size_t frames, int entry);

}  // namespace mocurate
