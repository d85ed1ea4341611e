#include "fitting/uncertainty/frame_covariances.h"

#include <algorithm>
#include <string>

#include "core/geometry/rotation.h"
#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/one_thread.h"

namespace mocurate {

Status VisitCovariances(const TrackWindow& whole, const std::function<void(const FrameCovariance&)>& visit) {
  const OneThread one_thread;
  const int length = static_cast<int>(whole.options.window_frames);
  const int context = static_cast<int>(whole.options.window_overlap);
  whole.state.Update(0, whole.end, true);
  BlockTridiagonal own_memory;
  for (int begin = 0; begin < whole.end; begin += length) {
    const int end = std::min(begin + length, whole.end);
    TrackWindow window{whole.tracks, whole.state, whole.sigma, whole.options};
    window.begin = std::max(begin - context, 0);
    window.end = std::min(end + context, whole.end);
    window.noise_scale = whole.noise_scale;
    window.rotations = whole.rotations;
    window.rest_sigmas = whole.rest_sigmas;
    window.rest_information = whole.rest_information;
    TrackEquations track(window);
    BlockTridiagonal& equations = whole.memory != nullptr ? *whole.memory : own_memory;
    equations.Resize(window.end - window.begin, track.size());
    track.Linearise(equations);
    if (!equations.Factor(Eigen::VectorXd::Zero(equations.blocks() * equations.size()))) {
      return Fail(ErrorCode::kInconsistent,
                  "the pose is undetermined in spite of its priors (singular normal equations)",
                  "frames " + std::to_string(begin) + " to " + std::to_string(end),
                  "check that these frames show a person, in metres");
    }
    Eigen::MatrixXd next;
    equations.VisitInverse([&](int f, const Eigen::MatrixXd& own, const Eigen::MatrixXd& with_next) {
      const int frame = window.begin + f;
      if (frame >= begin && frame < end) visit({track, frame, own, with_next, next, equations.Next(f)});
      next = own;
    });
  }
  return {};
}

TwistPropagation::TwistPropagation(const PoseState& state, const TrackEquations& track, int frame)
    : state_(state), track_(track), frame_(frame), twist_(static_cast<std::size_t>(state.joints())) {
  for (int j = 0; j < state.joints(); ++j) {
    if (track.column(j) < 0) continue;
    twist_[j].topRows<3>().noalias() = Hat(state.position(frame, j) - state.position(frame, 0)) * state.lever(frame, j);
    twist_[j].bottomRows<3>() = state.lever(frame, j);
  }
}

Eigen::Matrix<double, 3, 6> TwistPropagation::PositionDerivative(int joint) const {
  Eigen::Matrix<double, 3, 6> derivative;
  derivative.leftCols<3>().setIdentity();
  derivative.rightCols<3>() = Hat(state_.position(frame_, 0) - state_.position(frame_, joint));
  return derivative;
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
    const int c = track_.column(j);
    if (c < 0) continue;
    // Cross terms of the joint's carrier here and its rotation there, and the reverse.
    Eigen::Matrix<double, 6, 3> forth = Eigen::Matrix<double, 6, 3>::Zero();
    Eigen::Matrix<double, 3, 6> back = Eigen::Matrix<double, 3, 6>::Zero();
    forth.topRows<3>() = unknowns.block<3, 3>(0, c);
    back.leftCols<3>() = unknowns.block<3, 3>(c, 0);
    for (const int a : state_.path(j)) {
      const int above = track_.column(a);
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
