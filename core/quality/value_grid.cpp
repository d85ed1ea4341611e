#include "core/quality/value_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mocurate {
namespace {

/// Calls with every step of a point between frames on end, as lengths along the axes.
template <typename Call>
void ForSteps(const TrackedPoints& points, int k, int begin, int end, const Call& call) {
  for (int f = std::max(1, begin); f < std::min(end, points.frames()); ++f) {
    if (!points.sees(f, k) || !points.sees(f - 1, k)) continue;
    call(Vector3d((points.at(f, k) - points.at(f - 1, k)).cwiseAbs()));
  }
}

}  // namespace

std::optional<Vector3d> GridOf(const TrackedPoints& points) {
  constexpr double kOff = 0.01;  // of a grid step: of numbers in single precision
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Vector3d grid(kNone, kNone, kNone);
  for (int k = 0; k < points.count(); ++k) {
    ForSteps(points, k, 0, points.frames(), [&](const Vector3d& step) {
      for (int axis = 0; axis < 3; ++axis) {
        if (step[axis] > 0.0) grid[axis] = std::min(grid[axis], step[axis]);
      }
    });
  }
  bool fits = true;
  for (int k = 0; k < points.count() && fits; ++k) {
    ForSteps(points, k, 0, points.frames(), [&](const Vector3d& step) {
      for (int axis = 0; axis < 3; ++axis) {
        const double steps = step[axis] / grid[axis];
        fits = fits && std::abs(steps - std::round(steps)) < kOff;
      }
    });
  }
  return fits ? std::optional(grid) : std::nullopt;
}

double ExpectedByChance(const TrackedPoints& points, const Vector3d& grid, int k, int begin, int end) {
  constexpr int kAround = 8;  // frames before and after
  Vector3d moved = Vector3d::Zero();
  int steps = 0;
  const auto add = [&](const Vector3d& step) {
    moved += step.cwiseQuotient(grid);
    ++steps;
  };
  ForSteps(points, k, begin + 1 - kAround, begin + 1, add);
  ForSteps(points, k, end, end + kAround, add);
  if (steps == 0) return 0.0;
  const Vector3d often = (Vector3d::Ones() + 2.0 * moved / steps).cwiseInverse();
  return std::pow(often.prod(), end - begin - 1) * points.frames() * points.count();
}

}  // namespace mocurate
