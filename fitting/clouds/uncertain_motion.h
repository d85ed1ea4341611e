#pragma once

#include <vector>

#include "core/motion/motion.h"
#include "fitting/clouds/cloud_uncertainty.h"
#include "fitting/fit_result.h"

namespace mocurate {

/// The uncertainty of all frames of a motion, as Motion stores it.
class UncertainMotion {
 public:
  /// Of frames that are not set nothing is known.
  UncertainMotion(int frames, int joints);
  /// Begins with the uncertainty of another motion.
  explicit UncertainMotion(const Motion& motion);

  /// `body_error` (J, m): how far each joint of the body is from the person's, which every frame has beside its own,
  /// and `body_rotation` (J, rad^2) how far that turns its frame (BodyRotations). No rotation is less known than
  /// beforehand.
  void Set(int frame, const CloudUncertainty& uncertainty, const std::vector<double>& body_error,
           const std::vector<Vector3d>& body_rotation);
  /// Takes a frame's uncertainty over; of joints that are not `turned` (J) rotations stay as known as they were.
  void Replace(int frame, const CloudUncertainty& uncertainty, const std::vector<bool>& turned,
               const std::vector<Vector3d>& body_rotation);
  void Write(Motion& motion) const;

 private:
  void SetPosition(std::size_t at, const Matrix3d& covariance);
  void SetRotation(std::size_t at, const Vector3d& variance, const Vector3d& observed);

  int joints_;
  std::vector<float> position_cov_;
  std::vector<float> rotation_sigma_;
  std::vector<float> rotation_observed_;
};

/// Joints of which no view shows anything are farther off than pose and body tell: widens their covariances and what
/// their body is off (J, m) where they are not `seen` (J).
void WidenGaps(const std::vector<bool>& seen, CloudUncertainty& uncertainty, std::vector<double>& body_error);

/// Root mean square, 95th percentile and robust spread of distances (m, absolute).
void SetResiduals(std::vector<double> distances, FitResult& result);

}  // namespace mocurate
