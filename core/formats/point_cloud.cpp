#include "core/formats/point_cloud.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/median.h"

namespace mocurate {
namespace {

/// The vectors of three columns, of rows that are not `missing`; empty where a column is absent or a vector is zero.
template <class Column>
std::vector<Vector3d> Directions(const std::array<const Column*, 3>& columns,
                                 const std::vector<std::uint8_t>& missing) {
  std::vector<Vector3d> directions;
  if (std::find(columns.begin(), columns.end(), nullptr) != columns.end()) return directions;
  for (std::size_t i = 0; i < missing.size(); ++i) {
    if (missing[i] != 0) continue;
    const Vector3d direction(columns[0]->values[i], columns[1]->values[i], columns[2]->values[i]);
    if (!(direction.norm() > 0.0)) return {};
    directions.push_back(direction.normalized());
  }
  return directions;
}

Expected<PointCloud> FromPly(std::string_view bytes, const std::string& name) {
  const auto ply = ParsePly(bytes, name);
  if (!ply) return Forward(ply);
  auto points = PlyPoints(*ply, name);
  if (!points) return Forward(points);
  const auto triangles = PlyTriangles(*ply, name);
  if (!triangles) return Forward(triangles);
  std::array<const PlyProperty*, 3> columns;
  for (std::size_t a = 0; a < 3; ++a) {
    columns[a] = ply->Find("vertex")->Find(std::string("n") + "xyz"[a]);
    if (columns[a] != nullptr && columns[a]->list_count) columns[a] = nullptr;
  }
  PointCloud cloud{std::move(*points), {}, triangles->size()};
  cloud.normals = Directions(columns, std::vector<std::uint8_t>(cloud.points.size(), 0));
  return cloud;
}

Expected<PointCloud> FromPcd(std::string_view bytes, const std::string& name) {
  const auto pcd = ParsePcd(bytes, name);
  if (!pcd) return Forward(pcd);
  auto points = PcdPoints(*pcd, name);
  if (!points) return Forward(points);
  std::array<const PcdField*, 3> columns;
  for (std::size_t a = 0; a < 3; ++a) {
    columns[a] = pcd->Find(std::string("normal_") + "xyz"[a]);
    if (columns[a] != nullptr && columns[a]->count != 1) columns[a] = nullptr;
  }
  return PointCloud{std::move(*points), Directions(columns, pcd->missing), 0};
}

/// Without the points that are 0 0 0, where there are several.
Expected<PointCloud> DropWithoutDepth(Expected<PointCloud> cloud) {
  if (!cloud) return cloud;
  std::vector<Vector3d>& points = cloud->points;
  const auto none = [](const Vector3d& point) { return point.isZero(0.0); };
  const auto count = static_cast<std::size_t>(std::count_if(points.begin(), points.end(), none));
  if (count < 2) return cloud;
  const bool normals = !cloud->normals.empty();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (none(points[i])) continue;
    if (normals) cloud->normals[kept] = cloud->normals[i];
    points[kept++] = points[i];
  }
  points.resize(kept);
  if (normals) cloud->normals.resize(kept);
  cloud->without_depth = count;
  return cloud;
}

}  // namespace

Expected<PointCloud> ParsePointCloud(std::string_view bytes, const std::string& name) {
  const std::string_view begin = bytes.substr(std::min(bytes.size(), bytes.find_first_not_of(" \t\r\n")));
  if (begin.substr(0, 3) == "ply") return DropWithoutDepth(FromPly(bytes, name));
  if (begin.substr(0, 1) == "#" || begin.substr(0, 7) == "VERSION") return DropWithoutDepth(FromPcd(bytes, name));
  return Fail(ErrorCode::kUnsupported, "the file is not a PLY or PCD cloud", name, "export it as PLY or PCD");
}

std::vector<double> DistancesFromMiddle(const std::vector<Vector3d>& points) {
  Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vector3d& point : points) values.push_back(point[axis]);
    middle[axis] = Median(std::move(values));
  }
  std::vector<double> distances;
  for (const Vector3d& point : points) distances.push_back((point - middle).norm());
  return distances;
}

}  // namespace mocurate
