#include "fitting/keypoint_cloud_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/median.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/motion/kinematics.h"
#include "fitting/audit/rig_corrections.h"
#include "fitting/cloud_ray_fit.h"
#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/clouds/joint_cloud_fit.h"
#include "fitting/clouds/modality_alignment.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/keypoint_fit.h"

namespace mocurate {
namespace {

constexpr double kSure = 4.0;              ///< standard deviations that a finding needs
constexpr double kNotableMove = 0.03;      ///< m; smaller differences are explained by a body that is not the person's
constexpr double kNotableRotation = 0.05;  ///< rad; smaller differences likewise
constexpr double kHalfPerson = 0.5;        ///< m, from the middle of a person to the hands and feet
constexpr double kFarthestMove = 0.3;      ///< m; farther apart are two people, or two world frames
constexpr double kMaxRotation = 0.25;      ///< rad; larger rotations are of two people, or two world frames
constexpr double kMinModalityGain = 0.08;  ///< of the loss; below, no finding
constexpr double kMillimetres = 1e3;       ///< number of millimetres in a metre (numerical)

/// Views in which a person is detected in any frame.
std::vector<const KeypointView*> ViewsWithPerson(const std::vector<KeypointView>& views) {
  std::vector<const KeypointView*> seeing;
  for (const KeypointView& view : views) {
    bool seen = false;
    for (std::size_t i = 2; i < view.values.size() && !seen; i += 3) seen = view.values[i] > 0.0;
    if (seen) seeing.push_back(&view);
  }
  return seeing;
}

/// Drops times at which no camera has an image.
void DropEmptyMoments(std::vector<DepthView>& views) {
  std::size_t most = 0;
  for (const DepthView& view : views) most = std::max(most, view.files.size());
  for (const DepthView& view : views) {
    if (view.files.size() != most) return;  // FuseClip reports it
  }
  std::vector<DepthView> kept = views;
  for (DepthView& view : kept) view.files.clear(), view.sha256.clear(), view.time_s.clear();
  for (DepthView& view : kept) view.masks.clear(), view.mask_sha256.clear();
  for (std::size_t f = 0; f < most; ++f) {
    if (std::all_of(views.begin(), views.end(), [&](const DepthView& view) { return view.files[f].empty(); })) continue;
    for (std::size_t v = 0; v < views.size(); ++v) {
      kept[v].files.push_back(views[v].files[f]);
      kept[v].time_s.push_back(views[v].time_s[f]);
      if (f < views[v].sha256.size()) kept[v].sha256.push_back(views[v].sha256[f]);
      if (f < views[v].masks.size()) kept[v].masks.push_back(views[v].masks[f]);
      if (f < views[v].mask_sha256.size()) kept[v].mask_sha256.push_back(views[v].mask_sha256[f]);
    }
  }
  views = std::move(kept);
}

/// Clouds of the frames of a motion.
struct Pairing {
  std::vector<int> cloud;  ///< (F) -1: none
  double shift_s = 0.0;    ///< median of cloud time minus frame time, after correction
  int paired = 0;
};

/// A cloud shows the person `late_s` before its time stamp.
Pairing PairFrames(const Motion& motion, const std::vector<double>& cloud_s, double late_s) {
  Pairing pairing;
  std::vector<double> shifts;
  const double step = motion.rate.FrameTime(1);
  for (int f = 0; f < motion.frame_count(); ++f) {
    const double wanted = motion.rate.FrameTime(f) + late_s;
    const auto after = std::lower_bound(cloud_s.begin(), cloud_s.end(), wanted);
    auto nearest = after == cloud_s.end() && !cloud_s.empty() ? after - 1 : after;
    if (nearest != cloud_s.begin() && nearest != cloud_s.end() && wanted - *(nearest - 1) < *nearest - wanted)
      --nearest;
    const bool has = nearest != cloud_s.end() && std::abs(*nearest - wanted) <= 0.5 * step + 1e-9;
    pairing.cloud.push_back(has ? static_cast<int>(nearest - cloud_s.begin()) : -1);
    if (has) shifts.push_back(*nearest - wanted);
  }
  pairing.paired = static_cast<int>(shifts.size());
  if (!shifts.empty()) pairing.shift_s = MeanMedian(shifts);
  return pairing;
}

std::vector<FusedCloud> Paired(const Pairing& pairing, const std::vector<FusedCloud>& clouds) {
  std::vector<FusedCloud> paired;
  for (const int i : pairing.cloud) {
    paired.push_back(i >= 0 ? clouds[static_cast<std::size_t>(i)] : FusedCloud());
  }
  return paired;
}

/// The motion `seconds` after its frames: linear, rotations by slerp. Uncertainty and states stay.
void ShiftInTime(double seconds, Motion& motion) {
  if (std::abs(seconds) < 1e-4) return;
  const Motion given = motion;
  const int last = given.frame_count() - 1;
  for (int f = 0; f <= last; ++f) {
    const double at = std::clamp(f + seconds * given.rate.hz(), 0.0, static_cast<double>(last));
    const int before = std::min(static_cast<int>(at), std::max(0, last - 1));
    const int after = std::min(before + 1, last);
    const double part = at - before;
    const auto b = static_cast<std::size_t>(before), a = static_cast<std::size_t>(after);
    motion.root_translation[static_cast<std::size_t>(f)] =
        (1.0 - part) * given.root_translation[b] + part * given.root_translation[a];
    const std::size_t first = static_cast<std::size_t>(f) * static_cast<std::size_t>(given.joint_count());
    for (int j = 0; j < given.joint_count(); ++j) {
      motion.rotation[first + static_cast<std::size_t>(j)] =
          given.rotation_at(before, j).slerp(part, given.rotation_at(after, j)).normalized();
    }
  }
  Motion moved = MakeMotion(motion.skeleton, motion.rate, motion.root_translation, motion.rotation, motion.bone_length);
  motion.rotation = std::move(moved.rotation);
  motion.joints = std::move(moved.joints);
}

std::string Mm(double metres) { return RoundedText(kMillimetres * metres, 3) + " mm"; }

/// Findings about the two rigs against each other, and the correction.
struct ModalityVerdict {
  bool move = false;   ///< the clouds
  bool delay = false;  ///< shift the clouds' clock
  ModalityAlignment::Taken taken;
  std::vector<Finding> findings;
};

/// Correction by clock offset, by rigid motion, or by both: the better one alone, and both where the second reduces the
/// rest of the loss by at least kMinModalityGain.
ModalityAlignment::Taken TakenOf(const ModalityAlignment& alignment, const RigAuditOptions& audit) {
  const bool moves = audit.moved != AuditAction::kOff, clocks = audit.clocks != AuditAction::kOff;
  if (!clocks) return alignment.moved;
  if (!moves) return alignment.late;
  const ModalityAlignment::Taken& alone =
      alignment.late.loss <= alignment.moved.loss ? alignment.late : alignment.moved;
  return alignment.both.loss <= (1.0 - kMinModalityGain) * alone.loss ? alignment.both : alone;
}

Status CheckOnePerson(const ModalityAlignment& alignment, const RigAuditOptions& audit, const std::string& clip) {
  const ModalityAlignment::Taken taken = TakenOf(alignment, audit);
  const bool one =
      alignment.near_after >= kNearBodyShare && taken.moved <= kFarthestMove && taken.turned <= kMaxRotation;
  if (one) return {};
  return Fail(ErrorCode::kInconsistent,
              "keypoints and depth views do not show one person in one world: " +
                  std::to_string(std::lround(100.0 * alignment.near)) +
                  " % of the depth points lie near the keypoints' body, its middle is " +
                  RoundedText(alignment.apart, 3) + " m from that of the points, which are " +
                  RoundedText(alignment.size_ratio, 3) + " times its size",
              clip,
              "check axes, units and calibration of all cameras, and ingest.source.subjects; or fit one modality "
              "alone: fitting.method keypoints or point_clouds");
}

/// `pose_sigma`: m per axis, of a joint of the keypoints' fit.
ModalityVerdict JudgeModalities(const ModalityAlignment& alignment, double step_s, double pose_sigma,
                                const RigAuditOptions& audit) {
  ModalityVerdict verdict;
  const double stated = std::max(kNotableMove, kSure * pose_sigma);
  const double stated_rotation = std::max(kNotableRotation, kSure * pose_sigma / kHalfPerson);
  const auto is_late = [&](const ModalityAlignment::Taken& taken) {
    return std::abs(taken.late_s) > std::max(0.5 * step_s, kSure * taken.clock_offset_sigma);
  };
  const auto is_moved = [&](const ModalityAlignment::Taken& taken) {
    return taken.moved > std::max(stated, kSure * taken.moved_sigma) || taken.turned > stated_rotation;
  };
  ModalityAlignment::Taken& taken = verdict.taken = TakenOf(alignment, audit);
  if (!is_late(taken)) {
    taken = alignment.moved;
  } else if (!is_moved(taken)) {
    taken = alignment.late;
  }
  const bool gains = taken.loss <= (1.0 - kMinModalityGain) * alignment.loss;
  const bool late = gains && is_late(taken), moved = gains && is_moved(taken);
  if (moved && audit.moved != AuditAction::kOff) {
    verdict.move = audit.moved == AuditAction::kCorrect;
    verdict.findings.push_back(MakeFinding(kModalitiesApart, Severity::kWarning, kMillimetres * taken.moved,
                                           "the depth cameras as a whole are displaced by " + Mm(taken.moved) +
                                               " and " + RoundedText(kDegrees * taken.turned, 2) +
                                               " degrees against the keypoint cameras' world",
                                           verdict.move ? FindingAction::kRepaired : FindingAction::kFlagged));
  }
  if (late && audit.clocks != AuditAction::kOff) {
    verdict.delay = audit.clocks == AuditAction::kCorrect;
    verdict.findings.push_back(MakeFinding(kModalitiesClock, Severity::kWarning, kMillimetres * taken.late_s,
                                           "the depth cameras' clock offset is " +
                                               RoundedText(kMillimetres * taken.late_s, 3) +
                                               " ms against the keypoint cameras (positive: images are stamped late)",
                                           verdict.delay ? FindingAction::kRepaired : FindingAction::kFlagged));
  }
  return verdict;
}

Expected<FitResult> KeypointsAlone(FitResult keypoints, const SkeletonPtr& skeleton, std::string why) {
  keypoints.motion = WithoutDetectorPoints(keypoints.motion, skeleton);
  keypoints.findings.push_back(MakeFinding(kModalityMissing, Severity::kWarning, keypoints.motion.frame_count(),
                                           std::move(why) + "; fitted to the keypoints alone", FindingAction::kKept));
  return keypoints;
}

Expected<FitResult> CloudsAlone(const Clip& clip, const SkeletonPtr& skeleton, std::vector<double> bone_length,
                                const PointCloudOptions& options, std::string why) {
  bone_length.resize(bone_length.empty() ? 0 : skeleton->joints.size());
  Expected<FitResult> fit = FitClouds(clip, skeleton, bone_length, options);
  if (!fit) return fit;
  fit->findings.push_back(MakeFinding(kModalityMissing, Severity::kWarning, fit->motion.frame_count(),
                                      std::move(why) + "; fitted to the depth views alone", FindingAction::kKept));
  return fit;
}

/// Fit to both modalities, with the points of the detector.
Expected<FitResult> FitBothModalities(const Clip& clip, FitResult keypoints, const std::vector<FusedCloud>& clouds,
                                      const std::vector<double>& cloud_s, const PointCloudOptions& options) {
  if (keypoints.motion.position_cov.empty()) {
    return Fail(ErrorCode::kInconsistent, "the fit of the keypoints has no uncertainty", clip.id(),
                "set fitting.joint_tracks.uncertainty to true");
  }
  const double step = keypoints.motion.rate.FrameTime(1);
  Pairing pairing = PairFrames(keypoints.motion, cloud_s, 0.0);
  std::vector<FusedCloud> paired = Paired(pairing, clouds);
  const std::vector<int> shown = ShownFrames(paired);
  if (shown.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "no depth image lies within half a step (" + RoundedText(0.5 * kMillimetres * step, 3) +
                    " ms) of a frame of the keypoints: images are from " + RoundedText(cloud_s.front(), 4) + " to " +
                    RoundedText(cloud_s.back(), 4) + " s, keypoints to " +
                    RoundedText(keypoints.motion.rate.FrameTime(keypoints.motion.frame_count() - 1), 4) + " s",
                clip.id(),
                "give both the same clock, or fit one modality alone: fitting.method keypoints or point_clouds");
  }
  const Motion& motion = keypoints.motion;
  const CapsuleBody body = CapsuleBody::Make(motion.skeleton, BodyScale(*motion.skeleton, motion.bone_length));
  const ModalityAlignment alignment = AlignModalities(body, StateOf(motion, body), KnownJoints(motion), paired, shown,
                                                      step, options.audit.longest_s, options.max_distance);
  if (Status one = CheckOnePerson(alignment, options.audit, clip.id()); !one) return Forward(one);
  const double sigma = StatedSigma(motion, shown, false);
  const ModalityVerdict verdict = JudgeModalities(alignment, step, sigma, options.audit);
  if (verdict.delay) {
    pairing = PairFrames(keypoints.motion, cloud_s, verdict.taken.late_s);
    paired = Paired(pairing, clouds);
  }
  if (verdict.move) {
    for (FusedCloud& cloud : paired) cloud = Moved(cloud, verdict.taken.world_from_clouds);
  }
  ShiftInTime(pairing.shift_s, keypoints.motion);
  keypoints.findings.insert(keypoints.findings.end(), verdict.findings.begin(), verdict.findings.end());
  return FitTracksAndClouds(std::move(keypoints), paired, options);
}

}  // namespace

Expected<FitResult> FitKeypointsAndClouds(const Clip& clip, const SkeletonPtr& skeleton, const SkeletonPtr& body,
                                          const std::vector<double>& bone_length, const FittingOptions& options) {
  Clip given = clip;
  DropEmptyMoments(given.evidence.depth_views);
  const std::vector<DepthView>& views = given.evidence.depth_views;
  const bool depth = !views.empty() && !views[0].files.empty();
  const std::vector<const KeypointView*> seeing = ViewsWithPerson(clip.evidence.keypoint_views);
  if (seeing.size() == 1 && depth) {
    const Expected<Evidence> in_rig = WithRigOf(clip.evidence, options.keypoints);
    if (!in_rig) return InClip(in_rig.error(), clip);
    const std::vector<const KeypointView*> one = ViewsWithPerson(in_rig->keypoint_views);
    return FitCloudsAndRays(clip, *one[0], skeleton, body, bone_length, options);
  }
  if (seeing.empty() && depth) {
    return CloudsAlone(clip, WithoutDetectorPoints(body, skeleton), bone_length, options.point_clouds,
                       "no keypoint camera observes a person");
  }
  FittingOptions with_poses = options;
  with_poses.joint_tracks.poses = depth;
  Expected<FitResult> keypoints = FitKeypointsOnBody(clip.evidence, clip.rate, skeleton, body, bone_length, with_poses);
  if (!keypoints) return InClip(keypoints.error(), clip);
  if (!depth) return KeypointsAlone(std::move(*keypoints), skeleton, "the clip has no depth images");
  DepthRigReport report;
  const Expected<Clip> audited = WithAuditedRig(given, options.point_clouds.audit, report);
  if (!audited) return Forward(audited);
  const Expected<std::vector<FusedCloud>> clouds = FuseClip(*audited, options.point_clouds);
  if (!clouds) return Forward(clouds);
  if (ShownFrames(*clouds).empty()) {
    return KeypointsAlone(std::move(*keypoints), skeleton,
                          "the depth images do not show a person: no frame has 100 points");
  }
  keypoints->motion.skeleton = WithBarePoints(keypoints->motion.skeleton, skeleton);
  Expected<FitResult> both = FitBothModalities(clip, std::move(*keypoints), *clouds,
                                               audited->evidence.depth_views[0].time_s, options.point_clouds);
  if (!both) return both;
  both->motion = WithoutDetectorPoints(both->motion, skeleton);
  std::vector<RigFault> faults = both->keypoints->faults;
  faults.insert(faults.end(), report.faults.begin(), report.faults.end());
  ReportRig(std::move(report), *both);
  both->rig_audit = faults.empty() ? std::string() : FaultsText(faults);
  return both;
}

}  // namespace mocurate
