#pragma once

#include <Eigen/Core>

#include "core/motion/motion.h"

namespace mocurate {

/// Rows are samples in time.
using SampleMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A motion at a steady rate of its own, without place and heading: neither the camera nor the place of the person
/// changes it. S samples, the first at the first frame, the last at most `1 / rate_hz` before the last frame; J joints.
struct BodyDescription {
  double rate_hz = 12.5;
  SampleMatrix pose;   ///< (S, 3 J) joints from the middle of the hips, x left, y up, z forward of the hips, metres
  SampleMatrix speed;  ///< (S, J) of each joint in the world, m/s
  Eigen::VectorXd movement;  ///< (S) speed of the fastest joint over 0.4 s (FrameSpeeds), m/s

  int samples() const { return static_cast<int>(pose.rows()); }
  int joints() const { return static_cast<int>(speed.cols()); }
};

/// Joints are averaged by a Gaussian of `smoothing_s` (at least half a frame), so that a tracker's noise of a
/// centimetre does not show. Yaw is read from the hips (of a tree with names of its own, from where the legs or arms
/// begin) and kept while these are nearly vertical; a skeleton without either keeps the world's axes about joint 0. A
/// motion without frames has no samples.
BodyDescription DescribeBody(const Motion& motion, double rate_hz, double smoothing_s);

/// The rows averaged by a Gaussian of `sigma` samples; at the ends over what is there.
SampleMatrix SmoothRows(const SampleMatrix& rows, double sigma);

/// Root mean square of the distances of the sixth (at least two) of the joints that differ most between two poses
/// (3 J), metres: an arm that is raised counts as much in a tree of 24 joints as in one of 15.
double PoseDistance(const Eigen::Ref<const Eigen::RowVectorXd>& a, const Eigen::Ref<const Eigen::RowVectorXd>& b);

}  // namespace mocurate
