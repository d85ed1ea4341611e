#include "core/motion/one_euro.h"

#include <cmath>

#include "core/base/pi.h"
#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

/// Weight of the new value in a low-pass.
double WeightOf(double cutoff_hz, double rate_hz) {
  const double turns = 2.0 * kPi * cutoff_hz / rate_hz;
  return turns / (1.0 + turns);
}

}  // namespace

Motion OneEuroFiltered(const Motion& motion, const OneEuro& filter) {
  Motion filtered = MakeJointsOnly(motion.skeleton, motion.rate, motion.joints);
  const double rate = motion.rate.hz();
  const double speed_weight = WeightOf(filter.speed_cutoff_hz, rate);
  for (int j = 0; j < motion.joint_count(); ++j) {
    for (int axis = 0; axis < 3; ++axis) {
      double speed = 0.0;
      for (int f = 1; f < motion.frame_count(); ++f) {
        const double before = filtered.joints.at(f - 1, j)[axis], given = motion.joints.at(f, j)[axis];
        speed += speed_weight * ((given - before) * rate - speed);
        const double weight = WeightOf(filter.least_cutoff_hz + filter.speed * std::abs(speed), rate);
        filtered.joints.at(f, j)[axis] = before + weight * (given - before);
      }
    }
  }
  return filtered;
}

}  // namespace mocurate
