#pragma once

#include <cstddef>
#include <string_view>

#include "core/motion/skeleton.h"

namespace mocurate {

/// BodyShape is a person's difference from the CC0 template of the same size, in standard deviations of principal
/// components. The components are of capsule bodies of that template's variants (sexes, children, heavy, thin,
/// muscular, tall and short people), with size removed. 0: the template, the mean of man and woman.

/// Change of the rest offset of one of SMPL's joints, metres at the template's size. Zero for other names.
Vector3d OffsetChange(std::string_view joint, const BodyShape& shape);

/// Change of a capsule of the left side against the template's, metres at the template's size.
struct CapsuleChange {
  Vector3d begin = Vector3d::Zero();
  Vector3d end = Vector3d::Zero();
  double radius = 0.0;
};

/// Of the bones and of the other parts of CapsuleBody, in its order.
CapsuleChange ChangeOfBone(std::size_t bone, const BodyShape& shape);
CapsuleChange ChangeOfPart(std::size_t part, const BodyShape& shape);

}  // namespace mocurate
