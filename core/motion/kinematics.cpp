#include "core/motion/kinematics.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mocurate {
namespace {

/// Rest offsets scaled to the person's bone lengths; `bone_length` empty: as they are.
std::vector<Vector3d> ScaledOffsets(const Skeleton& skeleton, const std::vector<double>& bone_length) {
  std::vector<Vector3d> offsets;
  offsets.reserve(skeleton.joints.size());
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Vector3d& rest = skeleton.joints[j].rest_offset;
    const double length = rest.norm();
    const bool scale = !bone_length.empty() && length > 0.0;
    offsets.push_back(scale ? Vector3d(rest * (bone_length[j] / length)) : rest);
  }
  return offsets;
}

void TreeForward(const Skeleton& skeleton, const std::vector<Vector3d>& offsets, const Vector3d& root_translation,
                 const Quaterniond* rotation, Vector3d* joints, Quaterniond* global_rotation) {
  joints[0] = root_translation;
  global_rotation[0] = rotation[0];
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const int p = skeleton.joints[j].parent;
    joints[j] = joints[p] + global_rotation[p] * offsets[j];
    global_rotation[j] = global_rotation[p] * rotation[j];
  }
}

/// Rodrigues with the released floor: the squared angle is at least 1e-4 in the factors.
Matrix3d ReleasedExp(const Vector3d& w) {
  const double angle = std::sqrt(std::max(w.squaredNorm(), 1e-4));
  const Matrix3d hat = Hat(w);
  return Matrix3d::Identity() + std::sin(angle) / angle * hat + (1.0 - std::cos(angle)) / (angle * angle) * hat * hat;
}

Matrix3d LieExpMatrix(const Vector3d& w, LieExp exp) {
  return exp == LieExp::kReleased ? ReleasedExp(w) : ExpMatrix(w);
}

}  // namespace

void ForwardKinematics(const Skeleton& skeleton, const Vector3d& root_translation, const Quaterniond* rotation,
                       const std::vector<double>& bone_length, Vector3d* joints, Quaterniond* global_rotation) {
  std::vector<Quaterniond> own;
  if (global_rotation == nullptr) {
    own.resize(skeleton.joints.size());
    global_rotation = own.data();
  }
  TreeForward(skeleton, ScaledOffsets(skeleton, bone_length), root_translation, rotation, joints, global_rotation);
}

void ComputeJoints(Motion& motion) {
  const Skeleton& skeleton = *motion.skeleton;
  const int count = skeleton.joint_count();
  const int frames = static_cast<int>(motion.root_translation.size());
  const std::vector<Vector3d> offsets = ScaledOffsets(skeleton, motion.bone_length);
  std::vector<Vector3d> joints(count);
  std::vector<Quaterniond> global(count);
  if (motion.joints.frames != frames || motion.joints.joints != count) motion.joints = JointPositions(frames, count);
  for (int f = 0; f < frames; ++f) {
    const Quaterniond* rotation = motion.rotation.data() + static_cast<std::size_t>(f) * count;
    TreeForward(skeleton, offsets, motion.root_translation[f], rotation, joints.data(), global.data());
    for (int j = 0; j < count; ++j) motion.joints.at(f, j) = joints[j];
  }
}

Motion MakeMotion(SkeletonPtr skeleton, FrameRate rate, std::vector<Vector3d> root_translation,
                  std::vector<Quaterniond> rotation, std::vector<double> bone_length) {
  Motion motion;
  motion.skeleton = std::move(skeleton);
  motion.rate = rate;
  motion.root_translation = std::move(root_translation);
  motion.rotation = std::move(rotation);
  motion.bone_length = bone_length.empty() ? motion.skeleton->RestBoneLengths() : std::move(bone_length);
  ComputeJoints(motion);
  return motion;
}

Motion MakeJointsOnly(SkeletonPtr skeleton, FrameRate rate, JointPositions joints) {
  Motion motion;
  motion.skeleton = std::move(skeleton);
  motion.rate = rate;
  motion.joints = std::move(joints);
  return motion;
}

void LieForward(const Skeleton& skeleton, const double* parameters, const std::vector<double>& bone_length, LieExp exp,
                Vector3d* joints, const Vector3d* root_rotation) {
  const LieChains& lie = *skeleton.lie;
  joints[0] = Vector3d(parameters[0], parameters[1], parameters[2]);
  const Matrix3d start = root_rotation == nullptr ? Matrix3d::Identity() : LieExpMatrix(*root_rotation, exp);
  for (const std::vector<int>& chain : lie.chains) {
    Matrix3d rotation = start;
    for (std::size_t i = 1; i < chain.size(); ++i) {
      const int c = chain[i];
      rotation *= LieExpMatrix(Eigen::Map<const Vector3d>(parameters + std::ptrdiff_t{3} * c), exp);
      joints[c] = joints[chain[i - 1]] + rotation * (bone_length[c] * lie.raw_offsets[c]);
    }
  }
}

std::vector<double> BoneLengths(const Skeleton& skeleton, const Vector3d* joints) {
  std::vector<int> parents;
  if (skeleton.lie) {
    parents = skeleton.LieParents();
  } else {
    for (const Joint& joint : skeleton.joints) parents.push_back(joint.parent);
  }
  std::vector<double> lengths(skeleton.joints.size(), 0.0);
  for (int j = 1; j < skeleton.joint_count(); ++j) lengths[j] = (joints[j] - joints[parents[j]]).norm();
  return lengths;
}

void LieFromTree(const Motion& motion, int frame, double* parameters) {
  const Skeleton& skeleton = *motion.skeleton;
  const int count = skeleton.joint_count();
  std::vector<Vector3d> joints(count);
  std::vector<Quaterniond> global(count);
  ForwardKinematics(skeleton, motion.root_translation[frame], &motion.rotation_at(frame, 0), motion.bone_length,
                    joints.data(), global.data());
  for (int k = 0; k < 3; ++k) parameters[k] = joints[0][k];
  for (const std::vector<int>& chain : skeleton.lie->chains) {
    Quaterniond before = Quaterniond::Identity();
    for (std::size_t i = 1; i < chain.size(); ++i) {
      const int c = chain[i];
      const Vector3d& rest = skeleton.joints[c].rest_offset;
      const bool has_direction = rest.norm() > 0.0;
      const Quaterniond rest_from_raw =
          has_direction ? SwingBetween(skeleton.lie->raw_offsets[c], rest) : Quaterniond::Identity();
      const Quaterniond bone = global[skeleton.joints[c].parent] * rest_from_raw;
      Eigen::Map<Vector3d>(parameters + std::ptrdiff_t{3} * c) = LogQuaternion(before.conjugate() * bone);
      before = bone;
    }
  }
}

}  // namespace mocurate
