#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// Points of a cloud, or vertices of a mesh, in file units.
struct PointCloud {
  std::vector<Vector3d> points;
  std::vector<Vector3d> normals;  ///< (points) unit, of the file; none where a point has none
  std::size_t triangles = 0;
};

/// A PLY or a PCD file, by its first bytes. Errors of ParsePly, PlyPoints, PlyTriangles, ParsePcd and PcdPoints;
/// kUnsupported for another file.
Expected<PointCloud> ParsePointCloud(std::string_view bytes, const std::string& name);

/// Distances of the points from their middle, the median of each axis.
std::vector<double> DistancesFromMiddle(const std::vector<Vector3d>& points);

}  // namespace mocurate
