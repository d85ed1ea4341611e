#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/clouds/cloud_match.h"
#include "fitting/options.h"
#include "fitting/solver/body_information.h"

namespace mocurate {

/// Neighbouring points share the error of the body, so that a patch of them counts as one observation. Square root of a
/// point's share in its patch, for one point per voxel; 1 where the rule is off.
double PatchShare(const PointCloudOptions& options);
/// Radians beyond a joint limit, standard deviation.
inline constexpr double kCloudLimitSigma = 0.1;

/// Limits of a joint; null where `rest_sigma` (RestPoseSigmas) is less than that of limbs. There the rest-pose prior
/// suffices. A search that cannot pass through a twisted trunk misses orientations (of 24 stills two more were off by
/// 0.25 m).
inline const JointLimits* LimitsInClouds(const Joint& joint, double rest_sigma, const PointCloudOptions& options) {
  return joint.limits && rest_sigma >= options.rest_sigma ? &*joint.limits : nullptr;
}

/// Priors of a joint's rotation vector in a depth fit.
struct RestAndLimits {
  double rest = 0.0;                    ///< information of the rest pose, 1/rad^2
  const JointLimits* limits = nullptr;  ///< null: none
};

/// Of all joints but the root. Of joints whose rotation `pose` knows, the rest pose counts as far as it is not in that
/// already; their limits are in it. (J)
std::vector<RestAndLimits> PriorsInClouds(const Skeleton& skeleton, const PoseGaussian* pose,
                                          const PointCloudOptions& options);

/// Cost and normal equations of one frame of matched points at the parameters in a state. Sums the costs of
/// CloudProblem without their Jacobians (BodyInformation). Unknowns: translation (3), then the rotation vector of each
/// active joint (3), root first.
class CloudEquations {
 public:
  CloudEquations(const CapsuleBody& body, PoseState& state, FrameTerms terms, const PointCloudOptions& options);

  /// 1/2 sum of rho(r^2). The state's kinematics must be up to date.
  double Cost() const;
  /// Gauss-Newton, robust costs reweighted. The state's kinematics must be up to date, derivatives included.
  void Linearise();
  const Eigen::MatrixXd& matrix() const { return matrix_; }  ///< upper triangle
  const Eigen::VectorXd& gradient() const { return gradient_; }
  const Skeleton& skeleton() const { return *body_.skeleton; }
  int column(int joint) const { return column_[joint]; }  ///< first unknown of a joint's rotation; -1: not active

  Eigen::VectorXd Parameters() const;
  /// Sets the parameters and updates the kinematics with derivatives.
  void SetParameters(const Eigen::VectorXd& parameters);

 private:
  using Twist = Eigen::Matrix<double, 6, 3>;

  void SumPoints();
  void SumJoints();
  void AddPoints();
  void AddPriors();
  void AddPose();
  void AddStep(const FixedNeighbourFrame& neighbour);

  const CapsuleBody& body_;
  PoseState& state_;
  const FrameTerms terms_;
  const int frame_;
  const PointCloudOptions& options_;
  int size_ = 3;
  const std::vector<RestAndLimits> priors_;
  std::vector<int> column_;  ///< first unknown of a joint's rotation; -1: not active
  std::vector<BodyInformation> subtree_;
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd gradient_;
};

/// Result of a solve.
struct CloudSolution {
  double initial_cost = 0.0;
  double final_cost = 0.0;
};

/// At most `steps` steps of Levenberg-Marquardt; writes the solution to the state. Error kInconsistent when the initial
/// cost is not finite.
Expected<CloudSolution> SolveCloudEquations(CloudEquations& equations, int steps, double relative_tolerance);

}  // namespace mocurate
