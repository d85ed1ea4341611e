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
/// s; points of this time share the errors of a pose, so that costs of two poses are compared once in it.
constexpr double kComparedEvery_s = 0.5;
constexpr std::size_t kOthersFitted = 3;  ///< other first poses from which the clip is fitted too, at most (numerical)

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

void AddUncertainty(const SmoothedTrack& track, const Shown& shown, const PointCloudOptions& options,
                    FitResult& result) {
  const Motion& motion = result.motion;
  UncertainMotion uncertain(motion.frame_count(), PriorInClouds(*motion.skeleton, options));
  for (std::size_t i = 0; i < track.chain.size(); ++i) {
    const int f = track.chain[i].frame;
    uncertain.Set(f, track.smoothed.uncertainty[i], shown.error[static_cast<std::size_t>(f)]);
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

using FitOfStart = std::pair<CloudTrack, SmoothedTrack>;  ///< from one first pose

/// Cost of one fit less that of the other, over moments that are independent.
CostDifference Compare(const FitOfStart& one, const FitOfStart& other, const std::vector<double>& time_s,
                       const PointCloudOptions& options) {
  CostDifference difference;
  double last = -kComparedEvery_s;
  for (const FrameFit& frame : one.second.chain) {
    const auto f = static_cast<std::size_t>(frame.frame);
    if (time_s[f] - last < kComparedEvery_s || other.first.outcomes[f].iterations == 0) continue;
    last = time_s[f];
    const FrameFit fit = ComparedFit(frame.frame, options.iterations);
    const FusedCloud& cloud = one.first.clouds[f];
    difference += Compare(cloud, PointCosts(one.first.body, cloud, fit, one.first.state, options),
                          PointCosts(other.first.body, cloud, fit, other.first.state, options));
  }
  return difference;
}

/// Mean distance of the joints of two motions, m.
double JointsApart(const PoseState& a, const PoseState& b) {
  double sum = 0.0;
  for (int f = 0; f < a.frames(); ++f) {
    for (int j = 0; j < a.joints(); ++j) sum += (a.position(f, j) - b.position(f, j)).norm();
  }
  return sum / (static_cast<double>(a.frames()) * a.joints());
}

/// Chance that the other pose is the right one, by the difference of costs in its standard deviations.
double ChanceOfOther(const CostDifference& more) {
  return 0.5 * std::erfc(more.sum / std::max(more.sigma(), 1e-12) / std::sqrt(2.0));
}

/// A body of capsules looks much the same from the front and from the back, and a limb may be another one.
void ReportAmbiguous(double chance, double apart, const PoseState& other, FitResult& result) {
  result.findings.push_back(
      MakeFinding(kAmbiguousPose, Severity::kWarning, chance,
                  "another pose, whose joints are in the mean " + std::to_string(std::lround(1e3 * apart)) +
                      " mm away, explains the points about as well (chance " + RoundedText(chance, 2) +
                      "); the cheaper one is kept, stated standard deviations cover both; set "
                      "fitting.point_clouds.start if the first pose is known, or add views",
                  FindingAction::kKept));
  for (int j = 0; j < other.joints(); ++j) result.other_pose.push_back(other.position(0, j));
}

/// Covers the other pose too: second moments about the pose that is reported, with the chance of each.
void CoverOther(const PoseState& pose, const PoseState& other, int frame, double chance, const PosePosterior& of_other,
                PosePosterior& posterior) {
  for (int j = 0; j < pose.joints(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const Vector3d apart = other.position(frame, j) - pose.position(frame, j);
    posterior.position[at] =
        (1.0 - chance) * posterior.position[at] + chance * (of_other.position[at] + apart * apart.transpose());
    const Vector3d turned = LogMatrix(pose.local(frame, j).transpose() * other.local(frame, j));
    posterior.rotation[at] =
        ((1.0 - chance) * posterior.rotation[at] + chance * (of_other.rotation[at] + turned.cwiseAbs2()))
            .cwiseMin(posterior.prior[at]);
  }
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
  const std::vector<double> bones = bone_length.empty() ? skeleton->RestBoneLengths() : bone_length;
  const auto fit = [&](std::vector<FusedCloud> given, const std::vector<double>* first_pose) -> Expected<FitOfStart> {
    auto track = TrackClouds(std::move(given), skeleton, bones, clock.time_s, options, first_pose);
    if (!track) return Forward(track);
    auto smoothed = Smooth(clock.time_s, options, *track);
    if (!smoothed) return Forward(smoothed);
    return FitOfStart{*std::move(track), *std::move(smoothed)};
  };
  Expected<FitOfStart> best = fit(std::move(clouds), nullptr);
  if (!best) return Forward(best);
  std::optional<FitOfStart> other;
  double chance = 0.0, apart = 0.0;
  const CloudStart start = best->first.start;
  for (std::size_t i = 0; i < std::min(start.others.size(), kOthersFitted); ++i) {
    Expected<FitOfStart> second = fit(best->first.clouds, &start.others[i]);
    if (!second && second.error().code == ErrorCode::kInterrupted) return Forward(second);
    if (!second) continue;
    CostDifference more = Compare(*second, *best, clock.time_s, options);
    if (more.sum < 0.0) {
      std::swap(*second, *best);
      more.sum = -more.sum;
    }
    apart = JointsApart(second->first.state, best->first.state);
    if (apart < kDistinctPose || more.sum >= kClearlyWorse * more.sigma()) continue;
    chance = ChanceOfOther(more);
    other = *std::move(second);
    break;
  }
  best->first.start = start;
  CloudTrack* const track = &best->first;
  SmoothedTrack* const smoothed = &best->second;
  const bool stated = options.uncertainty && !smoothed->smoothed.undetermined;
  if (other && stated && !other->second.smoothed.undetermined) {
    for (std::size_t i = 0; i < smoothed->chain.size(); ++i) {
      const int f = smoothed->chain[i].frame;
      const auto same = std::find_if(other->second.chain.begin(), other->second.chain.end(),
                                     [&](const FrameFit& frame) { return frame.frame == f; });
      if (same == other->second.chain.end()) continue;
      const auto at = static_cast<std::size_t>(same - other->second.chain.begin());
      CoverOther(track->state, other->first.state, f, chance, other->second.smoothed.uncertainty[at],
                 smoothed->smoothed.uncertainty[i]);
    }
  }
  FitResult result;
  result.motion = MotionOf(track->state, track->body.skeleton, clock.rate);
  result.capsule_radii = RadiiText(track->body);
  const Shown shown = Measure(*track, options, result);
  const bool settled = smoothed->smoothed.settled;
  result.initial_cost = smoothed->smoothed.initial_cost;
  result.final_cost = smoothed->smoothed.final_cost;
  if (stated) AddUncertainty(*smoothed, shown, options, result);
  if (smoothed->smoothed.undetermined) result.findings.push_back(NoUncertainty(*smoothed->smoothed.undetermined));
  if (other) ReportAmbiguous(chance, apart, other->first.state, result);
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
