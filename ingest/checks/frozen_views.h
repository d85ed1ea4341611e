#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/motion/clip.h"

namespace mocurate {

/// What a view shows in each frame, as text that is equal where the view is; empty: no person is observed, or no file
/// is there.
struct ViewTrace {
  std::string camera;
  std::vector<std::string> frames;
};

/// Frames [begin, end) in which a camera hung.
struct FrozenView {
  std::string camera;
  int begin = 0, end = 0;

  Finding Report() const;
};

/// "frozen_view" (warning): 3 or more frames on end in which one of several views repeats itself to the last digit,
/// while in most of these steps another view changes: its camera hung, or its files were written twice. Value: frames.
/// A camera of half the others' rate, which gives each image twice, is none.
std::vector<FrozenView> FindFrozenViews(const std::vector<ViewTrace>& views);

/// The same of a clip's keypoints and depth images; `files`: where those lie, by name. Images without any depth in them
/// are equal where the person is out of sight.
std::vector<Finding> FindFrozenViews(const Evidence& evidence,
                                     const std::map<std::string, std::filesystem::path>& files);

}  // namespace mocurate
