#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/sha256.h"
#include "core/base/version.h"
#include "core/body/capsule_body.h"
#include "core/motion/gaps.h"
#include "core/store/store.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/clouds/joint_cloud_fit.h"
#include "fitting/contacts/foot_contacts.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/evidence/motion_tracks.h"
#include "fitting/fit_outcome.h"
#include "fitting/keypoint_cloud_fit.h"
#include "fitting/proportions.h"
#include "fitting/repair/track_repairs.h"
#include "fitting/rig_file.h"
#include "fitting/solver_check.h"
#include "fitting/stages.h"

namespace mocurate {
namespace {

/// The person's body; without a proportions artifact `skeleton` and no lengths.
Expected<PersonBody> ReadBody(const StageRequest& request, const SkeletonPtr& skeleton) {
  for (const StageInput& input : request.inputs) {
    if (input.role != "proportions") continue;
    const Expected<nlohmann::json> json = ReadJson(input.path);
    if (!json) return Forward(json);
    return BodyFromJson(*json, skeleton, "proportions of " + input.name);
  }
  return PersonBody{skeleton, {}};
}

/// Fits joint tracks and depth views of the same times.
Expected<FitResult> FitTracksAndDepth(const Clip& clip, const SkeletonPtr& skeleton, const std::vector<double>& bones,
                                      const FittingOptions& options) {
  FittingOptions with_poses = options;
  with_poses.joint_tracks.poses = true;
  Expected<FitResult> tracks = FitTracksOfClip(clip, skeleton, bones, with_poses);
  if (!tracks) return Forward(tracks);
  const Expected<SkeletonTracks> seen = TracksOfClip(clip, skeleton, options.other_joints);
  if (!seen) return Forward(seen);
  DepthRigReport report;
  const Expected<Clip> audited = WithAuditedRig(clip, options.point_clouds.audit, report);
  if (!audited) return Forward(audited);
  const std::vector<double>& depth_s = SurfaceTimes(audited->evidence);
  if (Status one = CheckOneClock(seen->time_s, depth_s, clip.rate.FrameTime(1), clip.id()); !one) return Forward(one);
  const Expected<std::vector<FusedCloud>> clouds = FuseClip(*audited, options.point_clouds);
  if (!clouds) return Forward(clouds);
  Expected<FitResult> both = FitTracksAndClouds(*std::move(tracks), *clouds, options.point_clouds);
  if (!both) return InClip(both.error(), clip);
  ReportRig(std::move(report), *both);
  return both;
}

Expected<FitResult> Fit(const StageRequest& request, const Clip& clip, const FittingOptions& options) {
  if (options.method == FitMethod::kNone) return TakeGivenMotion(clip);
  const Expected<SkeletonPtr> skeleton = LoadSkeleton(options.skeleton);
  if (!skeleton) return Forward(skeleton);
  if (options.method == FitMethod::kKeypoints || options.method == FitMethod::kKeypointsAndClouds) {
    const SkeletonPtr body = WithDetectorPoints(*skeleton, DetectorNames(clip.evidence.keypoint_names));
    const Expected<PersonBody> own = ReadBody(request, body);
    if (!own) return Forward(own);
    if (options.method == FitMethod::kKeypoints)
      return FitKeypointsOfClip(clip, *skeleton, own->skeleton, own->bone_length, options);
    return FitKeypointsAndClouds(clip, *skeleton, own->skeleton, own->bone_length, options);
  }
  const bool clouds_alone = options.method == FitMethod::kPointClouds;
  const Expected<PersonBody> body = ReadBody(request, clouds_alone ? *skeleton : WithTrackerPoints(*skeleton, clip));
  if (!body) return Forward(body);
  const std::vector<double>& bones = body->bone_length;
  if (clouds_alone) return FitClouds(clip, body->skeleton, bones, options.point_clouds);
  if (options.method == FitMethod::kJointsAndClouds) return FitTracksAndDepth(clip, body->skeleton, bones, options);
  return FitTracksOfClip(clip, body->skeleton, bones, options, body->place_sigma);
}

/// Whether a clip is in the share that both solvers fit, by the hash of its id.
bool IsChecked(const Clip& clip, double share) {
  constexpr double kAll = 4294967296.0;  ///< number, of values of eight hexadecimal digits (numerical)
  return static_cast<double>(std::stoul(Sha256Hex(clip.id()).substr(0, 8), nullptr, 16)) < share * kAll;
}

/// Compares a fit with that of the other solver: the same searches by the banded solver, then each solve that counts
/// from the same start (of a mixture: the tracks', then the depth's from its own tracks).
/// As CheckOfSolvers; errors kInterrupted, kInternal.
Expected<nlohmann::json> CompareSolvers(const StageRequest& request, const Clip& clip, FittingOptions options,
                                        FitResult& fit) {
  const bool banded = options.solver == PoseSolver::kBanded;
  options.UseSolver(banded ? PoseSolver::kCeres : PoseSolver::kBanded);
  const std::string solver = banded ? "ceres" : "banded";
  const Expected<FitResult> other = Fit(request, clip, options);
  if (!other && EndsAll(other.error().code)) return Forward(other);
  const bool same = options.method == FitMethod::kJointTracks || options.method == FitMethod::kKeypoints;
  return CheckOfSolvers(fit, solver, other, same ? SolverMatches::kFixed : SolverMatches::kOwn, fit.findings);
}

/// Whether the finding reports that ingest excluded images of a depth camera.
bool LeavesViewOut(const Finding& finding) {
  constexpr const char* kCodes[] = {"depth_excluded", "view_excluded", "no_person_in_view", "camera_missing",
                                    "camera_not_calibrated"};
  return std::find(std::begin(kCodes), std::end(kCodes), finding.code) != std::end(kCodes);
}

/// Error kInconsistent, with reasons, where ingest excluded all depth views of a clip.
Status CheckDepthIsLeft(const Clip& clip, const std::vector<Finding>& findings, FitMethod method) {
  const bool wanted = method == FitMethod::kPointClouds || method == FitMethod::kJointsAndClouds;
  if (!wanted || !SurfaceTimes(clip.evidence).empty()) return {};
  std::string why;
  for (const Finding& finding : findings) {
    if (LeavesViewOut(finding)) why += (why.empty() ? "" : "; ") + finding.message;
  }
  if (why.empty()) return {};
  return Fail(ErrorCode::kInconsistent, "ingest excluded all depth views of the clip: " + why, clip.id(),
              clip.evidence.tracks ? "complete the images, or fit the tracks alone: fitting.method joint_tracks"
                                   : "complete the images, or exclude the clip");
}

Expected<SlidingRemoval> RemoveSliding(const ContactOptions& options, const std::string& clip, Motion& motion) {
  if (motion.joints_only()) {
    return Fail(ErrorCode::kInconsistent, "foot sliding cannot be removed from a motion without rotations", clip,
                "set fitting.method to joint_tracks, or remove fitting.contacts.remove_sliding");
  }
  return RemoveFootSliding(options, motion);
}

/// Re-references rotations to the rest pose of the named skeleton, whatever the person's bone directions.
Status CountFromNamed(const FittingOptions& options, Motion& motion) {
  if (options.method == FitMethod::kNone) return {};
  const Expected<SkeletonPtr> named = LoadSkeleton(options.skeleton);
  if (!named) return Forward(named);
  auto rest_pose = std::make_shared<Skeleton>(*motion.skeleton);
  bool own = false;
  for (Joint& joint : rest_pose->joints) {
    const std::optional<int> at = (*named)->FindJoint(joint.name);
    if (!at) continue;
    const Vector3d& offset = (*named)->joints[static_cast<std::size_t>(*at)].rest_offset;
    own = own || joint.rest_offset != offset;
    joint.rest_offset = offset;
  }
  if (own) motion.rotation_reference = std::move(rest_pose);
  return {};
}

/// Frames without an observation in the given motion stay inferred, also at the edge of a clip that was cut in a gap.
void KeepInferred(const Motion& given, Motion& fitted) {
  if (fitted.state.empty() || given.frame_count() != fitted.frame_count()) return;
  const auto joints = static_cast<std::ptrdiff_t>(fitted.joint_count());
  for (const FrameRun& run : RunsWhere(InferredFrames(given), true)) {
    std::fill(fitted.state.begin() + run.begin * joints, fitted.state.begin() + run.end * joints,
              JointState::kInferred);
  }
}

}  // namespace

Expected<StageOutcome> FittingStage(const StageRequest& request) {
  Expected<FittingOptions> options = OptionsFromJson<FittingOptions>(request.options, "fitting");
  if (!options) return Forward(options);
  const StageInput* rig = RigInput(request);
  if (rig != nullptr) options->keypoints.rig = rig->path;
  const StageInput* evidence = nullptr;
  for (const StageInput& input : request.inputs) {
    if (input.role == "evidence") evidence = &input;
  }
  if (evidence == nullptr) return Fail(ErrorCode::kInternal, "fitting got no evidence", request.item);
  Dataset dataset;
  Expected<Clip> clip = ReadEvidence(evidence->path, &dataset.findings);
  if (!clip) return Forward(clip);
  ResolveDepthFiles(request, clip->evidence);
  options->joint_tracks.max_gap_s = MaxGapOf(*clip);
  const bool no_depth = SurfaceTimes(clip->evidence).empty();
  if (no_depth && options->without_depth == WithoutDepth::kTracks && options->method == FitMethod::kJointsAndClouds) {
    options->method = FitMethod::kJointTracks;
  }
  if (Status left = CheckDepthIsLeft(*clip, dataset.findings, options->method); !left) return Forward(left);
  Expected<FitResult> fit = Fit(request, *clip, *options);
  if (!fit) return fit.error().where.rfind("frame", 0) == 0 ? InClip(fit.error(), *clip) : Forward(fit);
  if (Status explained = CheckExplained(*fit, clip->id()); !explained) return Forward(explained);
  nlohmann::json check;
  if (options->method != FitMethod::kNone && fit->iterations > 0 && IsChecked(*clip, options->check)) {
    auto compared = CompareSolvers(request, *clip, *options, *fit);
    if (!compared) return Forward(compared);
    check = std::move(*compared);
  }
  if (Status counted = CountFromNamed(*options, fit->motion); !counted) return Forward(counted);
  if (options->method != FitMethod::kNone) MarkShortGaps(options->joint_tracks.max_gap_s, fit->motion);
  if (clip->motion) KeepInferred(*clip->motion, fit->motion);

  std::optional<SlidingRemoval> removal;
  if (options->contacts.remove_sliding) {
    const Expected<SlidingRemoval> removed = RemoveSliding(options->contacts, clip->id(), fit->motion);
    if (!removed) return Forward(removed);
    removal = *removed;
  }

  StageOutcome outcome = OutcomeOfFit(*clip, *fit, *options);
  if (!check.is_null()) outcome.summary["check"] = std::move(check);
  if (removal) outcome.summary["contacts"] = SlidingJson(*removal, *fit->motion.skeleton);
  dataset.created_by = CreatedBy();
  dataset.skeleton = fit->motion.rest_pose();
  dataset.joints_only = fit->motion.joints_only();
  dataset.findings.insert(dataset.findings.end(), outcome.findings.begin(), outcome.findings.end());
  clip->fit_rms = fit->residual_rms;
  clip->motion = std::move(fit->motion);
  clip->evidence = Evidence{};
  if (clip->evidence_sha256.empty()) clip->evidence_sha256 = evidence->sha256;
  clip->provenance["fitting"] = options->method == FitMethod::kNone ? "given motion" : CreatedBy();
  if (!fit->track_repairs.empty()) clip->provenance[kTrackRepairs] = fit->track_repairs;
  if (rig != nullptr) clip->provenance[kRigFile] = rig->sha256;
  if (!fit->rig_audit.empty()) clip->provenance[kRigAudit] = fit->rig_audit;
  if (!fit->capsule_radii.empty()) clip->provenance[kCapsuleRadii] = fit->capsule_radii;
  dataset.clips.push_back(std::move(*clip));
  if (Status written = WriteDataset(dataset, request.output); !written) return Forward(written);
  return outcome;
}

}  // namespace mocurate
