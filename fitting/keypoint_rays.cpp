#include "fitting/keypoint_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/median.h"
#include "fitting/evidence/detector_points.h"

namespace mocurate {
namespace {

constexpr double kNearInImage = 0.25;  ///< of the body's height in the image

int ImageAt(const KeypointView& view, double time_s, double step_s) {
  const auto after = std::lower_bound(view.time_s.begin(), view.time_s.end(), time_s);
  int nearest = -1;
  double least = 0.5 * step_s + 1e-9;
  for (const auto at : {after, after == view.time_s.begin() ? after : after - 1}) {
    if (at == view.time_s.end() || std::abs(*at - time_s) > least) continue;
    least = std::abs(*at - time_s);
    nearest = static_cast<int>(at - view.time_s.begin());
  }
  return nearest;
}

/// Distances of a detection's keypoints from the joints; `exchanged`: from those of the other side.
std::vector<double> DistancesFromJoints(const KeypointView& view, const std::vector<int>& joint_of, int image,
                                        int person, const Motion& motion, int frame, bool exchanged) {
  std::vector<double> distances;
  for (std::size_t k = 0; k < joint_of.size(); ++k) {
    const double* point = view.at(image, person, static_cast<int>(k));
    if (joint_of[k] < 0 || !(point[2] > 0.0)) continue;
    const int joint = exchanged ? motion.skeleton->joints[joint_of[k]].mirror : joint_of[k];
    const auto pixel = joint < 0 ? std::nullopt : view.camera.ProjectWorld(motion.joints.at(frame, joint));
    if (pixel) distances.push_back((*pixel - Vector2d(point[0], point[1])).norm());
  }
  return distances;
}

double HeightInImage(const Camera& camera, const Motion& motion, int frame) {
  double top = std::numeric_limits<double>::max(), bottom = -top;
  for (int j = 0; j < motion.joint_count(); ++j) {
    const auto pixel = camera.ProjectWorld(motion.joints.at(frame, j));
    if (!pixel) continue;
    top = std::min(top, pixel->y());
    bottom = std::max(bottom, pixel->y());
  }
  return std::max(0.0, bottom - top);
}

}  // namespace

std::vector<int> BodyJointsOfKeypoints(const Skeleton& skeleton, const std::vector<std::string>& keypoint_names) {
  std::vector<int> joints;
  for (const std::string& name : DetectorNames(keypoint_names)) joints.push_back(skeleton.FindJoint(name).value_or(-1));
  return joints;
}

RayAgreement CompareRays(const KeypointView& view, const std::vector<int>& joint_of, const Motion& motion) {
  RayAgreement found;
  std::vector<double> all, exchanged;
  int images = 0, near = 0;
  const double step = motion.rate.FrameTime(1);
  for (int f = 0; f < motion.frame_count(); ++f) {
    const int image = ImageAt(view, motion.rate.FrameTime(f), step);
    int person = -1;
    double least = kNearInImage * HeightInImage(view.camera, motion, f);
    for (int p = 0; image >= 0 && p < view.people; ++p) {
      std::vector<double> distances = DistancesFromJoints(view, joint_of, image, p, motion, f, false);
      if (distances.empty()) continue;
      const double median = MeanMedian(distances);
      if (median >= least) continue;
      least = median;
      person = p;
    }
    found.image.push_back(image);
    found.person.push_back(person);
    images += image >= 0 ? 1 : 0;
    if (person < 0) continue;
    ++near;
    const std::vector<double> own = DistancesFromJoints(view, joint_of, image, person, motion, f, false);
    const std::vector<double> other = DistancesFromJoints(view, joint_of, image, person, motion, f, true);
    all.insert(all.end(), own.begin(), own.end());
    exchanged.insert(exchanged.end(), other.begin(), other.end());
  }
  found.seen = static_cast<int>(all.size());
  found.share = images > 0 ? static_cast<double>(near) / images : 0.0;
  if (!all.empty()) found.median_px = MeanMedian(all);
  if (!exchanged.empty()) found.median_exchanged_px = MeanMedian(exchanged);
  return found;
}

std::vector<JointObservation> RaysOf(const KeypointView& view, const std::vector<int>& joint_of, int image, int person,
                                     double noise_px, double min_confidence, const PoseState& state, int frame) {
  std::vector<JointObservation> rays;
  const RigidTransform world_from_camera = Inverse(view.camera.camera_from_world);
  for (std::size_t k = 0; k < joint_of.size(); ++k) {
    const double* point = view.at(image, person, static_cast<int>(k));
    if (joint_of[k] < 0 || !(point[2] > 0.0) || point[2] < min_confidence) continue;
    const Vector3d place = state.position(frame, joint_of[k]);
    const double depth = (view.camera.camera_from_world * place).z();
    if (!(depth > 0.1)) continue;
    const Vector3d on_ray = world_from_camera * view.camera.Unproject(Vector2d(point[0], point[1]), depth);
    const Vector3d along = (on_ray - view.camera.Centre()).normalized();
    const double weight = std::sqrt(point[2]) * std::abs(view.camera.fx) / (noise_px * depth);
    rays.push_back({joint_of[k], on_ray, weight * (Matrix3d::Identity() - along * along.transpose())});
  }
  return rays;
}

}  // namespace mocurate
