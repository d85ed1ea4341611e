#include "fitting/clouds/depth_agreement.h"

#include <open3d/geometry/KDTreeFlann.h>
#include <open3d/geometry/PointCloud.h>

#include <algorithm>
#include <cmath>

#include "fitting/clouds/depth_fusion.h"

namespace mocurate {
namespace {

constexpr int kNeighbours = 24;  ///< looked at for one of another view

}  // namespace

Expected<std::vector<double>> ViewAgreement(const std::vector<DepthView>& views, int frame, double farthest,
                                            int every) {
  open3d::geometry::PointCloud all;
  std::vector<std::size_t> view_of;
  std::size_t with_points = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Expected<Eigen::Matrix3Xd> points = BackProject(views[v], frame);
    if (!points) return Forward(points);
    if (points->cols() > 0) ++with_points;
    for (Eigen::Index i = 0; i < points->cols(); i += every) {
      all.points_.emplace_back(points->col(i));
      view_of.push_back(v);
    }
  }
  if (with_points < 2) {
    return Fail(ErrorCode::kInconsistent, "fewer than two views have points", "depth views", "are the masks right?");
  }
  const open3d::geometry::KDTreeFlann tree(all);
  std::vector<double> square(views.size(), 0.0);
  std::vector<double> count(views.size(), 0.0);
  std::vector<int> neighbours;
  std::vector<double> squares;
  for (std::size_t i = 0; i < all.points_.size(); i += static_cast<std::size_t>(every)) {
    double nearest = farthest * farthest;
    tree.SearchKNN(all.points_[i], kNeighbours, neighbours, squares);
    for (std::size_t n = 0; n < neighbours.size(); ++n) {
      if (view_of[static_cast<std::size_t>(neighbours[n])] != view_of[i]) nearest = std::min(nearest, squares[n]);
    }
    square[view_of[i]] += nearest;
    count[view_of[i]] += 1.0;
  }
  std::vector<double> rms;
  for (std::size_t v = 0; v < views.size(); ++v) rms.push_back(count[v] > 0.0 ? std::sqrt(square[v] / count[v]) : 0.0);
  return rms;
}

}  // namespace mocurate
