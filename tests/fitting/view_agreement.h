#pragma once

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "fitting/clouds/depth_fusion.h"
#include "tests/fitting/back_project.h"

namespace mocurate {

/// RMS distance (m) at frame 0 of every `every`-th point of each view to the nearest point of any other view. Each
/// distance counts at most `farthest`.
inline Expected<std::vector<double>> ViewAgreement(const std::vector<DepthView>& views, double farthest, int every) {
  constexpr double kCell = 0.004;
  using Cell = std::array<int, 3>;
  struct ViewPoint {
    Vector3d at;
    std::size_t view;
  };
  const auto cell_of = [&](const Vector3d& at) {
    return Cell{static_cast<int>(std::floor(at.x() / kCell)), static_cast<int>(std::floor(at.y() / kCell)),
                static_cast<int>(std::floor(at.z() / kCell))};
  };
  std::vector<ViewPoint> all;
  std::map<Cell, std::vector<std::size_t>> cells;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Expected<Eigen::Matrix3Xd> points = BackProject(views[v], 0);
    if (!points) return Forward(points);
    for (Eigen::Index i = 0; i < points->cols(); i += every) {
      cells[cell_of(points->col(i))].push_back(all.size());
      all.push_back({points->col(i), v});
    }
  }
  std::vector<double> square(views.size(), 0.0), count(views.size(), 0.0);
  for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(every)) {
    double nearest = farthest * farthest;
    const Cell middle = cell_of(all[i].at);
    // Shell by shell, until a farther shell cannot contain a nearer point.
    for (int shell = 0; std::max(shell - 1, 0) * kCell < std::sqrt(nearest); ++shell) {
      for (int x = -shell; x <= shell; ++x) {
        for (int y = -shell; y <= shell; ++y) {
          for (int z = -shell; z <= shell; ++z) {
            if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != shell) continue;
            const auto found = cells.find({middle[0] + x, middle[1] + y, middle[2] + z});
            if (found == cells.end()) continue;
            for (const std::size_t other : found->second) {
              if (all[other].view != all[i].view)
                nearest = std::min(nearest, (all[other].at - all[i].at).squaredNorm());
            }
          }
        }
      }
    }
    square[all[i].view] += nearest;
    count[all[i].view] += 1.0;
  }
  std::vector<double> rms;
  for (std::size_t v = 0; v < views.size(); ++v) rms.push_back(count[v] > 0.0 ? std::sqrt(square[v] / count[v]) : 0.0);
  return rms;
}

}  // namespace mocurate
