#include "ingest/synthetic/keypoint_detector.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"

namespace mocurate {
namespace {

constexpr double kSurfaceBeforeJoint = 0.14;  ///< m in front of a point that count as its own surface

double RoundedToStep(double value, double steps) { return std::round(value * steps) / steps; }

}  // namespace

OpenPosePerson Detected(const std::vector<ImagePoint>& points, const KeypointOptions& options, std::int64_t seed,
                        const std::string& item) {
  Random random(static_cast<std::uint64_t>(seed), "studio.keypoints", item);
  OpenPosePerson person;
  for (const ImagePoint& point : points) {
    // The same random draws for every outcome of the point: one option does not change the errors of another.
    const double missed = random.Uniform();
    const double wrong = random.Uniform();
    const double sure = random.Uniform();
    const Vector2d error(random.Normal(), random.Normal());
    const double distance = random.Uniform(0.3, 1.0) * options.wrong_px;
    const double way = random.Uniform(0.0, 6.283185307179586);
    const double miss_share = point.hidden ? 1.0 - options.hidden_share : options.miss_share;
    if (!point.pixel || missed < miss_share) {
      person.pose.push_back({});
      continue;
    }
    double confidence = point.hidden ? 0.25 + 0.35 * sure : 0.6 + 0.35 * sure;
    const bool exact = options.noise == 0.0;
    Vector2d pixel = *point.pixel + options.noise / std::max(0.2, confidence) * 0.8 * error;
    if (wrong < options.wrong_share) {
      pixel += distance * Vector2d(std::cos(way), std::sin(way));
      confidence *= 0.8;
    }
    person.pose.push_back({RoundedToStep(pixel.x(), exact ? 1e6 : 1e3), RoundedToStep(pixel.y(), exact ? 1e6 : 1e3),
                           RoundedToStep(confidence, 1e6)});
  }
  return person;
}

std::vector<ImagePoint> PointsIn(const Camera& camera, const std::vector<PosedCapsule>& capsules,
                                 const JointPositions& places, int frame) {
  std::vector<PosedCapsule> in_camera;
  for (const PosedCapsule& capsule : capsules) {
    in_camera.push_back(
        {camera.camera_from_world * capsule.begin, camera.camera_from_world * capsule.end, capsule.radius});
  }
  std::vector<ImagePoint> points;
  for (int k = 0; k < places.joints; ++k) {
    const Vector3d at = camera.camera_from_world * places.at(frame, k);
    ImagePoint point;
    point.pixel = camera.Project(at);
    const auto inside = [](double value, int size) { return value >= 0.0 && value <= size - 1.0; };
    if (point.pixel && !(inside(point.pixel->x(), camera.width) && inside(point.pixel->y(), camera.height))) {
      point.pixel.reset();
    }
    point.hidden = FirstRayHit(in_camera, at) < 1.0 - kSurfaceBeforeJoint / at.norm();
    points.push_back(point);
  }
  return points;
}

}  // namespace mocurate
