#include "fitting/clouds/cloud_tracking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "fitting/clouds/cloud_match.h"
#include "fitting/evidence/noise.h"

namespace mocurate {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::array<double, 3> kTurns = {0.0, -kPi / 4.0, kPi / 4.0};  ///< tried about the stated facing
constexpr std::array<double, 2> kArmsDown = {0.0, 1.3};                 ///< rad from the T-pose
constexpr int kRadiusRounds = 4;
constexpr int kFewestPoints = 100;
constexpr double kSmallest = 0.4;  ///< of a person against the rest skeleton
constexpr double kLargest = 1.5;

/// Lowest and highest point along y; a few stray points do not count.
std::pair<double, double> Height(const Eigen::Matrix3Xd& points) {
  std::vector<double> y(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) y[i] = points(1, i);
  std::sort(y.begin(), y.end());
  const std::size_t stray = y.size() / 2000;
  return {y[stray], y[y.size() - 1 - stray]};
}

/// The same of a posed body.
std::pair<double, double> Height(const FleshBody& body, const PoseState& state, int frame) {
  double low = std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::lowest();
  for (const FleshCapsule& capsule : body.capsules) {
    const CapsuleEnds ends = EndsOf(capsule, state, frame);
    low = std::min({low, ends.begin.y() - capsule.radius, ends.end.y() - capsule.radius});
    high = std::max({high, ends.begin.y() + capsule.radius, ends.end.y() + capsule.radius});
  }
  return {low, high};
}

/// Upright, facing `facing` about y, arms lowered; amid the points.
void StartPose(const FleshBody& body, const FusedCloud& cloud, int frame, double facing, double arms_down,
               PoseState& state) {
  std::fill(state.translation(frame), state.rotation(frame, 0), 0.0);
  for (int j = 0; j < state.joints(); ++j) Eigen::Map<Vector3d>(state.rotation(frame, j)).setZero();
  state.rotation(frame, 0)[1] = facing;
  if (const auto shoulders = body.skeleton->Shoulders()) {
    state.rotation(frame, (*shoulders)[0])[2] = -arms_down;
    state.rotation(frame, (*shoulders)[1])[2] = arms_down;
  }
  state.Update(frame, frame + 1, false);
  const auto [body_low, body_high] = Height(body, state, frame);
  const auto [cloud_low, cloud_high] = Height(cloud.points);
  const Vector3d centre = cloud.points.rowwise().mean();
  const double up = 0.5 * (cloud_low + cloud_high - body_low - body_high);
  Eigen::Map<Vector3d>(state.translation(frame)) = Vector3d(centre.x(), up, centre.z());
}

std::vector<double> Parameters(PoseState& state, int frame) {
  return {state.translation(frame), state.rotation(frame, state.joints() - 1) + 3};
}

/// Leaves the best of several fits in the state.
Status FindStart(const CloudTrack& track, int frame, const PointCloudOptions& options, PoseState& state) {
  double least = std::numeric_limits<double>::max();
  std::vector<double> best;
  for (const double turn : kTurns) {
    for (const double arms_down : kArmsDown) {
      StartPose(track.body, track.clouds[frame], frame, options.start_facing_deg * kPi / 180.0 + turn, arms_down,
                state);
      const auto fit = FitCloudFrame(track.body, track.clouds, state, frame, false, 0.0, options);
      if (!fit) return Forward(fit);
      const double distance = MeanDistance(track.body, track.clouds[frame], state, frame, options.max_distance);
      if (distance >= least) continue;
      least = distance;
      best = Parameters(state, frame);
    }
  }
  std::copy(best.begin(), best.end(), state.translation(frame));
  return {};
}

/// Radii and pose of a frame in turn.
Status MeasureRadii(int frame, const PointCloudOptions& options, CloudTrack& track) {
  for (int round = 0; round < kRadiusRounds; ++round) {
    track.state.Update(frame, frame + 1, false);
    CalibrateRadii(track.clouds, track.state, frame, frame + 1, options.max_distance, track.body);
    const auto fit = FitCloudFrame(track.body, track.clouds, track.state, frame, false, 0.0, options);
    if (!fit) return Forward(fit);
    track.outcomes[frame] = *fit;
  }
  return {};
}

/// Follows the frames after `first`; those before it had no points.
Status Follow(int first, double frame_seconds, const PointCloudOptions& options, CloudTrack& track) {
  for (int f = first + 1; f < track.state.frames(); ++f) {
    const std::vector<double> previous = Parameters(track.state, f - 1);
    std::copy(previous.begin(), previous.end(), track.state.translation(f));
    if (track.clouds[f].size() < kFewestPoints) continue;
    const auto fit = FitCloudFrame(track.body, track.clouds, track.state, f, true, frame_seconds, options);
    if (!fit) return Forward(fit);
    track.outcomes[f] = *fit;
  }
  for (int f = first - 1; f >= 0; --f) {
    const std::vector<double> next = Parameters(track.state, f + 1);
    std::copy(next.begin(), next.end(), track.state.translation(f));
  }
  return {};
}

}  // namespace

Expected<std::vector<FusedCloud>> FuseClip(const Clip& clip, const PointCloudOptions& options) {
  return FuseClip(clip, options, std::numeric_limits<int>::max());
}

Expected<std::vector<FusedCloud>> FuseClip(const Clip& clip, const PointCloudOptions& options, int frames) {
  const std::vector<DepthView>& views = clip.evidence.depth_views;
  if (views.empty() || views[0].files.empty()) {
    return Fail(ErrorCode::kInconsistent, "the clip has no depth images", clip.id(),
                "fitting.method point_clouds needs depth views; joint_tracks fits tracked joints");
  }
  for (const DepthView& view : views) {
    if (view.files.size() == views[0].files.size()) continue;
    return Fail(ErrorCode::kInconsistent,
                "view '" + view.camera.name + "' has " + std::to_string(view.files.size()) + " depth images, view '" +
                    views[0].camera.name + "' has " + std::to_string(views[0].files.size()),
                clip.id(), "views must be synchronous");
  }
  const auto available = static_cast<int>(views[0].files.size());
  const int count = std::min(frames, available);
  std::vector<FusedCloud> clouds;
  for (int i = 0; i < count; ++i) {
    const auto f = static_cast<int>(static_cast<long long>(i) * available / count);
    Expected<FusedCloud> cloud = FuseViews(views, f, {options.voxel_size, options.outliers});
    if (!cloud) return Forward(cloud);
    clouds.push_back(std::move(*cloud));
  }
  return clouds;
}

double ScaleFromHeight(const SkeletonPtr& skeleton, const std::vector<FusedCloud>& clouds) {
  std::vector<double> heights;
  for (const FusedCloud& cloud : clouds) {
    if (cloud.size() < kFewestPoints) continue;
    const auto [low, high] = Height(cloud.points);
    heights.push_back(high - low);
  }
  if (heights.empty()) return 1.0;
  const FleshBody body = FleshBody::Make(skeleton, 1.0, 1.0);
  PoseState rest(*skeleton, 1, skeleton->RestBoneLengths(), body.MovingJoints());
  rest.Update(0, 1, false);
  const auto [low, high] = Height(body, rest, 0);
  return std::clamp(Median(heights) / (high - low), kSmallest, kLargest);
}

Expected<CloudTrack> TrackClouds(std::vector<FusedCloud> clouds, const SkeletonPtr& skeleton,
                                 const std::vector<double>& bone_length, double frame_seconds,
                                 const PointCloudOptions& options) {
  const auto frames = static_cast<int>(clouds.size());
  int first = 0;
  while (first < frames && clouds[first].size() < kFewestPoints) ++first;
  if (first == frames) {
    return Fail(ErrorCode::kInconsistent, "no frame has " + std::to_string(kFewestPoints) + " points", "depth views",
                "check depth_unit and the cameras");
  }
  const std::vector<double> rest = skeleton->RestBoneLengths();
  double length = 0.0;
  double rest_length = 0.0;
  for (std::size_t j = 0; j < rest.size(); ++j) length += bone_length[j], rest_length += rest[j];
  FleshBody body =
      FleshBody::Make(skeleton, rest_length > 0.0 ? length / rest_length : 1.0, options.capsule_radius_scale);
  PoseState state(*skeleton, frames, bone_length, body.MovingJoints());
  CloudTrack track{std::move(clouds), std::move(body), std::move(state), std::vector<CapsuleFitOutcome>(frames)};
  if (Status found = FindStart(track, first, options, track.state); !found) return Forward(found);
  if (Status measured = MeasureRadii(first, options, track); !measured) return Forward(measured);
  if (Status followed = Follow(first, frame_seconds, options, track); !followed) return Forward(followed);
  return track;
}

}  // namespace mocurate
