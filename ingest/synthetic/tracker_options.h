#pragma once

#include "core/base/options.h"

namespace mocurate {

/// Errors of a joint tracker. They are independent, and each draws from its own generator: enabling one does not change
/// the others.
struct TrackerOptions {
  double noise = 0.030;            ///< metres, root mean square in 3D, white
  double bias = 0.0;               ///< metres, root mean square in 3D, constant for a joint
  double dropout_share = 0.05;     ///< joints not seen
  double dropout_frames = 4.0;     ///< mean length of a gap
  double outlier_share = 0.02;     ///< outliers among the joints
  double outlier_nearest = 0.15;   ///< metres
  double outlier_farthest = 0.50;  ///< metres
  double swap_share = 0.2;         ///< takes in which limbs are exchanged once
  std::int64_t swap_frames = 2;
  double swapped_share = 0.0;  ///< frames in which they are, repeatedly, for swap_frames on average
  double frozen_share = 0.0;   ///< joints that repeat an earlier value
  double frozen_frames = 8.0;
  double wander = 0.0;          ///< metres, root mean square in 3D, of a slowly changing error
  double wander_frames = 10.0;  ///< its correlation time

  void Declare(OptionVisitor& v);
};

/// Errors of the size of Kinect trackers: their joints drift slowly rather than jitter. README.md compares them with
/// KARD.
TrackerOptions KinectTracker();

}  // namespace mocurate
