#include "fitting/uncertainty/pose_posterior.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "fitting/uncertainty/body_response.h"
#include "fitting/uncertainty/frame_covariances.h"

namespace mocurate {

Vector3d RotationVariance(const PoseState& state, int frame, int joint, const Eigen::MatrixXd& covariance, int column) {
  const Matrix3d& jacobian = state.right_jacobian(frame, joint);
  return (jacobian * covariance.block<3, 3>(column, column) * jacobian.transpose()).diagonal();
}

PosePosterior PosteriorOf(const PoseColumns& columns, const PoseState& state, int frame,
                          const Eigen::MatrixXd& covariance, std::vector<Vector3d> prior) {
  const TwistPropagation twists(state, columns, frame);
  const std::vector<Matrix6d> carrier = twists.CovarianceWith(twists, covariance);
  PosePosterior posterior;
  posterior.rotation = prior;
  for (int j = 0; j < state.joints(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const Matrix36d derivative = twists.PositionDerivative(j);
    posterior.position.emplace_back(derivative * carrier[at] * derivative.transpose());
    const int column = columns.of(j);
    if (column >= 0) posterior.rotation[at] = RotationVariance(state, frame, j, covariance, column).cwiseMin(prior[at]);
  }
  posterior.prior = std::move(prior);
  return posterior;
}

Status FactorInformation(BlockTridiagonal& information, const PoseColumns& columns, const Skeleton& skeleton,
                         int first) {
  const Eigen::VectorXd no_damping = Eigen::VectorXd::Zero(Eigen::Index{information.blocks()} * information.size());
  if (information.Factor(no_damping) && information.IsDetermined()) return {};
  const auto [block, row] = information.failed();
  std::string what = "the root's position";
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int column = columns.of(j);
    if (row >= 3 && column >= 0 && row >= column && row < column + 3)
      what = "the rotation of " + skeleton.joints[static_cast<std::size_t>(j)].name;
  }
  return Fail(ErrorCode::kInconsistent, "nothing determines " + what + " (normal equations that are not definite)",
              "frame " + std::to_string(first + block), "check that this frame shows a person, in metres");
}

void WidenRotation(double variance, float& sigma, float& observed) {
  const double own = static_cast<double>(sigma) * sigma;
  const double prior = observed < 1.0F ? own / (1.0 - observed) : kUnknownAngle;
  const double wider = std::max(own, std::min(own + variance, prior));
  sigma = static_cast<float>(std::sqrt(wider));
  observed = static_cast<float>(std::clamp(1.0 - wider / prior, 0.0, static_cast<double>(observed)));
}

void Add(const BodyResponse& response, PosePosterior& posterior) {
  for (std::size_t j = 0; j < posterior.position.size(); ++j) {
    posterior.position[j] += response.position()[j];
    posterior.rotation[j] = (posterior.rotation[j] + response.rotation()[j].diagonal()).cwiseMin(posterior.prior[j]);
  }
}

}  // namespace mocurate
