#pragma once

#include <vector>

#include "fitting/audit/rig_samples.h"
#include "fitting/options.h"

namespace mocurate {

inline constexpr double kSameClock_s = 0.004;  ///< clock offsets below this are not distinguished

/// Clock offsets of a rig's cameras, each with its standard deviation. Seconds, (views).
struct ClockOffsets {
  std::vector<double> clock_s;
  std::vector<double> sigma_s;
};

/// Clock offsets that minimise the pixel errors of all views and points. Gauss-Newton on one offset per camera, with
/// the points eliminated (Schur complement) and detections moved along the image velocities of the keypoints. The loss
/// is Geman and McClure's, its scale shrinks to a third of options.outlier. Starts from the model's clocks. Offsets are
/// relative to the camera with which the most others agree (ties: the first). Standard deviations come from the
/// variation between moments; infinite for a camera without moving keypoints or without detections.
ClockOffsets RefineClocks(const RigSamples& samples, const RigModel& model, const TriangulationOptions& options);

/// How far the clocks of a model change with cameras at the `calibrated` poses, and without another camera (of at least
/// four). For a walking person, a clock offset and a wrong camera pose look alike. Seconds, (views), the largest
/// change.
std::vector<double> ChangeOfClocks(const RigSamples& samples, const RigModel& model, const RigModel& calibrated,
                                   const TriangulationOptions& options);

}  // namespace mocurate
