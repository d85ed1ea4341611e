#include "core/quality/padding.h"

#include <algorithm>

#include "core/motion/motion.h"

namespace mocurate {
namespace {

constexpr double kNoRotation = 1e-9;  // sine of half an angle, of readers that multiply by their axes and back

/// Whether no joint but the root is rotated: the rest pose.
bool IsRestPose(const Motion& motion, int frame) {
  if (motion.joints_only()) return false;
  for (int j = 1; j < motion.joint_count(); ++j) {
    if (motion.rotation_at(frame, j).vec().cwiseAbs().maxCoeff() > kNoRotation) return false;
  }
  return true;
}

bool IsZero(const Motion& motion, int frame) {
  if (!motion.joints_only())
    return motion.root_translation[static_cast<std::size_t>(frame)].isZero(0.0) && IsRestPose(motion, frame);
  const double* first = motion.joints.at(frame, 0).data();
  return std::all_of(first, first + 3 * motion.joint_count(), [](double value) { return value == 0.0; });
}

/// Whether the pose is that of the frame before, to the last digit.
bool RepeatsPose(const Motion& motion, int frame) {
  const auto same = [&](const double* now, int numbers) { return std::equal(now, now + numbers, now - numbers); };
  if (!same(motion.joints.at(frame, 0).data(), 3 * motion.joint_count())) return false;
  if (motion.joints_only()) return true;
  const auto place = static_cast<std::size_t>(frame);
  if (motion.root_translation[place] != motion.root_translation[place - 1]) return false;
  for (int j = 0; j < motion.joint_count(); ++j) {
    if (motion.rotation_at(frame, j).coeffs() != motion.rotation_at(frame - 1, j).coeffs()) return false;
  }
  return true;
}

}  // namespace

int FramesWithoutPadding(const Motion& motion, bool repeats) {
  int frames = motion.frame_count();
  while (frames > 0 && IsZero(motion, frames - 1)) --frames;
  if (!repeats) return frames;
  int first = frames - 1;  // of the equal poses at the end
  while (first > 0 && RepeatsPose(motion, first)) --first;
  if (first <= 0 || frames - 1 - first < kPaddingRepeats) return frames;
  return IsRestPose(motion, first) ? first : first + 1;
}

}  // namespace mocurate
