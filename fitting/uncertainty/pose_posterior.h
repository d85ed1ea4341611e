#pragma once

#include <vector>

#include "fitting/solver/pose_equations.h"
#include "fitting/uncertainty/body_response.h"

namespace mocurate {

constexpr double kUnknownAngle = 3.289868133696453;  ///< rad^2; variance of a uniform angle, pi^2 / 3 (numerical)

/// What a fit knows of a frame's pose: the inverse of the information of the problem that was solved, for its joints.
struct PosePosterior {
  std::vector<Matrix3d> position;  ///< (J) covariance of joints in the world, m^2
  std::vector<Vector3d> rotation;  ///< (J) variance about the joint's own axes, rad^2, at most the prior's
  std::vector<Vector3d> prior;     ///< (J) the same of that problem without evidence
};

/// Variance of a joint's rotation about its own axes, rad^2, from that of its rotation vector at `column`.
Vector3d RotationVariance(const PoseState& state, int frame, int joint, const Eigen::MatrixXd& covariance, int column);

/// Of a frame of the state whose unknowns have the covariance (n x n). `prior` (J), rad^2; that of the root is a
/// uniform angle's, pi^2 / 3. A joint that is not an unknown has its prior. Kinematics up to date, derivatives
/// included.
PosePosterior PosteriorOf(const PoseColumns& columns, const PoseState& state, int frame,
                          const Eigen::MatrixXd& covariance, std::vector<Vector3d> prior);

/// Adds to the variance of a rotation about an axis that is stated as sigma (rad) and observed: at most its prior's.
void WidenRotation(double variance, float& sigma, float& observed);

/// Adds what a body that is not the person's does to the pose.
void Add(const BodyResponse& response, PosePosterior& posterior);

}  // namespace mocurate
