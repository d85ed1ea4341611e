#include "fitting/triangulation/inconsistent_cameras.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kSeldomShown = 0.5;    ///< share of a camera's frames without the person that gives a warning
constexpr double kNotableShare = 0.15;  ///< of a camera's keypoints excluded, and
constexpr double kNotableRatio = 4.0;   ///< ratio to any other camera, that together give a warning

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

void ReportRigCameras(const KeypointReport& report, const std::vector<double>& unseen, double outlier,
                      std::vector<Finding>& findings) {
  for (std::size_t v = 0; v < report.cameras.size(); ++v) {
    const CameraAgreement& camera = report.cameras[v];
    const std::string& name = report.camera_names[v];
    if (unseen[v] >= kSeldomShown) {
      findings.push_back(MakeFinding("camera_without_person", Severity::kWarning, unseen[v],
                                     "camera " + name + " does not show the person in " + PercentOf(unseen[v]) +
                                         " % of its frames" + "; the fit does not use it there",
                                     FindingAction::kKept));
    }
    const double share = camera.excluded_share();
    const double others = LargestExcludedShare(report.cameras, v);
    if (!camera.disagrees && report.cameras.size() > 2 && share > kNotableShare && share > kNotableRatio * others) {
      findings.push_back(MakeFinding("camera_disagrees_in_part", Severity::kWarning, share,
                                     "camera " + name + " partly disagrees with the others: " + PercentOf(share) +
                                         " % of its keypoints lie more than " + RoundedText(outlier, 3) +
                                         " px off, of any other camera at most " + PercentOf(others) +
                                         " %; check that it shows the same take and person throughout",
                                     FindingAction::kExcluded));
    }
    if (!camera.disagrees) continue;
    findings.push_back(MakeFinding("camera_disagrees", Severity::kWarning, camera.median_px,
                                   "camera " + name + " disagrees with the others: " + PercentOf(share) +
                                       " % of its keypoints lie more than " + RoundedText(outlier, 3) + " px off, " +
                                       RoundedText(camera.median_px, 3) + " px in the median; check its pose and clock",
                                   FindingAction::kExcluded));
  }
}

}  // namespace mocurate
