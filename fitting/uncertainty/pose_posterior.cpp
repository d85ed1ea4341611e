#include "fitting/uncertainty/pose_posterior.h"

#include <utility>

#include "fitting/uncertainty/frame_covariances.h"

namespace mocurate {

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
    if (column < 0) continue;
    const Matrix3d& jacobian = state.right_jacobian(frame, j);
    const Matrix3d variance = jacobian * covariance.block<3, 3>(column, column) * jacobian.transpose();
    posterior.rotation[at] = variance.diagonal().cwiseMin(prior[at]);
  }
  posterior.prior = std::move(prior);
  return posterior;
}

void Add(const BodyResponse& response, PosePosterior& posterior) {
  for (std::size_t j = 0; j < posterior.position.size(); ++j) {
    posterior.position[j] += response.position()[j];
    posterior.rotation[j] = (posterior.rotation[j] + response.rotation()[j].diagonal()).cwiseMin(posterior.prior[j]);
  }
}

}  // namespace mocurate
