#include "fitting/solver/track_equations.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/rotation.h"
#include "fitting/costs/huber.h"
#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/one_thread.h"
#include "fitting/solver/trust_region.h"
#include "fitting/stop_request.h"

namespace mocurate {

TrackEquations::TrackEquations(const TrackWindow& window)
    : window_(window),
      size_(3),
      hinges_(HingesOf(*window.tracks.skeleton)),
      velocity_weight_(window.tracks.confidence.size(), 0.0),
      rotation_weight_(window.tracks.confidence.size(), 0.0),
      subtree_(window.state.joints()),
      step_after_(window.state.joints()),
      twist_(window.state.joints()),
      twist_next_(window.state.joints()) {
  const PoseState& state = window.state;
  for (int j = 0; j < state.joints(); ++j) {
    column_.push_back(state.active(j) ? size_ : -1);
    if (state.active(j)) size_ += 3;
  }
  for (int f = window.first(); f + 1 < window.end; ++f) {
    if (!window.Joined(f)) continue;
    for (int j = 0; j < state.joints(); ++j) {
      velocity_weight_[window.Index(f, j)] = 1.0 / window.MoveVariance(f, j);
      rotation_weight_[window.Index(f, j)] = 1.0 / window.RotationVariance(f, j);
    }
  }
}

double TrackEquations::Cost() const {
  const PoseState& state = window_.state;
  const JointTrackOptions& options = window_.options;
  double twice = 0.0;
  for (int f = window_.begin; f < window_.end; ++f) {
    for (int j = 0; j < state.joints(); ++j) {
      if (window_.tracks.seen(f, j)) {
        const Vector3d away = state.position(f, j) - window_.tracks.positions.at(f, j);
        twice += HuberValue(away.dot(window_.Information(f, j) * away), options.huber_sigmas);
      }
      if (const std::size_t at = window_.Index(f, j); window_.rotations != nullptr && window_.rotations->has(at)) {
        twice += HuberValue(Square(window_.rotations->weight[at]) * RecordedRotation(f, j).squaredNorm(),
                            options.huber_sigmas);
      }
      if (j == 0 || !state.active(j)) continue;
      const Eigen::Map<const Vector3d> w(state.rotation(f, j));
      twice += window_.RestInformation(f, j) * w.squaredNorm();
      const auto& limits = window_.tracks.skeleton->joints[j].limits;
      for (int i = 0; limits && i < 3; ++i) {
        twice += Square(BeyondLimit(w[i], limits->min[i], limits->max[i]) / options.limit_sigma);
      }
      if (hinges_[j]) twice += OffHinge(*hinges_[j], state.local(f, j)).squaredNorm() / Square(options.hinge_sigma);
    }
  }
  for (int f = window_.first(); f + 1 < window_.end; ++f) {
    if (!joined(f)) continue;
    for (int j = 0; j < state.joints(); ++j) {
      twice += velocity_weight_[window_.Index(f, j)] * (state.position(f + 1, j) - state.position(f, j)).squaredNorm();
      if (!state.active(j)) continue;
      twice += rotation_weight_[window_.Index(f, j)] *
               LogMatrix(state.local(f, j).transpose() * state.local(f + 1, j)).squaredNorm();
    }
  }
  return 0.5 * twice;
}

Vector3d TrackEquations::RecordedRotation(int frame, int joint) const {
  const Matrix3d target = window_.rotations->world_from_joint[window_.Index(frame, joint)].toRotationMatrix();
  return LogMatrix(target.transpose() * window_.state.global(frame, joint));
}

void TrackEquations::AddRecordedRotation(int frame, int joint, BodyInformation& moved) const {
  const std::size_t at = window_.Index(frame, joint);
  if (window_.rotations == nullptr || !window_.rotations->has(at)) return;
  const Vector3d away = RecordedRotation(frame, joint);
  const double square = Square(window_.rotations->weight[at]);
  const double weight = square * HuberSlope(square * away.squaredNorm(), window_.options.huber_sigmas);
  const Matrix3d turn = RightJacobianInverse(away) * window_.state.global(frame, joint).transpose();
  moved.AddRotation(weight * turn.transpose() * turn, weight * turn.transpose() * away);
}

Matrix3d TrackEquations::DataInformation(int frame, int joint) const {
  const Vector3d away = window_.state.position(frame, joint) - window_.tracks.positions.at(frame, joint);
  const Matrix3d information = window_.Information(frame, joint);
  return HuberSlope(away.dot(information * away), window_.options.huber_sigmas) * information;
}

void TrackEquations::UpdateTwists(int frame, std::vector<Twist>& twists) const {
  for (int j = 0; j < window_.state.joints(); ++j) {
    if (column(j) < 0) continue;
    const Matrix3d& lever = window_.state.lever(frame, j);
    twists[j].topRows<3>().noalias() = Hat(Relative(frame, j)) * lever;
    twists[j].bottomRows<3>() = lever;
  }
}

/// Subtree sums of a frame: data, and the within-frame part of its steps to both neighbours.
void TrackEquations::SumFrame(int frame) {
  const PoseState& state = window_.state;
  const bool before = frame > window_.first() && joined(frame - 1);
  const bool after = frame + 1 < window_.end && joined(frame);
  for (Subtree& sum : subtree_) sum = {};
  for (int j = state.joints() - 1; j >= 0; --j) {
    const Vector3d& position = state.position(frame, j);
    Matrix3d weight = Matrix3d::Zero();
    Vector3d pull = Vector3d::Zero();
    if (window_.tracks.seen(frame, j)) {
      weight = DataInformation(frame, j);
      pull = weight * (position - window_.tracks.positions.at(frame, j));
    }
    if (before) {
      const double step = velocity_weight_[window_.Index(frame - 1, j)];
      weight.diagonal().array() += step;
      pull += step * (position - state.position(frame - 1, j));
    }
    if (after) {
      const double step = velocity_weight_[window_.Index(frame, j)];
      weight.diagonal().array() += step;
      pull += step * (position - state.position(frame + 1, j));
    }
    AddRecordedRotation(frame, j, subtree_[j].below);
    subtree_[j].at = subtree_[j].below;
    subtree_[j].at.AddPoint(Relative(frame, j), weight, pull);
    if (j > 0) subtree_[state.parent(j)].below += subtree_[j].at;
  }
}

/// Subtree sums between a frame and the next.
void TrackEquations::SumStep(int frame, std::vector<CrossSubtree>& sums) const {
  const PoseState& state = window_.state;
  for (CrossSubtree& sum : sums) sum.below.setZero();
  for (int j = state.joints() - 1; j >= 0; --j) {
    sums[j].at = sums[j].below;
    sums[j].at +=
        CrossInformation(Relative(frame, j), Relative(frame + 1, j), -velocity_weight_[window_.Index(frame, j)]);
    if (j > 0) sums[state.parent(j)].below += sums[j].at;
  }
}

void TrackEquations::AddFrame(int frame, BlockTridiagonal& equations) const {
  auto diagonal = equations.Diagonal(frame - window_.begin);
  auto gradient = equations.Gradient(frame - window_.begin);
  diagonal.topLeftCorner<3, 3>() += subtree_[0].at.information.topLeftCorner<3, 3>();
  gradient.head<3>() += subtree_[0].at.gradient.head<3>();
  for (int j = 0; j < window_.state.joints(); ++j) {
    const int c = column(j);
    if (c < 0) continue;
    const Twist moved = subtree_[j].below.information * twist_[j];
    diagonal.block<3, 3>(0, c) += moved.topRows<3>();
    diagonal.block<3, 3>(c, c).noalias() += twist_[j].transpose() * moved;
    for (const int a : window_.state.path(j)) {
      diagonal.block<3, 3>(column(a), c).noalias() += twist_[a].transpose() * moved;
    }
    gradient.segment<3>(c).noalias() += twist_[j].transpose() * subtree_[j].below.gradient;
  }
}

void TrackEquations::AddStep(int frame, BlockTridiagonal& equations) const {
  auto next = equations.Next(frame - window_.begin);
  next.topLeftCorner<3, 3>() += step_after_[0].at.topLeftCorner<3, 3>();
  for (int j = 0; j < window_.state.joints(); ++j) {
    const int c = column(j);
    if (c < 0) continue;
    const Twist moved = step_after_[j].below * twist_next_[j];
    const Twist back = step_after_[j].below.transpose() * twist_[j];
    next.block<3, 3>(0, c) += moved.topRows<3>();
    next.block<3, 3>(c, 0) += back.topRows<3>().transpose();
    next.block<3, 3>(c, c).noalias() += twist_[j].transpose() * moved;
    for (const int a : window_.state.path(j)) {
      next.block<3, 3>(column(a), c).noalias() += twist_[a].transpose() * moved;
      next.block<3, 3>(c, column(a)).noalias() += back.transpose() * twist_next_[a];
    }
  }
}

void TrackEquations::AddPriors(int frame, BlockTridiagonal& equations) const {
  const PoseState& state = window_.state;
  const double limit = 1.0 / Square(window_.options.limit_sigma);
  auto diagonal = equations.Diagonal(frame - window_.begin);
  auto gradient = equations.Gradient(frame - window_.begin);
  for (int j = 1; j < state.joints(); ++j) {
    const int c = column(j);
    if (c < 0) continue;
    const double rest = window_.RestInformation(frame, j);
    const auto& limits = window_.tracks.skeleton->joints[j].limits;
    for (int i = 0; i < 3; ++i) {
      const double w = state.rotation(frame, j)[i];
      diagonal(c + i, c + i) += rest;
      gradient[c + i] += rest * w;
      const double beyond = limits ? BeyondLimit(w, limits->min[i], limits->max[i]) : 0.0;
      if (beyond == 0.0) continue;
      diagonal(c + i, c + i) += limit;
      gradient[c + i] += limit * beyond;
    }
    if (!hinges_[j]) continue;
    const Vector3d w = Eigen::Map<const Vector3d>(state.rotation(frame, j));
    const Eigen::Matrix<double, 2, 3> slopes = OffHingeSlopes(*hinges_[j], state.local(frame, j), w);
    const double information = 1.0 / Square(window_.options.hinge_sigma);
    diagonal.block<3, 3>(c, c).noalias() += information * slopes.transpose() * slopes;
    gradient.segment<3>(c).noalias() += information * slopes.transpose() * OffHinge(*hinges_[j], state.local(frame, j));
  }
}

void TrackEquations::AddRotationStep(int frame, BlockTridiagonal& equations) const {
  const PoseState& state = window_.state;
  const int block = frame - window_.begin;  // -1: the fixed frame before the window
  for (int j = 0; j < state.joints(); ++j) {
    const int c = column(j);
    if (c < 0) continue;
    const double weight = rotation_weight_[window_.Index(frame, j)];
    const Vector3d turn = LogMatrix(state.local(frame, j).transpose() * state.local(frame + 1, j));
    const Matrix3d inverse = RightJacobianInverse(turn);
    const Matrix3d after = inverse * state.right_jacobian(frame + 1, j);
    equations.Diagonal(block + 1).block<3, 3>(c, c).noalias() += weight * after.transpose() * after;
    equations.Gradient(block + 1).segment<3>(c).noalias() += weight * after.transpose() * turn;
    if (block < 0) continue;
    const Matrix3d before = -inverse.transpose() * state.right_jacobian(frame, j);
    equations.Diagonal(block).block<3, 3>(c, c).noalias() += weight * before.transpose() * before;
    equations.Gradient(block).segment<3>(c).noalias() += weight * before.transpose() * turn;
    equations.Next(block).block<3, 3>(c, c).noalias() += weight * before.transpose() * after;
  }
}

void TrackEquations::Linearise(BlockTridiagonal& equations) {
  equations.SetZero(0);
  if (window_.first() < window_.begin && joined(window_.first())) AddRotationStep(window_.first(), equations);
  UpdateTwists(window_.begin, twist_);
  for (int f = window_.begin; f < window_.end; ++f) {
    const bool after = f + 1 < window_.end && joined(f);
    if (f + 1 < window_.end) equations.SetZero(f + 1 - window_.begin);
    SumFrame(f);
    AddFrame(f, equations);
    AddPriors(f, equations);
    if (f + 1 < window_.end) UpdateTwists(f + 1, twist_next_);
    if (after) {
      SumStep(f, step_after_);
      AddStep(f, equations);
      AddRotationStep(f, equations);
    }
    std::swap(twist_, twist_next_);
  }
}

Eigen::VectorXd TrackEquations::Parameters() const {
  const PoseState& state = window_.state;
  Eigen::VectorXd parameters((window_.end - window_.begin) * size_);
  for (int f = window_.begin; f < window_.end; ++f) {
    auto frame = parameters.segment((f - window_.begin) * size_, size_);
    frame.head<3>() = Eigen::Map<const Vector3d>(state.translation(f));
    for (int j = 0; j < state.joints(); ++j) {
      if (column(j) >= 0) frame.segment<3>(column(j)) = Eigen::Map<const Vector3d>(state.rotation(f, j));
    }
  }
  return parameters;
}

void TrackEquations::SetParameters(const Eigen::VectorXd& parameters) {
  PoseState& state = window_.state;
  for (int f = window_.begin; f < window_.end; ++f) {
    const auto frame = parameters.segment((f - window_.begin) * size_, size_);
    Eigen::Map<Vector3d>(state.translation(f)) = frame.head<3>();
    for (int j = 0; j < state.joints(); ++j) {
      if (column(j) >= 0) Eigen::Map<Vector3d>(state.rotation(f, j)) = frame.segment<3>(column(j));
    }
  }
  state.Update(window_.first(), window_.end, true);
}

Expected<WindowSolution> SolveBanded(const TrackWindow& window) {
  const OneThread one_thread;
  TrackEquations track(window);
  BlockTridiagonal own;
  BlockTridiagonal& equations = window.memory != nullptr ? *window.memory : own;
  equations.Resize(window.end - window.begin, track.size());
  TrustRegion region;
  Eigen::VectorXd parameters = track.Parameters();
  track.SetParameters(parameters);
  WindowSolution solution;
  double cost = solution.initial_cost = track.Cost();
  if (!std::isfinite(cost)) {
    return Fail(ErrorCode::kInconsistent, "the cost of the initial pose is not finite",
                "frames " + std::to_string(window.begin) + " to " + std::to_string(window.end),
                "check that these frames show a person, in metres");
  }
  bool moved = true;
  while (solution.iterations < window.step.max_iterations && !region.exhausted()) {
    if (Status on = StopIfInterrupted("fit of joint tracks"); !on) return Forward(on);
    if (moved) track.Linearise(equations);
    moved = false;
    ++solution.iterations;
    const Eigen::VectorXd damping = region.Damping(equations.DiagonalEntries());
    if (!equations.Factor(damping)) {
      region.Reject();
      continue;
    }
    const Eigen::VectorXd step = equations.Solve();
    const double predicted_decrease =
        0.5 * (step.dot(damping.cwiseProduct(step)) - step.dot(equations.GradientEntries()));
    track.SetParameters(parameters + step);
    const double next = track.Cost();
    const double gain = (cost - next) / predicted_decrease;
    if (!(predicted_decrease > 0.0) || !(gain > TrustRegion::kSmallestGain)) {
      track.SetParameters(parameters);
      // At the minimum, rounding decides the sign of the decrease.
      if (predicted_decrease <= 1e-3 * window.step.relative_tolerance * cost) {
        solution.converged = true;
        break;
      }
      region.Reject();
      continue;
    }
    parameters += step;
    region.Accept(gain);
    moved = true;
    const bool settled = cost - next <= window.step.relative_tolerance * cost;
    cost = next;
    if (settled) {
      solution.converged = true;
      break;
    }
  }
  solution.exhausted = !solution.converged && region.exhausted();
  solution.final_cost = cost;
  return solution;
}

}  // namespace mocurate
