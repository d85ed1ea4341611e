#pragma once

#include <vector>

#include "fitting/clouds/capsule_fit.h"
#include "fitting/clouds/cloud_equations.h"

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

}  // namespace mocurate
