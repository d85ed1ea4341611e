#include "ingest/sense/cloud_sense.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "ingest/options.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestCloudPoints = 20;
constexpr double kNear = 0.9;       // share of the points that the others are measured by
constexpr double kFarRadii = 20.0;  // of theirs
constexpr double kFarthestRadii = 1000.0;
constexpr double kReach_m = 2.5;  // of a person, from the middle

double AtShare(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Vector3d Middle(const std::vector<Vector3d>& points) {
  Vector3d middle;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), values.begin(), [&](const Vector3d& point) { return point[axis]; });
    middle[axis] = AtShare(values, 0.5);
  }
  return middle;
}

/// "m.obj:101: the vertex", "m.ply: vertex 100", "m.pcd: point 100".
std::string PlaceOfPoint(const ObservedCloud& cloud, std::size_t point, const std::string& file) {
  const std::string number =
      std::to_string(point < cloud.places.size() ? cloud.places[point] : static_cast<int>(point));
  if (cloud.format == "obj") return file + ":" + number + ": the vertex";
  return file + ": " + (cloud.format == "ply" ? "vertex " : "point ") + number;
}

}  // namespace

std::optional<Finding> DoubtPoints(const ObservedCloud& cloud, const std::string& units, const std::string& file) {
  if (cloud.points.size() < kFewestCloudPoints) return std::nullopt;
  const Vector3d middle = Middle(cloud.points);
  std::vector<double> distances;
  for (const Vector3d& point : cloud.points) distances.push_back((point - middle).norm());
  const double radius = AtShare(distances, kNear);
  if (!(radius > 0.0)) return std::nullopt;
  const double farthest = *std::max_element(distances.begin(), distances.end());
  const auto metres = units.empty() ? Expected<double>(0.0) : MetresPerUnit(units);
  const bool far = farthest > kFarRadii * radius;
  // A mesh is one surface; depth cameras have a number of their own for nothing seen.
  const bool error = farthest > (cloud.triangles > 0 ? kFarRadii : kFarthestRadii) * radius;
  const double limit = !far && metres && *metres > 0.0 ? kReach_m / *metres : kFarRadii * radius;
  const auto is_far = [&](double distance) { return distance > limit; };
  const auto first = std::find_if(distances.begin(), distances.end(), is_far);
  if (first == distances.end()) return std::nullopt;
  const auto count = std::count_if(distances.begin(), distances.end(), is_far);
  const auto at = static_cast<std::size_t>(first - distances.begin());
  const Vector3d& point = cloud.points[at];
  return MakeFinding(
      "point_far", error ? Severity::kError : Severity::kWarning, farthest,
      PlaceOfPoint(cloud, at, file) + " at " + RoundedText(point.x()) + " " + RoundedText(point.y()) + " " +
          RoundedText(point.z()) + " is " + Digits(*first) + " from the middle of the cloud" +
          (count > 1 ? ", and " + Counted(count - 1, "other") + " are so far" : "") + "; nine in ten of the " +
          std::to_string(cloud.points.size()) + " points are within " + Digits(radius) + ", and " +
          (far ? "what is more than 20 times as far is no part of what was scanned" : "nobody reaches beyond 2.5 m") +
          ": leave it out, or export the file again");
}

}  // namespace mocurate
