#include <algorithm>
#include <numeric>

#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/sensors.h"

namespace mocurate {
namespace {

/// Shape coefficients of a person: between man and woman, with small random variation in the others.
std::vector<double> ShapeOf(const BodyTemplate& body, std::int64_t seed, const std::string& subject) {
  Random random(static_cast<std::uint64_t>(seed), "studio.shape", subject);
  std::vector<double> shape(body.shape_names.size(), 0.0);
  for (std::size_t k = 0; k < shape.size(); ++k) {
    // "child" would make a child; the first goes from the man (-1) to the woman (+1).
    const bool is_child = body.shape_names[k].find("child") != std::string::npos;
    shape[k] = is_child ? 0.0 : k == 0 ? random.Uniform(-1.0, 1.0) : random.Uniform(-0.1, 0.25);
  }
  return shape;
}

Expected<SkeletonPtr> SkeletonOfRest(const RestBody& rest, const Skeleton& skeleton) {
  auto own = std::make_shared<Skeleton>(skeleton);
  for (std::size_t j = 1; j < own->joints.size(); ++j) {
    own->joints[j].rest_offset = rest.joints[j] - rest.joints[own->joints[j].parent];
  }
  if (Status fits = own->Check(); !fits) return Forward(fits);
  return SkeletonPtr(own);
}

}  // namespace

Expected<std::vector<Actor>> ActorsOf(const StudioOptions& options, std::int64_t count, const BodyTemplate* body) {
  const Expected<SkeletonPtr> skeleton = LoadSkeleton("smpl24");
  if (!skeleton) return Forward(skeleton);
  if (body != nullptr && body->joint_count() != (*skeleton)->joint_count()) {
    return Fail(ErrorCode::kInconsistent, "the body has " + std::to_string(body->joint_count()) + " joints, not 24",
                options.body.string());
  }
  std::vector<Actor> actors;
  for (Subject& subject : Cast(options.seed, count, **skeleton)) {
    Actor actor{std::move(subject), *skeleton, body, {}};
    if (body != nullptr) {
      actor.rest = Shaped(*body, ShapeOf(*body, options.seed, actor.subject.name));
      const Expected<SkeletonPtr> own = SkeletonOfRest(actor.rest, **skeleton);
      if (!own) return Forward(own);
      actor.skeleton = *own;
      actor.subject.bone_length = (*own)->RestBoneLengths();
    }
    actors.push_back(std::move(actor));
  }
  return actors;
}

Motion SelectFrames(const Motion& motion, const std::vector<int>& frames, const RigidTransform& target_from_world) {
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  for (const int f : frames) {
    root.push_back(target_from_world * motion.root_translation[f]);
    for (int j = 0; j < motion.joint_count(); ++j) {
      const Quaterniond& own = motion.rotation_at(f, j);
      rotation.push_back(j == 0 ? (target_from_world.rotation * own).normalized() : own);
    }
  }
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  for (std::size_t j = 0; j < joints; ++j) MakeSignContinuous(rotation.data() + j, frames.size(), joints);
  return MakeMotion(motion.skeleton, motion.rate, std::move(root), std::move(rotation), motion.bone_length);
}

Motion SelectFrames(const Motion& motion, const RigidTransform& target_from_world) {
  std::vector<int> frames(static_cast<std::size_t>(motion.frame_count()));
  std::iota(frames.begin(), frames.end(), 0);
  return SelectFrames(motion, frames, target_from_world);
}

Motion DelayBy(const Motion& motion, double seconds) {
  if (seconds == 0.0) return motion;
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  const int last = motion.frame_count() - 1;
  for (int f = 0; f <= last; ++f) {
    const double at = std::clamp(f + seconds * motion.rate.hz(), 0.0, static_cast<double>(last));
    const int before = std::min(static_cast<int>(at), std::max(0, last - 1));
    const int after = std::min(before + 1, last);
    const double part = at - before;
    root.push_back((1.0 - part) * motion.root_translation[before] + part * motion.root_translation[after]);
    for (int j = 0; j < motion.joint_count(); ++j) {
      rotation.push_back(motion.rotation_at(before, j).slerp(part, motion.rotation_at(after, j)).normalized());
    }
  }
  return MakeMotion(motion.skeleton, motion.rate, std::move(root), std::move(rotation), motion.bone_length);
}

RigidTransform LooksDown(double tilt) {
  return {Quaterniond(Eigen::AngleAxisd(tilt, Vector3d::UnitX())), Vector3d::Zero()};
}

RigidTransform HalfRotationAboutX() { return {Quaterniond(0.0, 1.0, 0.0, 0.0), Vector3d::Zero()}; }

double RoundedToDigits(double value, int digits) {
  if (value == 0.0) return 0.0;
  const double step = std::pow(10.0, std::floor(std::log10(std::abs(value))) - (digits - 1));
  return std::round(value / step) * step;
}

std::vector<double> RotationVectors(const Motion& motion, int frame) {
  std::vector<double> vectors;
  for (int j = 0; j < motion.joint_count(); ++j) {
    const Vector3d vector = LogQuaternion(motion.rotation_at(frame, j));
    vectors.insert(vectors.end(), vector.data(), vector.data() + 3);
  }
  return vectors;
}

Status WriteDepthImages(const StudioOptions& options, const Actor& actor, const Motion& motion, const Camera& camera,
                        const std::string& item, const std::vector<float>& background, bool mirrored,
                        const std::function<std::string(int)>& name_of, StudioFolder& folder) {
  const std::vector<Vector2d> rays = PixelRays(camera);
  const BodyView body(actor);
  for (int f = 0; f < motion.frame_count(); f += static_cast<int>(options.depth.every)) {
    DepthImage image = SimulateDepth(body.Depth(motion, f, camera, rays), background, camera, rays, options.depth,
                                     options.seed, item + "/" + std::to_string(f));
    if (mirrored) image = Mirrored(image);
    if (Status written = folder.WriteImage(name_of(f), image); !written) return written;
  }
  return {};
}

}  // namespace mocurate
