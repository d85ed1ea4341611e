#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mocurate {

/// How the files of a clip of many files are named.
struct GatheredNames {
  std::string pattern;     ///< "{recording}/{camera}_json/{camera}.{frame}.json"
  bool recording = false;  ///< the pattern has {recording}
};

/// From one file of each folder: the last digits are the frame, what folder and file have in common before them is the
/// camera (without `cameras`, the folder is the recording). Empty where the names of the files are not alike.
std::optional<GatheredNames> GuessGathered(const std::vector<std::string>& files, bool cameras);

}  // namespace mocurate
