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

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Agreement of the points of one view with another view, summed over points. The loss of a point is Geman and
/// McClure's, r^2 / (r^2 + scale^2), of its distance to the plane that the other view observes there. A point that lies
/// in front of the other view's background counts by its distance from the person's outline. A hidden point has no
/// loss.
struct Agreement {
  double loss = 0.0;
  double points = 0.0;     ///< of the person, including hidden ones
  double looked_at = 0.0;  ///< points inside the other image
  double matched = 0.0;    ///< points on a surface of both views
  double square = 0.0;     ///< m^2, of the matched points' distances to the plane
  /// Half of the loss' second and first derivatives with respect to rotation (about the centre, world axes) and
  /// translation of the points' view.
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

/// A view's surface at a moment, with a camera pose.
struct PlacedSurface {
  const ViewSurface& surface;
  const DepthView& view;
  const Camera& camera;  ///< with the pose to test
};

/// Compares points of `of` with the image of `in`; empty when either is empty. `scale`, metres: of the loss; points
/// farther than 2.5 scales from the surface do not match.
Agreement Compare(const PlacedSurface& of, const PlacedSurface& in, const Vector3d& centre, double scale);

/// Share [0, 1] of pixels with equal depth in two views of a sensor, among those with a depth in one of them. The
/// lowest over the first, middle and last frame; 0 for images of different size, negative when both are empty. Errors
/// of ReadDepthImage.
Expected<double> DepthSimilarity(const DepthView& a, const DepthView& b);

}  // namespace mocurate
