#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/motion/clip.h"
#include "fitting/audit/view_sides.h"

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

/// Keypoints of a mirrored image: x becomes width - x.
inline void Mirror(KeypointView& view) {
  for (std::size_t i = 0; i < view.values.size(); i += 3) {
    if (view.values[i + 2] > 0.0) view.values[i] = view.camera.width - view.values[i];
  }
}

/// Keypoints of an image `factor` times the size of the camera's.
inline void Enlarge(KeypointView& view, double factor) {
  for (std::size_t i = 0; i < view.values.size(); i += 3) {
    view.values[i] *= factor;
    view.values[i + 1] *= factor;
  }
}

/// Exchanges left and right keypoints, as a detector does that mistakes the sides.
inline void ExchangeSides(KeypointView& view, const std::vector<std::string>& names) {
  const std::vector<std::size_t> other = OtherSides(names);
  const std::vector<double> given = view.values;
  for (std::size_t i = 0; i < given.size() / 3; ++i) {
    const std::size_t k = i % names.size();
    for (std::size_t n = 0; n < 3; ++n) view.values[3 * i + n] = given[3 * (i - k + other[k]) + n];
  }
}

/// Two cameras get each other's files.
inline void ExchangeFiles(Evidence& evidence, std::size_t a, std::size_t b) {
  auto& views = evidence.keypoint_views;
  std::swap(views[a].values, views[b].values);
  std::swap(views[a].people, views[b].people);
}

/// Each camera gets the next one's files.
inline void RotateFiles(Evidence& evidence) {
  const auto& views = evidence.keypoint_views;
  for (std::size_t v = 0; v + 1 < views.size(); ++v) ExchangeFiles(evidence, v, v + 1);
}

}  // namespace mocurate
