#include "core/motion/preparation.h"

#include <algorithm>

namespace mocurate {
int WindowBound(int frame_count, int length, LastStart last_start) {
  const int gap = frame_count - length;
  if (gap <= 0) return 0;
  return last_start == LastStart::kExcluded ? gap : gap + 1;
}

Window DrawWindow(int frame_count, int length, LastStart last_start, Random& random) {
  const int bound = WindowBound(frame_count, length, last_start);
  Window window;
  window.padded = frame_count < length;
  if (bound > 0) window.start = static_cast<int>(random.Below(static_cast<std::uint64_t>(bound)));
  return window;
}

std::vector<double> PrepareWindow(const JointPositions& joints, const Window& window, int length, bool centre_clip) {
  std::vector<double> flat;
  if (joints.frames == 0 || joints.joints == 0) return flat;
  flat.reserve(static_cast<std::size_t>(length) * static_cast<std::size_t>(joints.joints) * 3);
  // Centred and then centred again in the crop: one subtraction after the other, as the released loader does.
  const Vector3d clip_root = centre_clip ? Vector3d(joints.at(0, 0)) : Vector3d::Zero();
  const Vector3d crop_root =
      window.padded ? Vector3d(Vector3d::Zero()) : Vector3d(Vector3d(joints.at(window.start, 0)) - clip_root);
  for (int f = 0; f < length; ++f) {
    const int frame = std::min(window.start + f, joints.frames - 1);
    for (int j = 0; j < joints.joints; ++j) {
      const Vector3d point = (Vector3d(joints.at(frame, j)) - clip_root) - crop_root;
      flat.insert(flat.end(), point.data(), point.data() + 3);
    }
  }
  return flat;
}

std::vector<int> SampleFrames(int shortest, int longest, int frame_count, const DrawInteger& draw) {
  const auto count = static_cast<int>(draw(shortest, std::max(std::min(frame_count, longest), shortest)));
  const int shift = count > frame_count ? 0 : static_cast<int>(draw(0, std::max(0, frame_count - count - 1)));
  std::vector<int> frames;
  for (int k = 0; k < count; ++k) frames.push_back(std::min(shift + k, frame_count - 1));
  return frames;
}

std::vector<int> SampleFrames(int shortest, int longest, int frame_count, Random& random) {
  return SampleFrames(shortest, longest, frame_count, [&random](std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(random.Below(static_cast<std::uint64_t>(high - low + 1)));
  });
}

}  // namespace mocurate
