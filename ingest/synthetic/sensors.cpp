#include "ingest/synthetic/sensors.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/body/skinned_body.h"
#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

constexpr double kEdge = 0.06;     // metres between neighbours on different surfaces
constexpr double kFarthest = 8.0;  // metres; no return from farther away
constexpr double kNearest = 0.4;
constexpr double kDepthStepsPerMetre = 1000.0;

class Surface {
 public:
  Surface(std::vector<float> depth, const Camera& camera, const std::vector<Vector2d>& rays)
      : depth_(std::move(depth)), camera_(camera), rays_(rays) {}

  float at(int x, int y) const {
    if (x < 0 || y < 0 || x >= camera_.width || y >= camera_.height) return 0.0F;
    return depth_[static_cast<std::size_t>(y) * camera_.width + x];
  }

  /// A neighbour on another surface or in the void: its depth, 0 for the void; negative: no such neighbour.
  float Across(int x, int y) const {
    const float own = at(x, y);
    for (const auto& [dx, dy] : {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)}) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= camera_.width || y + dy >= camera_.height) continue;
      const float other = at(x + dx, y + dy);
      if (std::abs(other - own) > kEdge) return other;
    }
    return -1.0F;
  }

  /// Cosine of the angle between the ray and the surface's normal; 1 where the normal is unknown.
  double Incidence(int x, int y) const {
    const auto point = [&](int px, int py) {
      const Vector2d& ray = rays_[static_cast<std::size_t>(py) * camera_.width + px];
      return Vector3d(at(px, py) * Vector3d(ray.x(), ray.y(), 1.0));
    };
    if (x + 1 >= camera_.width || y + 1 >= camera_.height) return 1.0;
    if (at(x + 1, y) == 0.0F || at(x, y + 1) == 0.0F) return 1.0;
    const Vector3d here = point(x, y);
    const Vector3d normal = (point(x + 1, y) - here).cross(point(x, y + 1) - here);
    return normal.norm() > 0.0 ? std::abs(normal.normalized().dot(here.normalized())) : 1.0;
  }

 private:
  std::vector<float> depth_;
  const Camera& camera_;
  const std::vector<Vector2d>& rays_;
};

/// The nearest of the sensor's levels, which are equidistant in the integral of distance^-growth: in disparity for 2.
double Stepped(double metres, const DepthSensorOptions& options) {
  const double step = options.quantisation;
  if (step <= 0.0) return metres;
  const double power = 1.0 - options.quantisation_growth;
  if (std::abs(power) < 1e-9) return std::exp(std::round(std::log(metres) / step) * step);
  const double level = std::round(std::pow(metres, power) / power / step) * step;
  return std::pow(std::max(1e-9, level * power), 1.0 / power);
}

std::uint16_t Quantised(double metres, const DepthSensorOptions& options) {
  if (metres < kNearest || metres > kFarthest) return 0;
  return static_cast<std::uint16_t>(
      std::clamp(std::lround(Stepped(metres, options) * kDepthStepsPerMetre), 0L, 65535L));
}

constexpr double kSurfaceBeforeJoint = 0.14;  ///< m in front of a point that count as its own surface

double RoundedToStep(double value, double steps) { return std::round(value * steps) / steps; }

}  // namespace

std::vector<float> RoomDepth(const Camera& camera, const std::vector<Vector2d>& rays, double wall) {
  const RigidTransform world_from_camera = Inverse(camera.camera_from_world);
  const Vector3d centre = world_from_camera.translation;
  std::vector<float> depth;
  depth.reserve(rays.size());
  for (const Vector2d& ray : rays) {
    const Vector3d direction = world_from_camera.rotation * Vector3d(ray.x(), ray.y(), 1.0);
    double nearest = 0.0;
    const auto meet = [&](double t) {
      if (t > 0.0 && (nearest == 0.0 || t < nearest)) nearest = t;
    };
    if (direction.y() != 0.0) meet(-centre.y() / direction.y());
    if (direction.z() != 0.0) meet((-wall - centre.z()) / direction.z());
    depth.push_back(nearest <= kFarthest ? static_cast<float>(nearest) : 0.0F);
  }
  return depth;
}

DepthImage SimulateDepth(const std::vector<float>& body, const std::vector<float>& background, const Camera& camera,
                         const std::vector<Vector2d>& rays, const DepthSensorOptions& options, std::int64_t seed,
                         const std::string& item) {
  std::vector<float> depth = body;
  for (std::size_t i = 0; i < background.size(); ++i) {
    if (background[i] > 0.0F && (depth[i] == 0.0F || background[i] < depth[i])) depth[i] = background[i];
  }
  const Surface surface(depth, camera, rays);
  Random random(static_cast<std::uint64_t>(seed), "studio.depth", item);
  DepthImage image{camera.width, camera.height, std::vector<std::uint16_t>(depth.size(), 0)};
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * camera.width + x;
      if (depth[pixel] == 0.0F) continue;
      const bool is_hole = options.hole_share > 0.0 && random.Uniform() < options.hole_share;
      const double grain = options.noise > 0.0 ? random.Normal() : 0.0;
      double metres = depth[pixel];
      const float across = surface.Across(x, y);
      if (across >= 0.0F && options.flying_share > 0.0 && random.Uniform() < options.flying_share) {
        // Light from both sides mixes; beside the void half of it is too weak for a measurement.
        const double part = random.Uniform();
        if (across == 0.0F && part < 0.5) continue;
        metres = across == 0.0F ? metres + 0.05 * part : metres + part * (across - metres);
      }
      if (is_hole) continue;
      if (options.grazing > 0.0 && across < 0.0F && surface.Incidence(x, y) < options.grazing) continue;
      image.values[pixel] = Quantised(metres + options.noise * metres * metres * grain, options);
    }
  }
  return image;
}

DepthImage Mirrored(const DepthImage& image) {
  DepthImage mirrored = image;
  for (int y = 0; y < image.height; ++y) {
    const auto row = mirrored.values.begin() + static_cast<std::ptrdiff_t>(y) * image.width;
    std::reverse(row, row + image.width);
  }
  return mirrored;
}

BodyView::BodyView(const Actor& actor)
    : actor_(actor),
      capsules_(CapsuleBody::Make(actor.skeleton, BodyScale(*actor.skeleton, actor.subject.bone_length))) {}

std::vector<PosedCapsule> BodyView::Capsules(const Motion& motion, int frame) const {
  std::vector<Vector3d> joints(static_cast<std::size_t>(motion.joint_count()));
  std::vector<Quaterniond> global(joints.size());
  ForwardKinematics(*motion.skeleton, motion.root_translation[frame], &motion.rotation_at(frame, 0), motion.bone_length,
                    joints.data(), global.data());
  return PosedCapsules(capsules_, joints.data(), global.data());
}

std::vector<float> BodyView::Depth(const Motion& motion, int frame, const Camera& camera,
                                   const std::vector<Vector2d>& rays) const {
  if (actor_.body == nullptr) return RenderCapsules(Capsules(motion, frame), camera, rays).depth;
  std::vector<Quaterniond> rotations;
  for (int j = 0; j < motion.joint_count(); ++j) rotations.push_back(motion.rotation_at(frame, j));
  const Vector3d translation = motion.root_translation[frame] - actor_.rest.joints[0];
  const RestBody posed = Posed(*actor_.body, actor_.rest, rotations, translation);
  return RenderMesh(posed.vertices, actor_.body->faces, camera, rays);
}

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

std::vector<bool> HiddenPoints(const Camera& camera, std::vector<PosedCapsule> capsules, const JointPositions& places,
                               int frame, double own_surface) {
  for (PosedCapsule& capsule : capsules) {
    capsule.begin = camera.camera_from_world * capsule.begin;
    capsule.end = camera.camera_from_world * capsule.end;
  }
  std::vector<bool> hidden;
  for (int k = 0; k < places.joints; ++k) {
    const Vector3d at = camera.camera_from_world * places.at(frame, k);
    hidden.push_back(FirstRayHit(capsules, at) < 1.0 - own_surface / at.norm());
  }
  return hidden;
}

std::vector<ImagePoint> PointsIn(const Camera& camera, const std::vector<PosedCapsule>& capsules,
                                 const JointPositions& places, int frame) {
  const std::vector<bool> hidden = HiddenPoints(camera, capsules, places, frame, kSurfaceBeforeJoint);
  const auto inside = [](double value, int size) { return value >= 0.0 && value <= size - 1.0; };
  std::vector<ImagePoint> points;
  for (int k = 0; k < places.joints; ++k) {
    ImagePoint point{camera.Project(camera.camera_from_world * places.at(frame, k)),
                     hidden[static_cast<std::size_t>(k)]};
    if (point.pixel && !(inside(point.pixel->x(), camera.width) && inside(point.pixel->y(), camera.height))) {
      point.pixel.reset();
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace mocurate
