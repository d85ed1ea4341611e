#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/motion/clip.h"

namespace mocurate {

/// Frames [begin, end) of every view.
inline Evidence FramesOf(const Evidence& evidence, int begin, int end) {
  Evidence some = evidence;
  for (KeypointView& view : some.keypoint_views) {
    const std::size_t numbers = view.values.size() / static_cast<std::size_t>(std::max(view.frames(), 1));
    const auto at = [&](int frame) { return static_cast<std::ptrdiff_t>(static_cast<std::size_t>(frame) * numbers); };
    view.values.assign(view.values.begin() + at(begin), view.values.begin() + at(end));
    view.time_s.assign(view.time_s.begin() + begin, view.time_s.begin() + end);
  }
  return some;
}

/// Keypoints of an image that was turned over: x becomes width - x.
inline void Mirror(KeypointView& view) {
  for (std::size_t i = 0; i < view.values.size(); i += 3) {
    if (view.values[i + 2] > 0.0) view.values[i] = view.camera.width - view.values[i];
  }
}

/// Keypoints of an image of another size than the camera's.
inline void Enlarge(KeypointView& view, double factor) {
  for (std::size_t i = 0; i < view.values.size(); i += 3) {
    view.values[i] *= factor;
    view.values[i + 1] *= factor;
  }
}

/// Each camera gets the next one's files.
inline void RotateFiles(Evidence& evidence) {
  auto& views = evidence.keypoint_views;
  for (std::size_t v = 0; v + 1 < views.size(); ++v) {
    std::swap(views[v].values, views[v + 1].values);
    std::swap(views[v].people, views[v + 1].people);
  }
}

}  // namespace mocurate
