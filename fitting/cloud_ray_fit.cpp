#include "fitting/cloud_ray_fit.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/median.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/motion/clip.h"
#include "core/quality/seen_person.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/clouds/cloud_smoothing.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/cloud_uncertainty.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/clouds/joint_cloud_fit.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/stop_request.h"
#include "fitting/terms/pose_state.h"

namespace mocurate {
namespace {

/// Agreement of one camera's keypoints with a motion that was fitted without them.
struct RayAgreement {
  std::vector<int> image;            ///< (F) of the view, nearest in time within half a step; -1: none
  std::vector<int> person;           ///< (F) the detection nearest to the motion; -1: none near it
  double median_px = 0.0;            ///< of all its detected keypoints from the projected joints
  double median_exchanged_px = 0.0;  ///< the same with left and right exchanged
  int seen = 0;                      ///< number of keypoints
  double share = 0.0;                ///< of the frames with an image, in which a detection is near
};

/// The joint of `skeleton` (with the detector's points) that each keypoint is; -1: none.
std::vector<int> BodyJointsOfKeypoints(const Skeleton& skeleton, const std::vector<std::string>& keypoint_names) {
  std::vector<int> joints;
  for (const std::string& name : DetectorNames(keypoint_names)) joints.push_back(skeleton.FindJoint(name).value_or(-1));
  return joints;
}

/// Compares a view with joints (F,J,3) at a rate.
RayAgreement CompareRays(const KeypointView& view, const std::vector<int>& joint_of, const Motion& motion) {
  RayAgreement found;
  std::vector<double> all, exchanged;
  std::vector<int> mirrored;
  for (const int joint : joint_of) mirrored.push_back(joint < 0 ? -1 : motion.skeleton->joints[joint].mirror);
  int images = 0, near = 0;
  const double step = motion.rate.FrameTime(1);
  for (int f = 0; f < motion.frame_count(); ++f) {
    const int image = ImageAt(view, motion.rate.FrameTime(f), step);
    const int person = image < 0 ? -1 : FindPerson(view, image, joint_of, motion, f).index;
    found.image.push_back(image);
    found.person.push_back(person);
    images += image >= 0 ? 1 : 0;
    if (person < 0) continue;
    ++near;
    const std::vector<double> own = DistancesFromJoints(view, image, person, joint_of, motion, f);
    const std::vector<double> other = DistancesFromJoints(view, image, person, mirrored, motion, f);
    all.insert(all.end(), own.begin(), own.end());
    exchanged.insert(exchanged.end(), other.begin(), other.end());
  }
  found.seen = static_cast<int>(all.size());
  found.share = images > 0 ? static_cast<double>(near) / images : 0.0;
  if (!all.empty()) found.median_px = MeanMedian(all);
  if (!exchanged.empty()) found.median_exchanged_px = MeanMedian(exchanged);
  return found;
}

/// A frame's keypoints as rays through the camera: positions known across the ray, not along it. `noise_px` of a
/// keypoint of confidence 1 per axis. The frame of the state must be up to date.
std::vector<PointTerm> RaysOf(const KeypointView& view, const std::vector<int>& joint_of, int image, int person,
                              double noise_px, double min_confidence, const PoseState& state, int frame) {
  std::vector<PointTerm> rays;
  const RigidTransform world_from_camera = Inverse(view.camera.camera_from_world);
  for (std::size_t k = 0; k < joint_of.size(); ++k) {
    const double* point = view.at(image, person, static_cast<int>(k));
    if (joint_of[k] < 0 || !(point[2] > 0.0) || point[2] < min_confidence) continue;
    const Vector3d& place = state.position(frame, joint_of[k]);
    const double depth = (view.camera.camera_from_world * place).z();
    if (!(depth > 0.1)) continue;
    const Vector3d on_ray = world_from_camera * view.camera.Unproject(Vector2d(point[0], point[1]), depth);
    const Vector3d along = (on_ray - view.camera.Centre()).normalized();
    const double weight = std::sqrt(point[2]) * std::abs(view.camera.fx) / (noise_px * depth);
    rays.push_back({joint_of[k], on_ray, weight * (Matrix3d::Identity() - along * along.transpose())});
  }
  return rays;
}

constexpr double kMinCoverage = 0.3;  ///< of the frames in which the camera sees the person
constexpr double kOtherWay =
    0.7;  ///< ratio of the distances with sides exchanged; below, the person faces the other way
constexpr double kPixelsOfModel = 4.0;  ///< px, error that is always assumed for points fixed to joints
/// Ratio of the median distance to the standard deviation per axis. Source: Rayleigh distribution, sqrt(2 ln 2)
constexpr double kMedianOfTwo = 1.1774;

/// Bone lengths of the body: given ones of the skeleton's joints, rest offsets in the person's size for points.
std::vector<double> BonesOf(const Skeleton& body, const Skeleton& skeleton, const std::vector<double>& given) {
  std::vector<double> bones = given.empty() ? skeleton.RestBoneLengths() : given;
  bones.resize(skeleton.joints.size());
  const double scale = BodyScale(skeleton, bones);
  const std::vector<double> rest = body.RestBoneLengths();
  for (std::size_t j = bones.size(); j < rest.size(); ++j) bones.push_back(scale * rest[j]);
  return bones;
}

Finding OneView(const RayAgreement& rays, const std::string& camera, bool used) {
  return MakeFinding(kOneKeypointView, used ? Severity::kInfo : Severity::kWarning, rays.median_px,
                     "camera '" + camera + "' is the only one with keypoints: it sees the person in " +
                         std::to_string(std::lround(100.0 * rays.share)) + " % of its frames, in the median " +
                         RoundedText(rays.median_px, 3) + " px from the joints of the depth views",
                     used ? FindingAction::kKept : FindingAction::kExcluded);
}

/// The heading of a motion's root, radians about y from +z.
double HeadingOfMotion(const Motion& motion) {
  const Vector3d front = motion.rotation_at(0, 0) * Vector3d::UnitZ();
  return std::atan2(front.x(), front.z());
}

/// Frames with enough points, each with the rays that see the person. Poses of frames with rays start from a fit of
/// their own, beside the frame before. Marks the joints that rays show.
Expected<std::vector<FrameFit>> FramesWithRays(const std::vector<FusedCloud>& clouds, const KeypointView& view,
                                               const std::vector<int>& joint_of, const RayAgreement& rays, double noise,
                                               const CapsuleBody& body, const FittingOptions& options, PoseState& state,
                                               FitResult& fit) {
  std::vector<FrameFit> frames;
  const auto joints = static_cast<std::size_t>(fit.motion.joint_count());
  for (int f = 0; f < fit.motion.frame_count(); ++f) {
    if (Status on = StopIfInterrupted("fit of depth views and keypoints"); !on) return Forward(on);
    const auto at = static_cast<std::size_t>(f);
    if (clouds[at].size() < kFewestPoints) continue;
    frames.push_back(FitOf(f, options.point_clouds));
    if (rays.person[at] < 0) continue;
    FrameFit frame = frames.back();
    frame.joints = RaysOf(view, joint_of, rays.image[at], rays.person[at], noise,
                          options.keypoints.triangulation.min_confidence, state, f);
    frames.back().joints = frame.joints;
    if (f > 0) frame.held.push_back({-1, fit.motion.rate.FrameTime(1)});
    const auto fitted = FitCloudFrame(body, clouds[at], frame, state, options.point_clouds);
    if (!fitted) return Forward(fitted);
    fit.iterations += fitted->iterations;
    for (const PointTerm& seen : frame.joints)
      fit.motion.state[at * joints + static_cast<std::size_t>(seen.joint)] = JointState::kObserved;
  }
  return frames;
}

Status FitFrames(const std::vector<FusedCloud>& clouds, const std::vector<double>& time_s, const KeypointView& view,
                 const std::vector<int>& joint_of, const RayAgreement& rays, const CapsuleBody& body,
                 const FittingOptions& options, FitResult& fit) {
  PointCloudOptions cloud_options = options.point_clouds;
  cloud_options.uncertainty = !fit.motion.position_cov.empty();
  const TriangulationOptions& detections = options.keypoints.triangulation;
  const double of_rays = std::max(kPixelsOfModel, std::min(rays.median_px / kMedianOfTwo, 2.0 * detections.noise));
  const Rules& rules = cloud_options.rules;
  const double noise = rules.on(FittingRule::kRayNoise) ? of_rays : detections.noise;
  PoseState state = StateOf(fit.motion, body);
  const auto frames = FramesWithRays(clouds, view, joint_of, rays, noise, body, options, state, fit);
  if (!frames) return Forward(frames);
  auto smoothed = SmoothChain(body, clouds, *frames, time_s, cloud_options, state);
  if (!smoothed) return Forward(smoothed);
  fit.initial_cost = smoothed->initial_cost;
  fit.final_cost = smoothed->final_cost;
  if (!smoothed->settled) {
    fit.converged = false;
    fit.termination = kUnsettledChain;
  }
  std::vector<bool> fitted(clouds.size(), false);
  for (const FrameFit& frame : *frames) fitted[static_cast<std::size_t>(frame.frame)] = true;
  FillFrames(fitted, state);
  state.Update(0, state.frames(), false);

  UncertainMotion uncertain(fit.motion);
  const double scale = BodyScale(*fit.motion.skeleton, fit.motion.bone_length);
  std::vector<double> low_coverage(clouds.size(), 0.0);  // m, of frames without rays
  std::vector<double> residual(clouds.size(), 0.0);      // m, root mean square
  std::vector<double> residuals;
  for (std::size_t i = 0; i < frames->size(); ++i) {
    const int f = (*frames)[i].frame;
    const auto at = static_cast<std::size_t>(f);
    const std::vector<CloudMatch> matches = MatchPoints(body, state, f, clouds[at], cloud_options.max_distance);
    for (const CloudMatch& match : matches) residuals.push_back(std::abs(match.distance));
    residual[at] = ResidualOf(matches);
    if (rays.person[at] < 0) low_coverage[at] = LowCoverageSigma(clouds[at], cloud_options, scale);
    if (cloud_options.uncertainty) uncertain.Set(f, smoothed->uncertainty[i], low_coverage[at]);
  }
  const Motion given = std::move(fit.motion);
  fit.motion = MotionOf(state, given.skeleton, given.rate);
  fit.motion.state = given.state;
  if (cloud_options.uncertainty) uncertain.Write(fit.motion);
  fit.findings.erase(std::remove_if(fit.findings.begin(), fit.findings.end(),
                                    [](const Finding& finding) {
                                      return finding.code == kLowCoverage || finding.code == kPoorlyExplained;
                                    }),
                     fit.findings.end());
  ReportLowCoverage(low_coverage, fit.findings);
  ReportPoorlyExplained(residual, fit.findings);
  SetResiduals(std::move(residuals), fit);
  return {};
}

}  // namespace

SkeletonPtr WithBarePoints(const SkeletonPtr& body, const SkeletonPtr& skeleton) {
  auto bare = std::make_shared<Skeleton>(*body);
  for (int j = skeleton->joint_count(); j < bare->joint_count(); ++j) bare->joints[j].radius = 0.0;
  return bare;
}

Expected<FitResult> FitCloudsAndRays(const Clip& clip, const KeypointView& view, const SkeletonPtr& skeleton,
                                     const SkeletonPtr& body, const std::vector<double>& bone_length,
                                     const FittingOptions& options) {
  DepthRigReport report;
  const Expected<Clip> audited = WithAuditedRig(clip, options.point_clouds.audit, report);
  if (!audited) return Forward(audited);
  const Expected<std::vector<FusedCloud>> clouds = FuseClip(*audited, options.point_clouds);
  if (!clouds) return Forward(clouds);
  const SkeletonPtr bare = WithBarePoints(body, skeleton);
  const std::vector<double> bones = BonesOf(*bare, *skeleton, bone_length);
  const CloudClock clock{clip.rate, SurfaceTimes(audited->evidence)};
  PointCloudOptions cloud_options = options.point_clouds;
  Expected<FitResult> fit = FitFusedClouds(*clouds, clock, bare, bones, cloud_options);
  if (!fit) return fit;
  const std::vector<int> joint_of = BodyJointsOfKeypoints(*bare, clip.evidence.keypoint_names);
  RayAgreement rays = CompareRays(view, joint_of, fit->motion);
  if (rays.seen > 0 && rays.median_exchanged_px < kOtherWay * rays.median_px) {
    cloud_options.start.facing = std::remainder(HeadingOfMotion(fit->motion) + kPi, 2.0 * kPi);
    Expected<FitResult> turned = FitFusedClouds(*clouds, clock, bare, bones, cloud_options);
    if (!turned) return turned;
    const RayAgreement other = CompareRays(view, joint_of, turned->motion);
    if (other.seen > 0 && other.median_px < rays.median_px) {
      fit = std::move(turned);
      rays = other;
    }
  }
  const bool used = rays.share >= kMinCoverage;
  if (used) {
    const std::optional<CapsuleBody> capsules = BodyFromRadii(bare, fit->motion.bone_length, fit->capsule_radii);
    if (!capsules) return Fail(ErrorCode::kInternal, "the body of the depth fit cannot be rebuilt", clip.id());
    if (Status fitted = FitFrames(*clouds, clock.time_s, view, joint_of, rays, *capsules, options, *fit); !fitted)
      return Forward(fitted);
  }
  fit->motion = WithoutDetectorPoints(fit->motion, skeleton);
  ReportRig(std::move(report), *fit);
  fit->findings.push_back(OneView(rays, view.camera.name, used));
  return fit;
}

}  // namespace mocurate
