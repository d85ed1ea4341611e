#include "fitting/clouds/cloud_uncertainty.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/pi.h"
#include "fitting/clouds/cloud_equations.h"
#include "fitting/clouds/cloud_match.h"
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

namespace {

constexpr float kUnknownPlaceVariance = 1.0F;  ///< m^2, of a joint without information (numerical)
/// rad; standard deviation of a uniform angle (numerical).
const float kUnknownAngleSigma = static_cast<float>(kPi / std::sqrt(3.0));
/// Factor on the deviations of unobserved joints. Without it, ankles of 4 synthetic clips were 18 mm off per axis with
/// 14.6 stated. Feet were 61 mm off with 48 stated (bench_fit_clouds 4 30 907 DIR hidden=7, 10).
constexpr double kUnobservedFactor = 1.3;

}  // namespace

UncertainMotion::UncertainMotion(int frames, int joints) : joints_(joints) {
  const auto numbers = static_cast<std::size_t>(frames) * static_cast<std::size_t>(joints);
  position_cov_.assign(6 * numbers, 0.0F);
  for (std::size_t at = 0; at < numbers; ++at) {
    for (const int i : {0, 3, 5}) position_cov_[6 * at + static_cast<std::size_t>(i)] = kUnknownPlaceVariance;
  }
  rotation_sigma_.assign(3 * numbers, kUnknownAngleSigma);
  rotation_observed_.assign(3 * numbers, 0.0F);
}

UncertainMotion::UncertainMotion(const Motion& motion)
    : joints_(motion.joint_count()),
      position_cov_(motion.position_cov),
      rotation_sigma_(motion.rotation_sigma),
      rotation_observed_(motion.rotation_observed) {}

void UncertainMotion::SetPosition(std::size_t at, const Matrix3d& c) { ToSixNumbers(c, position_cov_.data() + 6 * at); }

void UncertainMotion::SetRotation(std::size_t at, const Vector3d& variance, double prior) {
  for (int i = 0; i < 3; ++i) {
    const double stated = std::min(variance[i], prior);
    rotation_sigma_[3 * at + static_cast<std::size_t>(i)] = static_cast<float>(std::sqrt(stated));
    rotation_observed_[3 * at + static_cast<std::size_t>(i)] = static_cast<float>(1.0 - stated / prior);
  }
}

void UncertainMotion::Set(int frame, const CloudUncertainty& uncertainty, const std::vector<double>& body_error,
                          const std::vector<Vector3d>& body_rotation) {
  for (int j = 0; j < joints_; ++j) {
    const auto at = static_cast<std::size_t>(frame) * static_cast<std::size_t>(joints_) + static_cast<std::size_t>(j);
    SetPosition(at, uncertainty.position[j] + body_error[j] * body_error[j] * Matrix3d::Identity());
    SetRotation(at, uncertainty.rotation[j] + body_rotation[j], uncertainty.prior[j]);
  }
}

void UncertainMotion::Replace(int frame, const CloudUncertainty& uncertainty, const std::vector<bool>& moving,
                              const std::vector<Vector3d>& body_rotation) {
  for (int j = 0; j < joints_; ++j) {
    const auto at = static_cast<std::size_t>(frame) * static_cast<std::size_t>(joints_) + static_cast<std::size_t>(j);
    SetPosition(at, uncertainty.position[j]);
    if (moving[j]) SetRotation(at, uncertainty.rotation[j] + body_rotation[j], uncertainty.prior[j]);
  }
}

void UncertainMotion::Write(Motion& motion) const {
  motion.position_cov = position_cov_;
  motion.rotation_sigma = rotation_sigma_;
  motion.rotation_observed = rotation_observed_;
}

void WidenGaps(const std::vector<bool>& seen, CloudUncertainty& uncertainty, std::vector<double>& body_error) {
  for (std::size_t j = 0; j < seen.size(); ++j) {
    if (seen[j]) continue;
    uncertainty.position[j] *= kUnobservedFactor * kUnobservedFactor;
    body_error[j] *= kUnobservedFactor;
  }
}

void SetResiduals(std::vector<double> distances, FitResult& result) {
  if (distances.empty()) return;
  double square = 0.0;
  for (const double distance : distances) square += distance * distance;
  result.residual_rms = std::sqrt(square / static_cast<double>(distances.size()));
  result.noise_sigma = RobustSigma(distances);
  const auto place = distances.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), place, distances.end());
  result.residual_p95 = *place;
}

}  // namespace mocurate
