#include "fitting/clouds/person_points.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/formats/point_cloud.h"
#include "fitting/clouds/depth_normals.h"

namespace mocurate {
namespace {

constexpr double kLayer = 0.02;         ///< m; height of a bin (numerical)
constexpr double kLevelCosine = 0.85;   ///< cosine to the vertical from which a surface is level
constexpr double kFloorArea = 0.4;      ///< m^2 within two bins: more than a person lying down
constexpr double kFloorMargin = 0.02;   ///< m above the floor: points removed with it
constexpr double kUprightNormal = 0.5;  ///< cosine to the vertical, at most, of a wall point's normal
constexpr double kUprightPlane = 0.15;  ///< cosine to the vertical, at most, of a wall's normal
constexpr double kWallReach = 0.05;     ///< m from a wall's plane: distant depth is noisy
constexpr double kWallMargin = 0.12;    ///< m from a wall's plane: points removed with it
constexpr double kWallArea = 1.0;       ///< m^2: more than a person's in one upright plane
constexpr double kWallSide = 1.2;       ///< m, least visible extent of a wall in both directions
constexpr double kPersonReach = 2.4;    ///< m, from the lowest to the highest point, or across extended arms
constexpr int kMostWalls = 6;           ///< walls that are removed, at most (numerical)
constexpr double kCell = 0.06;          ///< m; points in touching cells are connected
constexpr double kNearPerson = 0.15;    ///< m from the person to another part of the person
constexpr int kFewestOfPart = 10;       ///< points; smaller parts are stray

/// Height of the floor; empty without one.
std::optional<double> FloorOfCloud(const FusedCloud& cloud, double voxel_size) {
  std::map<long, int> layers;
  for (int i = 0; i < cloud.size(); ++i) {
    if (cloud.normals(1, i) > kLevelCosine) ++layers[std::lround(cloud.points(1, i) / kLayer)];
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

/// Points x with normal . x = offset.
struct Plane {
  Vector3d normal = Vector3d::Zero();
  double offset = 0.0;

  double Away(const FusedCloud& cloud, int i) const { return std::abs(cloud.points.col(i).dot(normal) - offset); }
};

/// Least-squares plane of some points.
Plane PlaneThrough(const FusedCloud& cloud, const std::vector<int>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const int i : points) mean += cloud.points.col(i);
  mean /= static_cast<double>(points.size());
  Matrix3d scatter = Matrix3d::Zero();
  for (const int i : points) {
    const Vector3d away = cloud.points.col(i) - mean;
    scatter += away * away.transpose();
  }
  const Vector3d normal = Eigen::SelfAdjointEigenSolver<Matrix3d>(scatter).eigenvectors().col(0);
  return {normal, normal.dot(mean)};
}

std::vector<int> On(const Plane& plane, const FusedCloud& cloud, const std::vector<int>& points, double reach) {
  std::vector<int> on;
  std::copy_if(points.begin(), points.end(), std::back_inserter(on),
               [&](int i) { return plane.Away(cloud, i) <= reach; });
  return on;
}

/// The largest upright plane of some points, if larger than a person: RANSAC over three points with a fixed seed.
/// Normals of noisy walls lean towards the camera, so only positions decide.
std::optional<Plane> WallOf(const FusedCloud& cloud, const std::vector<int>& points, double voxel_size) {
  constexpr int kDraws = 150;             ///< draws of RANSAC (numerical)
  constexpr std::size_t kCounted = 3000;  ///< points that count inliers, at most (numerical)
  std::vector<int> upright;
  for (const int i : points) {
    if (std::abs(cloud.normals(1, i)) < kUprightNormal) upright.push_back(i);
  }
  const auto fewest = static_cast<std::size_t>(kWallArea / (voxel_size * voxel_size));
  if (upright.size() < fewest) return std::nullopt;
  std::vector<int> counted;
  for (std::size_t k = 0; k < upright.size(); k += upright.size() / kCounted + 1) counted.push_back(upright[k]);
  Random random(1, "walls");
  const auto any = [&] {
    return counted[static_cast<std::size_t>(random.Uniform() * static_cast<double>(counted.size()))];
  };
  std::size_t most = 0;
  Plane best;
  for (int draw = 0; draw < kDraws; ++draw) {
    const int a = any(), b = any(), c = any();
    const Vector3d across =
        Vector3d(cloud.points.col(b) - cloud.points.col(a)).cross(Vector3d(cloud.points.col(c) - cloud.points.col(a)));
    if (across.norm() < 0.05) continue;  // collinear or too close
    const Plane plane{across.normalized(), across.normalized().dot(cloud.points.col(a))};
    if (std::abs(plane.normal.y()) > kUprightPlane) continue;
    const auto on = static_cast<std::size_t>(
        std::count_if(counted.begin(), counted.end(), [&](int i) { return plane.Away(cloud, i) <= kWallReach; }));
    if (on <= most) continue;
    most = on;
    best = plane;
  }
  if (most == 0) return std::nullopt;
  for (int pass = 0; pass < 2; ++pass) best = PlaneThrough(cloud, On(best, cloud, upright, kWallReach));
  const std::vector<int> wall = On(best, cloud, upright, kWallReach);
  if (wall.size() < fewest || std::abs(best.normal.y()) > kUprightPlane) return std::nullopt;
  const Vector3d along = best.normal.cross(Vector3d::UnitY()).normalized();
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  for (const int i : wall) {
    const Eigen::Vector2d place(cloud.points.col(i).dot(along), cloud.points(1, i));
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
  if ((high - low).minCoeff() < kWallSide) return std::nullopt;
  return best;
}

/// Whether some points extend farther than a person.
bool AreWiderThanAPerson(const FusedCloud& cloud, const std::vector<int>& points) {
  Vector3d low = Vector3d::Constant(1e9), high = -low;
  for (const int i : points) {
    low = low.cwiseMin(cloud.points.col(i));
    high = high.cwiseMax(cloud.points.col(i));
  }
  return !points.empty() && (high - low).maxCoeff() > kPersonReach;
}

/// Removes walls, which would be the largest part.
std::vector<int> WithoutWalls(const FusedCloud& cloud, std::vector<int> points, double voxel_size) {
  for (int n = 0; n < kMostWalls && AreWiderThanAPerson(cloud, points); ++n) {
    const std::optional<Plane> wall = WallOf(cloud, points, voxel_size);
    if (!wall) break;
    points.erase(
        std::remove_if(points.begin(), points.end(), [&](int i) { return wall->Away(cloud, i) <= kWallMargin; }),
        points.end());
  }
  return points;
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

/// Whether a point of one part is nearer than kNearPerson to a point of the other.
bool AreNear(const FusedCloud& cloud, const Part& a, const Part& b) {
  const Vector3d apart = (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0);
  if (apart.norm() >= kNearPerson) return false;
  for (const int i : a.points) {
    for (const int k : b.points) {
      if ((cloud.points.col(i) - cloud.points.col(k)).squaredNorm() < kNearPerson * kNearPerson) return true;
    }
  }
  return false;
}

}  // namespace

FusedCloud PersonPoints(const FusedCloud& cloud, double voxel_size) {
  const std::optional<double> floor = FloorOfCloud(cloud, voxel_size);
  std::vector<int> above;
  for (int i = 0; i < cloud.size(); ++i) {
    if (!floor || cloud.points(1, i) > *floor + kFloorMargin) above.push_back(i);
  }
  const std::vector<Part> parts = PartsOf(cloud, WithoutWalls(cloud, std::move(above), voxel_size));
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
  FusedCloud cleaned = ChosenPoints(cloud, kept);
  cleaned.excluded = cloud.size() - cleaned.size();
  return cleaned;
}

Expected<FusedCloud> ReadPersonCloud(const CloudFiles& clouds, int frame, double voxel_size) {
  constexpr double kVoxelsBetween = 2.5;  ///< voxels between neighbours of a thinned cloud, at most
  const std::filesystem::path& file = clouds.files[frame];
  if (file.empty()) return FusedCloud();
  const Expected<std::string> bytes = ReadFile(file);
  if (!bytes) return Forward(bytes);
  if (Status same = CheckUnchanged(file, clouds.sha256[frame]); !same) return Forward(same);
  Expected<PointCloud> cloud = ParsePointCloud(*bytes, file.string());
  if (!cloud) return Forward(cloud);
  const double side = clouds.metres_per_unit < 0.0 ? -1.0 : 1.0;
  for (Vector3d& point : cloud->points) point = clouds.world_from_file * Vector3d(clouds.metres_per_unit * point);
  for (Vector3d& normal : cloud->normals) normal = side * (clouds.world_from_file.rotation * normal);
  const bool has_normals = !cloud->normals.empty();
  const Expected<FusedCloud> fused = FusePoints(std::move(cloud->points), std::move(cloud->normals), voxel_size);
  if (!fused) return Forward(fused);
  FusedCloud person = PersonPoints(*fused, voxel_size);
  if (!has_normals) FaceOutwards(kVoxelsBetween * voxel_size, person);
  return person;
}

}  // namespace mocurate
