#include "fitting/keypoint_fit.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/keypoint_files.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/audit/rig_hypotheses.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/evidence/implausible_body.h"
#include "fitting/evidence/motion_tracks.h"
#include "fitting/evidence/noise.h"
#include "fitting/fit_outcome.h"
#include "fitting/repair/body_sides.h"
#include "fitting/repair/track_repairs.h"
#include "fitting/solver/body_size.h"
#include "fitting/solver/bone_lengths.h"
#include "fitting/solver/joint_track_fit.h"
#include "fitting/triangulation/keypoint_tracks.h"

namespace mocurate {
namespace {

/// Excludes keypoints that are neither a joint of the body nor a point of it.
JointTracks TracksOfBody(const JointTracks& tracks, const Skeleton& body) {
  std::vector<std::optional<std::string>> names;
  for (const std::string& name : tracks.names)
    names.push_back(body.FindJoint(name) ? std::optional(name) : std::nullopt);
  return SelectedTracks(tracks, names);
}

/// Of each joint's samples, (F*J).
std::vector<Matrix3d> PrecisionOnBody(const KeypointTracks& found, const Skeleton& body) {
  const std::size_t keypoints = found.tracks.names.size();
  const auto frames = static_cast<std::size_t>(found.tracks.positions.frames);
  const std::size_t joints = body.joints.size();
  std::vector<Matrix3d> precision(frames * joints, Matrix3d::Identity());
  for (std::size_t k = 0; k < keypoints; ++k) {
    const auto joint = body.FindJoint(found.tracks.names[k]);
    if (!joint) continue;
    for (std::size_t f = 0; f < frames; ++f) {
      precision[f * joints + static_cast<std::size_t>(*joint)] = found.precision[f * keypoints + k];
    }
  }
  return precision;
}

/// Error where exchanged sides of the whole clip are explained by exchanged files just as well.
Status CheckFileNames(const Evidence& evidence, const Skeleton& skeleton, const KeypointFitOptions& options,
                      const BodyExchange& body) {
  const auto lengths = KnownLengths(DetectorNames(evidence.keypoint_names), skeleton);
  const std::vector<RigHypothesis> others =
      FindMirroredHypotheses(evidence.keypoint_views, evidence.keypoint_names, lengths,
                             options.triangulation.min_confidence, options.audit.sure);
  if (others.empty()) return {};
  std::string words = "left and right are exchanged (" + body.evidence + "): all cameras list left as right";
  for (const RigHypothesis& hypothesis : others) words += "; or " + WordsOf(hypothesis, evidence.keypoint_views);
  return Fail(ErrorCode::kInconsistent, words + "; the explanations are ambiguous, because the rig is symmetric",
              "keypoints",
              "compare an image of each camera with its file and correct the names; where they are right, set "
              "fitting.keypoints.audit.exchanged to off, which exchanges the labels; or set "
              "fitting.keypoints.audit.sides to report, with which the person may be mirrored");
}

/// Views that agree may all have exchanged labels: rays of one label meet in one point whatever its name is.
Status CorrectLeftRight(const Evidence& evidence, const Skeleton& skeleton, const KeypointFitOptions& options,
                        BodyTracks& found) {
  const KeypointAuditOptions& audit = options.audit;
  SkeletonTracks& tracks = found.tracks;
  const std::vector<int> left = LeftJoints(*tracks.skeleton);
  const double sigma = EstimateNoise(tracks, {}).sigma;
  const bool files_wrong = FilesAreExchanged(found.report.faults);
  const std::vector<BodyExchange> exchanges = FindBodyExchanges(tracks, sigma, audit.side_margin);
  const bool whole = !exchanges.empty() && CoverAll(exchanges, tracks);
  const bool names_or_files =
      audit.sides == AuditAction::kCorrect && audit.exchanged == AuditAction::kCorrect && options.rig.empty();
  if (whole && names_or_files && !FilesAreCorrected(found.report.faults)) {
    if (Status names = CheckFileNames(evidence, skeleton, options, exchanges[0]); !names) return names;
  }
  for (const BodyExchange& body : exchanges) {
    RigFault fault = MakeFault("views_swap_sides", "", body.confidence,
                               "all cameras list left as right in " +
                                   Counted(body.frame_end - body.frame_begin, "frame") + ": " + body.evidence);
    fault.limb = "body";
    fault.frame_begin = body.frame_begin;
    fault.frame_end = body.frame_end;
    fault.confidence = body.confidence;
    fault.confidence_of = ConfidenceOf::kModel;
    fault.corrected = audit.sides == AuditAction::kCorrect && !files_wrong;
    found.findings.push_back(FindingOf(fault));
    found.report.suspect = found.report.suspect || IsAmbiguous(fault);
    found.report.faults.push_back(fault);
    if (!fault.corrected) continue;
    ExchangeJoints(left, body.frame_begin, body.frame_end, tracks);
    found.exchanged.resize(tracks.confidence.size(), false);
    for (int f = body.frame_begin; f < body.frame_end; ++f) {
      for (const int joint : left) {
        const std::size_t first = static_cast<std::size_t>(f) * static_cast<std::size_t>(tracks.joints());
        found.exchanged[first + static_cast<std::size_t>(joint)] = true;
        found.exchanged[first + static_cast<std::size_t>(tracks.skeleton->joints[joint].mirror)] = true;
      }
    }
  }
  return {};
}

/// Exchanges limbs back that all views label as the other side, by steps and bone lengths. Nothing is exchanged where
/// the audit forbids it, or where files are wrong.
RepairedTracks CorrectLimbsOfBody(const BodyTracks& found, const std::vector<double>& bones,
                                  const FittingOptions& options) {
  const bool may = options.repair.swaps && options.keypoints.audit.sides == AuditAction::kCorrect &&
                   !FilesAreExchanged(found.report.faults);
  if (!may) return RepairedTracks{found.tracks, {}, {}, {}};
  return RepairLimbs(found.tracks, bones, EstimateNoise(found.tracks, bones).sigma, options.repair);
}

/// Adds a constant error of the whole to all positions.
void AddToCovariances(const Matrix3d& c, Motion& motion) {
  std::array<float, 6> added{};
  ToSixNumbers(c, added.data());
  for (std::size_t i = 0; i < motion.position_cov.size(); ++i) motion.position_cov[i] += added[i % 6];
}

}  // namespace

Expected<BodyTracks> TracksOnBody(const Evidence& evidence, const Skeleton& skeleton, const SkeletonPtr& body,
                                  const KeypointFitOptions& options) {
  Expected<KeypointTracks> found = TriangulateKeypoints(evidence, skeleton, options);
  if (!found) return Forward(found);
  Expected<SkeletonTracks> mapped = MapTracks(TracksOfBody(found->tracks, *body), body);
  if (!mapped) return Forward(mapped);
  mapped->precision = PrecisionOnBody(*found, *body);
  BodyTracks tracks{std::move(*mapped), std::move(found->report), std::move(found->findings), {}};
  if (options.audit.sides != AuditAction::kOff && options.audit.rules.on(FittingRule::kBodySides)) {
    if (Status corrected = CorrectLeftRight(evidence, skeleton, options, tracks); !corrected) return Forward(corrected);
  }
  return tracks;
}

Expected<FitResult> FitKeypointsOnBody(const Evidence& evidence, const FrameRate& rate, const SkeletonPtr& skeleton,
                                       const SkeletonPtr& body, const std::vector<double>& bone_length,
                                       const FittingOptions& options) {
  Expected<BodyTracks> found = TracksOnBody(evidence, *skeleton, body, options.keypoints);
  if (!found) return Forward(found);
  if (!bone_length.empty()) {
    Expected<std::optional<Finding>> size = CheckSize(found->tracks, bone_length, "keypoints");
    if (!size) return Forward(size);
    if (*size) found->findings.push_back(**std::move(size));
  }
  const std::vector<double> bones =
      bone_length.empty() ? EstimateBoneLengths({found->tracks}, *body, true).length : bone_length;
  const RepairedTracks repaired = CorrectLimbsOfBody(*found, bones, options);
  Expected<FitResult> fit = FitJointTracks(repaired.tracks, rate, bones, options.joint_tracks);
  if (!fit) return fit;
  for (Finding& finding : FindUnexplainedJoints(repaired.tracks, fit->motion.joints))
    fit->findings.push_back(std::move(finding));
  MarkRepaired(found->exchanged, fit->motion);
  ReportRepairs(repaired, *fit);
  if (options.rules.on(FittingRule::kAmbiguousRigCovariance))
    AddToCovariances(found->report.place_covariance, fit->motion);
  if (!found->report.faults.empty()) fit->rig_audit = FaultsText(found->report.faults);
  fit->keypoints = std::move(found->report);
  fit->findings.insert(fit->findings.begin(), found->findings.begin(), found->findings.end());
  fit->triangulated = WithoutDetectorPoints(found->tracks, skeleton);
  for (Finding& finding : FindImplausibleBody(*fit->triangulated)) fit->findings.push_back(std::move(finding));
  return fit;
}

Expected<FitResult> FitKeypoints(const Evidence& evidence, const FrameRate& rate, const SkeletonPtr& skeleton,
                                 const SkeletonPtr& body, const std::vector<double>& bone_length,
                                 const FittingOptions& options) {
  Expected<FitResult> fit = FitKeypointsOnBody(evidence, rate, skeleton, body, bone_length, options);
  if (fit) fit->motion = WithoutDetectorPoints(fit->motion, skeleton);
  return fit;
}

}  // namespace mocurate
