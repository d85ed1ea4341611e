#pragma once

#include <vector>

#include "core/geometry/axes.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Joints of SMPL's body, in the order of smpl24.
inline constexpr int kSmplBodyJoints = 24;

/// A clip's motion in the axes of a layout. F frames, J joints of the skeleton.
struct MotionInAxes {
  Motion motion;  ///< joints computed from its rotations, where it has any
  Matrix3d file_from_world;

  MotionInAxes(const Clip& clip, const AxisConvention& axes);
  /// (F*J*3) metres, of the joints in this order; empty: the skeleton's.
  std::vector<double> Joints(const std::vector<int>& order = {}) const;
  /// (F*3) metres.
  std::vector<double> RootTranslation() const;
  /// (F*3*N) rotation vectors, radians, of the first N joints in this order; the root's is rotated into the file's
  /// axes.
  std::vector<double> RotationVectors(const std::vector<int>& order) const;
};

/// The bone lengths used when a motion is read on smpl24.
enum class BonesReadBack { kPersons, kSmpl24 };

/// Rotations and root on the rest directions of smpl24, its joints in SMPL's order.
Motion OnSmpl24(const Motion& motion, const std::vector<int>& order, BonesReadBack bones);

/// Largest distance of a joint, in metres, between OnSmpl24 and the motion.
double FarthestReadBack(const Motion& motion, const std::vector<int>& order, BonesReadBack bones);

/// For each of SMPL's 24 joints, in their order, the joint of the skeleton. Error kUnsupported names the missing joint,
/// or reports missing rotations; `clip` for messages.
Expected<std::vector<int>> SmplOrder(const Clip& clip);

}  // namespace mocurate
