#include "fitting/clouds/view_surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "fitting/clouds/depth_fusion.h"
#include "fitting/clouds/person_points.h"

namespace mocurate {
namespace {

constexpr int kFewestSurfacePoints = 60;  ///< points of a person in one view, at least
constexpr int kMostPoints = 400;          ///< points of a surface, at most (numerical)
constexpr double kNearInDepth = 0.05;     ///< m of depth between a pixel and the person's points near it
constexpr double kMargin = 0.25;          ///< m around the person that the outline covers
constexpr double kMaskedShare = 0.5;      ///< of the pixels without depth, from which the image is masked: a room has
                                          ///< fewer
/// Ratio of the extent across a plane to the smaller extent in it; at least 0.2 for a person.
constexpr double kFlatPatch = 0.06;

/// Depth range of the person's points in coarse cells, each extended to its neighbours.
struct DepthRange {
  int cell = 4;  ///< pixels
  int columns = 0, rows = 0;
  std::vector<float> low, high;

  bool Holds(int x, int y, double depth) const {
    const auto at =
        static_cast<std::size_t>(y / cell) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x / cell);
    return depth > low[at] - kNearInDepth && depth < high[at] + kNearInDepth;
  }
};

DepthRange RangeOf(const Eigen::Matrix3Xd& points, const Camera& camera, double voxel_size) {
  DepthRange range;
  const double middle = points.row(2).mean();
  range.cell = std::clamp(static_cast<int>(std::ceil(1.3 * voxel_size * std::abs(camera.fx) / middle)), 2, 64);
  range.columns = camera.width / range.cell + 1;
  range.rows = camera.height / range.cell + 1;
  range.low.assign(static_cast<std::size_t>(range.columns) * range.rows, std::numeric_limits<float>::max());
  range.high.assign(range.low.size(), -std::numeric_limits<float>::max());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const auto pixel = camera.Project(points.col(i));
    if (!pixel) continue;
    const int x = static_cast<int>(std::lround(pixel->x())) / range.cell;
    const int y = static_cast<int>(std::lround(pixel->y())) / range.cell;
    for (int row = std::max(0, y - 1); row <= std::min(range.rows - 1, y + 1); ++row) {
      for (int column = std::max(0, x - 1); column <= std::min(range.columns - 1, x + 1); ++column) {
        const auto at =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(range.columns) + static_cast<std::size_t>(column);
        range.low[at] = std::min(range.low[at], static_cast<float>(points(2, i)));
        range.high[at] = std::max(range.high[at], static_cast<float>(points(2, i)));
      }
    }
  }
  return range;
}

/// Distance transform: propagates the nearest set cell (two sweeps over eight neighbours).
void PropagateNearest(int columns, int rows, std::vector<std::int32_t>& nearest) {
  const auto square = [&](std::int32_t of, int x, int y) {
    const int dx = of % columns - x, dy = of / columns - y;
    return dx * dx + dy * dy;
  };
  const auto sweep = [&](int step, const int(&beside)[4][2]) {
    for (int y = step > 0 ? 0 : rows - 1; y >= 0 && y < rows; y += step) {
      for (int x = step > 0 ? 0 : columns - 1; x >= 0 && x < columns; x += step) {
        std::int32_t& here = nearest[static_cast<std::size_t>(y) * columns + x];
        for (const auto& by : beside) {
          const int nx = x + by[0], ny = y + by[1];
          if (nx < 0 || ny < 0 || nx >= columns || ny >= rows) continue;
          const std::int32_t other = nearest[static_cast<std::size_t>(ny) * columns + nx];
          if (other >= 0 && (here < 0 || square(other, x, y) < square(here, x, y))) here = other;
        }
      }
    }
  };
  sweep(1, {{-1, 0}, {-1, -1}, {0, -1}, {1, -1}});
  sweep(-1, {{1, 0}, {1, 1}, {0, 1}, {-1, 1}});
}

void SetOutline(const DepthView& view, const DepthRange& range, ViewSurface& surface) {
  const Camera& camera = view.camera;
  Vector2d low(camera.width, camera.height), high(0.0, 0.0);
  for (Eigen::Index i = 0; i < surface.points.cols(); ++i) {
    const auto pixel = camera.Project(surface.points.col(i));
    if (!pixel) continue;
    low = low.cwiseMin(*pixel);
    high = high.cwiseMax(*pixel);
  }
  const double margin = kMargin * std::abs(camera.fx) / surface.points.row(2).mean();
  const int left = std::max(0, static_cast<int>(low.x() - margin));
  const int top = std::max(0, static_cast<int>(low.y() - margin));
  const int right = std::min(camera.width - 1, static_cast<int>(high.x() + margin));
  const int bottom = std::min(camera.height - 1, static_cast<int>(high.y() + margin));
  surface.left = left, surface.top = top;
  surface.columns = std::max(1, (right - left) / kOutlineCell + 1);
  surface.rows = std::max(1, (bottom - top) / kOutlineCell + 1);
  surface.nearest.assign(static_cast<std::size_t>(surface.columns) * surface.rows, -1);
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const std::uint16_t value = surface.image->values[static_cast<std::size_t>(y) * surface.image->width + x];
      if (value == 0 || !range.Holds(x, y, value * view.metres_per_unit)) continue;
      const int cell = (y - top) / kOutlineCell * surface.columns + (x - left) / kOutlineCell;
      surface.nearest[static_cast<std::size_t>(cell)] = cell;
    }
  }
  PropagateNearest(surface.columns, surface.rows, surface.nearest);
}

/// Whether points lie nearly in a plane, relative to their extent in it. People never do, in any unit.
bool IsFlat(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd off = points.colwise() - points.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(Matrix3d(off * off.transpose()), Eigen::EigenvaluesOnly);
  return axes.eigenvalues()[0] < kFlatPatch * kFlatPatch * axes.eigenvalues()[1];
}

}  // namespace

Expected<ViewSurface> SurfaceOf(const DepthView& view, DepthImage image, double voxel_size) {
  ViewSurface surface;
  std::vector<DepthImage> images;
  images.push_back(std::move(image));
  const Expected<FusedCloud> cloud = FuseImages({view}, images, voxel_size);
  if (!cloud) return Forward(cloud);
  surface.image = std::make_shared<const DepthImage>(std::move(images[0]));
  const FusedCloud person = PersonPoints(*cloud, voxel_size);
  const bool too_few = person.size() < kFewestSurfacePoints;
  if (too_few && cloud->size() < kFewestSurfacePoints) return surface;
  if (too_few || IsFlat(person.points)) {
    surface.flat = true;
    return surface;
  }
  const Camera& camera = view.camera;
  const Matrix3d rotation = camera.camera_from_world.rotation.toRotationMatrix();
  surface.points = (rotation * person.points).colwise() + camera.camera_from_world.translation;
  surface.normals = rotation * person.normals;
  if (surface.points.row(2).minCoeff() < kNearestDepth) return ViewSurface{};
  const auto without = std::count(surface.image->values.begin(), surface.image->values.end(), std::uint16_t{0});
  surface.masked = static_cast<double>(without) > kMaskedShare * static_cast<double>(surface.image->values.size());
  SetOutline(view, RangeOf(surface.points, camera, voxel_size), surface);
  const Eigen::Index step = surface.points.cols() / kMostPoints + 1;
  if (step > 1) {
    const Eigen::Index kept = (surface.points.cols() + step - 1) / step;
    for (Eigen::Index i = 0; i < kept; ++i) {
      surface.points.col(i) = surface.points.col(i * step).eval();
      surface.normals.col(i) = surface.normals.col(i * step).eval();
    }
    surface.points.conservativeResize(3, kept);
    surface.normals.conservativeResize(3, kept);
  }
  return surface;
}

namespace {

constexpr double kReachOfScales = 2.5;  ///< factor on the scale of the loss: farther surfaces are not compared
constexpr double kSameSide = 0.5;       ///< least cosine between normals of one surface
/// Factor on this reach: largest depth difference for which the plane is computed (numerical).
constexpr double kThickness = 2.0;
constexpr double kOutlineSlack_px = 1.5;  ///< distance from the outline that is not counted

class Comparer {
 public:
  Comparer(const PlacedSurface& of, const PlacedSurface& in, const Vector3d& centre, double scale)
      : of_(of),
        in_(in),
        centre_(centre),
        square_(scale * scale),
        reach_(kReachOfScales * scale),
        world_from_in_(Inverse(in.camera.camera_from_world)),
        in_from_of_(in.camera.camera_from_world * Inverse(of.camera.camera_from_world)),
        turn_(in_from_of_.rotation.toRotationMatrix()),
        turn_to_world_(world_from_in_.rotation.toRotationMatrix()) {}

  Agreement Run() {
    const auto count = of_.surface.points.cols();
    sum_.points = static_cast<double>(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      Add(turn_ * of_.surface.points.col(i) + in_from_of_.translation, turn_ * of_.surface.normals.col(i));
    }
    return sum_;
  }

 private:
  /// In the frame of the camera of the other image.
  void Add(const Vector3d& point, const Vector3d& normal) {
    if (point.z() < kNearestDepth) return;
    const auto pixel = in_.camera.Project(point);
    if (!pixel) return;
    const DepthImage& image = *in_.surface.image;
    if (!(pixel->x() > -0.5 && pixel->y() > -0.5 && pixel->x() < image.width - 0.5 && pixel->y() < image.height - 0.5))
      return;
    sum_.looked_at += 1.0;
    const auto x = static_cast<int>(std::lround(pixel->x())), y = static_cast<int>(std::lround(pixel->y()));
    const double depth = image.values[static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x)] *
                         in_.view.metres_per_unit;
    if (depth == 0.0 && !in_.surface.masked) return;
    if (depth == 0.0 || depth > point.z() + kThickness * reach_) return SeenThrough(point, *pixel);
    if (depth < point.z() - kThickness * reach_) return;
    const std::optional<PixelPlane> plane = PlaneAtPixel(in_.view, image, x, y);
    if (!plane) return;
    const double distance = plane->normal.dot(point - plane->point);
    if (plane->normal.dot(normal) > kSameSide) {
      if (std::abs(distance) < reach_) {
        sum_.matched += 1.0;
        sum_.square += distance * distance;
        return Pull(point, plane->normal, distance);
      }
      if (distance > 0.0) sum_.loss += 1.0;
      return;
    }
    // A back or a side: it is hidden, or lies in front of the visible surface.
    if (point.z() < depth) sum_.loss += Loss(depth - point.z());
  }

  void SeenThrough(const Vector3d& point, const Vector2d& pixel) {
    const ViewSurface& seen = in_.surface;
    const int column = (static_cast<int>(std::lround(pixel.x())) - seen.left) / kOutlineCell;
    const int row = (static_cast<int>(std::lround(pixel.y())) - seen.top) / kOutlineCell;
    if (pixel.x() < seen.left || pixel.y() < seen.top || column >= seen.columns || row >= seen.rows) {
      sum_.loss += 1.0;
      return;
    }
    const std::int32_t nearest =
        seen.nearest[static_cast<std::size_t>(row) * seen.columns + static_cast<std::size_t>(column)];
    if (nearest < 0) {
      sum_.loss += 1.0;
      return;
    }
    // From the centre of the nearest cell.
    const int inside_column = nearest % seen.columns, inside_row = nearest / seen.columns;
    const Vector2d inside(seen.left + (inside_column + 0.5) * kOutlineCell - 0.5,
                          seen.top + (inside_row + 0.5) * kOutlineCell - 0.5);
    const Vector2d away = pixel - inside;
    const double outside_px = away.norm() - kOutlineSlack_px;
    if (outside_px <= 0.0) return;
    const Vector2d focal(in_.camera.fx, in_.camera.fy);
    const double distance = outside_px * point.z() / std::abs(focal.x());
    if (distance >= reach_) {
      sum_.loss += Loss(distance);
      return;
    }
    const Vector3d aside(away.x() / focal.x(), away.y() / focal.y(), 0.0);
    Pull(point, aside.normalized(), distance);
  }

  double Loss(double distance) const { return distance * distance / (distance * distance + square_); }

  void Pull(const Vector3d& point, const Vector3d& normal, double distance) {
    sum_.loss += Loss(distance);
    const double root = square_ / (distance * distance + square_);
    const double weight = root * root;
    const Vector3d way = turn_to_world_ * normal;
    Vector6d row;
    row << (world_from_in_ * point - centre_).cross(way), way;
    sum_.information.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
    sum_.gradient += weight * distance * row;
  }

  PlacedSurface of_, in_;
  Vector3d centre_;
  double square_, reach_;
  RigidTransform world_from_in_, in_from_of_;
  Matrix3d turn_, turn_to_world_;
  Agreement sum_;
};

}  // namespace

Agreement Compare(const PlacedSurface& of, const PlacedSurface& in, const Vector3d& centre, double scale) {
  if (of.surface.empty() || in.surface.empty()) return {};
  Agreement agreement = Comparer(of, in, centre, scale).Run();
  agreement.information = agreement.information.selfadjointView<Eigen::Lower>();
  return agreement;
}

namespace {

constexpr double kAsDeep_m = 0.03;  ///< larger than noise and filters of a sensor at a person's distance

/// Negative when both images are empty.
double ImageSimilarity(const DepthImage& a, double a_m, const DepthImage& b, double b_m) {
  if (a.width != b.width || a.height != b.height) return 0.0;
  double seen = 0.0;
  double alike = 0.0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    if (a.values[i] == 0 && b.values[i] == 0) continue;
    seen += 1.0;
    const bool both = a.values[i] != 0 && b.values[i] != 0;
    alike += both && std::abs(a_m * a.values[i] - b_m * b.values[i]) < kAsDeep_m ? 1.0 : 0.0;
  }
  return seen > 0.0 ? alike / seen : -1.0;
}

}  // namespace

Expected<double> DepthSimilarity(const DepthView& a, const DepthView& b) {
  const std::size_t frames = std::min(a.files.size(), b.files.size());
  double least = -1.0;
  for (const std::size_t f : {std::size_t{0}, frames / 2, frames - 1}) {
    if (frames == 0 || a.files[f].empty() || b.files[f].empty()) continue;
    const Expected<DepthImage> one = ReadDepthImage(a.files[f]);
    if (!one) return Forward(one);
    const Expected<DepthImage> other = ReadDepthImage(b.files[f]);
    if (!other) return Forward(other);
    const double share = ImageSimilarity(*one, a.metres_per_unit, *other, b.metres_per_unit);
    if (share >= 0.0) least = least < 0.0 ? share : std::min(least, share);
  }
  return least;
}

}  // namespace mocurate
