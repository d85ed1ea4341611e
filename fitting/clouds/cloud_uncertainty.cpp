#include "fitting/clouds/cloud_uncertainty.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <string>

#include "fitting/clouds/cloud_equations.h"
#include "fitting/solver/rest_sigmas.h"
#include "fitting/uncertainty/body_sigma.h"

namespace mocurate {
namespace {

/// dp = translation + sum over the joint's path of P_a dw_a.
Matrix3d PositionCovariance(const CloudEquations& equations, const PoseState& state, int frame, int joint,
                            const Eigen::MatrixXd& covariance) {
  std::vector<int> columns{0};
  std::vector<Matrix3d> derivatives{Matrix3d::Identity()};
  for (const int a : state.path(joint)) {
    columns.push_back(equations.column(a));
    derivatives.emplace_back(Hat(state.position(frame, a) - state.position(frame, joint)) * state.lever(frame, a));
  }
  Matrix3d sum = Matrix3d::Zero();
  for (std::size_t b = 0; b < columns.size(); ++b) {
    Matrix3d left = Matrix3d::Zero();
    for (std::size_t a = 0; a < columns.size(); ++a) {
      left.noalias() += derivatives[a] * covariance.block<3, 3>(columns[a], columns[b]);
    }
    sum.noalias() += left * derivatives[b].transpose();
  }
  return sum;
}

}  // namespace

CloudUncertainty UncertaintyOfCovariance(const CloudEquations& equations, int frame, const Eigen::MatrixXd& covariance,
                                         const PoseState& state, const PointCloudOptions& options) {
  const std::vector<double> rest = RestPoseSigmas(equations.skeleton(), options.rest_sigma);
  CloudUncertainty uncertainty;
  for (int j = 0; j < state.joints(); ++j) {
    uncertainty.position.push_back(PositionCovariance(equations, state, frame, j, covariance));
    const double prior = j == 0 ? kUnknownAngle : std::min(rest[j] * rest[j], kUnknownAngle);
    Vector3d variance = Vector3d::Constant(prior);
    if (const int column = equations.column(j); column >= 0) {
      const Matrix3d& jacobian = state.right_jacobian(frame, j);
      variance = (jacobian * covariance.block<3, 3>(column, column) * jacobian.transpose()).diagonal();
    }
    uncertainty.prior.push_back(prior);
    uncertainty.rotation.emplace_back(variance.cwiseMin(prior));
  }
  return uncertainty;
}

Expected<CloudUncertainty> UncertaintyOfFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                              double sigma, PoseState& state, const PointCloudOptions& options) {
  const std::vector<CloudMatch> matches = MatchPoints(body, state, fit.frame, cloud, options.max_distance);
  const double share = fit.point_weight * PatchShare(options);
  CloudEquations equations(
      body, state,
      {fit.frame, cloud, matches, share / sigma, share * options.huber_sigmas, fit.held, fit.joints, fit.pose},
      options);
  equations.SetParameters(equations.Parameters());
  equations.Linearise();
  const Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> factor(equations.matrix());
  if (factor.info() != Eigen::Success) {
    return Fail(ErrorCode::kInconsistent, "the points of the depth views do not determine a pose of the body",
                "frame " + std::to_string(fit.frame),
                "check that the views show a person, and check their calibration");
  }
  const auto size = equations.matrix().rows();
  const Eigen::MatrixXd covariance = factor.solve(Eigen::MatrixXd::Identity(size, size));
  return UncertaintyOfCovariance(equations, fit.frame, covariance, state, options);
}

}  // namespace mocurate
