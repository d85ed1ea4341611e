#pragma once

#include <algorithm>
#include <cmath>
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

inline std::size_t PointGrid::Hash::operator()(const Cell& cell) const {
  std::uint64_t hash = 0;
  for (const std::int64_t part : {cell.x, cell.y, cell.z}) {
    hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15ULL;
    hash ^= hash >> 29;
  }
  return static_cast<std::size_t>(hash);
}

inline PointGrid::PointGrid(std::vector<Vector3d> points, double cell) : points_(std::move(points)), cell_(cell) {
  for (std::size_t i = 0; i < points_.size(); ++i) cells_[CellOf(points_[i])].push_back(static_cast<int>(i));
}

inline PointGrid::Cell PointGrid::CellOf(const Vector3d& point) const {
  const auto part = [&](double value) {
    constexpr double kFar = 1e15;
    return static_cast<std::int64_t>(std::clamp(std::floor(value / cell_), -kFar, kFar));
  };
  return {part(point.x()), part(point.y()), part(point.z())};
}

inline int PointGrid::Nearest(const Vector3d& query, double reach) const {
  const Cell centre = CellOf(query);
  const auto rings = static_cast<std::int64_t>(std::ceil(reach / cell_));
  int best = -1;
  double best_squared = reach * reach;
  // Ring by ring; a point of ring r is at least r - 1 cells away.
  for (std::int64_t ring = 0; ring <= rings; ++ring) {
    const double least = static_cast<double>(ring - 1) * cell_;
    if (ring > 0 && least * least > best_squared) break;
    for (std::int64_t x = -ring; x <= ring; ++x) {
      for (std::int64_t y = -ring; y <= ring; ++y) {
        const bool face = std::abs(x) == ring || std::abs(y) == ring;
        for (std::int64_t z = -ring; z <= ring; z += face ? 1 : std::max<std::int64_t>(2 * ring, 1)) {
          const auto found = cells_.find(Cell{centre.x + x, centre.y + y, centre.z + z});
          if (found == cells_.end()) continue;
          for (const int i : found->second) {
            const double squared = (points_[static_cast<std::size_t>(i)] - query).squaredNorm();
            if (squared < best_squared || (squared == best_squared && (best < 0 || i < best))) {
              best = i;
              best_squared = squared;
            }
          }
        }
      }
    }
  }
  return best;
}

inline double PointGrid::Distance(const Vector3d& query, double reach) const {
  const int nearest = Nearest(query, reach);
  return nearest < 0 ? reach : (points_[static_cast<std::size_t>(nearest)] - query).norm();
}

}  // namespace mocurate
