#pragma once

#include <string>
#include <vector>

#include "core/motion/motion.h"

namespace mocurate {

inline constexpr int kSmplJoints = 24;
/// In the order of its pose; those of the hands are SMPL's alone, not SMPL-H's.
extern const char* const kSmplJointNames[kSmplJoints];

/// Rotation vectors of SMPL's joints, as its files have them: (frames, columns) radians, three columns per joint.
struct SmplRotations {
  const std::vector<double>& vectors;
  std::size_t frames = 0;
  std::size_t columns = 3 * kSmplJoints;
  int joints_in_file = kSmplJoints;  ///< the body's; those after them stay at rest
};

/// Whether the skeleton is a tree of SMPL's 24 joints.
bool HasSmplTree(const Skeleton& skeleton);

/// Of each of the skeleton's joints the first of its columns, -1 for a joint that the file says nothing of. Error
/// kConfig names a joint of SMPL's that the skeleton lacks.
Expected<std::vector<int>> SmplColumns(const Skeleton& skeleton, int joints_in_file);

/// Local rotations (F*J) of the skeleton, sign-continuous; the root's is turned by `world_from_file`. Error as above.
Expected<std::vector<Quaterniond>> SmplLocalRotations(const Skeleton& skeleton, const SmplRotations& rotations,
                                                      const Quaterniond& world_from_file);

/// The right-handed turn that a source's axes are. Error kConfig where they mirror: rotations are those of a
/// right-handed frame.
Expected<Quaterniond> TurnOf(const std::string& axes);

}  // namespace mocurate
