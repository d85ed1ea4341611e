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

void AddTrackResiduals(const Motion& motion, const JointTracks& recorded, ClipSeries& series) {
  const TracksOfJoints tracks = InJoints(recorded, *motion.skeleton);
  series.residual_name = "Distance of the fit from the tracked joints, mm";
  for (int f = 0; f < std::min(motion.frame_count(), tracks.joints.frames); ++f) {
    double square = 0.0;
    double most = 0.0;
    int count = 0;
    for (int j = 0; j < motion.joint_count(); ++j) {
      if (tracks.confidence[static_cast<std::size_t>(f) * motion.joint_count() + j] <= 0.0) continue;
      const double distance = 1e3 * (motion.joints.at(f, j) - tracks.joints.at(f, j)).norm();
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

}  // namespace

double StatedSigmaMm(const Motion& motion, int frame, int joint) {
  if (motion.position_cov.empty()) return kNan;
  const float* c = motion.position_cov.data() + 6 * (static_cast<std::size_t>(frame) * motion.joint_count() + joint);
  const double variance = (static_cast<double>(c[0]) + c[3] + c[5]) / 3.0;
  return variance >= 0.0 ? 1e3 * std::sqrt(variance) : kNan;
}

TracksOfJoints InJoints(const JointTracks& tracks, const Skeleton& skeleton) {
  const std::vector<int> points = MatchTracks(tracks.names, skeleton).point_of_joint;
  const int frames = tracks.positions.frames, joints = skeleton.joint_count();
  TracksOfJoints own{JointPositions(frames, joints), std::vector<double>(static_cast<std::size_t>(frames) * joints)};
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < joints; ++j) {
      if (points[j] < 0 || !Observes(tracks, f, points[j])) continue;
      own.joints.at(f, j) = tracks.positions.at(f, points[j]);
      own.confidence[static_cast<std::size_t>(f) * joints + j] = 1.0;
    }
  }
  return own;
}

Expected<ClipSeries> SeriesOf(const Clip& fitted, const Evidence& evidence) {
  if (Status ok = CheckFrame(fitted, 0); !ok) return Forward(ok);
  const Motion& motion = *fitted.motion;
  ClipSeries series;
  if (evidence.tracks) {
    AddTrackResiduals(motion, *evidence.tracks, series);
  } else {
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
  return series;
}

}  // namespace mocurate
