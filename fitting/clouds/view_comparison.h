#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/motion/clip.h"
#include "fitting/clouds/view_surface.h"

namespace mocurate {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// How well the points of one view agree with what another measured, summed over points. The loss of a point is that of
/// Geman and McClure, r^2 / (r^2 + scale^2), of its distance to the plane that the other view sees there; a point where
/// the other one sees through counts by its distance from the person's outline; one that is hidden counts nothing.
struct Agreement {
  double loss = 0.0;
  double points = 0.0;     ///< of the person, hidden ones too
  double looked_at = 0.0;  ///< in the other image
  double matched = 0.0;    ///< on a surface that both see
  double square = 0.0;     ///< m^2, of the matched points' distances to the plane
  /// Half of the loss' second and first derivatives, by rotation (about the centre, world axes) and translation of the
  /// view whose points they are.
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

/// A view of a moment where its camera stands.
struct PlacedSurface {
  const ViewSurface& surface;
  const DepthView& view;
  const Camera& camera;  ///< with the pose that is asked for
};

/// Points of `of` in the image of `in`; nothing where either is empty. `scale`, metres: of the loss, points farther
/// than 2.5 of it from the surface are no match.
Agreement Compare(const PlacedSurface& of, const PlacedSurface& in, const Vector3d& centre, double scale);

}  // namespace mocurate
