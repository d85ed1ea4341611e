#pragma once

#include <optional>

#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// A camera with the pose that its detections imply.
struct CameraRefit {
  Camera camera;
  double before_px = 0.0;  ///< median distance of its detections from the points
  double after_px = 0.0;
  double moved_m = 0.0;  ///< of its centre
  double rotation_rad = 0.0;
};

/// Pose of a view that minimises the distances of its detections from the other views' points (Gauss-Newton on the six
/// numbers, Huber at 10 px, lens and focal length as calibrated). Empty with fewer than 100 detections of such points,
/// or where the median distance does not fall below `improved` times the previous one.
std::optional<CameraRefit> RefitCamera(const ViewKeypoints& view, const TriangulatedTracks& points,
                                       double improved = 0.5);

}  // namespace mocurate
