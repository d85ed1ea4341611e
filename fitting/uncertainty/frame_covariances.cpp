#include "fitting/uncertainty/frame_covariances.h"

#include <algorithm>

#include "core/geometry/rotation.h"
#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/one_thread.h"
#include "fitting/uncertainty/pose_posterior.h"

namespace mocurate {

Status VisitCovariances(const TrackProblem& whole, const std::function<void(const FrameCovariance&)>& visit) {
  const OneThread one_thread;
  const int length = static_cast<int>(whole.options.window_frames);
  const int context = static_cast<int>(whole.options.window_overlap);
  whole.state.Update(0, whole.frames(), true);
  BlockTridiagonal own_memory;
  PoseEquations pose(whole.state);
  for (int begin = 0; begin < whole.frames(); begin += length) {
    const int end = std::min(begin + length, whole.frames());
    const int first = std::max(begin - context, 0);
    const PoseTerms terms = whole.Terms(first, std::min(end + context, whole.frames()), false);
    BlockTridiagonal& equations = whole.memory != nullptr ? *whole.memory : own_memory;
    equations.Resize(static_cast<int>(terms.frames.size()), pose.columns().size());
    pose.Linearise(terms, whole.state, equations);
    Status factored = FactorInformation(equations, pose.columns(), *whole.tracks.skeleton, first);
    if (!factored) return factored;
    Eigen::MatrixXd next;
    equations.VisitInverse([&](int f, const Eigen::MatrixXd& own, const Eigen::MatrixXd& with_next) {
      const int frame = first + f;
      if (frame >= begin && frame < end) visit({pose.columns(), frame, own, with_next, next, equations.Next(f)});
      next = own;
    });
  }
  return {};
}

TwistPropagation::TwistPropagation(const PoseState& state, const PoseColumns& columns, int frame)
    : state_(state), columns_(columns), frame_(frame), twist_(static_cast<std::size_t>(state.joints())) {
  for (int j = 0; j < state.joints(); ++j) {
    if (columns.of(j) >= 0) twist_[static_cast<std::size_t>(j)] = TwistOf(state, frame, j);
  }
}

Matrix36d TwistPropagation::PositionDerivative(int joint) const {
  return PointMotion(state_.position(frame_, joint) - state_.position(frame_, 0));
}

std::vector<Matrix6d> TwistPropagation::CovarianceWith(const TwistPropagation& other,
                                                       const Eigen::MatrixXd& unknowns) const {
  const auto joints = static_cast<std::size_t>(state_.joints());
  std::vector<Matrix6d> carrier(joints, Matrix6d::Zero());
  std::vector<Matrix6d> turned(joints);  // carrier of the joint's descendants
  for (int j = 0; j < state_.joints(); ++j) {
    if (j == 0) {
      carrier[j].topLeftCorner<3, 3>() = unknowns.topLeftCorner<3, 3>();
    } else {
      carrier[j] = turned[state_.parent(j)];
    }
    turned[j] = carrier[j];
    const int c = columns_.of(j);
    if (c < 0) continue;
    // Cross terms of the joint's carrier here and its rotation there, and the reverse.
    Eigen::Matrix<double, 6, 3> forth = Eigen::Matrix<double, 6, 3>::Zero();
    Eigen::Matrix<double, 3, 6> back = Eigen::Matrix<double, 3, 6>::Zero();
    forth.topRows<3>() = unknowns.block<3, 3>(0, c);
    back.leftCols<3>() = unknowns.block<3, 3>(c, 0);
    for (const int a : state_.path(j)) {
      const int above = columns_.of(a);
      forth.noalias() += twist_[a] * unknowns.block<3, 3>(above, c);
      back.noalias() += unknowns.block<3, 3>(c, above) * other.twist_[a].transpose();
    }
    forth.noalias() += twist_[j] * unknowns.block<3, 3>(c, c);
    turned[j].noalias() += twist_[j] * back;
    turned[j].noalias() += forth * other.twist_[j].transpose();
  }
  return carrier;
}

}  // namespace mocurate
