#include "fitting/clouds/depth_normals.h"

#include <open3d/geometry/KDTreeFlann.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>

namespace mocurate {
namespace {

constexpr std::size_t kFewestNeighbours = 6;  ///< points for a plane; with fewer in the radius, the nearest ones
constexpr double kStrayShare = 0.3;           ///< of the usual number of neighbours

/// Normal of the plane through some points, up rather than down.
Vector3d PlaneNormal(const Eigen::Matrix3Xd& cloud, const std::vector<int>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const int i : points) mean += cloud.col(i);
  mean /= static_cast<double>(points.size());
  Matrix3d scatter = Matrix3d::Zero();
  for (const int i : points) scatter += (cloud.col(i) - mean) * (cloud.col(i) - mean).transpose();
  const Vector3d normal = Eigen::SelfAdjointEigenSolver<Matrix3d>(scatter).eigenvectors().col(0);
  return normal.y() < 0.0 ? Vector3d(-normal) : normal;
}

/// A step that propagates a normal's sign to a neighbour; the most similar normals first.
struct Step {
  double alike;
  int from, to;
  bool operator<(const Step& other) const { return alike < other.alike; }
};

/// Gives the normals of all points connected to `seed` one sign. Returns the points.
std::vector<int> Connect(int seed, double reach, const open3d::geometry::KDTreeFlann& tree, FusedCloud& cloud,
                         std::vector<bool>& done) {
  std::vector<int> part, neighbours;
  std::vector<double> squared;
  std::priority_queue<Step> open;
  open.push({1.0, seed, seed});
  while (!open.empty()) {
    const Step step = open.top();
    open.pop();
    const auto at = static_cast<std::size_t>(step.to);
    if (done[at]) continue;
    done[at] = true;
    part.push_back(step.to);
    if (cloud.normals.col(step.from).dot(cloud.normals.col(step.to)) < 0.0) cloud.normals.col(step.to) *= -1.0;
    tree.SearchRadius(Vector3d(cloud.points.col(step.to)), reach, neighbours, squared);
    for (const int next : neighbours) {
      if (done[static_cast<std::size_t>(next)]) continue;
      open.push({std::abs(cloud.normals.col(step.to).dot(cloud.normals.col(next))), step.to, next});
    }
  }
  return part;
}

}  // namespace

void EstimateNormals(const Eigen::Matrix3Xd& cloud, double radius, FusedCloud& thin) {
  if (thin.size() == 0) return;        // all points were outliers
  const Eigen::MatrixXd kept = cloud;  // referenced by the tree
  const open3d::geometry::KDTreeFlann tree(kept);
  std::vector<std::size_t> counts;
  std::vector<int> neighbours;
  std::vector<double> squared;
  for (int i = 0; i < thin.size(); ++i) {
    const Vector3d point = thin.points.col(i);
    tree.SearchRadius(point, radius, neighbours, squared);
    counts.push_back(neighbours.size());
    if (counts.back() < kFewestNeighbours) tree.SearchKNN(point, kFewestNeighbours, neighbours, squared);
    thin.normals.col(i) = PlaneNormal(cloud, neighbours);
  }
  std::vector<std::size_t> sorted = counts;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double fewest = kStrayShare * static_cast<double>(sorted[sorted.size() / 2]);
  std::vector<int> kept_points;
  for (int i = 0; i < thin.size(); ++i) {
    if (static_cast<double>(counts[static_cast<std::size_t>(i)]) >= fewest) kept_points.push_back(i);
  }
  thin = ChosenPoints(thin, kept_points);
}

void FaceOutwards(double reach, FusedCloud& cloud) {
  if (cloud.size() == 0) return;
  const Eigen::MatrixXd kept = cloud.points;
  const open3d::geometry::KDTreeFlann tree(kept);
  std::vector<bool> done(static_cast<std::size_t>(cloud.size()), false);
  for (int seed = 0; seed < cloud.size(); ++seed) {
    if (done[static_cast<std::size_t>(seed)]) continue;
    const std::vector<int> part = Connect(seed, reach, tree, cloud, done);
    Vector3d middle = Vector3d::Zero();
    for (const int i : part) middle += cloud.points.col(i) / static_cast<double>(part.size());
    double outwards = 0.0;
    for (const int i : part) outwards += cloud.normals.col(i).dot(cloud.points.col(i) - middle);
    for (const int i : part) cloud.normals.col(i) *= outwards < 0.0 ? -1.0 : 1.0;
  }
}

}  // namespace mocurate
