#include "ingest/inspect/scene_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "core/base/text.h"
#include "core/formats/point_cloud.h"
#include "core/quality/tracked_points.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/calibration_estimate.h"
#include "ingest/inspect/clip_report.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/file_names.h"
#include "ingest/sources/babel_segments.h"

namespace mocurate {
namespace {

constexpr double kShortestPerson = 1.2, kTallestPerson = 2.1;  // metres, of a person from sole to crown
constexpr double kThinnest = 0.08, kThickest = 0.35;           // a person's depth against the height
constexpr double kStray = 0.005;                               // share of points on each side that may be junk
constexpr double kFarRadii = 20.0;                             // of most points of a cloud

/// Declared where the format declares it, else as measured.
Reported<std::string> Decided(const Measured& measured, bool declared) {
  Reported<std::string> reported = MeasuredText(measured);
  if (declared && reported.value) reported.from = Provenance::kDeclared;
  return reported;
}

/// Sides of the box around all points but a share on each side.
Vector3d BoxSides(const std::vector<Vector3d>& points, double share) {
  Vector3d extent = Vector3d::Zero();
  std::vector<double> values(points.size());
  const auto stray = static_cast<std::ptrdiff_t>(share * static_cast<double>(points.size()));
  for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
    std::transform(points.begin(), points.end(), values.begin(), [&](const Vector3d& point) { return point[axis]; });
    const auto low = values.begin() + stray, high = values.end() - 1 - stray;
    std::nth_element(values.begin(), low, values.end());
    const double least = *low;
    std::nth_element(values.begin(), high, values.end());
    extent[axis] = *high - least;
  }
  return extent;
}

Reported<std::string> UnitsOf(const Vector3d& extent) {
  const double thin = extent.maxCoeff() > 0.0 ? extent.minCoeff() / extent.maxCoeff() : 0.0;
  for (const auto& [name, metres] : {std::pair{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}}) {
    const double height = extent.maxCoeff() * metres;
    if (height < kShortestPerson || height > kTallestPerson || thin < kThinnest || thin > kThickest) continue;
    return Report<std::string>(name, Provenance::kMeasured, 0.6,
                               "the longest side is " + FormatDouble(FourDecimals(height)) + " m in " + name +
                                   ", and the shape as flat as a person");
  }
  return Unknown<std::string>(
      "the format does not declare it, and no usual unit makes the shape as high and as flat as a person");
}

/// "point_far": points 20 times as far from the middle as nine in ten are. Depth cameras have a number of their own for
/// nothing seen.
void ReportFarPoints(const RawCloud& cloud, const std::string& file, std::vector<Finding>& findings) {
  std::vector<double> distances = DistancesFromMiddle(cloud.points);
  std::sort(distances.begin(), distances.end());
  const double radius = distances.empty() ? 0.0 : distances[distances.size() * 9 / 10];
  const auto far = std::upper_bound(distances.begin(), distances.end(), kFarRadii * radius);
  if (far == distances.end() || radius == 0.0) return;
  findings.push_back(FindingAt(
      file, "point_far", Severity::kWarning, FourDecimals(distances.back()),
      Counted(distances.end() - far, "point") + " up to " + Digits(distances.back()) +
          " from the middle of the cloud, within " + Digits(radius) +
          " of which nine in ten are: no part of what was scanned; leave them out, or export the file again"));
}

constexpr std::size_t kMostMissing = 20;
constexpr std::string_view kEnding = ".npz";

/// Motions by every ending of their path.
struct Motions {
  std::map<std::string, const InspectedClip*> files;  ///< null: cannot be read, which is reported of the file
  std::set<std::string> folders;

  explicit Motions(const Inspection& inspection) {
    for (const InspectedClip& clip : inspection.clips) {
      if (DriverOf(clip.format).HasOption("annotations")) Add(clip.file, &clip);
    }
    if (files.empty()) return;
    for (const Finding& finding : inspection.findings) {  // a file that cannot be read is there
      const std::size_t end = finding.clip.find(kEnding);
      if (finding.severity == Severity::kError && end != std::string::npos)
        Add(finding.clip.substr(0, end + kEnding.size()), nullptr);
    }
  }

  void Add(const std::string& path, const InspectedClip* clip) {
    for (std::size_t at = 0;; ++at) {
      files.emplace(path.substr(at), clip);
      if (const std::string folder = FolderOf(path.substr(at)); !folder.empty()) folders.insert(folder);
      at = path.find('/', at);
      if (at == std::string::npos) break;
    }
  }
};

void CompareDuration(const AnnotatedMotion& motion, const InspectedClip& clip, std::vector<Finding>& findings) {
  if (!clip.rate_hz.value || !(*clip.rate_hz.value > 0.0)) return;
  const auto doubt = CheckDuration(motion.duration_s, *clip.frames.value / *clip.rate_hz.value);
  if (!doubt) return;
  findings.push_back(FindingAt(motion.file + ":" + motion.key, doubt->code, doubt->severity, doubt->value,
                               clip.id + ": " + doubt->message));
}

}  // namespace

void ReportCameras(const Calibration& calibration, const std::string& file, Inspection& inspection) {
  const CalibrationEstimate sense = EstimateCalibration(calibration);
  InspectedCamera camera;
  camera.file = file;
  camera.format = calibration.dialect;
  camera.reading = Decided(sense.reading, calibration.reading != PoseConvention::kUnknown);
  camera.units = Decided(sense.unit, calibration.metres_per_unit > 0.0);
  camera.up = Decided(sense.up, false);
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    const CalibratedView& view = calibration.views[i];
    camera.id = view.name;
    camera.world = view.world;
    camera.kind = view.kind;
    const bool sized = view.width > 0 && view.height > 0;
    camera.image_size = Report(sized ? std::optional(std::array<int, 2>{view.width, view.height}) : std::nullopt,
                               Provenance::kDeclared, 1.0, sized ? "pixels" : "the file does not declare it");
    camera.centre_m.reset();
    if (i < sense.cameras.size()) {
      camera.centre_m = Inverse(sense.cameras[i].camera_from_world).translation.unaryExpr(&FourDecimals);
    }
    inspection.cameras.push_back(camera);
  }
  for (const Finding& remark : sense.remarks) inspection.findings.push_back(FindingAt(file, Rounded(remark)));
}

void ReportCloud(const RawCloud& cloud, const std::string& file, Inspection& inspection) {
  InspectedCloud report;
  report.file = file;
  report.format = cloud.format;
  report.points = cloud.points.size();
  report.triangles = cloud.triangles;
  report.units = UnitsOf(BoxSides(cloud.points, kStray));
  const Vector3d extent = BoxSides(cloud.points, 0.0).unaryExpr(&FourDecimals);
  report.extent = Report<Vector3d>(extent, Provenance::kMeasured, 1.0, "x, y, z in the file's unit");
  ReportFarPoints(cloud, file, inspection.findings);
  inspection.clouds.push_back(std::move(report));
}

void CompareAnnotations(const std::vector<AnnotatedMotion>& annotated, Inspection& inspection) {
  const Motions motions(inspection);
  std::vector<Finding>& findings = inspection.findings;
  if (motions.files.empty()) return;
  std::size_t reported = 0, elsewhere = 0;
  for (const AnnotatedMotion& motion : annotated) {
    const InspectedClip* clip = nullptr;
    bool folder_is_here = false, is_here = false;
    for (const std::string& name : AmassNames(motion.feat_p)) {
      const auto found = motions.files.find(name);
      if (found != motions.files.end()) is_here = true;
      if (found != motions.files.end() && found->second != nullptr) clip = found->second;
      folder_is_here = folder_is_here || motions.folders.count(FolderOf(name)) > 0;
    }
    if (clip != nullptr) {
      CompareDuration(motion, *clip, findings);
    } else if (is_here) {
      continue;
    } else if (folder_is_here && reported < kMostMissing) {
      ++reported;
      findings.push_back(FindingAt(
          motion.file + ":" + motion.key, "motion_missing", Severity::kWarning, 0.0,
          "feat_p '" + motion.feat_p +
              "' names a motion that is missing in its folder: correct feat_p, or download that file of AMASS"));
    } else {
      ++elsewhere;
    }
  }
  if (elsewhere == 0) return;
  findings.push_back(
      FindingAt(annotated.front().file, "motion_missing", Severity::kInfo, static_cast<double>(elsewhere),
                Counted(static_cast<long long>(elsewhere), "annotated motion") + " of " +
                    std::to_string(annotated.size()) + (elsewhere == 1 ? " lies" : " lie") +
                    " in folders that are missing here: AMASS is downloaded in parts. Download those that you need"));
}

}  // namespace mocurate
