#include "ingest/synthetic/vibe_track.h"

#include <algorithm>

#include "core/motion/kinematics.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/tracker.h"

namespace mocurate {
namespace {

constexpr double kFocal = 500.0;
constexpr double kHalfImage = 270.0;
constexpr double kBoxMargin = 1.1;
constexpr double kCropScale = 0.9;   // of a box, filled by the person in VIBE's crop
constexpr double kLimb = 0.25;       // metres; bone length that converts position errors to rotation errors
constexpr double kDepthError = 4.0;  // of one image: error along the line of sight, relative to across

/// Errors of the rotations and the root, generated as for tracked points; the last one is the root.
JointPositions ErrorsOf(const Motion& motion, const TrackerOptions& options, std::int64_t seed,
                        const std::string& item) {
  TrackerOptions persistent = options;
  persistent.dropout_share = persistent.outlier_share = persistent.frozen_share = 0.0;
  persistent.swap_share = persistent.swapped_share = 0.0;
  std::vector<std::string> names;
  for (const Joint& joint : motion.skeleton->joints) names.push_back(joint.name);
  names.emplace_back("place of the root");
  const JointPositions still(motion.frame_count(), static_cast<int>(names.size()));
  return Track(still, names, persistent, seed, item + "/rotations").positions;
}

/// Rotations and root with these errors.
Motion DeclaredMotion(const Motion& motion, const JointPositions& errors) {
  const int joints = motion.joint_count();
  std::vector<Vector3d> root = motion.root_translation;
  std::vector<Quaterniond> rotation = motion.rotation;
  for (int f = 0; f < motion.frame_count(); ++f) {
    root[f] += errors.at(f, joints).cwiseProduct(Vector3d(1.0, 1.0, kDepthError));
    for (int j = 0; j < joints; ++j) {
      Quaterniond& own = rotation[static_cast<std::size_t>(f) * joints + j];
      own = (own * ExpQuaternion(errors.at(f, j) / kLimb)).normalized();
    }
  }
  return MakeMotion(motion.skeleton, motion.rate, std::move(root), std::move(rotation), motion.bone_length);
}

}  // namespace

VibeTrack VibeTrackOf(const Motion& motion, const TrackerOptions& options, std::int64_t seed, const std::string& item,
                      const Vector2d& image_centre) {
  VibeTrack track;
  track.id = 1;
  track.frames = static_cast<std::size_t>(motion.frame_count());
  const std::vector<std::string> names = NamesOf(Vibe49Places());
  track.joints = names.size();
  const JointPositions truth = PlacesOf(motion, Vibe49Places());
  TrackedTake tracked = Track(truth, names, options, seed, item);
  ExtrapolateMissing(options, seed, item, tracked);
  const Motion declared = DeclaredMotion(motion, ErrorsOf(motion, options, seed, item));
  for (int f = 0; f < motion.frame_count(); ++f) {
    const std::vector<double> pose = RotationVectors(declared, f);
    track.pose.insert(track.pose.end(), pose.begin(), pose.end());
    const Vector3d root = motion.root_translation[f];
    Vector2d low = Vector2d::Constant(1e9), high = Vector2d::Constant(-1e9);
    for (int k = 0; k < truth.joints; ++k) {
      const Vector3d at = tracked.positions.at(f, k) - root;
      track.joints3d.insert(track.joints3d.end(), at.data(), at.data() + 3);
      const Vector3d place = truth.at(f, k);
      const Vector2d pixel = kFocal * place.head<2>() / place.z() + image_centre;
      low = low.cwiseMin(pixel);
      high = high.cwiseMax(pixel);
    }
    track.betas.insert(track.betas.end(), 10, 0.0);
    const Vector3d declared_root = declared.root_translation[f];
    const double scale = kFocal / (kHalfImage * declared_root.z());
    track.original_camera.insert(track.original_camera.end(), {scale, scale, declared_root.x(), declared_root.y()});
    const Vector2d centre = 0.5 * (low + high);
    const double side = kBoxMargin * (high - low).maxCoeff();
    const double crop = kCropScale * scale * 2.0 * kHalfImage / side;
    const Vector2d shift = (kFocal * root.head<2>() / root.z() + image_centre - centre) / side;
    track.predicted_camera.insert(track.predicted_camera.end(), {crop, 2.0 * shift.x() / crop, 2.0 * shift.y() / crop});
    track.boxes.insert(track.boxes.end(), {centre.x(), centre.y(), side, side});
    track.frame_ids.push_back(f);
  }
  return track;
}

}  // namespace mocurate
