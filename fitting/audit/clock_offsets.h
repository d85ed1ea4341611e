#pragma once

#include <vector>

#include "fitting/audit/rig_samples.h"
#include "fitting/options.h"

namespace mocurate {

/// What the clocks of a rig's cameras are off by, each with its standard deviation. Seconds, (views).
struct ClockOffsets {
  std::vector<double> clock_s;
  std::vector<double> sigma_s;
};

/// Clocks that minimise the pixel errors of all views and points together: Gauss-Newton on one offset per camera with
/// the points eliminated (Schur complement), detections moved along the image velocities of the keypoints, under the
/// loss of Geman and McClure, whose scale shrinks to a third of options.outlier. From the model's clocks; what a camera
/// is off by is counted from the camera that most others agree with (ties: the first). Standard deviations by the
/// spread of what the moments say. A camera that sees nothing move, or nothing at all, has an infinite one.
ClockOffsets RefineClocks(const RigSamples& samples, const RigModel& model, const TriangulationOptions& options);

/// How far the clocks of a model change when its cameras stand as `calibrated`, and when another camera is excluded
/// (of four at least): of who walks, a clock and a wrong place of any camera look alike. Seconds, (views), the largest.
std::vector<double> ChangeOfClocks(const RigSamples& samples, const RigModel& model, const RigModel& calibrated,
                                   const TriangulationOptions& options);

}  // namespace mocurate
