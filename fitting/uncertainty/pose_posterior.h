#pragma once

#include <vector>

#include "fitting/solver/pose_equations.h"
#include "fitting/uncertainty/body_response.h"

namespace mocurate {

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

/// Factors the information of frames' unknowns, the first of which is the frame `first`. Error kInconsistent where it
/// is not positive definite: names the frame and what nothing determines in it.
Status FactorInformation(BlockTridiagonal& information, const PoseColumns& columns, const Skeleton& skeleton,
                         int first);

/// Adds to the variance of a rotation about an axis that is stated as sigma (rad) and observed: at most its prior's.
void WidenRotation(double variance, float& sigma, float& observed);

/// Adds what a body that is not the person's does to the pose.
void Add(const BodyResponse& response, PosePosterior& posterior);

}  // namespace mocurate
