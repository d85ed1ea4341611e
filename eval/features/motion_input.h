#pragma once

#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/motion/motion.h"
#include "eval/options.h"

namespace mocurate {

/// Start of the window in a longer motion.
enum class CropStart {
  kFirst,     ///< at the first frame: not random
  kReleased,  ///< random, never at the last possible frame (a2m_actor.md F15)
  kAny,       ///< random among all possible frames
};

/// Conversion of motions to a network's input; one value for all motions of an extractor.
struct InputRules {
  ExtractorOptions options;
  SkeletonPtr skeleton;                              ///< of the network
  Matrix3d unit_from_metres = Matrix3d::Identity();  ///< to the network's axes and unit
  bool root_rotation = true;                         ///< rotations include the root's

  int frames() const { return static_cast<int>(options.frames); }
  int size() const {
    return options.values == ExtractorValues::kJoints ? 3 * skeleton->joint_count()
                                                      : 6 * (skeleton->joint_count() - (root_rotation ? 0 : 1));
  }
};

/// Error kConfig, kNotFound for unknown axes or skeleton.
Expected<InputRules> RulesOf(const ExtractorOptions& options);

/// For each joint of the network the motion's joint of that name (or synonym). Error kInconsistent names the missing
/// joints.
Expected<std::vector<int>> JointsFor(const Skeleton& network, const Skeleton& motion);

/// Whether the motion's rotations are defined on the network's skeleton. Error kInconsistent: a motion of joints only,
/// another tree, another rest pose.
Status CheckRotations(const Skeleton& network, const Motion& motion);

/// One motion as the network's input: writes (frames, size()) float32 to `values`, and returns the frame whose output
/// is used.
int WriteMotionInput(const InputRules& rules, const std::vector<int>& joints, const Motion& motion, RootRule root,
                     CropStart start, Random& random, float* values);

}  // namespace mocurate
