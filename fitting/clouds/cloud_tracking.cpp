#include "fitting/clouds/cloud_tracking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/median.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/cloud_start.h"
#include "fitting/clouds/person_points.h"
#include "fitting/stop_request.h"

namespace mocurate {
namespace {

constexpr int kRadiusRounds = 4;  ///< rounds of matching that estimate the radii (numerical)
/// Factor on the clip's median cost per point, from which a frame is fitted again.
constexpr double kPoor = 1.15;
constexpr double kBetterPose = 0.98;  ///< of the cost before; otherwise the pose stays
constexpr double kLost = 3.0;         ///< factor on the clip's median cost per point, from which the person is lost
/// Cost per point, at least. Source: correct fits of bodies that differ from capsules (0.1 to 0.2)
constexpr double kLostCost = 0.3;
constexpr double kFound = 0.7;      ///< of the cost before, for a pose that is found again
constexpr double kNear_s = 0.5;     ///< distance from a frame that was searched
constexpr int kSearches = 6;        ///< per clip, at most: one takes about as long as 20 frames (numerical)
constexpr double kAnyPose_s = 0.4;  ///< time without points after which a limb may have any pose

/// Alternates radii and pose of a frame.
Status MeasureRadii(int frame, const PointCloudOptions& options, CloudTrack& track) {
  for (int round = 0; round < kRadiusRounds; ++round) {
    track.state.Update(frame, frame + 1, false);
    CalibrateRadii(track.clouds, track.state, frame, frame + 1, options.max_distance, track.body);
    const FrameFit fit = FitOf(frame, options);
    const auto fitted = FitCloudFrame(track.body, track.clouds[frame], fit, track.state, options);
    if (!fitted) return Forward(fitted);
    track.outcomes[frame] = *fitted;
  }
  return {};
}

/// Extrapolates a joint's rotation from `before` and `last`.
Vector3d Extrapolated(const Eigen::Map<const Vector3d>& before, const Eigen::Map<const Vector3d>& last, double share) {
  const Quaterniond from = ExpQuaternion(before);
  const Quaterniond to = ExpQuaternion(last);
  return LogQuaternion(to * ExpQuaternion(share * LogQuaternion(from.conjugate() * to)));
}

/// Initial pose of frame f: that of frame `last`, or the extrapolated motion from `before` to `last`, whichever is
/// nearer to the points. Frames need Update.
void Predict(int before, int last, int f, const std::vector<double>& time_s, double max_distance, CloudTrack& track) {
  PoseState& state = track.state;
  const std::vector<double> still = state.FrameParameters(last);
  state.SetFrameParameters(f, still);
  if (before < 0) return;
  state.Update(f, f + 1, false);
  const double distance = MeanDistance(track.body, track.clouds[f], state, f, max_distance);
  const double share = (time_s[f] - time_s[last]) / (time_s[last] - time_s[before]);
  const auto at = [&](int frame) { return Eigen::Map<const Vector3d>(std::as_const(state).translation(frame)); };
  const auto rotation_of = [&](int frame, int j) {
    return Eigen::Map<const Vector3d>(std::as_const(state).rotation(frame, j));
  };
  Eigen::Map<Vector3d>(state.translation(f)) = at(last) + share * (at(last) - at(before));
  for (int j = 0; j < state.joints(); ++j) {
    if (state.active(j))
      Eigen::Map<Vector3d>(state.rotation(f, j)) = Extrapolated(rotation_of(before, j), rotation_of(last, j), share);
  }
  state.Update(f, f + 1, false);
  if (MeanDistance(track.body, track.clouds[f], state, f, max_distance) < distance) return;
  state.SetFrameParameters(f, still);
}

/// Searches the pose of a frame anew. Accepts it if `is_found` (given the search and its cost), else restores the
/// previous pose. Returns whether it was accepted.
template <typename IsFound>
Expected<bool> SearchAnew(int f, const PointCloudOptions& search, const PointCloudOptions& options,
                          const IsFound& is_found, CloudTrack& track) {
  PoseState& state = track.state;
  const std::vector<double> kept = state.FrameParameters(f);
  const auto found = FindStart(track.body, track.clouds[f], f, search, state, StartSearch::kStancesAndLimbs);
  if (!found) return Forward(found);
  if (is_found(*found)) {
    const FrameFit fit = FitOf(f, options);
    const auto fitted = FitCloudFrame(track.body, track.clouds[f], fit, state, options);
    if (!fitted) return Forward(fitted);
    track.outcomes[f] = *fitted;
    return true;
  }
  state.SetFrameParameters(f, kept);
  state.Update(f, f + 1, false);
  return false;
}

/// After a gap in which a person may reach any pose: searches as in a clip's first frame, near the facing of frame
/// `last`, and keeps the cheaper pose.
Status RestartAfterGap(int last, int f, const PointCloudOptions& options, CloudTrack& track) {
  PoseState& state = track.state;
  state.Update(last, last + 1, false);
  state.Update(f, f + 1, false);
  const double cost = PoseCost(track.body, track.clouds[f], ComparedFit(f, options.iterations), state, options);
  PointCloudOptions about_as_before = options;
  about_as_before.start = {HeadingOf(state, last), StartPosture::kUnknown};
  const auto is_found = [&](const CloudStart& start) { return !start.off_facing && start.cost < kBetterPose * cost; };
  const Expected<bool> found = SearchAnew(f, about_as_before, options, is_found, track);
  return found ? Status() : Status(Forward(found));
}

/// Tracks the frames after `first`; earlier frames have no points.
Status Follow(int first, const std::vector<double>& time_s, const PointCloudOptions& options, CloudTrack& track) {
  int before = -1;
  int last = first;
  for (int f = first + 1; f < track.state.frames(); ++f) {
    track.state.SetFrameParameters(f, track.state.FrameParameters(last));
    if (track.clouds[f].size() < kFewestPoints) continue;
    if (Status on = StopIfInterrupted("fit of depth views"); !on) return on;
    Predict(before, last, f, time_s, options.max_distance, track);
    // Across a gap the fixed frame repeats `last`; the process noise uses the time since then.
    FrameFit fit = FitOf(f, options);
    fit.held = {{-1, time_s[f] - time_s[last]}};
    fit.sigma = track.outcomes[last].residual;
    const auto fitted = FitCloudFrame(track.body, track.clouds[f], fit, track.state, options);
    if (!fitted) return Forward(fitted);
    track.outcomes[f] = *fitted;
    if (time_s[f] - time_s[last] > kAnyPose_s && options.rules.on(FittingRule::kRestartAfterGap)) {
      if (Status again = RestartAfterGap(last, f, options, track); !again) return again;
      last = -1;
    }
    before = last;
    last = f;
  }
  return {};
}

/// Cost per point of each frame, and its median.
struct FrameCosts {
  std::vector<double> of_frame;  ///< (F), 0 for frames without a fit
  double median = 0.0;           ///< over fitted frames; 0 for fewer than three
};

bool IsFitted(const CloudTrack& track, int frame) {
  return frame >= 0 && frame < track.state.frames() && track.outcomes[frame].iterations > 0;
}

double CostPerPoint(int frame, const PointCloudOptions& options, CloudTrack& track) {
  track.state.Update(frame, frame + 1, false);
  const FrameFit fit = ComparedFit(frame, options.iterations);
  return PoseCost(track.body, track.clouds[frame], fit, track.state, options) / track.clouds[frame].size();
}

FrameCosts CostsOf(const PointCloudOptions& options, CloudTrack& track) {
  const int frames = track.state.frames();
  FrameCosts costs{std::vector<double>(frames, 0.0), 0.0};
  std::vector<double> known;
  for (int f = 0; f < frames; ++f) {
    if (!IsFitted(track, f)) continue;
    costs.of_frame[f] = CostPerPoint(f, options, track);
    known.push_back(costs.of_frame[f]);
  }
  if (known.size() >= 3) costs.median = MeanMedian(known);
  return costs;
}

/// Fits frames with a high cost again, from the pose of the next (step 1) or previous (-1) frame. The order propagates
/// good poses. The cheaper pose wins.
Status RefitPoorFrames(int step, const std::vector<double>& time_s, const PointCloudOptions& options,
                       CloudTrack& track) {
  const int frames = track.state.frames();
  FrameCosts costs = CostsOf(options, track);
  if (costs.median == 0.0) return {};
  for (int i = 0; i < frames; ++i) {
    const int f = step > 0 ? frames - 1 - i : i;
    if (!IsFitted(track, f) || !IsFitted(track, f + step) || costs.of_frame[f] <= kPoor * costs.median) continue;
    if (Status on = StopIfInterrupted("fit of depth views"); !on) return on;
    const std::vector<double> kept = track.state.FrameParameters(f);
    FrameFit fit = ComparedFit(f, options.iterations);
    fit.held = {{step, std::abs(time_s[f] - time_s[f + step])}};
    const auto cost_here = [&] {
      track.state.Update(f + step, f + step + 1, false);
      track.state.Update(f, f + 1, false);
      return PoseCost(track.body, track.clouds[f], fit, track.state, options);
    };
    const double cost_before = cost_here();
    track.state.SetFrameParameters(f, track.state.FrameParameters(f + step));
    const auto fitted = FitCloudFrame(track.body, track.clouds[f], fit, track.state, options);
    if (!fitted) return Forward(fitted);
    if (cost_here() < kBetterPose * cost_before) {
      costs.of_frame[f] = CostPerPoint(f, options, track);
      track.outcomes[f] = *fitted;
      continue;
    }
    track.state.SetFrameParameters(f, kept);
    track.state.Update(f, f + 1, false);
  }
  return {};
}

Status RefitPoorFrames(const std::vector<double>& time_s, const PointCloudOptions& options, CloudTrack& track) {
  if (!options.rules.on(FittingRule::kRefitPoorFrames)) return {};
  for (const int step : {1, -1}) {
    if (Status looked = RefitPoorFrames(step, time_s, options, track); !looked) return looked;
  }
  return {};
}

/// Among frames in which the person was lost, without those `tried`: the one with the most points; -1 without any.
int LostFrame(const FrameCosts& costs, const CloudTrack& track, const std::vector<bool>& tried) {
  int most = -1;
  for (int f = 0; f < track.state.frames(); ++f) {
    const bool lost = costs.median > 0.0 && costs.of_frame[f] > std::max(kLost * costs.median, kLostCost);
    if (!lost || tried[f]) continue;
    if (most < 0 || track.clouds[f].size() > track.clouds[most].size()) most = f;
  }
  return most;
}

/// A person who leaves the views and returns may get a wrong pose. Where the cost is much higher than in most frames,
/// searches the pose of one frame anew, in all directions, and tracks from there.
Status RecoverLostFrames(const std::vector<double>& time_s, const PointCloudOptions& options, CloudTrack& track) {
  if (!options.rules.on(FittingRule::kRecoverLostFrames)) return {};
  std::vector<bool> tried(static_cast<std::size_t>(track.state.frames()), false);
  PointCloudOptions any_way = options;
  any_way.start = {};
  for (int search = 0; search < kSearches; ++search) {
    const int f = LostFrame(CostsOf(options, track), track, tried);
    if (f < 0) return {};
    const auto near = [&](int frame) { return std::abs(time_s[frame] - time_s[f]) < kNear_s; };
    for (int i = 0; i < track.state.frames(); ++i) tried[i] = tried[i] || near(i);
    const double cost = CostPerPoint(f, options, track);
    const auto is_found = [&](const CloudStart& start) { return start.cost < kFound * cost * track.clouds[f].size(); };
    const Expected<bool> found = SearchAnew(f, any_way, options, is_found, track);
    if (!found) return Forward(found);
    if (!*found) continue;
    if (Status looked = RefitPoorFrames(time_s, options, track); !looked) return looked;
  }
  return {};
}

/// Error kInconsistent where `time_s` does not increase.
Status CheckOrder(const std::vector<double>& time_s, const std::string& whose, const std::string& clip) {
  for (std::size_t f = 1; f < time_s.size(); ++f) {
    if (time_s[f] > time_s[f - 1]) continue;
    return Fail(ErrorCode::kInconsistent,
                "frame " + std::to_string(f) + " of " + whose + " is not stamped later than the frame before it", clip,
                "order the files by time, and remove duplicates");
  }
  return {};
}

Status CheckFrames(const Clip& clip) {
  const std::vector<DepthView>& views = clip.evidence.depth_views;
  if (SurfaceTimes(clip.evidence).empty()) {
    return Fail(
        ErrorCode::kInconsistent, "the clip has no depth images or point clouds", clip.id(),
        "fitting.method point_clouds requires one of them; for tracked joints set fitting.method to joint_tracks");
  }
  if (views.empty()) return CheckOrder(clip.evidence.clouds->time_s, "the clouds", clip.id());
  for (const DepthView& view : views) {
    if (view.files.size() != views[0].files.size()) {
      return Fail(ErrorCode::kInconsistent,
                  "view '" + view.camera.name + "' has " + std::to_string(view.files.size()) + " depth images, view '" +
                      views[0].camera.name + "' has " + std::to_string(views[0].files.size()),
                  clip.id(), "give synchronous views");
    }
    if (Status order = CheckOrder(view.time_s, "view '" + view.camera.name + "'", clip.id()); !order) return order;
  }
  return {};
}

}  // namespace

void FillFrames(const std::vector<bool>& fitted, PoseState& state) {
  const int frames = state.frames();
  int first = 0;
  while (first + 1 < frames && !fitted[static_cast<std::size_t>(first)]) ++first;
  for (int f = first - 1; f >= 0; --f) state.SetFrameParameters(f, state.FrameParameters(f + 1));
  for (int f = first + 1; f < frames; ++f) {
    if (!fitted[static_cast<std::size_t>(f)]) state.SetFrameParameters(f, state.FrameParameters(f - 1));
  }
}

void FillFrames(CloudTrack& track) {
  std::vector<bool> fitted;
  for (const CapsuleFitOutcome& outcome : track.outcomes) fitted.push_back(outcome.iterations > 0);
  FillFrames(fitted, track.state);
}

Expected<std::vector<FusedCloud>> FuseClip(const Clip& clip, const PointCloudOptions& options) {
  return FuseClip(clip, options, std::numeric_limits<int>::max());
}

Expected<std::vector<FusedCloud>> FuseClip(const Clip& clip, const PointCloudOptions& options, int frames) {
  if (Status checked = CheckFrames(clip); !checked) return Forward(checked);
  const Evidence& evidence = clip.evidence;
  const auto available = static_cast<int>(SurfaceTimes(evidence).size());
  const int count = std::min(frames, available);
  std::vector<FusedCloud> clouds;
  for (int i = 0; i < count; ++i) {
    if (Status on = StopIfInterrupted("fusion of depth views"); !on) return Forward(on);
    const int f = FrameOfFew(i, count, available);
    const bool is_cloud = evidence.depth_views.empty();
    Expected<FusedCloud> cloud = is_cloud ? ReadPersonCloud(*evidence.clouds, f, options.voxel_size)
                                          : FuseViews(evidence.depth_views, f, options.voxel_size);
    if (!cloud) return Forward(cloud);
    const bool is_person = is_cloud || !options.rules.on(FittingRule::kPersonPoints);
    clouds.push_back(is_person ? std::move(*cloud) : PersonPoints(*cloud, options.voxel_size));
    clouds.back().spacing = SpacingOf(clouds.back(), options.voxel_size);
  }
  return clouds;
}

Expected<CloudTrack> TrackClouds(std::vector<FusedCloud> clouds, const SkeletonPtr& skeleton,
                                 const std::vector<double>& bone_length, const std::vector<double>& time_s,
                                 const PointCloudOptions& options, const std::vector<double>* first_pose) {
  const auto frames = static_cast<int>(clouds.size());
  int first = 0;
  while (first < frames && clouds[first].size() < kFewestPoints) ++first;
  if (first == frames) {
    return Fail(ErrorCode::kInconsistent, "no frame has " + std::to_string(kFewestPoints) + " points", "depth views",
                "check depth_unit and the cameras");
  }
  CapsuleBody body = CapsuleBody::Make(skeleton, BodyScale(*skeleton, bone_length));
  PoseState state(*skeleton, frames, bone_length, body.MovingJoints());
  CloudTrack track{std::move(clouds), std::move(body), std::move(state), std::vector<CapsuleFitOutcome>(frames), {}};
  if (first_pose != nullptr) {
    track.state.SetFrameParameters(first, *first_pose);
  } else {
    auto start = FindStart(track.body, track.clouds[first], first, options, track.state, StartSearch::kStancesAndLimbs);
    if (!start) return Forward(start);
    track.start = *std::move(start);
  }
  if (Status measured = MeasureRadii(first, options, track); !measured) return Forward(measured);
  if (Status followed = Follow(first, time_s, options, track); !followed) return Forward(followed);
  if (Status looked = RefitPoorFrames(time_s, options, track); !looked) return Forward(looked);
  if (Status found = RecoverLostFrames(time_s, options, track); !found) return Forward(found);
  FillFrames(track);
  return track;
}

}  // namespace mocurate
