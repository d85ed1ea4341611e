#pragma once

#include "core/motion/kinematics.h"

namespace mocurate {

/// The inverse of LieForward (a2m_actor.md B.4): swing-only parameters of one frame. Exact where the released code
/// gives NaN (bone along its raw offset: zero; bone opposite to it: a half turn about a fixed perpendicular axis).
/// `parameters` receives 3*J numbers.
inline void LieInverse(const Skeleton& skeleton, const Vector3d* joints, double* parameters) {
  const LieChains& lie = *skeleton.lie;
  for (int k = 0; k < 3; ++k) parameters[k] = joints[0][k];
  for (const std::vector<int>& chain : lie.chains) {
    Quaterniond rotation = Quaterniond::Identity();
    for (std::size_t i = 1; i < chain.size(); ++i) {
      const int c = chain[i];
      const Vector3d bone = joints[c] - joints[chain[i - 1]];
      Eigen::Map<Vector3d> w(parameters + std::ptrdiff_t{3} * c);
      w.setZero();
      if (bone.norm() == 0.0) continue;  // no direction: the bone keeps that of the one before it
      const Quaterniond swing = SwingBetween(lie.raw_offsets[c], bone);
      w = LogQuaternion(rotation.conjugate() * swing);
      rotation = swing;
    }
  }
}

}  // namespace mocurate
