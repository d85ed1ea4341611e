#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/clouds/frame_terms.h"
#include "fitting/options.h"
#include "fitting/solver/body_information.h"

namespace mocurate {

/// Points share the error of the body with their neighbours, so that a patch of them counts as one observation: the
/// square root of a point's share in its patch, for a cloud of one point per voxel.
double PatchShare(double voxel_size);
/// Radians beyond a joint limit, in clouds.
inline constexpr double kCloudLimitSigma = 0.1;

/// Limits of a joint in clouds; null of one whose `rest_sigma` (RestPoseSigmas) is less than that of limbs: the rest
/// pose holds it, and a search that cannot pass through a twisted trunk loses facings (of 24 stills two more were off
/// by 0.25 m).
inline const JointLimits* LimitsInClouds(const Joint& joint, double rest_sigma, const PointCloudOptions& options) {
  return joint.limits && rest_sigma >= options.rest_sigma ? &*joint.limits : nullptr;
}

/// Cost and normal equations of one frame of matched points at the present parameters of a state: the costs of
/// CloudProblem, summed without forming their Jacobians (BodyInformation). Unknowns: translation (3), then the rotation
/// vector of each active joint (3), root first.
class CloudEquations {
 public:
  CloudEquations(const CapsuleBody& body, PoseState& state, FrameTerms terms, const PointCloudOptions& options);

  /// 1/2 sum of rho(r^2). The state's kinematics must be up to date.
  double Cost() const;
  /// Gauss-Newton, robust costs reweighted. The state's kinematics must be up to date, derivatives included.
  void Linearise();
  const Eigen::MatrixXd& matrix() const { return matrix_; }  ///< upper triangle
  const Eigen::VectorXd& gradient() const { return gradient_; }
  int column(int joint) const { return column_[joint]; }  ///< first unknown of a joint's rotation; -1: not active

  Eigen::VectorXd Parameters() const;
  /// Writes them and updates the kinematics with derivatives.
  void SetParameters(const Eigen::VectorXd& parameters);

 private:
  using Twist = Eigen::Matrix<double, 6, 3>;

  void SumPoints();
  void SumJoints();
  void AddPoints();
  void AddPriors();
  void AddStep(const FixedNeighbourFrame& held);

  const CapsuleBody& body_;
  PoseState& state_;
  const FrameTerms terms_;
  const int frame_;
  const PointCloudOptions& options_;
  const std::vector<double> rest_sigmas_;
  int size_ = 3;
  std::vector<int> column_;  ///< first unknown of a joint's rotation; -1: not active
  std::vector<BodyInformation> subtree_;
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd gradient_;
};

/// How a solve ended.
struct CloudSolution {
  double initial_cost = 0.0;
  double final_cost = 0.0;
};

/// At most `steps` steps of Levenberg-Marquardt; the solution is in the state. Error kInconsistent when the cost of the
/// start is no number.
Expected<CloudSolution> SolveCloudEquations(CloudEquations& equations, int steps, double relative_tolerance);

}  // namespace mocurate
