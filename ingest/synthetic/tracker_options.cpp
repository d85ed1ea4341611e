#include "ingest/synthetic/tracker_options.h"

namespace mocurate {

void TrackerOptions::Declare(OptionVisitor& v) {
  v.Number("noise", noise, Unit::kMetre, {0.0, 1.0}, "root mean square error of a tracked joint");
  v.Number("bias", bias, Unit::kMetre, {0.0, 1.0}, "root mean square of a joint's constant offset");
  v.Number("dropout", dropout_share, Unit::kNone, {0.0, 0.9}, "share of joints that are not seen");
  v.Number("dropout_frames", dropout_frames, Unit::kNone, {1.0, 1e4}, "mean frames until a lost joint is found again");
  v.Number("outlier", outlier_share, Unit::kNone, {0.0, 0.9}, "share of outliers among the joints");
  v.Number("outlier_nearest", outlier_nearest, Unit::kMetre, {0.0, 10.0}, "smallest error of an outlier");
  v.Number("outlier_farthest", outlier_farthest, Unit::kMetre, {0.0, 10.0}, "largest error of an outlier");
  v.Number("swap", swap_share, Unit::kNone, {0.0, 1.0},
           "share of takes in which left and right arms or legs are exchanged once");
  v.Integer("swap_frames", swap_frames, {1.0, 1e4}, "frames for which limbs are exchanged");
  v.Number("swapped", swapped_share, Unit::kNone, {0.0, 0.9},
           "share of frames in which left and right arms, legs or both are exchanged, repeatedly, each time for "
           "swap_frames on average");
  v.Number("frozen", frozen_share, Unit::kNone, {0.0, 0.9}, "share of joints that repeat an earlier value exactly");
  v.Number("frozen_frames", frozen_frames, Unit::kNone, {1.0, 1e4}, "mean frames for which a joint is frozen");
  v.Number("wander", wander, Unit::kMetre, {0.0, 1.0}, "root mean square of a slowly changing error");
  v.Number("wander_frames", wander_frames, Unit::kNone, {1.0, 1e4}, "correlation time of the slow error in frames");
}

TrackerOptions KinectTracker() {
  TrackerOptions options;
  options.noise = 0.004;
  options.wander = 0.025;
  options.wander_frames = 8.0;
  options.dropout_share = 0.02;
  options.outlier_share = 0.002;
  options.swap_share = 0.01;
  return options;
}

}  // namespace mocurate
