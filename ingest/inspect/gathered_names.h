#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mocurate {

/// How the files of clips of many files are named.
struct FramePattern {
  std::string pattern;       ///< "{recording}/{camera}_json/{camera}.{frame}.json"
  bool recording = false;    ///< the pattern has {recording}
  std::size_t matching = 0;  ///< names that follow it
};

/// From one file of each folder: the last digits are the frame, what folder and file have in common before them is the
/// camera (without `cameras`, the folder is the recording). Empty where less than half of the names are alike.
std::optional<FramePattern> EstimateFramePattern(const std::vector<std::string>& files, bool cameras);

/// Files of a camera each: what stands before and after the camera's own part of their names.
struct CameraNames {
  std::string before;
  std::string after;
  std::vector<std::string> cameras;  ///< the parts in between
};

/// What all names share at both ends, up to a letter or digit that differs. "0001_camera.xml": "", "_camera.xml".
/// Each name counts once.
CameraNames NamesOfCameras(const std::vector<std::string>& all);

}  // namespace mocurate
