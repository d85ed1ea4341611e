#pragma once

#include <array>

#include "core/motion/skeleton.h"

namespace mocurate {

/// The joints of one limb, each above the next in the tree; -1 where there is none.
struct Limb {
  int collar = -1;  ///< of an arm: the shoulder's parent, if on the same side
  int root = -1;    ///< shoulder or hip
  int middle = -1;  ///< elbow or knee
  int end = -1;     ///< wrist or ankle
  int tip = -1;     ///< hand or foot (the ball of the toes)

  bool known() const { return middle >= 0; }
};

/// Arms and legs, left and right, and the ends of the trunk.
struct Limbs {
  std::array<Limb, 2> arm;
  std::array<Limb, 2> leg;
  int chest = -1;   ///< common ancestor of both arms and their collars
  int pelvis = -1;  ///< lowest common ancestor of both legs
};

/// Finds elbows and knees by their names ("left_elbow", "LeftForeArm", "LowerArm_L"; "LeftLeg" where a joint of its
/// side lies above it) and all else by how it hangs from them: exporters call an ankle "LeftFoot", a wrist "LeftHand"
/// and a collar "LeftShoulder", which are other joints elsewhere. Twist joints are skipped.
Limbs LimbsOf(const Skeleton& skeleton);

}  // namespace mocurate
