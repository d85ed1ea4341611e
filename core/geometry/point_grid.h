#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/geometry/rotation.h"

namespace mocurate {

/// Points sorted into cubes, for nearest neighbours within a reach.
class PointGrid {
 public:
  /// `cell` is the side of a cube, metres, positive: best near the distances asked for. Keeps a copy of the points,
  /// which must be finite.
  PointGrid(std::vector<Vector3d> points, double cell);

  /// Index of the nearest point, the lowest of equally near ones; -1 when none lies within `reach`.
  int Nearest(const Vector3d& query, double reach) const;
  /// Distance to it; `reach` when none is nearer.
  double Distance(const Vector3d& query, double reach) const;
  const std::vector<Vector3d>& points() const { return points_; }

 private:
  struct Cell {
    std::int64_t x, y, z;
    bool operator==(const Cell& other) const { return x == other.x && y == other.y && z == other.z; }
  };
  struct Hash {
    std::size_t operator()(const Cell& cell) const;
  };
  Cell CellOf(const Vector3d& point) const;

  std::vector<Vector3d> points_;
  double cell_;
  std::unordered_map<Cell, std::vector<int>, Hash> cells_;
};

}  // namespace mocurate
