#include "train/recognisers/recogniser_input.h"

#include <algorithm>
#include <cmath>

#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "core/motion/preparation.h"

namespace mocurate {

JointPositions ResampledJoints(const Motion& motion, int frames) {
  if (motion.frame_count() == frames) return motion.joints;
  JointPositions resampled(frames, motion.joint_count());
  if (motion.frame_count() < 2) {
    for (int f = 0; f < frames; ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) resampled.at(f, j) = motion.joints.at(0, j);
    }
    return resampled;
  }
  return ResampleToCount(MakeJointsOnly(motion.skeleton, motion.rate, motion.joints), frames).joints;
}

std::vector<float> RecogniserInput(const Motion& motion, RecogniserInputKind kind, int frames, Random& random) {
  std::vector<double> values;
  if (kind == RecogniserInputKind::kCrop) {
    const Window window = DrawWindow(motion.frame_count(), frames, LastStart::kExcluded, random);
    values = PrepareWindow(motion.joints, window, frames, true);
  } else if (kind == RecogniserInputKind::kWhole) {
    const Vector3d root = motion.joints.at(0, 0);
    for (int f = 0; f < frames; ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) {
        Vector3d place = -root;
        if (f < motion.frame_count()) place += motion.joints.at(f, j);
        values.insert(values.end(), place.data(), place.data() + 3);
      }
    }
  } else {
    JointPositions resampled = ResampledJoints(motion, frames);
    const Vector3d root = resampled.at(0, 0);
    for (int f = 0; f < frames; ++f) {
      for (int j = 0; j < resampled.joints; ++j) resampled.at(f, j) -= root;
    }
    values = std::move(resampled.xyz);
  }
  return std::vector<float>(values.begin(), values.end());
}

void AugmentSpace(const AugmentationOptions& options, const Skeleton& skeleton, int frames, Random& random,
                  std::vector<float>& motion) {
  const int J = skeleton.joint_count();
  const double yaw = random.Uniform(-options.yaw_rad, options.yaw_rad);
  const double scale = 1.0 + random.Uniform(-options.scale, options.scale);
  const bool mirrored = options.mirror && random.Uniform() < 0.5;
  const double c = std::cos(yaw) * scale, s = std::sin(yaw) * scale;
  for (int f = 0; f < frames; ++f) {
    float* row = motion.data() + static_cast<std::size_t>(f) * 3 * J;
    if (mirrored) {
      for (int j = 0; j < J; ++j) {
        const int partner = skeleton.joints[j].mirror;
        if (partner > j) std::swap_ranges(row + 3 * j, row + 3 * j + 3, row + 3 * partner);
      }
      for (int j = 0; j < J; ++j) row[3 * j] = -row[3 * j];
    }
    for (int j = 0; j < J; ++j) {
      float* p = row + 3 * j;
      const double x = c * p[0] + s * p[2], z = -s * p[0] + c * p[2];
      p[0] = static_cast<float>(x);
      p[1] = static_cast<float>(scale * p[1]);
      p[2] = static_cast<float>(z);
      if (options.noise_m > 0.0) {
        for (int k = 0; k < 3; ++k) p[k] += static_cast<float>(options.noise_m * random.Normal());
      }
    }
  }
  if (options.noise_m > 0.0) {
    const float root[3] = {motion[0], motion[1], motion[2]};
    for (std::size_t i = 0; i < motion.size(); ++i) motion[i] -= root[i % 3];
  }
}

JointPositions AugmentTime(const AugmentationOptions& options, const JointPositions& joints, Random& random) {
  const double cut = random.Uniform(0.0, options.crop);
  const double before = random.Uniform(0.0, cut);
  const double warp = random.Uniform(-options.warp, options.warp);
  const int F = joints.frames;
  if (F < 2 || (options.crop <= 0.0 && options.warp <= 0.0)) return joints;
  JointPositions result(F, joints.joints);
  for (int f = 0; f < F; ++f) {
    const double u = static_cast<double>(f) / (F - 1);
    const double bent = u + warp * std::sin(3.14159265358979 * 2.0 * u) / (2.0 * 3.14159265358979);
    const double at = std::clamp((before + (1.0 - cut) * bent) * (F - 1), 0.0, static_cast<double>(F - 1));
    const int low = std::min(static_cast<int>(at), F - 2);
    const double part = at - low;
    for (int j = 0; j < joints.joints; ++j) {
      result.at(f, j) = (1.0 - part) * joints.at(low, j) + part * joints.at(low + 1, j);
    }
  }
  return result;
}

}  // namespace mocurate
