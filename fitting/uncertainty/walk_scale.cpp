#include "fitting/uncertainty/walk_scale.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/one_thread.h"
#include "fitting/solver/track_equations.h"

namespace mocurate {
namespace {

/// E |r|^2 of a step whose residual is `mean` with the covariances of both ends.
double ExpectedSquare(const Vector3d& mean, const Matrix3d& before, const Matrix3d& after, const Matrix3d& own,
                      const Matrix3d& other, const Matrix3d& between) {
  const Matrix3d cross = before * between * after.transpose();
  return mean.squaredNorm() + (before * own * before.transpose() + after * other * after.transpose()).trace() +
         2.0 * cross.trace();
}

}  // namespace

Expected<double> WalkScale(const TrackWindow& window) {
  const OneThread one_thread;
  PoseState& state = window.state;
  state.Update(window.begin, window.end, true);
  TrackEquations track(window);
  BlockTridiagonal equations(window.end - window.begin, track.size(), 0);
  track.Linearise(equations);
  if (!equations.Factor(Eigen::VectorXd::Zero(equations.blocks() * equations.size()))) {
    return Fail(ErrorCode::kInternal, "the pose is not determined, not even by its priors", "fitting");
  }
  double squares = 0.0;
  double numbers = 0.0;
  Eigen::MatrixXd after;
  equations.VisitInverse([&](int f, const Eigen::MatrixXd& own, const Eigen::MatrixXd& between) {
    const int frame = window.begin + f;
    if (between.size() > 0 && window.Joined(frame)) {
      const double turn_variance = window.options.rotation_walk * window.options.rotation_walk * window.Step(frame);
      const double move_variance = window.options.velocity_walk * window.options.velocity_walk * window.Step(frame);
      const Matrix3d identity = Matrix3d::Identity();
      squares += ExpectedSquare(state.position(frame + 1, 0) - state.position(frame, 0), -identity, identity,
                                own.topLeftCorner<3, 3>(), after.topLeftCorner<3, 3>(), between.topLeftCorner<3, 3>()) /
                 move_variance;
      numbers += 3.0;
      for (int j = 0; j < state.joints(); ++j) {
        const int c = track.column(j);
        if (c < 0) continue;
        const Vector3d turn = LogMatrix(state.local(frame, j).transpose() * state.local(frame + 1, j));
        const Matrix3d inverse = RightJacobianInverse(turn);
        squares += ExpectedSquare(turn, -inverse.transpose() * state.right_jacobian(frame, j),
                                  inverse * state.right_jacobian(frame + 1, j), own.block<3, 3>(c, c),
                                  after.block<3, 3>(c, c), between.block<3, 3>(c, c)) /
                   turn_variance;
        numbers += 3.0;
      }
    }
    after = own;
  });
  return numbers > 0.0 ? std::sqrt(squares / numbers) : 1.0;
}

}  // namespace mocurate
