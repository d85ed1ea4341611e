#include "fitting/fit_outcome.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "core/base/text.h"
#include "core/motion/motion.h"
#include "core/motion/operations.h"
#include "core/quality/measures.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/evidence/implausible_body.h"
#include "fitting/evidence/motion_tracks.h"
#include "fitting/evidence/noise.h"
#include "fitting/keypoint_fit.h"
#include "fitting/proportions.h"
#include "fitting/repair/track_repairs.h"
#include "fitting/solver/body_size.h"
#include "fitting/solver/joint_track_fit.h"
#include "fitting/uncertainty/pose_posterior.h"

namespace mocurate {
namespace {

/// A motion fitted to the joints of a given one is not more certain than that. Adds the given motion's stated
/// covariances to those of `fitted`, which are relative to the given joints: of the same joints, else of the nearest
/// parent that it has. Variances of rotations likewise, for joints that both have, up to the prior's. A sample that the
/// given motion interpolated or inferred does not count as observed. Without stated uncertainties nothing changes. Both
/// have the same frames; skeletons may differ.
void AddGivenUncertainty(const Motion& given, Motion& fitted) {
  const std::vector<int> match = MatchJoints(*given.skeleton, *fitted.skeleton);
  std::vector<int> nearest = match;
  for (int j = 1; j < fitted.joint_count(); ++j) {
    if (nearest[j] < 0) nearest[j] = nearest[fitted.skeleton->joints[j].parent];
  }
  for (int f = 0; f < fitted.frame_count(); ++f) {
    for (int j = 0; j < fitted.joint_count(); ++j) {
      if (nearest[j] < 0) continue;
      const std::size_t from = static_cast<std::size_t>(f) * given.joint_count() + nearest[j];
      const std::size_t to = static_cast<std::size_t>(f) * fitted.joint_count() + j;
      if (!given.position_cov.empty() && !fitted.position_cov.empty()) {
        for (std::size_t i = 0; i < 6; ++i) fitted.position_cov[6 * to + i] += given.position_cov[6 * from + i];
      }
      if (match[j] < 0) continue;
      if (!given.rotation_sigma.empty() && !fitted.rotation_sigma.empty()) {
        for (std::size_t i = 0; i < 3; ++i) {
          WidenRotation(Square(given.rotation_sigma[3 * from + i]), fitted.rotation_sigma[3 * to + i],
                        fitted.rotation_observed[3 * to + i]);
        }
      }
      if (!given.state.empty() && !fitted.state.empty()) {
        fitted.state[to] = std::max(fitted.state[to], given.state[from]);
      }
    }
  }
}

/// m RMS; beyond, skeleton and evidence hardly match. Source: 3DPCK, Mehta et al., 3DV 2017
constexpr double kLargeResidual = 0.15;
/// Share of the frames without any observation; beyond, the clip is suspect. Source: 1,213 recorded clips
/// (docs/fitting.md)
constexpr double kMaxUnobservedShare = 0.3;
/// Share of samples that are outliers; beyond, the clip is suspect. Source: 1,213 recorded clips (docs/fitting.md)
constexpr double kMostRejected = 0.25;
constexpr double kNoFit = 0.3;            ///< metres, median of the joints: beyond, the fit explains nothing
constexpr double kNoFitOfStature = 0.25;  ///< share of the stature, likewise

double Millimetres(double metres) { return std::round(metres * 1e7) / 1e4; }

/// Of a body whose size was measured from depth views.
std::optional<Finding> SuspectSize(const FitResult& fit, const FittingOptions& options) {
  const bool height_given = options.point_clouds.height.has_value();
  if (!fit.depth_rig || height_given || options.method == FitMethod::kJointsAndClouds) return {};
  const Skeleton& skeleton = *fit.motion.skeleton;
  const double stature = Stature(skeleton, fit.motion.bone_length);
  return CheckStature(stature, stature / Stature(skeleton, skeleton.RestBoneLengths()));
}

Finding ExcludedJoints(const std::vector<std::string>& names, const Skeleton& skeleton) {
  return MakeFinding("joints_excluded", Severity::kWarning, static_cast<double>(names.size()),
                     "skeleton '" + skeleton.name + "' has no " + JoinTexts(names), FindingAction::kExcluded);
}

/// Frames in which tracks were corrected, by the code of the finding, and the number of samples rejected as outliers.
nlohmann::json RepairCounts(const FitResult& fit) {
  std::map<std::string, std::vector<bool>> repaired_frames;
  double outliers = 0.0;
  const auto frames = static_cast<std::size_t>(fit.motion.frame_count());
  for (const Finding& finding : fit.findings) {
    if (finding.code == kOutliersRejected) outliers += finding.value;
    if (finding.code == kOutliersRejected ||
        (finding.action != FindingAction::kRepaired && finding.action != FindingAction::kMissing))
      continue;
    for (const std::string& code : {finding.code, std::string("any")}) {
      std::vector<bool>& of_code = repaired_frames.emplace(code, std::vector<bool>(frames, false)).first->second;
      std::fill(of_code.begin() + finding.frame_begin, of_code.begin() + finding.frame_end, true);
    }
  }
  nlohmann::json counts = {{"outlier_samples", outliers}};
  for (const auto& [code, of_code] : repaired_frames)
    counts[code + "_frames"] = std::count(of_code.begin(), of_code.end(), true);
  return counts;
}

nlohmann::json StateCounts(const Motion& motion) {
  std::size_t counts[4] = {};
  for (const JointState state : motion.state) ++counts[static_cast<std::size_t>(state)];
  return {{"observed", counts[0]}, {"repaired", counts[1]}, {"interpolated", counts[2]}, {"inferred", counts[3]}};
}

nlohmann::json KeypointsJson(const KeypointReport& report) {
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  nlohmann::json points = nlohmann::json::object();
  for (std::size_t k = 0; k < report.keypoint_names.size(); ++k) {
    points[report.keypoint_names[k]] = rounded(report.keypoint_share[k]);
  }
  nlohmann::json cameras = nlohmann::json::object();
  for (std::size_t v = 0; v < report.cameras.size(); ++v) {
    const CameraAgreement& camera = report.cameras[v];
    cameras[report.camera_names[v]] = {{"detections", camera.detections},
                                       {"excluded", camera.excluded},
                                       {"median_px", rounded(camera.median_px)},
                                       {"disagrees", camera.disagrees}};
  }
  nlohmann::json residuals = nlohmann::json::object();
  for (std::size_t v = 0; v < report.residual_px.size(); ++v) {
    for (const double px : report.residual_px[v]) {
      const bool seen = px > 0.0;
      residuals[report.given_cameras[v]].push_back(seen ? nlohmann::json(rounded(px)) : nlohmann::json(nullptr));
    }
  }
  return {{"people", report.people},
          {"residual_px_over_time", residuals},
          {"faults", FaultsJson(report.faults)},
          {"seen_share", rounded(report.seen_share)},
          {"triangulated_share", rounded(report.triangulated)},
          {"triangulated_share_of", points},
          {"median_px", rounded(report.median_px)},
          {"p90_px", rounded(report.p90_px)},
          {"views_per_point", rounded(report.views)},
          {"cameras", cameras}};
}

nlohmann::json DepthRigJson(const DepthRigReport& report) {
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  nlohmann::json cameras = nlohmann::json::object();
  for (std::size_t v = 0; v < report.loss.size(); ++v) {
    nlohmann::json residuals = nlohmann::json::array();
    for (const double mm : report.residual_mm[v]) {
      residuals.push_back(mm > 0.0 ? nlohmann::json(rounded(mm)) : nlohmann::json(nullptr));
    }
    cameras[report.cameras[v]] = {{"residual_mm_over_time", residuals},
                                  {"contradicts", rounded(report.loss[v])},
                                  {"contradicts_after", rounded(report.loss_after[v])}};
  }
  return {{"frames", report.frames}, {"cameras", cameras}, {"faults", FaultsJson(report.faults)}};
}

}  // namespace

void ReportRepairs(const RepairedTracks& repaired, FitResult& fit) {
  fit.findings.insert(fit.findings.end(), repaired.findings.begin(), repaired.findings.end());
  if (repaired.repairs.empty()) return;
  MarkRepaired(repaired.exchanged, fit.motion);
  const Skeleton& skeleton = *repaired.tracks.skeleton;
  const std::vector<Finding> findings = FindingsOf(repaired.repairs, skeleton);
  fit.findings.insert(fit.findings.end(), findings.begin(), findings.end());
  fit.track_repairs = RepairsText(repaired.repairs, skeleton);
}

Expected<FitResult> RepairAndFit(const SkeletonTracks& given, const FrameRate& rate,
                                 const std::vector<double>& bone_length, const RepairOptions& repair,
                                 const JointTrackOptions& options) {
  const RepairedTracks repaired = RepairTracks(given, bone_length, EstimateNoise(given, bone_length).sigma, repair);
  Expected<FitResult> fit = FitJointTracks(repaired.tracks, rate, bone_length, options);
  if (!fit) return fit;
  for (Finding& finding : FindUnexplainedJoints(repaired.tracks, fit->motion.joints))
    fit->findings.push_back(std::move(finding));
  ReportRepairs(repaired, *fit);
  return fit;
}

Expected<FitResult> FitTracksOfClip(const Clip& clip, const SkeletonPtr& skeleton,
                                    const std::vector<double>& bone_length, const FittingOptions& options,
                                    const std::vector<double>& place_sigma) {
  std::vector<std::string> excluded;
  Expected<SkeletonTracks> tracks = TracksOfClip(clip, skeleton, options.other_joints, &excluded);
  if (!tracks) return Forward(tracks);
  if (!place_sigma.empty()) tracks->place_sigma = place_sigma;
  std::optional<Finding> size_differs;
  if (!bone_length.empty()) {
    Expected<std::optional<Finding>> size = CheckSize(*tracks, bone_length, clip.id());
    if (!size) return Forward(size);
    size_differs = *std::move(size);
  }
  if (Status body = CheckBody(*tracks, clip.id()); !body) return tl::unexpected<Error>(body.error());
  const std::vector<double> bones = bone_length.empty() ? skeleton->RestBoneLengths() : bone_length;
  Expected<FitResult> fit = RepairAndFit(*tracks, clip.rate, bones, options.repair, options.joint_tracks);
  if (!fit) return fit;
  for (Finding& finding : FindImplausibleBody(*tracks)) fit->findings.push_back(std::move(finding));
  if (size_differs) fit->findings.push_back(*std::move(size_differs));
  if (!excluded.empty()) fit->findings.push_back(ExcludedJoints(excluded, *skeleton));
  if (!clip.evidence.tracks && clip.motion) AddGivenUncertainty(*clip.motion, fit->motion);
  const SkeletonPtr plain = WithoutTrackerPoints(skeleton);
  if (plain != skeleton) fit->motion = WithoutDetectorPoints(fit->motion, plain);
  return fit;
}

Expected<FitResult> FitKeypointsOfClip(const Clip& clip, const SkeletonPtr& skeleton, const SkeletonPtr& body,
                                       const std::vector<double>& bone_length, const FittingOptions& options) {
  if (clip.evidence.keypoint_views.empty()) {
    return Fail(ErrorCode::kInconsistent, "the clip has no keypoints of calibrated views", clip.id(),
                clip.evidence.tracks ? "set fitting.method to joint_tracks for joint tracks"
                                     : "set fitting.method to the evidence that the source has");
  }
  Expected<FitResult> result = FitKeypoints(clip.evidence, clip.rate, skeleton, body, bone_length, options);
  if (!result) return InClip(result.error(), clip);
  return result;
}

void ResolveDepthFiles(const StageRequest& request, Evidence& evidence) {
  std::map<std::string, std::filesystem::path> files;
  for (const StageInput& input : request.inputs) {
    if (input.role == "depth") files[input.name] = input.path;
  }
  ResolveDepthFiles(files, evidence);
}

Expected<FitResult> TakeGivenMotion(const Clip& clip) {
  if (!clip.motion) {
    return Fail(ErrorCode::kInconsistent, "the clip has no given motion", clip.id(),
                "set fitting.method to joint_tracks or point_clouds");
  }
  FitResult result;
  result.motion = *clip.motion;
  result.converged = true;
  result.termination = "given";
  return result;
}

Status CheckExplained(const FitResult& fit, const std::string& where) {
  if (fit.residual_median <= 0.0) return {};
  const double stature = Stature(*fit.motion.skeleton, fit.motion.bone_length);
  const double most = std::min(kNoFit, kNoFitOfStature * stature);
  if (!(fit.residual_median > most)) return {};
  return Fail(ErrorCode::kInconsistent,
              "no pose of the person explains the joints: the median residual is " +
                  RoundedText(fit.residual_median, 3) + " m (limit: " + RoundedText(most, 3) +
                  " m), the 95th percentile " + RoundedText(fit.residual_p95, 3) + " m, the person " +
                  RoundedText(stature, 3) + " m tall",
              where, "check the unit, the order of the joints, the skeleton, and which person the clip shows");
}

/// Share of the frames in which no joint is observed or repaired. 0 where joints have no states.
double UnobservedShare(const Motion& motion) {
  if (motion.state.empty()) return 0.0;
  const auto joints = static_cast<std::ptrdiff_t>(motion.joint_count());
  int unobserved = 0;
  for (auto frame = motion.state.begin(); frame != motion.state.end(); frame += joints) {
    unobserved += std::none_of(frame, frame + joints, [](JointState state) {
      return state == JointState::kObserved || state == JointState::kRepaired;
    });
  }
  return static_cast<double>(unobserved) / motion.frame_count();
}

StageOutcome OutcomeOfFit(const Clip& clip, const FitResult& fit, const FittingOptions& options) {
  StageOutcome outcome;
  outcome.findings = fit.findings;
  if (!fit.converged) {
    outcome.findings.push_back(MakeFinding("fit_not_converged", Severity::kWarning, fit.iterations,
                                           "the fit stopped after " + Counted(fit.iterations, "iteration") +
                                               " at the cost " + RoundedText(fit.final_cost, 6) + ": " +
                                               fit.termination));
    outcome.kind = OutcomeKind::kSuspect;
  }
  if (!(fit.residual_rms <= kLargeResidual)) {
    outcome.findings.push_back(MakeFinding("large_residual", Severity::kWarning, Millimetres(fit.residual_rms),
                                           "the RMS residual of the body exceeds 150 mm: check skeleton and unit"));
    outcome.kind = OutcomeKind::kSuspect;
  }
  if (fit.rejected_share > kMostRejected) {
    outcome.findings.push_back(MakeFinding(
        "evidence_rejected", Severity::kWarning, fit.rejected_share,
        "more than 25 % of the evidence was rejected: it is far from the body of neighbouring frames. The residual "
        "excludes it. Check the skeleton, the order of the joints, and which person the clip shows"));
    outcome.kind = OutcomeKind::kSuspect;
  }
  if (const double share = UnobservedShare(fit.motion); share > kMaxUnobservedShare) {
    outcome.findings.push_back(
        MakeFinding("mostly_unobserved", Severity::kWarning, share,
                    "no joint is observed in " + std::to_string(std::lround(100.0 * share)) +
                        " % of the frames (limit: 30 %); exclude these frames, or train with the joints' states"));
    outcome.kind = OutcomeKind::kSuspect;
  }
  if (options.method != FitMethod::kNone) {
    for (Finding& finding : FindJointsBeyondLimits(fit.motion)) outcome.findings.push_back(std::move(finding));
  }
  if (auto size = SuspectSize(fit, options)) outcome.findings.push_back(std::move(*size));
  if (fit.keypoints && fit.keypoints->suspect) outcome.kind = OutcomeKind::kSuspect;
  if (fit.depth_rig && fit.depth_rig->IsAmbiguous()) outcome.kind = OutcomeKind::kSuspect;
  for (Finding& finding : outcome.findings) {
    finding.clip = clip.id();
    if (finding.severity == Severity::kError) outcome.kind = OutcomeKind::kSuspect;
  }

  const Skeleton& skeleton = *fit.motion.skeleton;
  outcome.summary = {{"method", Name(options.method)},
                     {"residual_rms_mm", Millimetres(fit.residual_rms)},
                     {"residual_p95_mm", Millimetres(fit.residual_p95)},
                     {"rejected_share", std::round(fit.rejected_share * 1e4) / 1e4},
                     {"noise_sigma_mm", Millimetres(fit.noise_sigma)},
                     {"variance_factor", std::round(fit.variance_factor * 1e3) / 1e3},
                     {"iterations", fit.iterations},
                     {"converged", fit.converged},
                     {"termination", fit.termination},
                     {"cost", std::round(fit.final_cost * 1e3) / 1e3},
                     {"states", StateCounts(fit.motion)},
                     {"repairs", RepairCounts(fit)},
                     {"after", MeasuresJson(MeasureMotion(fit.motion), skeleton)}};
  if (fit.keypoints) outcome.summary["keypoints"] = KeypointsJson(*fit.keypoints);
  if (fit.depth_rig) outcome.summary["depth_rig"] = DepthRigJson(*fit.depth_rig);
  const auto measure_before = [&](const SkeletonTracks& tracks) {
    outcome.summary["before"] =
        MeasuresJson(MeasureJoints(skeleton, tracks.positions, tracks.confidence, tracks.time_s), skeleton);
  };
  if (fit.triangulated) measure_before(*fit.triangulated);
  for (const Vector3d& joint : fit.other_pose) {
    const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
    outcome.summary["other_pose_m"].push_back({rounded(joint.x()), rounded(joint.y()), rounded(joint.z())});
  }
  if (fit.surface_weight) outcome.summary["surface_weight"] = std::round(*fit.surface_weight * 1e4) / 1e4;
  if (options.method == FitMethod::kJointTracks || options.method == FitMethod::kJointsAndClouds) {
    if (const auto tracks = TracksOfClip(clip, fit.motion.skeleton, options.other_joints)) measure_before(*tracks);
  }
  return outcome;
}

}  // namespace mocurate
