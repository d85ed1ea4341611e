#include "report/annotate_page.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kLargest16 = 32767.0;
constexpr double kLargest8 = 127.0;
constexpr double kHalfWindow_s = 0.1;

double ToMillimetres(double metres) { return 1000.0 * metres; }

}  // namespace

PackedFrames PackFrames(const Motion& motion, int step) {
  PackedFrames packed;
  packed.step = step;
  const int frames = motion.frame_count(), joints = motion.joint_count();
  if (frames == 0) return packed;
  const Vector3d origin = motion.joints.at(0, 0);
  double root_reach = 0.0, joint_reach = 0.0;
  for (int f = 0; f < frames; f += step) {
    const Vector3d root = motion.joints.at(f, 0);
    root_reach = std::max(root_reach, (root - origin).cwiseAbs().maxCoeff());
    for (int j = 1; j < joints; ++j) {
      joint_reach = std::max(joint_reach, (motion.joints.at(f, j) - root).cwiseAbs().maxCoeff());
    }
  }
  packed.root_mm = std::max(1.0, ToMillimetres(root_reach) / kLargest16);
  packed.joint_mm = std::max(1.0, ToMillimetres(joint_reach) / kLargest8);
  for (int f = 0; f < frames; f += step) {
    const Vector3d root = motion.joints.at(f, 0);
    for (int i = 0; i < 3; ++i) {
      const auto value = static_cast<unsigned>(std::lround(ToMillimetres(root[i] - origin[i]) / packed.root_mm));
      packed.rows += static_cast<char>(value & 0xFFU);
      packed.rows += static_cast<char>(value >> 8U & 0xFFU);
    }
    for (int j = 1; j < joints; ++j) {
      const Vector3d from_root = motion.joints.at(f, j) - root;
      for (int i = 0; i < 3; ++i) {
        packed.rows += static_cast<char>(std::lround(ToMillimetres(from_root[i]) / packed.joint_mm));
      }
    }
  }
  return packed;
}

void PackedFrames::Halve(int joints) {
  const std::size_t bytes = RowBytes(joints);
  std::string kept;
  for (std::size_t row = 0; row * bytes < rows.size(); row += 2) kept.append(rows, row * bytes, bytes);
  rows = std::move(kept);
  step *= 2;
}

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
