#pragma once

#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/motion/motion.h"
#include "eval/features/extractor_options.h"

namespace mocurate {

/// Which frames of a longer motion a window takes.
enum class CropStart {
  kFirst,     ///< from the first frame on: nothing is drawn
  kReleased,  ///< drawn, the last place never (a2m_actor.md F15)
  kAny,       ///< drawn among all places
};

/// How motions become what a network reads. One value serves all motions of an extractor.
struct InputRules {
  SkeletonPtr skeleton;                              ///< of the network
  Matrix3d unit_from_metres = Matrix3d::Identity();  ///< to the network's axes and unit
  int frames = 60;
  LengthRule length = LengthRule::kCrop;
  PaddingRule padding = PaddingRule::kRepeatLast;
  ReadOut read_out = ReadOut::kLastFrame;
  ExtractorValues values = ExtractorValues::kJoints;
  bool root_rotation = true;  ///< of rotations: the root's is read too

  int size() const {
    return values == ExtractorValues::kJoints ? 3 * skeleton->joint_count()
                                              : 6 * (skeleton->joint_count() - (root_rotation ? 0 : 1));
  }
};

/// Error kConfig, kNotFound for axes or a skeleton that there are not.
Expected<InputRules> RulesOf(const ExtractorOptions& options);

/// For each joint of the network the motion's joint of that name (or synonym). Error kInconsistent names those that the
/// motion lacks.
Expected<std::vector<int>> JointsFor(const Skeleton& network, const Skeleton& motion);

/// Whether rotations of the motion are those of the network's skeleton. Error kInconsistent: a motion of joints alone,
/// another tree, another rest pose.
Status CheckRotations(const Skeleton& network, const Motion& motion);

/// One motion as the network reads it: writes (frames, size()) float32 to `values`, and gives the frame after which the
/// output counts.
int WriteMotionInput(const InputRules& rules, const std::vector<int>& joints, const Motion& motion, RootRule root,
                     CropStart start, Random& random, float* values);

}  // namespace mocurate
