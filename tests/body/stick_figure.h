#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/body/bone_capsules.h"

namespace mocurate::test {

/// A trunk of 0.6 m with two arms of 0.5 m along x, posed at the origin; the root has no capsule.
struct StickFigure {
  SkeletonPtr skeleton;
  std::vector<Vector3d> joints;
};

inline StickFigure MakeStickFigure() {
  Skeleton skeleton;
  skeleton.name = "stick";
  const auto add = [&](const char* name, int parent, const Vector3d& offset, double radius) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.rest_offset = offset;
    joint.radius = radius;
    skeleton.joints.push_back(joint);
  };
  add("pelvis", -1, Vector3d::Zero(), 0.1);
  add("neck", 0, Vector3d(0, 0.6, 0), 0.12);
  add("left_hand", 1, Vector3d(0.5, 0, 0), 0.04);
  add("right_hand", 1, Vector3d(-0.5, 0, 0), 0.04);
  StickFigure figure;
  figure.joints = {Vector3d(0, 0, 0), Vector3d(0, 0.6, 0), Vector3d(0.5, 0.6, 0), Vector3d(-0.5, 0.6, 0)};
  figure.skeleton = std::make_shared<const Skeleton>(std::move(skeleton));
  return figure;
}

}  // namespace mocurate::test
