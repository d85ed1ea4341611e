#include "fitting/clouds/fit_clouds.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/motion/limbs.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/cloud_smoothing.h"
#include "fitting/clouds/cloud_start.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/cloud_uncertainty.h"
#include "fitting/fit_result.h"

namespace mocurate {
namespace {

constexpr double kObservingArea = 0.0023;   ///< m^2 of points on a joint's capsules from which it is observed
constexpr double kOwnShare = 1.0 / 3.0;     ///< of a bone: the part that counts to the joint
constexpr std::size_t kFewestMatches = 30;  ///< points near the body; fewest of a frame that is fitted (numerical)
constexpr double kNotableRoom = 0.02;       ///< share of the points of floor and walls, from which a finding is written
/// Share of the points far from the body, from which a finding is written.
constexpr double kNotableFar = 0.05;
constexpr double kContradictingShare = 0.15;  ///< of the points, from which a given height is wrong
constexpr double kHardlyEver = 0.1;           ///< share of the frames, up to which a limb counts as unobserved
constexpr double kClearMargin =
    0.1;  ///< relative cost difference up to which the facing of the first pose is ambiguous

/// Number of points (CoverageSample) that observe each joint. For a joint with a single child: points within a third of
/// the bone on either side of the joint. For others (hands, head, trunk): all points of capsules that move with it.
/// Points on the knee's third of a shin do not observe the ankle.
std::vector<int> PointsOfJoints(const CapsuleBody& body, const PoseState& state, int frame, const FusedCloud& cloud,
                                const std::vector<CloudMatch>& matches, double voxel_size) {
  const auto children = body.skeleton->Children();
  std::vector<int> points(body.skeleton->joints.size(), 0);
  const std::vector<bool> sample = CoverageSample(cloud, voxel_size);
  for (const CloudMatch& match : matches) {
    if (!sample[static_cast<std::size_t>(match.point)]) continue;
    const BodyCapsule& capsule = body.capsules[match.capsule];
    const int child = capsule.end_joint != capsule.frame ? capsule.end_joint : OnlyChild(children, capsule.frame);
    if (child < 0) {
      ++points[capsule.frame];
      continue;
    }
    const Vector3d& begin = state.position(frame, capsule.frame);
    const Vector3d bone = state.position(frame, child) - begin;
    const double place = bone.dot(cloud.points.col(match.point) - begin) / std::max(1e-12, bone.squaredNorm());
    if (place < kOwnShare) ++points[capsule.frame];
    if (place > 1.0 - kOwnShare) ++points[child];
  }
  return points;
}

/// What the views observe in a track's frames.
struct Shown {
  std::vector<bool> joint;       ///< (F*J) enough points for the joint
  std::vector<double> error;     ///< (F) LowCoverageSigma, m; 0 without a fit
  std::vector<double> residual;  ///< (F) root mean square, m; 0 without a fit
};

/// Residuals and joint states of all frames.
Shown Measure(const CloudTrack& track, const PointCloudOptions& options, FitResult& result) {
  Shown shown;
  std::vector<double> residuals;
  const double area = CoverageOfPoint(options.voxel_size);
  const double scale = BodyScale(*result.motion.skeleton, result.motion.bone_length);
  for (int f = 0; f < track.state.frames(); ++f) {
    const bool is_fitted = track.outcomes[f].iterations > 0;
    std::vector<CloudMatch> matches;
    if (is_fitted) matches = MatchPoints(track.body, track.state, f, track.clouds[f], options.max_distance);
    shown.error.push_back(is_fitted ? LowCoverageSigma(track.clouds[f], options, scale) : 0.0);
    for (const int points : PointsOfJoints(track.body, track.state, f, track.clouds[f], matches, options.voxel_size)) {
      shown.joint.push_back(points * area >= kObservingArea);
      const bool is_observed = shown.joint.back() && shown.error.back() <= kUnobservedError;
      result.motion.state.push_back(is_observed ? JointState::kObserved : JointState::kInferred);
    }
    for (const CloudMatch& match : matches) residuals.push_back(std::abs(match.distance));
    shown.residual.push_back(ResidualOf(matches));
  }
  SetResiduals(std::move(residuals), result);
  return shown;
}

/// The tracked frames, fitted together (SmoothChain). The rest gets the pose of a neighbour.
struct SmoothedTrack {
  std::vector<FrameFit> chain;
  SmoothedChain smoothed;
};

/// Frames whose points are hardly any near the body count as frames without a fit.
Expected<SmoothedTrack> Smooth(const std::vector<double>& time_s, const PointCloudOptions& options, CloudTrack& track) {
  SmoothedTrack result;
  track.state.Update(0, track.state.frames(), false);
  for (int f = 0; f < track.state.frames(); ++f) {
    if (track.outcomes[f].iterations == 0) continue;
    if (MatchPoints(track.body, track.state, f, track.clouds[f], options.max_distance).size() < kFewestMatches) {
      track.outcomes[f] = {};
      continue;
    }
    FrameFit fit;
    fit.frame = f;
    result.chain.push_back(fit);
  }
  auto smoothed = SmoothChain(track.body, track.clouds, result.chain, time_s, options, track.state);
  if (!smoothed) return Forward(smoothed);
  result.smoothed = *std::move(smoothed);
  FillFrames(track);
  track.state.Update(0, track.state.frames(), false);
  return result;
}

void AddUncertainty(SmoothedTrack track, const Shown& shown, const PointCloudOptions& options, FitResult& result) {
  const Motion& motion = result.motion;
  UncertainMotion uncertain(motion.frame_count(), motion.joint_count());
  const std::vector<double> usual =
      BodyErrors(*motion.skeleton, BodyScale(*motion.skeleton, motion.bone_length), options.rules);
  for (std::size_t i = 0; i < track.chain.size(); ++i) {
    const int f = track.chain[i].frame;
    CloudUncertainty& uncertainty = track.smoothed.uncertainty[i];
    std::vector<double> body_error = usual;
    const double factor = BodyErrorFactor(shown.residual[f], options.rules);
    for (double& error : body_error) error = std::hypot(factor * error, shown.error[f]);
    const std::vector<Vector3d> body_rotation =
        BodyRotations(*motion.skeleton, motion.bone_length, body_error, options.rules);
    const auto begin = shown.joint.begin() + static_cast<std::ptrdiff_t>(f) * motion.joint_count();
    if (options.rules.on(FittingRule::kUnobservedFactor))
      WidenGaps({begin, begin + motion.joint_count()}, uncertainty, body_error);
    uncertain.Set(f, uncertainty, body_error, body_rotation);
  }
  uncertain.Write(result.motion);
}

void ReportUntrackedFrames(const CloudTrack& track, FitResult& result) {
  std::vector<bool> without;
  for (const auto& outcome : track.outcomes) without.push_back(outcome.iterations == 0);
  ReportFramesWithout(without, "too few depth points, pose of the previous or next frame used", result.findings);
}

/// Reports arms and legs that the views almost never observe. Their pose is an assumption, and their parent joint is
/// uncertain.
void ReportUnobservedLimbs(const Shown& shown, FitResult& result) {
  const Motion& motion = result.motion;
  const Limbs limbs = LimbsOf(*motion.skeleton);
  std::string names;
  int unobserved = 0;
  for (const auto* pair : {&limbs.arm, &limbs.leg}) {
    for (const Limb& limb : *pair) {
      if (!limb.known()) continue;
      int frames = 0;
      for (int f = 0; f < motion.frame_count(); ++f) {
        const auto at = static_cast<std::size_t>(f) * motion.joint_count() + static_cast<std::size_t>(limb.middle);
        frames += shown.joint[at] ? 1 : 0;
      }
      if (frames > kHardlyEver * motion.frame_count()) continue;
      names += (unobserved++ > 0 ? ", " : "") + motion.skeleton->joints[limb.middle].name;
    }
  }
  if (unobserved == 0) return;
  result.findings.push_back(MakeFinding(
      "limb_never_seen", Severity::kWarning, unobserved,
      "the views almost never show " + names +
          " and the joints below: their pose is an assumption, their parent joints are uncertain, and the "
          "person may be taller than this body; inferred; set fitting.point_clouds.height and start.posture if known",
      FindingAction::kKept));
}

/// Reports points that were classified as room, and points of the person far from the body.
void ReportPointsOffTheBody(const CloudTrack& track, const PointCloudOptions& options, FitResult& result) {
  double room = 0.0;
  double far = 0.0;
  double all = 0.0;
  for (int f = 0; f < track.state.frames(); ++f) {
    if (track.outcomes[f].iterations == 0) continue;
    const FusedCloud& cloud = track.clouds[f];
    all += cloud.size() + cloud.excluded;
    room += cloud.excluded;
    far +=
        cloud.size() - static_cast<double>(MatchPoints(track.body, track.state, f, cloud, options.max_distance).size());
  }
  const auto report = [&](double points, double share, const char* code, const char* message, FindingAction action) {
    if (points <= share * all) return;
    result.findings.push_back(MakeFinding(code, Severity::kWarning, points / all,
                                          std::to_string(std::lround(100.0 * points / all)) + message, action));
  };
  report(room, kNotableRoom, "points_of_the_room", " % of the depth points are floor or separate from the person",
         FindingAction::kExcluded);
  report(far, kNotableFar, "points_off_the_body", " % of the person's points lie far from the fitted body",
         FindingAction::kFlagged);
  if (!options.height || far <= kContradictingShare * all) return;
  result.findings.push_back(
      MakeFinding("height_contradicted", Severity::kError, *options.height,
                  "a body of the given height, " + RoundedText(*options.height, 3) + " m, leaves " +
                      std::to_string(std::lround(100.0 * far / all)) +
                      " % of the person's points unexplained; flagged; check fitting.point_clouds.height, or remove it",
                  FindingAction::kKept));
}

/// A body of capsules looks much the same from the front and from the back.
void ReportAmbiguous(const CloudTrack& track, FitResult& result) {
  if (!track.start.margin || *track.start.margin > kClearMargin) return;
  result.findings.push_back(
      MakeFinding("facing_ambiguous", Severity::kWarning, *track.start.margin,
                  "a first pose that faces another way explains the points almost as well: its cost is " +
                      std::to_string(std::lround(100.0 * *track.start.margin)) +
                      " % higher; the cheaper one is kept; set fitting.point_clouds.start.facing if known",
                  FindingAction::kKept));
}

void ReportContradiction(const CloudTrack& track, FitResult& result) {
  if (!track.start.off_facing) return;
  result.findings.push_back(
      MakeFinding("facing_contradicted", Severity::kWarning, *track.start.off_facing,
                  "every first pose that explains the points contradicts the given facing: the cheapest by " +
                      std::to_string(std::lround(kDegrees * *track.start.off_facing)) +
                      " degrees; the cheapest one is kept; check fitting.point_clouds.start.facing",
                  FindingAction::kKept));
}

}  // namespace

Expected<FitResult> FitClouds(const Clip& clip, const SkeletonPtr& skeleton, const std::vector<double>& bone_length,
                              const PointCloudOptions& options) {
  DepthRigReport report;
  const Expected<Clip> audited = WithAuditedRig(clip, options.audit, report);
  if (!audited) return Forward(audited);
  Expected<std::vector<FusedCloud>> clouds = FuseClip(*audited, options);
  if (!clouds) return Forward(clouds);
  Expected<FitResult> fit =
      FitFusedClouds(std::move(*clouds), {clip.rate, SurfaceTimes(audited->evidence)}, skeleton, bone_length, options);
  if (fit) ReportRig(std::move(report), *fit);
  return fit;
}

void ReportRig(DepthRigReport report, FitResult& fit) {
  const std::vector<Finding> findings = FindingsOf(report);
  fit.findings.insert(fit.findings.begin(), findings.begin(), findings.end());
  if (!report.faults.empty()) fit.rig_audit = FaultsText(report.faults);
  fit.depth_rig = std::move(report);
}

Expected<FitResult> FitFusedClouds(std::vector<FusedCloud> clouds, const CloudClock& clock, const SkeletonPtr& skeleton,
                                   const std::vector<double>& bone_length, const PointCloudOptions& options) {
  auto track = TrackClouds(std::move(clouds), skeleton, bone_length.empty() ? skeleton->RestBoneLengths() : bone_length,
                           clock.time_s, options);
  if (!track) return Forward(track);
  Expected<SmoothedTrack> smoothed = Smooth(clock.time_s, options, *track);
  if (!smoothed) return Forward(smoothed);
  FitResult result;
  result.motion = MotionOf(track->state, track->body.skeleton, clock.rate);
  result.capsule_radii = RadiiText(track->body);
  const Shown shown = Measure(*track, options, result);
  const bool settled = smoothed->smoothed.settled;
  result.initial_cost = smoothed->smoothed.initial_cost;
  result.final_cost = smoothed->smoothed.final_cost;
  if (options.uncertainty) AddUncertainty(*std::move(smoothed), shown, options, result);
  ReportAmbiguous(*track, result);
  ReportContradiction(*track, result);
  ReportUntrackedFrames(*track, result);
  ReportUnobservedLimbs(shown, result);
  ReportLowCoverage(shown.error, result.findings);
  ReportPoorlyExplained(shown.residual, result.findings);
  ReportPointsOffTheBody(*track, options, result);
  int unsettled = 0;
  for (const CapsuleFitOutcome& outcome : track->outcomes) {
    result.iterations += outcome.iterations;
    if (outcome.iterations > 0 && !outcome.converged) ++unsettled;
  }
  result.converged = unsettled == 0 && settled;
  result.termination = "converged";
  if (unsettled > 0) {
    result.termination =
        "iteration limit in " + std::to_string(unsettled) + " of " + std::to_string(track->outcomes.size()) + " frames";
  } else if (!settled) {
    result.termination = kUnsettledChain;
  }
  return result;
}

}  // namespace mocurate
