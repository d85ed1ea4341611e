#include "ingest/sense/scene_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/point_cloud.h"
#include "core/quality/tracked_points.h"
#include "ingest/sense/calibration_sense.h"
#include "ingest/sense/clip_report.h"
#include "ingest/sense/comparison.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr double kShortestPerson = 1.2, kTallestPerson = 2.1;  // metres, of a person from sole to crown
constexpr double kThinnest = 0.08, kThickest = 0.35;           // a person's depth against the height
constexpr double kStray = 0.005;                               // share of points on each side that may be junk
constexpr double kFarRadii = 20.0;                             // of most points of a cloud

/// Declared where the format says it, else as measured.
Json Decided(const Measured& measured, bool declared) {
  return ReportValue(measured.value, declared ? "declared" : "measured", measured.confidence, measured.evidence);
}

/// Sides of the box around all points but a share on each side.
std::array<double, 3> BoxSides(const std::vector<Vector3d>& points, double share) {
  std::array<double, 3> extent{};
  std::vector<double> values(points.size());
  const auto stray = static_cast<std::size_t>(share * static_cast<double>(points.size()));
  for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
    std::transform(points.begin(), points.end(), values.begin(), [&](const Vector3d& point) { return point[axis]; });
    const auto low = values.begin() + static_cast<std::ptrdiff_t>(stray);
    std::nth_element(values.begin(), low, values.end());
    const double least = *low;
    const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(stray);
    std::nth_element(values.begin(), high, values.end());
    extent[static_cast<std::size_t>(axis)] = *high - least;
  }
  return extent;
}

Json UnitsOf(std::array<double, 3> extent) {
  std::sort(extent.begin(), extent.end());
  const double thin = extent[2] > 0.0 ? extent[0] / extent[2] : 0.0;
  for (const auto& [name, metres] : {std::pair{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}}) {
    const double height = extent[2] * metres;
    if (height < kShortestPerson || height > kTallestPerson || thin < kThinnest || thin > kThickest) continue;
    return ReportValue(name, "measured", 0.6,
                       "the longest side is " + FormatDouble(FourDecimals(height)) + " m in " + name +
                           ", and the shape as flat as a person");
  }
  return ReportValue(Json(), "unknown", 0.0,
                     "the format does not say it, and no usual unit makes the shape as high and as flat as a person");
}

/// "point_far": points 20 times as far from the middle as nine in ten are. Depth cameras have
/// a number of their own for nothing seen.
void ReportFarPoints(const ObservedCloud& cloud, const std::string& file, Json& findings) {
  std::vector<double> distances = DistancesFromMiddle(cloud.points);
  std::sort(distances.begin(), distances.end());
  const double radius = distances.empty() ? 0.0 : distances[distances.size() * 9 / 10];
  const auto far = std::upper_bound(distances.begin(), distances.end(), kFarRadii * radius);
  if (far == distances.end() || radius == 0.0) return;
  findings.push_back(InspectionFinding(
      "point_far", Severity::kWarning, file, FourDecimals(distances.back()),
      Counted(distances.end() - far, "point") + " up to " + Digits(distances.back()) +
          " from the middle of the cloud, within " + Digits(radius) +
          " of which nine in ten are: no part of what was scanned; leave them out, or export the file again"));
}

}  // namespace

void ReportCameras(const Calibration& calibration, const std::string& file, Json& cameras, Json& findings) {
  const CalibrationSense sense = SenseCalibration(calibration);
  const Json reading = Decided(sense.reading, calibration.reading != PoseReading::kUnknown);
  const Json units = Decided(sense.unit, calibration.metres_per_unit > 0.0);
  const Json up = Decided(sense.up, false);
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    const CalibratedView& view = calibration.views[i];
    Json camera = {{"id", view.name},     {"file", file},      {"format", calibration.dialect},
                   {"world", view.world}, {"kind", view.kind}, {"units", units},
                   {"reading", reading},  {"up", up}};
    const bool sized = view.width > 0 && view.height > 0;
    camera["image_size"] = ReportValue(sized ? Json{view.width, view.height} : Json(), "declared", 1.0,
                                       sized ? "pixels" : "the file does not say it");
    camera["centre_m"] = nullptr;
    if (i < sense.cameras.size()) {
      const Vector3d centre = Inverse(sense.cameras[i].camera_from_world).translation;
      camera["centre_m"] = {FourDecimals(centre.x()), FourDecimals(centre.y()), FourDecimals(centre.z())};
    }
    cameras.push_back(std::move(camera));
  }
  for (const Finding& remark : sense.remarks) {
    findings.push_back(
        InspectionFinding(remark.code, remark.severity, file, FourDecimals(remark.value), remark.message));
  }
}

Json CloudReport(const ObservedCloud& cloud, const std::string& file, Json& findings) {
  const Json units = UnitsOf(BoxSides(cloud.points, kStray));
  ReportFarPoints(cloud, file, findings);
  const std::array<double, 3> extent = BoxSides(cloud.points, 0.0);
  return {{"id", file},
          {"file", file},
          {"format", cloud.format},
          {"points", cloud.points.size()},
          {"triangles", cloud.triangles},
          {"extent", ReportValue(Json{FourDecimals(extent[0]), FourDecimals(extent[1]), FourDecimals(extent[2])},
                                 "measured", 1.0, "x, y, z in the file's unit")},
          {"units", units}};
}

Json CompanionReport(const ObservedCompanion& companion) {
  Json facts = Json::object();
  for (const auto& [key, text] : companion.texts) facts[key] = text;
  for (const auto& [key, number] : companion.numbers) facts[key] = number;
  return {{"file", companion.file}, {"format", companion.format}, {"facts", std::move(facts)}};
}

}  // namespace mocurate
