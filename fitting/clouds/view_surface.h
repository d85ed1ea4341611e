#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"

namespace mocurate {

inline constexpr double kNearestDepth = 0.05;  ///< m in front of the camera; nearer points are invalid

/// The person in one depth view at one moment. Camera's frame, metres; columns are points.
struct ViewSurface {
  std::shared_ptr<const DepthImage> image;  ///< all depths, including the room
  Eigen::Matrix3Xd points;                  ///< of the person, thinned
  Eigen::Matrix3Xd normals;                 ///< unit, towards the camera
  bool flat = false;                        ///< a flat surface is in the place of the person; no points
  bool masked = false;                      ///< pixels without depth are outside the person
  /// The outline, in cells of kOutlineCell pixels around the person. For each cell the nearest cell of the person, as
  /// row * columns + column.
  int left = 0, top = 0, columns = 0, rows = 0;
  std::vector<std::int32_t> nearest;  ///< (rows*columns)

  bool empty() const { return points.cols() == 0; }
};

inline constexpr int kOutlineCell = 2;  ///< pixels, edge of a cell of the outline (numerical)

/// The person in one view's image (PersonPoints of this view alone), thinned to `voxel_size`. Empty for fewer than 60
/// points, and for a flat surface. Errors of FuseImages.
Expected<ViewSurface> SurfaceOf(const DepthView& view, DepthImage image, double voxel_size);

}  // namespace mocurate
