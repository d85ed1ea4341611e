#include "fitting/triangulation/keypoint_tracks.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/median.h"
#include "core/base/text.h"
#include "fitting/association/associate.h"
#include "fitting/association/body_shape.h"
#include "fitting/audit/keypoint_files.h"
#include "fitting/audit/keypoint_order.h"
#include "fitting/audit/rig_audit.h"
#include "fitting/audit/rig_corrections.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/audit/view_sides.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/triangulation/inconsistent_cameras.h"

namespace mocurate {
namespace {

constexpr double kFewPoints = 0.02;  ///< share of the frames times keypoints; below, there is too little to fit
constexpr double kPoorPoints = 0.4;  ///< share, likewise; below: a warning
constexpr double kContradicted =
    0.1;  ///< of the keypoints that three or more views detect, without a triangulated point
/// Ratio of the standard deviations along the worst and the best direction, from which a finding is written.
constexpr double kUnevenDepth = 6.0;
constexpr double kSeldomFound = 0.05;  ///< of the frames; a keypoint found less often counts as never found

Error Inconsistent(const std::string& what, const std::string& where, const std::string& hint) {
  return {ErrorCode::kInconsistent, what, where, hint};
}

Status CheckViews(const Evidence& evidence) {
  if (Status sound = CheckKeypoints(evidence); !sound) return sound;
  const auto views = static_cast<long long>(evidence.keypoint_views.size());
  if (views >= 2 && !evidence.keypoint_names.empty()) return {};
  return tl::unexpected<Error>(Inconsistent("keypoints of " + Counted(views, "camera") + " give no depth", "keypoints",
                                            "give at least two views"));
}

long Percent(double share) { return std::lround(100.0 * share); }

double Quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

void ReportPeople(const std::vector<RigView>& rig, const Association& take, std::int64_t subject,
                  std::vector<Finding>& findings) {
  if (take.people.size() > 1) {
    findings.push_back(MakeFinding("other_people", Severity::kInfo, static_cast<double>(take.people.size()),
                                   "views agree on " + Counted(static_cast<long long>(take.people.size()), "person") +
                                       "; this clip is person number " + std::to_string(subject) +
                                       " (ordered by presence)",
                                   FindingAction::kKept));
  }
  std::string where;
  int excluded = 0;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    if (take.excluded[v] == 0) continue;
    excluded += take.excluded[v];
    where += (where.empty() ? "" : ", ") + rig[v].camera.camera.name + " " + std::to_string(take.excluded[v]) + " of " +
             std::to_string(take.entries[v]);
  }
  if (excluded == 0) return;
  findings.push_back(MakeFinding("bystanders_skipped", Severity::kInfo, excluded,
                                 "detections that no second view confirms (other people, false positives): " + where,
                                 FindingAction::kExcluded));
}

/// Reports that most views with a detection do not show this person.
void ReportRigContradiction(const std::vector<RigView>& rig, const AssociatedPerson& person, KeypointTracks& found) {
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
  found.report.suspect = true;
  found.findings.push_back(MakeFinding("views_contradict", Severity::kWarning, agreeing,
                                       "of " + RoundedText(showing, 2) + " views with a detection only " +
                                           RoundedText(agreeing, 2) + " agree on this person (mean over the frames)",
                                       FindingAction::kFlagged));
}

/// Share of the keypoints detected by three or more views, in which no two detections meet in a point.
double ContradictedShare(const std::vector<ViewKeypoints>& views, const TriangulatedTracks& points,
                         double min_confidence) {
  double detected = 0.0;
  double lost = 0.0;
  for (std::size_t i = 0; i < points.confidence.size(); ++i) {
    const auto seen = std::count_if(views.begin(), views.end(), [&](const ViewKeypoints& view) {
      return view.confidence[i] > 0.0 && view.confidence[i] >= min_confidence;
    });
    if (seen < 3) continue;
    detected += 1.0;
    lost += points.confidence[i] > 0.0 ? 0.0 : 1.0;
  }
  return detected > 0.0 ? lost / detected : 0.0;
}

void ReportContradictedPoints(double share, KeypointTracks& found) {
  if (share <= kContradicted) return;
  found.report.suspect = true;
  found.findings.push_back(
      MakeFinding("keypoints_contradict", Severity::kWarning, share,
                  "of the keypoints that three or more views detect, " + std::to_string(Percent(share)) +
                      " % have no intersection: check that all cameras show the same take of the same person",
                  FindingAction::kFlagged));
}

void ReportPoints(const TriangulatedTracks& points, KeypointTracks& found) {
  KeypointReport& report = found.report;
  std::vector<Finding>& findings = found.findings;
  std::string never;
  for (std::size_t k = 0; k < report.keypoint_share.size(); ++k) {
    if (report.keypoint_share[k] > kSeldomFound) continue;
    never += (never.empty() ? "" : ", ") + report.keypoint_names[k];
  }
  if (!never.empty()) {
    findings.push_back(MakeFinding("keypoints_never_found", Severity::kInfo, 0.0,
                                   "not triangulated, as too few views agree: " + never + " (in nearly all frames)",
                                   FindingAction::kInterpolated));
  }
  if (report.triangulated < kPoorPoints) {
    report.suspect = true;
    findings.push_back(
        MakeFinding("few_points", Severity::kWarning, report.triangulated,
                    "only " + std::to_string(Percent(report.triangulated)) + " % of the keypoints are triangulated",
                    FindingAction::kFlagged));
  }
  std::vector<double> uneven;
  for (std::size_t i = 0; i < points.confidence.size(); ++i) {
    if (points.confidence[i] <= 0.0) continue;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(points.precision[i], Eigen::EigenvaluesOnly);
    uneven.push_back(std::sqrt(axes.eigenvalues()[2] / std::max(axes.eigenvalues()[0], 1e-300)));
  }
  const double ratio = MeanMedian(uneven);
  if (ratio <= kUnevenDepth) return;
  report.suspect = true;
  findings.push_back(
      MakeFinding("views_close_together", Severity::kWarning, ratio,
                  "points are " + RoundedText(ratio, 3) +
                      " times as uncertain along their worst direction as along their best, because the views that see "
                      "them stand close together, or opposite each other",
                  FindingAction::kFlagged));
}

KeypointReport ReportOf(const Evidence& evidence, const std::vector<RigView>& rig, const Association& take,
                        const AssociatedPerson& person, const TriangulatedTracks& points) {
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
  for (const RigView& view : rig) report.camera_names.push_back(view.camera.camera.name);
  for (const KeypointView& view : evidence.keypoint_views) report.given_cameras.push_back(view.camera.name);
  report.cameras = points.cameras;
  return report;
}

constexpr double kOddProportions = 0.15;  ///< log ratio of lengths, absolute, mean, from which other orders are tried
constexpr double kMuchBetterOrder = 0.6;  ///< ratio of that mean in the other order

/// A fault where another order of the keypoints makes a plausible person and the declared one does not.
std::optional<RigFault> WrongOrder(const Evidence& evidence, const TriangulatedTracks& points, const Skeleton& skeleton,
                                   double mismatch, std::vector<std::string>& names) {
  if (mismatch < kOddProportions) return {};
  const auto order = FindKeypointOrder(points.positions, points.confidence, evidence.keypoint_names, skeleton);
  if (!order || order->found > kMuchBetterOrder * order->given) return {};
  names = order->names;
  RigFault fault =
      MakeFault("keypoint_order", "", order->given,
                "limb proportions differ from a person's by a factor of " + RoundedText(std::exp(order->given), 3) +
                    " (mean); in the order of " + order->name + " by " + RoundedText(std::exp(order->found), 3));
  fault.confidence = order->confidence;
  return fault;
}

std::optional<RigFault> WrongUnit(double scale) {
  const auto unit = FindUnit(scale);
  if (!unit) return {};
  RigFault fault = MakeFault("calibration_unit", "", unit->factor,
                             "the calibration looks like " + unit->text + ": the person is " + RoundedText(scale, 3) +
                                 " times a person's size");
  // Distance of the person's size from the next explanation, a factor of 1.6 at least; sizes of people have a standard
  // deviation of 12 %.
  fault.confidence = std::erf(std::log(1.6) / (0.12 * std::sqrt(2.0)) -
                              std::abs(std::log(scale / unit->factor)) / (0.12 * std::sqrt(2.0)));
  fault.confidence = std::clamp(fault.confidence, 0.0, 1.0);
  fault.confidence_of = ConfidenceOf::kModel;
  return fault;
}

Expected<KeypointTracks> Triangulated(const Evidence& evidence, const Skeleton& skeleton,
                                      const KeypointFitOptions& options, std::vector<RigFault> faults,
                                      const TakeStarts& takes);

/// Whether a fault of the rig is one that the file of an audited rig should have, found for a take that uses the file.
bool ContradictsRig(const RigFault& fault, const KeypointFitOptions& options) {
  return !options.rig.empty() && !fault.corrected && fault.code != kOnePlace;
}

/// That the views are those of an audited rig, and which cameras of it are ambiguous.
Finding UsesRig(const RigFile& rig) {
  std::string ambiguous;
  double count = 0.0;
  for (const RigCamera& camera : rig.cameras) {
    if (camera.verdict != RigVerdict::kAmbiguous) continue;
    ambiguous += (ambiguous.empty() ? "" : ", ") + camera.camera.name;
    count += 1.0;
  }
  return MakeFinding("rig_used", Severity::kInfo, count,
                     "the views have the poses, clocks and files of an audited rig" +
                         (ambiguous.empty() ? std::string() : "; " + ambiguous + " ambiguous"),
                     FindingAction::kKept);
}

/// Checks the triangulated person; corrects unit and order where options allow it, and triangulates again. Empty: no
/// fault.
std::optional<Expected<KeypointTracks>> CheckPerson(const Evidence& evidence, const TriangulatedTracks& points,
                                                    const Skeleton& skeleton, const std::vector<KnownLength>& lengths,
                                                    const KeypointFitOptions& options,
                                                    const std::vector<RigFault>& faults, const TakeStarts& takes) {
  std::vector<int> frames(static_cast<std::size_t>(points.positions.frames));
  std::iota(frames.begin(), frames.end(), 0);
  const std::vector<double> measured = MedianLengths(points.positions, points.confidence, lengths, frames);
  const ShapeMatch shape = CompareShape(measured, lengths);
  const auto again = [&](RigFault fault, const Evidence& corrected) {
    fault.corrected = true;
    std::vector<RigFault> all = faults;
    all.push_back(std::move(fault));
    return Triangulated(corrected, skeleton, options, std::move(all), takes);
  };
  const auto known = [&](const char* code) {
    return std::any_of(faults.begin(), faults.end(), [&](const RigFault& fault) { return fault.code == code; });
  };
  std::string hint;
  std::vector<std::string> names;
  if (options.audit.order != AuditAction::kOff && !known("keypoint_order")) {
    auto fault = WrongOrder(evidence, points, skeleton, shape.lengths > 3 ? shape.mismatch : 1.0, names);
    if (fault && fault->confidence >= options.audit.sure) {
      if (options.audit.order == AuditAction::kCorrect) {
        Evidence corrected = evidence;
        corrected.keypoint_names = names;
        return again(std::move(*fault), corrected);
      }
      return tl::unexpected<Error>(
          Inconsistent(fault->message + "; " + ConfidenceText(fault->confidence, fault->confidence_of), "keypoints",
                       "declare the detector's order of keypoints, or set fitting.keypoints.audit.order to correct"));
    }
  }
  if (ForAuditOfRig(options).audit.unit == AuditAction::kCorrect && !known("calibration_unit")) {
    auto fault = WrongUnit(shape.scale);
    if (fault && shape.lengths > 3 && fault->confidence >= options.audit.sure) {
      Evidence corrected = evidence;
      for (KeypointView& view : corrected.keypoint_views) view.camera.camera_from_world.translation /= fault->value;
      return again(std::move(*fault), corrected);
    }
  }
  if (!options.audit.rules.on(FittingRule::kPersonShape)) return {};
  if (Status sound = CheckPersonShape(measured, lengths); !sound) return tl::unexpected<Error>(sound.error());
  return {};
}

/// Exchanges left and right limbs of single views back; true when anything changed.
bool CorrectLeftRightOfViews(const std::vector<RigView>& rig, const TriangulatedTracks& points,
                             const std::vector<std::string>& names, const KeypointFitOptions& options,
                             std::vector<ViewKeypoints>& views, std::vector<RigFault>& faults) {
  if (options.audit.sides == AuditAction::kOff || !options.audit.rules.on(FittingRule::kViewSides)) return false;
  const auto exchanges =
      FindSideExchanges(views, points, names, options.triangulation.noise, options.audit.side_margin);
  const bool corrected = options.audit.sides == AuditAction::kCorrect;
  for (const SideExchange& exchange : exchanges) {
    const std::string& camera = rig[exchange.view].camera.camera.name;
    RigFault fault = MakeFault("view_swaps_sides", camera, exchange.margin,
                               "camera " + camera + " labels left " + exchange.limb + " as right in " +
                                   Counted(exchange.frame_end - exchange.frame_begin, "frame"));
    fault.limb = exchange.limb;
    fault.frame_begin = exchange.frame_begin;
    fault.frame_end = exchange.frame_end;
    fault.confidence = 1.0 / (1.0 + std::exp(-exchange.margin));
    fault.confidence_of = ConfidenceOf::kModel;
    fault.corrected = corrected;
    faults.push_back(std::move(fault));
  }
  if (!corrected || exchanges.empty()) return false;
  ExchangeSides(exchanges, names, views);
  return true;
}

/// Whether a clock offset and a displacement of a camera have similar effects, as for a walking person; 30 mm are a
/// poor tracker's error of a joint.
bool ClocksAndPlacesMix(const KeypointReport& report) {
  const auto late = [](const RigFault& fault) { return fault.code == "camera_clock_off"; };
  return std::sqrt(report.place_covariance.trace()) > 0.03 &&
         std::any_of(report.faults.begin(), report.faults.end(), late);
}

Expected<KeypointTracks> Triangulated(const Evidence& evidence, const Skeleton& skeleton,
                                      const KeypointFitOptions& options, std::vector<RigFault> faults,
                                      const TakeStarts& takes) {
  const auto keypoints = static_cast<int>(evidence.keypoint_names.size());
  std::vector<RigView> rig;
  for (const KeypointView& view : evidence.keypoint_views) {
    rig.emplace_back(view, keypoints, options.triangulation.min_confidence);
  }
  KeypointTracks found;
  found.tracks.names = DetectorNames(evidence.keypoint_names);
  const std::vector<KnownLength> lengths = KnownLengths(found.tracks.names, skeleton);
  Association take = AssociatePeople(rig, lengths);
  if (take.people.empty()) return tl::unexpected<Error>(WhyNoPerson(rig));
  AuditedRig audited = AuditRig(rig, take, evidence.keypoint_names, ForAuditOfRig(options), takes);
  if (audited.corrected) {
    rig = audited.rig;
    take = AssociatePeople(rig, lengths, take.time_s);
  }
  if (evidence.subject < 0 || evidence.subject >= static_cast<int>(take.people.size())) {
    return tl::unexpected<Error>(Inconsistent("person " + std::to_string(evidence.subject) +
                                                  " is requested (from 0, ordered by presence), but views agree on " +
                                                  Counted(static_cast<long long>(take.people.size()), "person"),
                                              "keypoints", "reduce the number of people per recording"));
  }
  const AssociatedPerson& person = take.people[static_cast<std::size_t>(evidence.subject)];
  std::vector<ViewKeypoints> views = ViewsOfPerson(rig, take, person);
  const auto frames = static_cast<int>(take.time_s.size());
  TriangulatedTracks points = TriangulateViews(views, frames, keypoints, options.triangulation);
  std::vector<RigFault> sides;
  if (CorrectLeftRightOfViews(rig, points, evidence.keypoint_names, options, views, sides))
    points = TriangulateViews(views, frames, keypoints, options.triangulation);
  if (options.audit.rules.on(FittingRule::kInconsistentCameras))
    points = WithoutOddCameras(std::move(points), views, frames, keypoints, options.triangulation);
  found.report = ReportOf(evidence, rig, take, person, points);
  if (found.report.triangulated < kFewPoints) {
    return tl::unexpected<Error>(Inconsistent(
        "only " + std::to_string(Percent(found.report.triangulated)) + " % of the keypoints are triangulated",
        "keypoints",
        "views must agree within fitting.keypoints.triangulation.outlier, " +
            RoundedText(options.triangulation.outlier, 3) + " px"));
  }
  if (auto other = CheckPerson(evidence, points, skeleton, lengths, options, faults, takes)) return std::move(*other);
  faults.insert(faults.end(), audited.faults.begin(), audited.faults.end());
  const std::size_t of_rig = faults.size();
  faults.insert(faults.end(), sides.begin(), sides.end());
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const bool contradicts = i < of_rig && ContradictsRig(faults[i], options);
    found.findings.push_back(contradicts ? ContradictionOfRig(faults[i]) : FindingOf(faults[i]));
    found.report.suspect = found.report.suspect || contradicts || IsAmbiguous(faults[i]);
  }
  if (!audited.not_audited.empty()) {
    found.findings.push_back(MakeFinding(kRigNotAudited, Severity::kInfo, static_cast<double>(rig.size()),
                                         audited.not_audited, FindingAction::kKept));
  }
  found.report.faults = std::move(faults);
  found.report.rig = std::move(audited.estimate);
  found.report.residual_px = audited.residual_px;
  found.report.place_covariance = audited.place_covariance;
  found.report.suspect = found.report.suspect || ClocksAndPlacesMix(found.report);
  ReportPeople(rig, take, evidence.subject, found.findings);
  ReportRigContradiction(rig, person, found);
  ReportRigCameras(found.report, UnobservedShares(person), options.triangulation.outlier, found.findings);
  ReportContradictedPoints(ContradictedShare(views, points, options.triangulation.min_confidence), found);
  ReportPoints(points, found);
  found.tracks.time_s = take.time_s;
  found.tracks.positions = std::move(points.positions);
  found.precision = std::move(points.precision);
  found.tracks.confidence = std::move(points.confidence);
  return found;
}

/// Clocks, poses and sides are only audited with the given files.
KeypointFitOptions WithoutAudit(KeypointFitOptions options) {
  options.audit.clocks = options.audit.moved = options.audit.sides = AuditAction::kOff;
  return options;
}

}  // namespace

Expected<KeypointTracks> TriangulateKeypoints(const Evidence& evidence, const Skeleton& skeleton,
                                              const KeypointFitOptions& options, const TakeStarts& takes) {
  if (Status checked = CheckViews(evidence); !checked) return tl::unexpected<Error>(checked.error());
  std::vector<RigFault> faults;
  FileFindings files;
  Evidence as_seen = evidence;
  Matrix3d of_rig = Matrix3d::Zero();
  std::optional<Finding> used;
  if (!options.rig.empty()) {
    const Expected<RigFile> rig = ReadRigFile(options.rig);
    if (!rig) return Forward(rig);
    Expected<Evidence> corrected = WithRig(std::move(as_seen), *rig);
    if (!corrected) return Forward(corrected);
    as_seen = std::move(*corrected);
    of_rig = rig->place_covariance;
    used = UsesRig(*rig);
  }
  const std::vector<KnownLength> lengths = KnownLengths(DetectorNames(evidence.keypoint_names), skeleton);
  Status assigned = CorrectFileAssignment(as_seen, lengths, ForAuditOfRig(options), faults, files);
  if (!assigned) return Forward(assigned);
  const bool wrong = FilesAreExchanged(faults);
  Expected<KeypointTracks> found =
      Triangulated(as_seen, skeleton, wrong ? WithoutAudit(options) : options, std::move(faults), takes);
  if (!found) return found;
  found->report.files = std::move(files);
  found->report.place_covariance += of_rig;
  if (used) found->findings.push_back(*used);
  if (wrong) {
    found->findings.push_back(MakeFinding(
        kRigNotAudited, Severity::kInfo, static_cast<double>(as_seen.keypoint_views.size()),
        "clocks, poses and sides of cameras were not audited, because the files were exchanged", FindingAction::kKept));
  }
  return found;
}

}  // namespace mocurate
