#pragma once

#include <vector>

#include "core/motion/motion.h"
#include "fitting/clouds/cloud_uncertainty.h"
#include "fitting/fit_result.h"

namespace mocurate {

/// The uncertainty of all frames of a motion, in the layout of Motion.
class UncertainMotion {
 public:
  /// All frames begin without information.
  UncertainMotion(int frames, int joints);
  /// Begins with the uncertainty of `motion`.
  explicit UncertainMotion(const Motion& motion);

  /// `body_error` (J, m): error of the body's joints in every frame, and `body_rotation` (J, rad^2) the rotation of
  /// joint frames that it causes (BodyRotations); both are added to the frame's own. Rotation variances are at most the
  /// prior's.
  void Set(int frame, const CloudUncertainty& uncertainty, const std::vector<double>& body_error,
           const std::vector<Vector3d>& body_rotation);
  /// The same without an error of the body in positions; joints that are not `moving` (J) keep the uncertainty of their
  /// rotation.
  void Replace(int frame, const CloudUncertainty& uncertainty, const std::vector<bool>& moving,
               const std::vector<Vector3d>& body_rotation);
  void Write(Motion& motion) const;

 private:
  void SetPosition(std::size_t at, const Matrix3d& covariance);
  void SetRotation(std::size_t at, const Vector3d& variance, double prior);

  int joints_;
  std::vector<float> position_cov_;
  std::vector<float> rotation_sigma_;
  std::vector<float> rotation_observed_;
};

/// Widens covariances and body errors (J, m) of joints without observations (not `seen`, J): their errors exceed those
/// of pose and body.
void WidenGaps(const std::vector<bool>& seen, CloudUncertainty& uncertainty, std::vector<double>& body_error);

/// Root mean square, 95th percentile and robust standard deviation of distances (m, absolute).
void SetResiduals(std::vector<double> distances, FitResult& result);

}  // namespace mocurate
