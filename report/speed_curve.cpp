#include "report/annotate_page.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kHalfWindow_s = 0.1;

}  // namespace

std::vector<double> FastestJointSpeeds(const Motion& motion) {
  const int frames = motion.frame_count();
  std::vector<double> speeds(static_cast<std::size_t>(frames), 0.0);
  const int half = std::max(1, static_cast<int>(std::lround(kHalfWindow_s * motion.rate.hz())));
  for (int f = 0; f < frames; ++f) {
    const int begin = std::max(0, f - half), end = std::min(frames - 1, f + half);
    if (begin == end) continue;
    double farthest = 0.0;
    for (int j = 0; j < motion.joint_count(); ++j) {
      farthest = std::max(farthest, (motion.joints.at(end, j) - motion.joints.at(begin, j)).norm());
    }
    speeds[static_cast<std::size_t>(f)] = farthest / motion.rate.FrameTime(end - begin);
  }
  return speeds;
}

PackedSpeeds PackSpeeds(const std::vector<double>& speeds, std::size_t most) {
  PackedSpeeds packed;
  if (speeds.empty()) return packed;
  packed.fastest = *std::max_element(speeds.begin(), speeds.end());
  const std::size_t count = std::min(most, speeds.size());
  for (std::size_t i = 0; i < count; ++i) {
    const auto begin = speeds.begin() + static_cast<std::ptrdiff_t>(i * speeds.size() / count);
    const auto end = speeds.begin() + static_cast<std::ptrdiff_t>((i + 1) * speeds.size() / count);
    const double share = packed.fastest > 0.0 ? *std::max_element(begin, end) / packed.fastest : 0.0;
    packed.values += static_cast<char>(static_cast<unsigned char>(std::lround(255.0 * std::sqrt(share))));
  }
  return packed;
}

}  // namespace mocurate
