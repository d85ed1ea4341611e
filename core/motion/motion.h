#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// Frames per second as a fraction, so that 120000/1001 stays exact.
struct FrameRate {
  std::int64_t numerator = 30;
  std::int64_t denominator = 1;

  double hz() const { return static_cast<double>(numerator) / static_cast<double>(denominator); }
  double FrameTime(std::int64_t frame) const {
    return static_cast<double>(frame) * static_cast<double>(denominator) / static_cast<double>(numerator);
  }
  /// "30", "120000/1001"; Error kMalformed unless both are positive.
  static Expected<FrameRate> Parse(std::string_view text);
  /// Nearest fraction with denominator 1 or 1001 within 1e-4 relative, else a fraction of micro-hertz.
  static FrameRate FromHz(double hz);
  std::string Text() const;
};
bool operator==(const FrameRate& a, const FrameRate& b);

/// (frames, joints, 3), row-major, contiguous. Metres.
struct JointPositions {
  int frames = 0;
  int joints = 0;
  std::vector<double> xyz;

  JointPositions() = default;
  JointPositions(int frame_count, int joint_count)
      : frames(frame_count), joints(joint_count), xyz(static_cast<std::size_t>(frame_count) * joint_count * 3, 0.0) {}

  Eigen::Map<Vector3d> at(int frame, int joint) {
    return Eigen::Map<Vector3d>(xyz.data() + 3 * (static_cast<std::size_t>(frame) * joints + joint));
  }
  Eigen::Map<const Vector3d> at(int frame, int joint) const {
    return Eigen::Map<const Vector3d>(xyz.data() + 3 * (static_cast<std::size_t>(frame) * joints + joint));
  }
  bool empty() const { return xyz.empty(); }
};

/// Where a joint of a frame comes from; training can mask on it. Samples that contradict the fitted body count as not
/// observed: interpolated where such a gap is short, else inferred.
enum class JointState : std::uint8_t { kObserved = 0, kRepaired = 1, kInterpolated = 2, kInferred = 3 };

/// Motion of one person. Either full (root translation and one rotation per joint; joints are computed from them) or
/// joints only (`rotation` empty, never invented). Optional fields are empty or have exactly the stated shape.
/// F frames, J joints of `skeleton`.
struct Motion {
  SkeletonPtr skeleton;
  SkeletonPtr rotation_reference;  ///< skeleton whose rest pose has zero rotations; null: `skeleton`
  FrameRate rate;
  std::vector<Vector3d> root_translation;  ///< (F) of joint 0 in the world; empty if joints only
  std::vector<Quaterniond> rotation;  ///< (F*J) parent_from_joint; for the root world_from_root; empty if joints only
  JointPositions joints;              ///< (F,J,3) in the world
  std::vector<double> bone_length;    ///< (J) of this person, bone that ends at the joint; empty if joints only

  std::vector<JointState> state;         ///< (F*J)
  std::vector<float> position_cov;       ///< (F*J*6) xx xy xz yy yz zz, m^2
  std::vector<float> rotation_sigma;     ///< (F*J*3) rad
  std::vector<float> rotation_observed;  ///< (F*J*3) 1 - posterior/prior variance
  std::vector<std::uint8_t> contact;     ///< (F*2) left and right foot

  int frame_count() const { return joints.frames; }
  int joint_count() const { return joints.joints; }
  bool joints_only() const { return rotation.empty(); }
  /// Skeleton of the common rest pose, so that rotations of several people are comparable: `skeleton` without this
  /// person's bone directions.
  const SkeletonPtr& rest_pose() const { return rotation_reference ? rotation_reference : skeleton; }
  double duration() const { return rate.FrameTime(frame_count()); }

  Quaterniond& rotation_at(int frame, int joint) {
    return rotation[static_cast<std::size_t>(frame) * joint_count() + joint];
  }
  const Quaterniond& rotation_at(int frame, int joint) const {
    return rotation[static_cast<std::size_t>(frame) * joint_count() + joint];
  }

  /// Shapes agree, numbers finite, quaternions unit to 1e-6, joints equal forward kinematics to 1e-6 m.
  Status Check() const;
};

/// Sixteen hexadecimal digits that identify a motion: of the SHA-256 over its rate and its joints as a dataset stores
/// them (float32). Equal in every file that holds the motion, with any id or label.
std::string MotionFingerprint(const Motion& motion);

/// Symmetric 3 x 3 matrices stored as six numbers, xx xy xz yy yz zz: covariances of positions.
inline Eigen::Matrix3d FromSixNumbers(const float* c) {
  Eigen::Matrix3d full;
  full << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return full;
}

inline void ToSixNumbers(const Eigen::Matrix3d& full, float* c) {
  const double values[6] = {full(0, 0), full(0, 1), full(0, 2), full(1, 1), full(1, 2), full(2, 2)};
  for (int i = 0; i < 6; ++i) c[i] = static_cast<float>(values[i]);
}

}  // namespace mocurate
