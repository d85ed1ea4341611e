#include "core/motion/preparation.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <string>

namespace mocurate {
namespace {

tl::unexpected<Error> Unusable(const std::string& what, const std::string& hint) {
  return Fail(ErrorCode::kUsage, what, "frame sampling", hint);
}

Status CheckSampling(const ActorSampling& s, int frame_count) {
  if (frame_count < 1) return Unusable("a clip of " + std::to_string(frame_count) + " frames", "it needs at least one");
  if (s.num_frames == 0 || s.num_frames < -2) {
    return Unusable("num_frames " + std::to_string(s.num_frames), "write a positive number, -1 (all) or -2 (drawn)");
  }
  if (s.step == 0 || s.step < -1) {
    return Unusable("step " + std::to_string(s.step), "write a positive number or -1 (as large as fits)");
  }
  if (s.max_len == 0 || s.max_len < -1) {
    return Unusable("max_len " + std::to_string(s.max_len), "write a positive number or -1 (no bound)");
  }
  if (s.num_frames == -2 && s.min_len < 1) {
    return Unusable("min_len " + std::to_string(s.min_len), "write a positive number");
  }
  return {};
}

/// Draws with a check that the given numbers keep the rules.
Expected<int> DrawWithin(const DrawInteger& draw, std::int64_t low, std::int64_t high) {
  const std::int64_t drawn = draw(low, high);
  if (drawn >= low && drawn <= high) return static_cast<int>(drawn);
  return Unusable("a draw of " + std::to_string(drawn),
                  "it must lie in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
}

Expected<std::vector<int>> DistinctFrames(int count, int frame_count, const DrawInteger& draw) {
  std::vector<int> frames(static_cast<std::size_t>(frame_count));
  std::iota(frames.begin(), frames.end(), 0);
  for (int i = 0; i < count; ++i) {
    const auto chosen = DrawWithin(draw, i, frame_count - 1);
    if (!chosen) return Forward(chosen);
    std::swap(frames[static_cast<std::size_t>(i)], frames[static_cast<std::size_t>(*chosen)]);
  }
  frames.resize(static_cast<std::size_t>(count));
  std::sort(frames.begin(), frames.end());
  return frames;
}

Expected<std::vector<int>> ConsecutiveFrames(const ActorSampling& s, int count, int frame_count,
                                             const DrawInteger& draw) {
  const int largest = count > 1 ? (frame_count - 1) / (count - 1) : 1;
  int step = s.step;
  if (s.kind == ActorSampling::Kind::kRandomConsecutive) {
    const auto drawn = DrawWithin(draw, 1, largest);
    if (!drawn) return Forward(drawn);
    step = *drawn;
  } else if (step == -1 || static_cast<std::int64_t>(step) * (count - 1) >= frame_count) {
    step = largest;
  }
  const int last = step * (count - 1);
  const auto shift = DrawWithin(draw, 0, std::max(0, frame_count - last - 2));
  if (!shift) return Forward(shift);
  std::vector<int> frames;
  for (int k = 0; k < count; ++k) frames.push_back(*shift + step * k);
  return frames;
}

}  // namespace

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

Expected<std::vector<int>> SampleFrames(const ActorSampling& s, int frame_count, const DrawInteger& draw) {
  if (Status ok = CheckSampling(s, frame_count); !ok) return Forward(ok);
  std::vector<int> all(static_cast<std::size_t>(frame_count));
  std::iota(all.begin(), all.end(), 0);
  if (s.num_frames == -1 && (s.max_len == -1 || frame_count <= s.max_len)) return all;
  int count = s.num_frames;
  if (count == -1) count = s.max_len;
  if (count == -2) {
    const int longest = s.max_len == -1 ? frame_count : std::min(frame_count, s.max_len);
    const auto drawn = DrawWithin(draw, s.min_len, std::max(longest, s.min_len));
    if (!drawn) return Forward(drawn);
    count = *drawn;
  }
  if (count > frame_count) {
    all.resize(static_cast<std::size_t>(count), frame_count - 1);
    return all;
  }
  if (s.kind == ActorSampling::Kind::kRandom) return DistinctFrames(count, frame_count, draw);
  return ConsecutiveFrames(s, count, frame_count, draw);
}

Expected<std::vector<int>> SampleFrames(const ActorSampling& sampling, int frame_count, Random& random) {
  return SampleFrames(sampling, frame_count, [&random](std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(random.Below(static_cast<std::uint64_t>(high - low + 1)));
  });
}

}  // namespace mocurate
