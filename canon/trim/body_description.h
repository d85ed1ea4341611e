#pragma once

#include <Eigen/Core>

#include "core/motion/motion.h"

namespace mocurate {

/// Rows are samples in time.
using SampleMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A motion at a constant rate, without position and heading: invariant to the camera and the person's position. S
/// samples, the first at the first frame, the last at most `1 / rate_hz` before the last frame; J joints.
struct BodyDescription {
  double rate_hz = 12.5;
  SampleMatrix pose;   ///< (S, 3 J) joints from the middle of the hips, x left, y up, z forward of the hips, metres
  SampleMatrix speed;  ///< (S, J) of each joint in the world, m/s
  Eigen::VectorXd movement;  ///< (S) speed of the fastest joint over 0.4 s (FrameSpeeds), m/s

  int samples() const { return static_cast<int>(pose.rows()); }
  int joints() const { return static_cast<int>(speed.cols()); }
};

/// Joints are smoothed by a Gaussian of `smoothing_s` (at least half a frame), to suppress a tracker's noise of about a
/// centimetre. Yaw comes from the hips (in a skeleton with other names, from where the legs or arms begin) and is kept
/// while these are nearly vertical; a skeleton without either keeps the world's axes about joint 0. A motion without
/// frames has no samples.
BodyDescription DescribeBody(const Motion& motion, double rate_hz, double smoothing_s);

/// The rows smoothed by a Gaussian of `sigma` samples, truncated at the ends.
SampleMatrix SmoothRows(const SampleMatrix& rows, double sigma);

/// Root mean square distance over the sixth (at least two) of the joints that differ most between two poses (3 J),
/// metres: a raised arm counts equally in a tree of 24 joints and of 15.
double PoseDistance(const Eigen::Ref<const Eigen::RowVectorXd>& a, const Eigen::Ref<const Eigen::RowVectorXd>& b);

}  // namespace mocurate
