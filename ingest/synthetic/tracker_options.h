#pragma once

#include "core/base/options.h"

namespace mocurate {

/// How bad a joint tracker is. Errors are independent of each other; each draws from a generator of its own, so that
/// turning one on leaves the others as they were.
struct TrackerOptions {
  double noise = 0.030;            ///< metres, root mean square in 3D, white
  double bias = 0.0;               ///< metres, root mean square in 3D, constant for a joint
  double dropout_share = 0.05;     ///< joints not seen
  double dropout_frames = 4.0;     ///< mean length of a gap
  double outlier_share = 0.02;     ///< joints grossly wrong
  double outlier_nearest = 0.15;   ///< metres
  double outlier_farthest = 0.50;  ///< metres
  double swap_share = 0.2;         ///< takes in which limbs are exchanged once
  std::int64_t swap_frames = 2;
  double swapped_share = 0.0;  ///< frames in which they are, again and again, for swap_frames on average
  double frozen_share = 0.0;   ///< joints that repeat an earlier value
  double frozen_frames = 8.0;
  double wander = 0.0;          ///< metres, root mean square in 3D, of an error that changes slowly
  double wander_frames = 10.0;  ///< in which it changes

  void Declare(OptionVisitor& v);
};

/// Errors of the size that Kinect trackers have: their joints wander about rather than tremble. Compared with KARD in
/// README.md.
TrackerOptions KinectTracker();

}  // namespace mocurate
