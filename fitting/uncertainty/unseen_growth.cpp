#include "fitting/uncertainty/unseen_growth.h"

#include <algorithm>
#include <limits>

namespace mocurate {
namespace {

constexpr double kSurprise_s = 0.6;  ///< gaps from which on people go farther than a walk of independent steps
constexpr double kMostSurprise = 4.0;

/// Of a joint's variance, (F).
std::vector<double> GrowthOf(const SkeletonTracks& tracks, int joint) {
  const int frames = tracks.frames();
  std::vector<double> factors(static_cast<std::size_t>(frames), 1.0);
  for (int begin = 0; begin < frames; ++begin) {
    if (tracks.seen(begin, joint)) continue;
    int end = begin;
    while (end < frames && !tracks.seen(end, joint)) ++end;
    double length_s = tracks.time_s[std::min(end, frames - 1)] - tracks.time_s[std::max(begin - 1, 0)];
    if (begin == 0 || end == frames) length_s *= 2.0;  // nothing is known of its other end
    const double factor = std::clamp(length_s / kSurprise_s, 1.0, kMostSurprise);
    std::fill(factors.begin() + begin, factors.begin() + end, factor * factor);
    begin = end;
  }
  return factors;
}

}  // namespace

UnseenGrowth GrowthOfUnseen(const SkeletonTracks& tracks) {
  const auto joints = static_cast<std::size_t>(tracks.joints());
  const std::vector<bool> ever = tracks.SeenJoints();
  UnseenGrowth growth;
  growth.position.assign(tracks.confidence.size(), 1.0);
  growth.rotation.assign(tracks.confidence.size(), std::numeric_limits<double>::infinity());
  for (int j = tracks.joints() - 1; j >= 0; --j) {
    if (!ever[j]) continue;
    const std::vector<double> own = GrowthOf(tracks, j);
    for (std::size_t f = 0; f < own.size(); ++f) growth.position[f * joints + j] = own[f];
  }
  for (int j = tracks.joints() - 1; j > 0; --j) {
    const int parent = tracks.skeleton->joints[j].parent;
    for (std::size_t f = 0; f < growth.position.size() / joints; ++f) {
      const double& below = growth.rotation[f * joints + j];
      double& above = growth.rotation[f * joints + parent];
      above = std::min({above, below, ever[j] ? growth.position[f * joints + j] : above});
    }
  }
  for (int j = 0; j < tracks.joints(); ++j) {  // what is never shown follows what is, above or below
    const int parent = tracks.skeleton->joints[j].parent;
    for (std::size_t at = j; !ever[j] && at < growth.position.size(); at += joints) {
      const double above = parent < 0 ? growth.rotation[at] : growth.position[at + parent - j];
      growth.position[at] = std::min(above, growth.rotation[at]);
    }
  }
  for (double& factor : growth.rotation) {
    if (factor == std::numeric_limits<double>::infinity()) factor = 1.0;
  }
  return growth;
}

}  // namespace mocurate
