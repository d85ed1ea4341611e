#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fitting/clouds/cloud_match.h"
#include "fitting/options.h"
#include "fitting/solver/body_information.h"

namespace mocurate {

/// Weight of a point, 1/m: `sigma` (m) is the spread of distances, and points share the error of the body with their
/// neighbours, so that a patch of them counts as one observation.
double PointWeight(double sigma, double voxel_size);
/// Whitened distance beyond which a point counts linearly.
double PointHuber(const PointCloudOptions& options);
/// Radians beyond a joint limit, in clouds.
inline constexpr double kCloudLimitSpread = 0.1;

/// Cost and normal equations of one frame of matched points at the present parameters of a state: the costs of
/// CloudProblem, summed without forming their Jacobians (BodyInformation). Unknowns: translation (3), then the rotation
/// vector of each active joint (3), root first.
class CloudEquations {
 public:
  /// `since_previous_s`: seconds since frame - 1, which is held and joins through the walks. `weight` of PointWeight.
  CloudEquations(const FleshBody& body, PoseState& state, int frame, const FusedCloud& cloud,
                 const std::vector<CloudMatch>& matches, double weight, std::optional<double> since_previous_s,
                 const PointCloudOptions& options);

  /// 1/2 sum of rho(r^2). The state's kinematics must be up to date.
  double Cost() const;
  /// Gauss-Newton, robust costs reweighted. The state's kinematics must be up to date, derivatives included.
  void Linearise();
  const Eigen::MatrixXd& matrix() const { return matrix_; }  ///< upper triangle
  const Eigen::VectorXd& gradient() const { return gradient_; }

  Eigen::VectorXd Parameters() const;
  /// Writes them and updates the kinematics with derivatives.
  void SetParameters(const Eigen::VectorXd& parameters);

 private:
  using Twist = Eigen::Matrix<double, 6, 3>;

  void SumPoints();
  void AddPoints();
  void AddPriors();
  void AddStep();

  const FleshBody& body_;
  PoseState& state_;
  const int frame_;
  const FusedCloud& cloud_;
  const std::vector<CloudMatch>& matches_;
  const double weight_;
  const double huber_;
  const std::vector<double> rest_spreads_;
  double turn_weight_ = 0.0;  ///< squared, of the walk from the frame before; 0 where there is none
  double move_weight_ = 0.0;
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
