#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/motion/motion.h"

namespace mocurate {

/// What counts as the same. Joints are compared by their distances from all other joints, which do not depend on place,
/// heading, axes or camera; in metres, root mean squares over a stretch, of the joint that differs or moves most.
struct StretchLimits {
  double distance = 0.004;  ///< at most
  double full_s = 1.0;      ///< shorter stretches may differ by less, as the square root of their length
  double least_s = 0.6;     ///< length of a stretch
  double spread = 0.007;    ///< at least, about the mean: motionless stretches always match
};

/// Two motions that show the same for a while, perhaps as mirror images.
struct SharedStretch {
  std::size_t first = 0, second = 0;  ///< indices, first < second
  bool mirrored = false;
  double distance = 0.005;            ///< metres
  double begin_s = 0.0, end_s = 0.0;  ///< of the first
  double second_begin_s = 0.0, second_end_s = 0.0;
};

/// Motion of an index, or null; valid until the next call.
using MotionAt = std::function<const Motion*(std::size_t)>;

/// The longest shared stretch of every two of `count` motions that have one, sorted by (first, second): copies, crops,
/// other rates and small noise. Windows of `least_s` are looked up in a k-d tree of their principal components, then
/// compared over the whole overlap at the best shift in time; at least 0.8 of the overlap must be shared, as takes of
/// one person agree in parts. Joints are smoothed by a Gaussian of 0.08 s, so that interpolation and noise of
/// millimetres do not hide a copy. Motions of one skeleton whose frames lie at most
/// kMaxGap_s apart, others match none; each is requested twice and stored as about 2 kB per
/// second.
std::vector<SharedStretch> FindSharedStretches(std::size_t count, const MotionAt& motion,
                                               const StretchLimits& limits = {});

}  // namespace mocurate
