#include "fitting/triangulation/odd_cameras.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kSeldomShown = 0.5;    ///< of a camera's frames without the person: worth a warning
constexpr double kNotableShare = 0.15;  ///< of a camera's keypoints left out, and
constexpr double kNotableRatio = 4.0;   ///< times that of any other camera: worth a warning

Finding WarningOfCamera(const std::string& code, double value, const std::string& message, FindingAction action) {
  Finding finding;
  finding.code = code;
  finding.severity = Severity::kWarning;
  finding.value = value;
  finding.message = message;
  finding.action = action;
  return finding;
}

std::string PercentOf(double share) { return std::to_string(std::lround(100.0 * share)); }

}  // namespace

TriangulatedTracks WithoutOddCameras(TriangulatedTracks points, std::vector<ViewKeypoints> views, int frames,
                                     int keypoints, const TriangulationOptions& options) {
  const auto odd = std::count_if(points.cameras.begin(), points.cameras.end(),
                                 [](const CameraAgreement& camera) { return camera.disagrees; });
  if (odd == 0 || static_cast<std::size_t>(odd) + 2 > views.size()) return points;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (points.cameras[v].disagrees) std::fill(views[v].confidence.begin(), views[v].confidence.end(), 0.0);
  }
  TriangulatedTracks others = TriangulateViews(views, frames, keypoints, options);
  others.cameras = std::move(points.cameras);
  return others;
}

void TellOfCameras(const KeypointReport& report, const std::vector<double>& unseen, double outlier,
                   std::vector<Finding>& findings) {
  for (std::size_t v = 0; v < report.cameras.size(); ++v) {
    const CameraAgreement& camera = report.cameras[v];
    const std::string& name = report.camera_names[v];
    if (unseen[v] >= kSeldomShown) {
      findings.push_back(WarningOfCamera("camera_without_person", unseen[v],
                                         "camera " + name + " shows nothing of the person in " + PercentOf(unseen[v]) +
                                             " % of its frames" + "; fitted without it there",
                                         FindingAction::kKept));
    }
    const double share = camera.left_out_share();
    const double others = MostLeftOutElsewhere(report.cameras, v);
    if (!camera.disagrees && report.cameras.size() > 2 && share > kNotableShare && share > kNotableRatio * others) {
      findings.push_back(WarningOfCamera("camera_disagrees_in_part", share,
                                         "camera " + name + " disagrees with the others in part: " + PercentOf(share) +
                                             " % of its keypoints lie more than " + RoundedText(outlier, 3) +
                                             " px off, of another one at most " + PercentOf(others) +
                                             " %; does it show the same take of the same person, all along?",
                                         FindingAction::kLeftOut));
    }
    if (!camera.disagrees) continue;
    findings.push_back(WarningOfCamera("camera_disagrees", camera.median_px,
                                       "camera " + name + " disagrees with the others: " + PercentOf(share) +
                                           " % of its keypoints lie more than " + RoundedText(outlier, 3) +
                                           " px off, " + RoundedText(camera.median_px, 3) +
                                           " px in the median; was it moved, or is its clock off?",
                                       FindingAction::kLeftOut));
  }
}

}  // namespace mocurate
