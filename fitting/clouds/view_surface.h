#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/depth_image.h"
#include "core/motion/clip.h"

namespace mocurate {

/// What one depth view saw of the person at one moment. Camera's frame, metres; columns are points.
struct ViewSurface {
  std::shared_ptr<const DepthImage> image;  ///< all that was measured, the room too
  Eigen::Matrix3Xd points;                  ///< of the person, thinned
  Eigen::Matrix3Xd normals;                 ///< unit, towards the camera
  bool flat = false;                        ///< a wall is where the person should be: no points then
  bool masked = false;                      ///< a pixel without a value is one where the person is not
  /// The outline, in cells of kOutlineCell pixels about the person: for each cell the nearest one that shows the
  /// person, as row * columns + column.
  int left = 0, top = 0, columns = 0, rows = 0;
  std::vector<std::int32_t> nearest;  ///< (rows*columns)

  bool empty() const { return points.cols() == 0; }
};

inline constexpr int kOutlineCell = 2;  ///< pixels

/// The person in an image of a view, as person_points finds her in this view alone; thinned to `voxel_size`. Empty for
/// fewer than 60 points, and for what is flat as no person is. Errors of FuseImages.
Expected<ViewSurface> SurfaceOf(const DepthView& view, DepthImage image, double voxel_size);

}  // namespace mocurate
