#include "fitting/triangulation/keypoint_tracks.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "fitting/association/associate.h"
#include "fitting/association/person_views.h"
#include "fitting/association/rig_diagnosis.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/evidence/noise.h"
#include "fitting/triangulation/camera_refit.h"

namespace mocurate {
namespace {

constexpr double kFewPoints = 0.02;   ///< share of the frames times keypoints: less is nothing to fit
constexpr double kPoorPoints = 0.4;   ///< worth a warning
constexpr double kUnevenDepth = 6.0;  ///< of the standard deviations along the worst and the best direction
constexpr double kSeldomSeen = 0.05;  ///< of the frames; a keypoint found less often counts as never found

Error Inconsistent(const std::string& what, const std::string& where, const std::string& hint) {
  return {ErrorCode::kInconsistent, what, where, hint};
}

Status CheckViews(const Evidence& evidence) {
  if (Status sound = CheckKeypoints(evidence); !sound) return sound;
  const auto views = static_cast<long long>(evidence.keypoint_views.size());
  if (views >= 2 && !evidence.keypoint_names.empty()) return {};
  return tl::unexpected<Error>(Inconsistent("keypoints of " + Counted(views, "camera") + " give no depth", "keypoints",
                                            "two views at least are needed"));
}

Finding Tell(const std::string& code, Severity severity, double value, const std::string& message,
             const std::string& action) {
  Finding finding;
  finding.code = code;
  finding.severity = severity;
  finding.value = value;
  finding.message = message;
  finding.action = action;
  return finding;
}

long Percent(double share) { return std::lround(100.0 * share); }

double Quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

void TellOfPeople(const std::vector<RigView>& rig, const Association& take, std::int64_t subject,
                  std::vector<Finding>& findings) {
  if (take.people.size() > 1) {
    findings.push_back(Tell("other_people", Severity::kInfo, static_cast<double>(take.people.size()),
                            "views agree on " + Counted(static_cast<long long>(take.people.size()), "person") +
                                "; this is number " + std::to_string(subject) + " by presence",
                            "kept apart"));
  }
  std::string where;
  int left_out = 0;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    if (take.left_out[v] == 0) continue;
    left_out += take.left_out[v];
    where += (where.empty() ? "" : ", ") + rig[v].camera.camera.name + " " + std::to_string(take.left_out[v]) + " of " +
             std::to_string(take.entries[v]);
  }
  if (left_out == 0) return;
  findings.push_back(Tell("bystanders_left_out", Severity::kInfo, left_out,
                          "people or false finds that no second view confirms: " + where, "left out"));
}

void TellOfCameras(const KeypointReport& report, const std::optional<CameraRefit>& refit, double outlier,
                   std::vector<Finding>& findings) {
  for (std::size_t v = 0; v < report.cameras.size(); ++v) {
    const CameraAgreement& camera = report.cameras[v];
    if (camera.detections == 0) {
      findings.push_back(Tell("camera_without_person", Severity::kWarning, 0.0,
                              "camera " + report.camera_names[v] + " shows nothing of the person", "left out"));
    }
    if (!camera.disagrees) continue;
    const double share = static_cast<double>(camera.left_out) / camera.detections;
    findings.push_back(
        Tell("camera_disagrees", Severity::kWarning, camera.median_px,
             "camera " + report.camera_names[v] + " disagrees with the others: " + std::to_string(Percent(share)) +
                 " % of its keypoints lie more than " + RoundedText(outlier, 3) + " px off, " +
                 RoundedText(camera.median_px, 3) + " px in the median; was it moved, or is its clock off?",
             refit ? "pose refitted to what the others see: " + RoundedText(1e3 * refit->moved_m, 3) + " mm and " +
                         RoundedText(57.29577951308232 * refit->turned_rad, 2) + " degrees away, " +
                         RoundedText(refit->after_px, 3) + " px left"
                   : "left out where it disagrees"));
  }
}

/// Whether most views that show somebody show somebody else.
void TellOfContradiction(const std::vector<RigView>& rig, const AssociatedPerson& person, KeypointTracks& found) {
  double showing = 0.0;
  double agreeing = 0.0;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    const RigView& view = rig[v];
    for (int f = 0; f < view.frames(); ++f) {
      bool shows = false;
      for (int p = 0; p < view.people; ++p) shows = shows || view.seen[view.Entry(f, p)] > 0;
      showing += shows ? 1.0 / view.frames() : 0.0;
      agreeing += person.entry[v][static_cast<std::size_t>(f)] >= 0 ? 1.0 / view.frames() : 0.0;
    }
  }
  if (rig.size() < 3 || agreeing > 0.5 * showing) return;
  found.report.doubtful = true;
  found.findings.push_back(Tell("views_contradict", Severity::kWarning, agreeing,
                                "of " + RoundedText(showing, 2) + " views that show somebody only " +
                                    RoundedText(agreeing, 2) + " agree on this person (mean over the frames)",
                                "flagged"));
}

void TellOfPoints(const TriangulatedTracks& points, KeypointTracks& found) {
  KeypointReport& report = found.report;
  std::vector<Finding>& findings = found.findings;
  std::string never;
  for (std::size_t k = 0; k < report.keypoint_share.size(); ++k) {
    if (report.keypoint_share[k] > kSeldomSeen) continue;
    never += (never.empty() ? "" : ", ") + report.keypoint_names[k];
  }
  if (!never.empty()) {
    findings.push_back(Tell("keypoints_never_found", Severity::kInfo, 0.0,
                            "too few views agree on " + never + " in nearly all frames", "inferred"));
  }
  if (report.triangulated < kPoorPoints) {
    report.doubtful = true;
    findings.push_back(Tell(
        "few_points", Severity::kWarning, report.triangulated,
        "only " + std::to_string(Percent(report.triangulated)) + " % of the keypoints are found in 3-D", "flagged"));
  }
  std::vector<double> uneven;
  for (std::size_t i = 0; i < points.confidence.size(); ++i) {
    if (points.confidence[i] <= 0.0) continue;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(points.covariance[i], Eigen::EigenvaluesOnly);
    uneven.push_back(std::sqrt(axes.eigenvalues()[2] / std::max(axes.eigenvalues()[0], 1e-300)));
  }
  const double ratio = Median(uneven);
  if (ratio <= kUnevenDepth) return;
  report.doubtful = true;
  findings.push_back(Tell("views_close_together", Severity::kWarning, ratio,
                          "points are " + RoundedText(ratio, 3) +
                              " times as uncertain along their worst direction as along their best: the views that see "
                              "them stand close together, or opposite each other",
                          "flagged"));
}

KeypointReport ReportOf(const Evidence& evidence, const Association& take, const AssociatedPerson& person,
                        const TriangulatedTracks& points) {
  KeypointReport report;
  const std::size_t keypoints = evidence.keypoint_names.size();
  const std::size_t frames = take.time_s.size();
  report.people = static_cast<int>(take.people.size());
  report.seen_share = static_cast<double>(person.frames_seen) / static_cast<double>(frames);
  report.keypoint_names = evidence.keypoint_names;
  report.keypoint_share.assign(keypoints, 0.0);
  std::vector<double> px;
  for (std::size_t i = 0; i < points.confidence.size(); ++i) {
    if (points.confidence[i] <= 0.0) continue;
    px.push_back(points.error_px[i]);
    report.views += points.view_count[i];
    report.keypoint_share[i % keypoints] += 1.0 / static_cast<double>(frames);
  }
  report.triangulated = static_cast<double>(px.size()) / static_cast<double>(points.confidence.size());
  if (!px.empty()) report.views /= static_cast<double>(px.size());
  report.median_px = Quantile(px, 0.5);
  report.p90_px = Quantile(px, 0.9);
  for (const KeypointView& view : evidence.keypoint_views) report.camera_names.push_back(view.camera.name);
  report.cameras = points.cameras;
  return report;
}

/// Median of each known length over the frames.
std::vector<double> MedianLengths(const TriangulatedTracks& points, const std::vector<KnownLength>& lengths) {
  std::vector<double> medians;
  for (const KnownLength& length : lengths) {
    std::vector<double> samples;
    for (int f = 0; f < points.positions.frames; ++f) {
      const std::size_t first = static_cast<std::size_t>(f) * points.positions.joints;
      if (points.confidence[first + length.from] <= 0.0 || points.confidence[first + length.to] <= 0.0) continue;
      samples.push_back((points.positions.at(f, length.from) - points.positions.at(f, length.to)).norm());
    }
    medians.push_back(Median(samples));
  }
  return medians;
}

}  // namespace

Expected<KeypointTracks> TriangulateKeypoints(const Evidence& evidence, const Skeleton& skeleton,
                                              const KeypointFitOptions& options) {
  if (Status checked = CheckViews(evidence); !checked) return tl::unexpected<Error>(checked.error());
  const auto keypoints = static_cast<int>(evidence.keypoint_names.size());
  std::vector<RigView> rig;
  for (const KeypointView& view : evidence.keypoint_views) {
    rig.emplace_back(view, keypoints, options.triangulation.min_confidence);
  }
  KeypointTracks found;
  found.tracks.names = DetectorNames(evidence.keypoint_names);
  const std::vector<KnownLength> lengths = KnownLengths(found.tracks.names, skeleton);
  const Association take = AssociatePeople(rig, lengths);
  if (take.people.empty()) return tl::unexpected<Error>(WhyNobody(rig));
  if (evidence.subject < 0 || evidence.subject >= static_cast<int>(take.people.size())) {
    return tl::unexpected<Error>(Inconsistent("person " + std::to_string(evidence.subject) +
                                                  " is wanted, counted from 0 by presence, but views agree on " +
                                                  Counted(static_cast<long long>(take.people.size()), "person"),
                                              "keypoints", "ask for fewer people per recording"));
  }
  const AssociatedPerson& person = take.people[static_cast<std::size_t>(evidence.subject)];
  std::vector<ViewKeypoints> views = ViewsOfPerson(rig, take, person);
  const auto frames = static_cast<int>(take.time_s.size());
  const std::optional<int> odd = OddView(views, frames, keypoints, options.triangulation);
  TriangulatedTracks points = TriangulateViews(views, frames, keypoints, options.triangulation, odd.value_or(-1));
  const std::optional<CameraRefit> refit = odd ? RefitCamera(views[*odd], points) : std::nullopt;
  if (refit) {
    const CameraAgreement as_calibrated = points.cameras[*odd];
    views[*odd].camera = refit->camera;
    points = TriangulateViews(views, frames, keypoints, options.triangulation);
    points.cameras[*odd] = as_calibrated;
  }
  found.report = ReportOf(evidence, take, person, points);
  if (found.report.triangulated < kFewPoints) {
    return tl::unexpected<Error>(Inconsistent(
        "only " + std::to_string(Percent(found.report.triangulated)) + " % of the keypoints are found in 3-D",
        "keypoints",
        "views must agree within fitting.keypoints.triangulation.outlier, " +
            RoundedText(options.triangulation.outlier, 3) + " px"));
  }
  if (Status shape = CheckPersonShape(MedianLengths(points, lengths), lengths); !shape) {
    return tl::unexpected<Error>(shape.error());
  }
  TellOfPeople(rig, take, evidence.subject, found.findings);
  TellOfContradiction(rig, person, found);
  TellOfCameras(found.report, refit, options.triangulation.outlier, found.findings);
  TellOfPoints(points, found);
  found.tracks.time_s = take.time_s;
  found.tracks.positions = std::move(points.positions);
  found.tracks.confidence = std::move(points.confidence);
  return found;
}

}  // namespace mocurate
