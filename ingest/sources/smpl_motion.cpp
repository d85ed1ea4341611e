#include "ingest/sources/smpl_motion.h"

namespace mocurate {

const char* const kSmplJointNames[kSmplJoints] = {
    "pelvis",     "left_hip",    "right_hip",    "spine1",      "left_knee",     "right_knee",
    "spine2",     "left_ankle",  "right_ankle",  "spine3",      "left_foot",     "right_foot",
    "neck",       "left_collar", "right_collar", "head",        "left_shoulder", "right_shoulder",
    "left_elbow", "right_elbow", "left_wrist",   "right_wrist", "left_hand",     "right_hand"};

bool HasSmplTree(const Skeleton& skeleton) {
  return skeleton.joint_count() == kSmplJoints && SmplColumns(skeleton, kSmplJoints).has_value();
}

Expected<std::vector<int>> SmplColumns(const Skeleton& skeleton, int joints_in_file) {
  std::vector<int> columns(skeleton.joints.size(), -1);
  for (int k = 0; k < kSmplJoints; ++k) {
    const std::optional<int> joint = skeleton.FindJoint(kSmplJointNames[k]);
    if (!joint || (k == 0) != (skeleton.joints[*joint].parent < 0)) {
      return Fail(ErrorCode::kConfig,
                  "skeleton '" + skeleton.name + "' has no joint '" + kSmplJointNames[k] + "' of SMPL's tree",
                  "ingest.source.skeleton", "rotations of SMPL are read on smpl24");
    }
    if (k < joints_in_file) columns[*joint] = 3 * k;
  }
  return columns;
}

Expected<std::vector<Quaterniond>> SmplLocalRotations(const Skeleton& skeleton, const SmplRotations& rotations,
                                                      const Quaterniond& world_from_file) {
  const Expected<std::vector<int>> columns = SmplColumns(skeleton, rotations.joints_in_file);
  if (!columns) return Forward(columns);
  const std::size_t joints = columns->size();
  std::vector<Quaterniond> local(rotations.frames * joints, Quaterniond::Identity());
  for (std::size_t f = 0; f < rotations.frames; ++f) {
    for (std::size_t j = 0; j < joints; ++j) {
      const int column = (*columns)[j];
      if (column < 0) continue;
      const double* vector = &rotations.vectors[f * rotations.columns + static_cast<std::size_t>(column)];
      const Quaterniond turned = ExpQuaternion(Vector3d(vector[0], vector[1], vector[2]));
      local[f * joints + j] = (column == 0 ? world_from_file * turned : turned).normalized();
    }
  }
  for (std::size_t j = 0; j < joints; ++j) MakeSignContinuous(local.data() + j, rotations.frames, joints);
  return local;
}

}  // namespace mocurate
