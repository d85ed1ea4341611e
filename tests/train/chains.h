#pragma once

#include <memory>
#include <string>

#include "core/motion/skeleton.h"

namespace mocurate {

/// Chains and raw offsets of HumanAct12 (a2m_actor.md B.2).
inline LieChains HumanAct12Chains() {
  LieChains lie;
  lie.chains = {
      {0, 1, 4, 7, 10}, {0, 2, 5, 8, 11}, {0, 3, 6, 9, 12, 15}, {9, 13, 16, 18, 20, 22}, {9, 14, 17, 19, 21, 23}};
  const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  lie.raw_offsets = {Vector3d(0, 0, 0), x, -x, y, -y, -y, y, -y, -y, y, z, z, y, x, -x, z};
  for (int i = 0; i < 8; ++i) lie.raw_offsets.push_back(-y);
  return lie;
}

/// A skeleton of five joints in two chains, for small trainings.
inline SkeletonPtr SmallSkeleton() {
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = "small";
  const int parents[5] = {-1, 0, 1, 0, 3};
  const Vector3d offsets[5] = {{0, 0, 0}, {0, 0.3, 0}, {0, 0.3, 0}, {0, -0.4, 0}, {0, -0.4, 0}};
  for (int j = 0; j < 5; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = parents[j];
    joint.rest_offset = offsets[j];
    joint.mirror = j;
    skeleton->joints.push_back(joint);
  }
  return skeleton;
}

}  // namespace mocurate
