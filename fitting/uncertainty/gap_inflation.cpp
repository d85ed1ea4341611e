#include "fitting/uncertainty/gap_inflation.h"

#include <algorithm>
#include <limits>

namespace mocurate {
namespace {

/// Gaps beyond which people move farther than a random walk. Source: bench_studio_fits gap=SECONDS
constexpr double kLongGap_s = 0.6;
constexpr double kMaxInflation = 4.0;  ///< factor on sigma, at most. Source: bench_studio_fits gap=SECONDS

/// Inflation of a joint's variance, (F).
std::vector<double> InflationOf(const SkeletonTracks& tracks, int joint) {
  const int frames = tracks.frames();
  std::vector<double> factors(static_cast<std::size_t>(frames), 1.0);
  for (int begin = 0; begin < frames; ++begin) {
    if (tracks.seen(begin, joint)) continue;
    int end = begin;
    while (end < frames && !tracks.seen(end, joint)) ++end;
    double length_s = tracks.time_s[std::min(end, frames - 1)] - tracks.time_s[std::max(begin - 1, 0)];
    if (begin == 0 || end == frames) length_s *= 2.0;  // its other end is unknown
    const double factor = std::clamp(length_s / kLongGap_s, 1.0, kMaxInflation);
    std::fill(factors.begin() + begin, factors.begin() + end, factor * factor);
    begin = end;
  }
  return factors;
}

}  // namespace

GapInflation FindGapInflation(const SkeletonTracks& tracks) {
  const auto joints = static_cast<std::size_t>(tracks.joints());
  const std::vector<bool> ever = tracks.JointObservations();
  GapInflation inflation;
  inflation.position.assign(tracks.confidence.size(), 1.0);
  inflation.rotation.assign(tracks.confidence.size(), std::numeric_limits<double>::infinity());
  for (int j = tracks.joints() - 1; j >= 0; --j) {
    if (!ever[j]) continue;
    const std::vector<double> own = InflationOf(tracks, j);
    for (std::size_t f = 0; f < own.size(); ++f) inflation.position[f * joints + j] = own[f];
  }
  for (int j = tracks.joints() - 1; j > 0; --j) {
    const int parent = tracks.skeleton->joints[j].parent;
    for (std::size_t f = 0; f < inflation.position.size() / joints; ++f) {
      const double& below = inflation.rotation[f * joints + j];
      double& above = inflation.rotation[f * joints + parent];
      above = std::min({above, below, ever[j] ? inflation.position[f * joints + j] : above});
    }
  }
  for (int j = 0; j < tracks.joints(); ++j) {  // a joint never observed follows those above or below
    const int parent = tracks.skeleton->joints[j].parent;
    for (std::size_t at = j; !ever[j] && at < inflation.position.size(); at += joints) {
      const double above = parent < 0 ? inflation.rotation[at] : inflation.position[at + parent - j];
      inflation.position[at] = std::min(above, inflation.rotation[at]);
    }
  }
  for (double& factor : inflation.rotation) {
    if (factor == std::numeric_limits<double>::infinity()) factor = 1.0;
  }
  return inflation;
}

}  // namespace mocurate
