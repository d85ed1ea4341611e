#pragma once

#include <vector>

#include "core/motion/motion.h"
#include "fitting/clouds/capsule_fit.h"
#include "fitting/clouds/cloud_equations.h"
#include "fitting/fit_result.h"

namespace mocurate {

/// Uncertainty of a frame's pose.
struct CloudUncertainty {
  std::vector<Matrix3d> position;  ///< (J) covariance of joints in the world, m^2
  std::vector<Vector3d> rotation;  ///< (J) variance about the joint's own axes, rad^2
  std::vector<double> prior;       ///< (J) prior variance of the rotation, rad^2
};

/// Of a frame whose unknowns (CloudEquations) have the covariance (n x n). Needs Update with derivatives.
CloudUncertainty UncertaintyOfCovariance(const CloudEquations& equations, int frame, const Eigen::MatrixXd& covariance,
                                         const PoseState& state, const PointCloudOptions& options);

/// From the inverse of the Gauss-Newton matrix of the frame's terms, at the minimum in the state; points weighted with
/// `sigma` (CapsuleFitOutcome). Does not include the difference between body and person (BodyErrors). Needs Update.
Expected<CloudUncertainty> UncertaintyOfFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                              double sigma, PoseState& state, const PointCloudOptions& options);

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
