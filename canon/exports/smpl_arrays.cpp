#include "canon/exports/smpl_arrays.h"

#include <algorithm>
#include <utility>

#include "core/base/text.h"
#include "core/motion/kinematics.h"

namespace mocurate {

MotionInAxes::MotionInAxes(const Clip& clip, const AxisConvention& axes)
    : motion(*clip.motion), file_from_world(axes.canonical_from_source.transpose()) {
  if (!motion.joints_only()) ComputeJoints(motion);  // a file's joints may have fewer digits than its rotations
}

std::vector<double> MotionInAxes::Joints(const std::vector<int>& order) const {
  std::vector<double> numbers;
  const int joints = order.empty() ? motion.joint_count() : static_cast<int>(order.size());
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int k = 0; k < joints; ++k) {
      const Vector3d place = file_from_world * motion.joints.at(f, order.empty() ? k : order[k]);
      numbers.insert(numbers.end(), place.data(), place.data() + 3);
    }
  }
  return numbers;
}

std::vector<double> MotionInAxes::RootTranslation() const {
  std::vector<double> numbers;
  for (const Vector3d& root : motion.root_translation) {
    const Vector3d place = file_from_world * root;
    numbers.insert(numbers.end(), place.data(), place.data() + 3);
  }
  return numbers;
}

std::vector<double> MotionInAxes::RotationVectors(const std::vector<int>& order) const {
  const Quaterniond turn(file_from_world);
  std::vector<double> numbers;
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (const int joint : order) {
      const Quaterniond& own = motion.rotation_at(f, joint);
      const Vector3d vector = LogQuaternion(joint == 0 ? (turn * own).normalized() : own);
      numbers.insert(numbers.end(), vector.data(), vector.data() + 3);
    }
  }
  return numbers;
}

Motion OnSmpl24(const Motion& motion, const std::vector<int>& order, BonesReadBack bones) {
  std::vector<double> lengths;
  std::vector<Quaterniond> rotation;
  for (const int joint : order) {
    if (bones == BonesReadBack::kPersons && !motion.bone_length.empty()) lengths.push_back(motion.bone_length[joint]);
  }
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (const int joint : order) rotation.push_back(motion.rotation_at(f, joint));
  }
  return MakeMotion(*LoadSkeleton("smpl24"), motion.rate, motion.root_translation, std::move(rotation),
                    std::move(lengths));
}

double FarthestReadBack(const Motion& motion, const std::vector<int>& order, BonesReadBack bones) {
  const Motion read = OnSmpl24(motion, order, bones);
  double farthest = 0.0;
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int k = 0; k < read.joint_count(); ++k) {
      farthest = std::max(farthest, (read.joints.at(f, k) - motion.joints.at(f, order[k])).norm());
    }
  }
  return farthest;
}

Expected<std::vector<int>> SmplOrder(const Clip& clip) {
  if (clip.motion->joints_only()) {
    return Fail(ErrorCode::kUnsupported, "the motion has joints alone, no rotations", clip.id(),
                "`mocurate fit --skeleton smpl24` estimates rotations");
  }
  const Skeleton& skeleton = *clip.motion->skeleton;
  const Expected<SkeletonPtr> smpl = LoadSkeleton("smpl24");
  if (!smpl) return Forward(smpl);
  std::vector<int> order;
  for (const Joint& joint : (*smpl)->joints) {
    const std::optional<int> own = skeleton.FindJoint(joint.name);
    const int parent = own ? skeleton.joints[*own].parent : -1;
    const int wanted = joint.parent < 0 ? -1 : order[joint.parent];
    if (!own || parent != wanted || skeleton.joint_count() != kSmplBodyJoints) {
      return Fail(ErrorCode::kUnsupported,
                  "skeleton '" + skeleton.name + "' with " + Counted(skeleton.joint_count(), "joint") +
                      " is not SMPL's tree of 24" + (own ? "" : ": it has no '" + joint.name + "'"),
                  clip.id(), "`mocurate fit --skeleton smpl24` fits the clip to that tree");
    }
    order.push_back(*own);
  }
  return order;
}

}  // namespace mocurate
