#include "report/clip_page.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/median.h"
#include "report/filmstrip.h"
#include "report/painters.h"

namespace mocurate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Tracks in the order of a skeleton's joints.
class TracksOfJoints {
 public:
  TracksOfJoints(const JointTracks& tracks, const Skeleton& skeleton)
      : tracks_(tracks), point_(MatchTracks(tracks.names, skeleton).point_of_joint) {}

  bool seen(int frame, int joint) const { return point_[joint] >= 0 && Observes(tracks_, frame, point_[joint]); }
  Vector3d at(int frame, int joint) const { return tracks_.positions.at(frame, point_[joint]); }

 private:
  const JointTracks& tracks_;
  std::vector<int> point_;
};

void AddTrackResiduals(const Motion& motion, const TracksOfJoints& tracks, ClipSeries& series) {
  series.residual_name = "Distance of the fit from the tracked joints, mm";
  for (int f = 0; f < motion.frame_count(); ++f) {
    double square = 0.0;
    double most = 0.0;
    int count = 0;
    for (int j = 0; j < motion.joint_count(); ++j) {
      if (!tracks.seen(f, j)) continue;
      const double distance = 1e3 * (motion.joints.at(f, j) - tracks.at(f, j)).norm();
      square += distance * distance;
      most = std::max(most, distance);
      ++count;
    }
    series.residual.push_back(count > 0 ? std::sqrt(square / count) : kNan);
    series.residual_most.push_back(count > 0 ? most : kNan);
  }
}

/// Median distance of the depth views' points near the body from its surface: every sixth row and column.
double CloudResidual(const Clip& fitted, const Evidence& evidence, int frame) {
  constexpr int kStep = 6;
  constexpr double kReach = 0.2;  // metres: farther points are not the person's
  const PosedBody body = BodyOf(fitted, frame);
  std::vector<double> distances;
  for (const int v : ChosenViews(evidence, std::min<int>(8, static_cast<int>(evidence.depth_views.size())))) {
    if (v >= static_cast<int>(evidence.depth_views.size())) continue;
    const auto points = PointsNear(body, evidence.depth_views[v], frame, kStep, kReach);
    for (const NearPoint& point : points.value_or(std::vector<NearPoint>())) {
      distances.push_back(1e3 * std::abs(point.distance));
    }
  }
  return distances.empty() ? kNan : Median(std::move(distances));
}

double KeypointResidual(const Motion& motion, const Evidence& evidence, int frame) {
  std::vector<double> medians;
  const std::vector<int> joint_of = JointsOfKeypoints(*motion.skeleton, evidence.keypoint_names);
  for (std::size_t v = 0; v < evidence.keypoint_views.size(); ++v) {
    const KeypointView& view = evidence.keypoint_views[v];
    const int image = ImageAt(view, motion.rate.FrameTime(frame), motion.rate.FrameTime(1));
    if (image < 0) continue;
    const SeenPerson person = FindPerson(view, image, joint_of, motion, frame);
    if (person.index >= 0) medians.push_back(person.median_px);
  }
  return medians.empty() ? kNan : Median(std::move(medians));
}

/// Root mean square over joints of the third derivative, at the middle of four frames that have them.
template <class Seen, class Place>
std::vector<double> JerkOf(int frames, int joints, double dt, Seen&& seen, Place&& place) {
  std::vector<double> jerk(static_cast<std::size_t>(frames), kNan);
  for (int f = 1; f + 2 < frames; ++f) {
    double square = 0.0;
    int count = 0;
    for (int j = 0; j < joints; ++j) {
      if (!seen(f - 1, j) || !seen(f, j) || !seen(f + 1, j) || !seen(f + 2, j)) continue;
      const Vector3d third =
          (place(f + 2, j) - place(f - 1, j) - 3.0 * (place(f + 1, j) - place(f, j))) / (dt * dt * dt);
      square += third.squaredNorm();
      ++count;
    }
    if (count > 0) jerk[f] = std::sqrt(square / count);
  }
  return jerk;
}

double SpreadOf(const std::vector<double>& values, double& mean) {
  double sum = 0.0;
  double square = 0.0;
  int count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  mean = count > 0 ? sum / count : kNan;
  for (const double value : values) {
    if (std::isfinite(value)) square += (value - mean) * (value - mean);
  }
  return count > 0 ? std::sqrt(square / count) : kNan;
}

void AddBones(const Motion& motion, const TracksOfJoints* tracks, ClipSeries& series) {
  for (int j = 1; j < motion.joint_count(); ++j) {
    const int parent = motion.skeleton->joints[j].parent;
    BoneSeries bone;
    bone.joint = j;
    bool any = false;
    for (int f = 0; f < motion.frame_count(); ++f) {
      const bool seen = tracks != nullptr && tracks->seen(f, j) && tracks->seen(f, parent);
      bone.raw.push_back(seen ? 1e3 * (tracks->at(f, j) - tracks->at(f, parent)).norm() : kNan);
      bone.fitted.push_back(1e3 * (motion.joints.at(f, j) - motion.joints.at(f, parent)).norm());
      any = any || seen;
    }
    double fitted_mean = 0.0;
    bone.raw_spread = SpreadOf(bone.raw, bone.raw_mean);
    bone.fitted_spread = SpreadOf(bone.fitted, fitted_mean);
    series.raw_bones = series.raw_bones || any;
    if (any || tracks == nullptr) series.bones.push_back(std::move(bone));
  }
}

}  // namespace

double StatedSigmaMm(const Motion& motion, int frame, int joint) {
  if (motion.position_cov.empty()) return kNan;
  const float* c = motion.position_cov.data() + 6 * (static_cast<std::size_t>(frame) * motion.joint_count() + joint);
  const double variance = (static_cast<double>(c[0]) + c[3] + c[5]) / 3.0;
  return variance >= 0.0 ? 1e3 * std::sqrt(variance) : kNan;
}

Expected<ClipSeries> SeriesOf(const Clip& fitted, const Evidence& evidence) {
  if (Status ok = CheckFrame(fitted, 0); !ok) return Forward(ok);
  const Motion& motion = *fitted.motion;
  ClipSeries series;
  for (int f = 0; f < motion.frame_count(); ++f) series.time_s.push_back(motion.rate.FrameTime(f));
  const double dt = 1.0 / motion.rate.hz();
  const auto always = [](int, int) { return true; };
  const auto fitted_place = [&](int f, int j) { return Vector3d(motion.joints.at(f, j)); };
  series.jerk_fitted = JerkOf(motion.frame_count(), motion.joint_count(), dt, always, fitted_place);
  if (evidence.tracks) {
    const TracksOfJoints tracks(*evidence.tracks, *motion.skeleton);
    AddTrackResiduals(motion, tracks, series);
    series.jerk_raw = JerkOf(
        motion.frame_count(), motion.joint_count(), dt, [&](int f, int j) { return tracks.seen(f, j); },
        [&](int f, int j) { return tracks.at(f, j); });
    AddBones(motion, &tracks, series);
  } else {
    AddBones(motion, nullptr, series);
    const bool depth = !evidence.depth_views.empty();
    if (depth || !evidence.keypoint_views.empty()) {
      const char* of_keypoints = "Distance of keypoints from the projected joints, median, px";
      series.residual_name = depth ? "Distance of depth points from the body's surface, median, mm" : of_keypoints;
      if (depth && !evidence.keypoint_views.empty()) series.keypoint_residual_name = of_keypoints;
      for (int f = 0; f < motion.frame_count(); ++f) {
        series.residual.push_back(depth ? CloudResidual(fitted, evidence, f) : KeypointResidual(motion, evidence, f));
        if (!series.keypoint_residual_name.empty())
          series.keypoint_residual.push_back(KeypointResidual(motion, evidence, f));
      }
    }
  }
  for (int f = 0; f < motion.frame_count() && !motion.position_cov.empty(); ++f) {
    double square = 0.0;
    for (int j = 0; j < motion.joint_count(); ++j) square += std::pow(StatedSigmaMm(motion, f, j), 2);
    series.sigma_mm.push_back(std::sqrt(square / motion.joint_count()));
  }
  return series;
}

}  // namespace mocurate
