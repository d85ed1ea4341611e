#pragma once

#include <optional>

#include "core/quality/tracked_points.h"

namespace mocurate {

/// The steps of a grid that all samples of a clip lie on, in its unit: pixels, or millimetres that were rounded.
/// Infinite along an axis in which nothing moves. Nothing where samples lie on no grid.
std::optional<Vector3d> GridOf(const TrackedPoints& points);

/// How many stillnesses as long as that of point `k` from frame `begin` to before `end` a clip on the grid shows by
/// chance: a sample that moves by m grid steps a frame on average, measured around the stillness, falls on its place
/// again once in 1 + 2 m times along each axis.
double ExpectedByChance(const TrackedPoints& points, const Vector3d& grid, int k, int begin, int end);

}  // namespace mocurate
