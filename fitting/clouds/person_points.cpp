#include "fitting/clouds/person_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace mocurate {
namespace {

constexpr double kLayer = 0.02;     ///< m, heights that are counted together
constexpr double kLevel = 0.85;     ///< cosine to the vertical of a level surface
constexpr double kFloorArea = 0.4;  ///< m^2 within two layers: more than a person lying down has at one height
constexpr double kFloorMargin = 0.02;
constexpr double kCell = 0.06;     ///< m; points in touching cells are connected
constexpr double kNear = 0.15;     ///< m from the person to another part of the person
constexpr int kFewestOfPart = 10;  ///< points; smaller parts are stray

/// Height of the floor, or empty.
std::optional<double> FloorOf(const FusedCloud& cloud, double voxel_size) {
  std::map<long, int> layers;
  for (int i = 0; i < cloud.size(); ++i) {
    if (cloud.normals(1, i) > kLevel) ++layers[std::lround(cloud.points(1, i) / kLayer)];
  }
  const double wanted = kFloorArea / (voxel_size * voxel_size);
  for (const auto& [layer, count] : layers) {
    const auto above = layers.find(layer + 1);
    const int both = count + (above == layers.end() ? 0 : above->second);
    if (both >= wanted)
      return (static_cast<double>(layer) + (both > count && above->second > count ? 1.0 : 0.0)) * kLayer;
  }
  return std::nullopt;
}

using Cell = std::array<long, 3>;

struct Part {
  std::vector<int> points;
  Vector3d low = Vector3d::Constant(1e9);
  Vector3d high = Vector3d::Constant(-1e9);
};

/// Connected parts of some points of a cloud.
std::vector<Part> PartsOf(const FusedCloud& cloud, const std::vector<int>& points) {
  std::map<Cell, std::vector<int>> cells;
  for (const int i : points) {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis) cell[axis] = static_cast<long>(std::floor(cloud.points(axis, i) / kCell));
    cells[cell].push_back(i);
  }
  std::vector<Part> parts;
  while (!cells.empty()) {
    Part part;
    std::vector<Cell> open{cells.begin()->first};
    while (!open.empty()) {
      const Cell cell = open.back();
      open.pop_back();
      const auto found = cells.find(cell);
      if (found == cells.end()) continue;
      for (const int i : found->second) {
        part.points.push_back(i);
        part.low = part.low.cwiseMin(cloud.points.col(i));
        part.high = part.high.cwiseMax(cloud.points.col(i));
      }
      cells.erase(found);
      for (int n = 0; n < 27; ++n) open.push_back({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

/// Whether a point of one part is nearer than kNear to a point of the other.
bool AreNear(const FusedCloud& cloud, const Part& a, const Part& b) {
  const Vector3d apart = (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0);
  if (apart.norm() >= kNear) return false;
  for (const int i : a.points) {
    for (const int k : b.points) {
      if ((cloud.points.col(i) - cloud.points.col(k)).squaredNorm() < kNear * kNear) return true;
    }
  }
  return false;
}

}  // namespace

FusedCloud PersonPoints(const FusedCloud& cloud, double voxel_size) {
  const std::optional<double> floor = FloorOf(cloud, voxel_size);
  std::vector<int> above;
  for (int i = 0; i < cloud.size(); ++i) {
    if (!floor || cloud.points(1, i) > *floor + kFloorMargin) above.push_back(i);
  }
  const std::vector<Part> parts = PartsOf(cloud, above);
  std::vector<int> kept;
  if (!parts.empty()) {
    const Part& person = *std::max_element(
        parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.points.size() < b.points.size(); });
    for (const Part& part : parts) {
      const bool is_of_person = part.points.size() >= kFewestOfPart && AreNear(cloud, part, person);
      if (&part == &person || is_of_person) kept.insert(kept.end(), part.points.begin(), part.points.end());
    }
  }
  std::sort(kept.begin(), kept.end());
  FusedCloud cleaned{Eigen::Matrix3Xd(3, kept.size()), Eigen::Matrix3Xd(3, kept.size()),
                     cloud.size() - static_cast<int>(kept.size())};
  for (std::size_t i = 0; i < kept.size(); ++i) {
    cleaned.points.col(static_cast<Eigen::Index>(i)) = cloud.points.col(kept[i]);
    cleaned.normals.col(static_cast<Eigen::Index>(i)) = cloud.normals.col(kept[i]);
  }
  return cleaned;
}

}  // namespace mocurate
