#pragma once

#include <string>
#include <vector>

#include "core/formats/camera_files.h"
#include "ingest/inspect/measure.h"
#include "ingest/inspect/raw_clip.h"

namespace mocurate {

/// A calibration with everything decided, by the file where it says so and by evidence where it is silent. A value is
/// empty where the evidence does not tell; then `cameras` is empty.
struct CalibrationEstimate {
  Measured reading;             ///< "world_to_camera", "centre", "camera_to_world"
  Measured unit;                ///< "m", "cm", "mm", "inch"
  Measured up;                  ///< "+z": where the top of the images points, in world axes; empty is no obstacle
  std::vector<Camera> cameras;  ///< of every view, in order, metres
  /// "calibration_contradiction": what the file declares is not what its numbers look like, or they are of no camera.
  std::vector<Finding> remarks;
};

/// Below this probability a decision is unknown.
inline constexpr double kSureOfCalibration = 0.9;

/// Decides
/// - what R and t mean: optical axes that meet near one point in front of the cameras, subject points in front,
///   inside the images and no farther than a depth camera measures;
/// - the unit: cameras stand about 1 to 10 m from what they look at (log-normal around 3 m); inches are rare;
/// - up: against the image rows' direction, on the average.
CalibrationEstimate EstimateCalibration(const Calibration& calibration);

}  // namespace mocurate
