#pragma once

#include <string>
#include <vector>

#include "core/motion/motion.h"

namespace mocurate {

inline constexpr int kSmplJoints = 24;
/// In the order of its pose; those of the hands are only in SMPL, not in SMPL-H.
extern const char* const kSmplJointNames[kSmplJoints];

/// Rotation vectors of SMPL's joints, as its files have them: (frames, columns) radians, three columns per joint.
struct SmplRotations {
  const std::vector<double>& vectors;
  std::size_t frames = 0;
  std::size_t columns = std::size_t{3} * kSmplJoints;
  int joints_in_file = kSmplJoints;  ///< the body's; joints after them stay at rest
};

/// Whether the skeleton is a tree of SMPL's 24 joints.
bool HasSmplTree(const Skeleton& skeleton);

/// The first column of each of the skeleton's joints, -1 for a joint that the file lacks. Error kConfig names a joint
/// of SMPL's that the skeleton lacks.
Expected<std::vector<int>> SmplColumns(const Skeleton& skeleton, int joints_in_file);

/// Local rotations (F*J) of the skeleton, sign-continuous; the root's is rotated by `world_from_file`. Error as above.
Expected<std::vector<Quaterniond>> SmplLocalRotations(const Skeleton& skeleton, const SmplRotations& rotations,
                                                      const Quaterniond& world_from_file);

}  // namespace mocurate
