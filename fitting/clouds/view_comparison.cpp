#include "fitting/clouds/view_comparison.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "fitting/clouds/depth_fusion.h"
#include "fitting/clouds/depth_image.h"

namespace mocurate {
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
