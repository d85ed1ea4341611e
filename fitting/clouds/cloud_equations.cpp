#include "fitting/clouds/cloud_equations.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/rotation.h"
#include "fitting/costs/huber.h"
#include "fitting/solver/rest_sigmas.h"
#include "fitting/solver/trust_region.h"

namespace mocurate {
namespace {

constexpr double kBodyPatch = 0.05;  ///< m; closer points share the error of the capsule body

}  // namespace

double PatchShare(const PointCloudOptions& options) {
  return options.rules.on(FittingRule::kPatchShare) ? std::min(1.0, options.voxel_size / kBodyPatch) : 1.0;
}

std::vector<RestAndLimits> PriorsInClouds(const Skeleton& skeleton, const PoseGaussian* pose,
                                          const PointCloudOptions& options) {
  const std::vector<double> sigmas = RestPoseSigmas(skeleton, options.rest_sigma);
  std::vector<RestAndLimits> priors(sigmas.size());
  for (std::size_t j = 1; j < sigmas.size(); ++j)
    priors[j] = {1.0 / Square(sigmas[j]), LimitsInClouds(skeleton.joints[j], sigmas[j], options)};
  for (std::size_t k = 0; pose != nullptr && k < pose->joints.size(); ++k) {
    RestAndLimits& prior = priors[static_cast<std::size_t>(pose->joints[k])];
    prior = {std::max(0.0, prior.rest - pose->rest[k]), nullptr};
  }
  return priors;
}

CloudEquations::CloudEquations(const CapsuleBody& body, PoseState& state, FrameTerms terms,
                               const PointCloudOptions& options)
    : body_(body),
      state_(state),
      terms_(std::move(terms)),
      frame_(terms_.frame),
      options_(options),
      priors_(PriorsInClouds(*body.skeleton, terms_.pose, options)),
      subtree_(state.joints()) {
  for (int j = 0; j < state.joints(); ++j) {
    column_.push_back(state.active(j) ? size_ : -1);
    if (state.active(j)) size_ += 3;
  }
}

double CloudEquations::Cost() const {
  std::vector<CapsuleEnds> ends;
  for (const BodyCapsule& capsule : body_.capsules) ends.push_back(EndsOf(capsule, state_, frame_));
  double twice = 0.0;
  for (const CloudMatch& match : terms_.matches) {
    const Vector3d point = terms_.cloud.points.col(match.point);
    const CapsuleEnds& axis = ends[match.capsule];
    const double distance = (point - (axis.begin + PlaceOnAxis(axis, point) * (axis.end - axis.begin))).norm();
    twice += HuberValue(Square(terms_.weight * (distance - body_.capsules[match.capsule].radius)), terms_.huber);
  }
  for (const JointObservation& seen : terms_.joints) {
    const Vector3d error = seen.whitening * (state_.position(frame_, seen.joint) - seen.position);
    twice += HuberValue(error.squaredNorm(), options_.huber_sigmas);
  }
  for (int j = 0; j < state_.joints(); ++j) {
    if (!state_.active(j)) continue;
    for (const FixedNeighbourFrame& neighbour : terms_.held) {
      const Matrix3d rotation = state_.local(frame_ + neighbour.step, j).transpose() * state_.local(frame_, j);
      twice += LogMatrix(rotation).squaredNorm() / (Square(options_.rotation_process_noise) * neighbour.seconds);
    }
    const RestAndLimits& prior = priors_[static_cast<std::size_t>(j)];
    const Eigen::Map<const Vector3d> w(std::as_const(state_).rotation(frame_, j));
    twice += w.squaredNorm() * prior.rest;
    for (int i = 0; prior.limits != nullptr && i < 3; ++i) {
      twice += Square(BeyondLimit(w[i], prior.limits->min[i], prior.limits->max[i]) / kCloudLimitSigma);
    }
  }
  for (const FixedNeighbourFrame& neighbour : terms_.held) {
    const Vector3d move = state_.position(frame_, 0) - state_.position(frame_ + neighbour.step, 0);
    twice += move.squaredNorm() / (Square(options_.velocity_process_noise) * neighbour.seconds);
  }
  if (terms_.pose != nullptr) {
    twice +=
        (terms_.pose->whitening.triangularView<Eigen::Lower>() * terms_.pose->Errors(state_, frame_)).squaredNorm();
  }
  return 0.5 * twice;
}

/// Adds the points' terms for the twist of each joint's subtree, about the root's position.
void CloudEquations::SumPoints() {
  std::vector<CapsuleEnds> ends;
  for (const BodyCapsule& capsule : body_.capsules) ends.push_back(EndsOf(capsule, state_, frame_));
  for (BodyInformation& sum : subtree_) sum = {};
  const Vector3d& origin = state_.position(frame_, 0);
  for (const CloudMatch& match : terms_.matches) {
    const BodyCapsule& capsule = body_.capsules[match.capsule];
    const Vector3d point = terms_.cloud.points.col(match.point);
    const CapsuleEnds& axis = ends[match.capsule];
    const Vector3d nearest = axis.begin + PlaceOnAxis(axis, point) * (axis.end - axis.begin);
    const Vector3d away = point - nearest;
    const double length = away.norm();
    if (length == 0.0) continue;  // on the axis: no direction
    const double residual = terms_.weight * (length - capsule.radius);
    Vector6d row;  // of the residual in the twist: -weight (n, q x n)
    row.head<3>() = (-terms_.weight / length) * away;
    row.tail<3>() = (nearest - origin).cross(row.head<3>());
    const double slope = HuberSlope(Square(residual), terms_.huber);
    BodyInformation& sum = subtree_[capsule.frame];
    sum.information.noalias() += (slope * row) * row.transpose();
    sum.gradient += (slope * residual) * row;
  }
}

/// Observed joints move with their parent joint.
void CloudEquations::SumJoints() {
  const Vector3d& origin = state_.position(frame_, 0);
  for (const JointObservation& seen : terms_.joints) {
    const Vector3d& position = state_.position(frame_, seen.joint);
    const Vector3d error = position - seen.position;
    const Vector3d white = seen.whitening * error;
    const double slope = HuberSlope(white.squaredNorm(), options_.huber_sigmas);
    const Matrix3d weight = slope * seen.whitening.transpose() * seen.whitening;
    subtree_[std::max(0, state_.parent(seen.joint))].AddPoint(position - origin, weight, weight * error);
  }
}

void CloudEquations::AddPoints() {
  for (int j = state_.joints() - 1; j > 0; --j) subtree_[state_.parent(j)] += subtree_[j];
  std::vector<Twist> twists(state_.joints());
  matrix_.topLeftCorner<3, 3>() += subtree_[0].information.topLeftCorner<3, 3>();
  gradient_.head<3>() += subtree_[0].gradient.head<3>();
  for (int j = 0; j < state_.joints(); ++j) {
    const int c = column_[j];
    if (c < 0) continue;
    const Matrix3d& lever = state_.lever(frame_, j);
    twists[j].topRows<3>().noalias() = Hat(state_.position(frame_, j) - state_.position(frame_, 0)) * lever;
    twists[j].bottomRows<3>() = lever;
    const Twist moved = subtree_[j].information * twists[j];
    matrix_.block<3, 3>(0, c) += moved.topRows<3>();
    matrix_.block<3, 3>(c, c).noalias() += twists[j].transpose() * moved;
    for (const int a : state_.path(j)) {
      matrix_.block<3, 3>(column_[a], c).noalias() += twists[a].transpose() * moved;
    }
    gradient_.segment<3>(c).noalias() += twists[j].transpose() * subtree_[j].gradient;
  }
}

void CloudEquations::AddPriors() {
  for (int j = 1; j < state_.joints(); ++j) {
    const int c = column_[j];
    if (c < 0) continue;
    const auto& [rest, limits] = priors_[static_cast<std::size_t>(j)];
    const double limit = 1.0 / Square(kCloudLimitSigma);
    for (int i = 0; i < 3; ++i) {
      const double w = std::as_const(state_).rotation(frame_, j)[i];
      const double beyond = limits != nullptr ? BeyondLimit(w, limits->min[i], limits->max[i]) : 0.0;
      matrix_(c + i, c + i) += rest + (beyond == 0.0 ? 0.0 : limit);
      gradient_[c + i] += rest * w + limit * beyond;
    }
  }
}

void CloudEquations::AddPose() {
  if (terms_.pose == nullptr) return;
  const PoseGaussian& pose = *terms_.pose;
  const Eigen::VectorXd errors = pose.Errors(state_, frame_);
  const auto whitening = pose.whitening.triangularView<Eigen::Lower>();
  const Eigen::VectorXd residual = whitening * errors;
  Eigen::MatrixXd jacobian = whitening;
  std::vector<int> columns{0};
  for (std::size_t k = 0; k < pose.joints.size(); ++k) {
    const auto at = PoseGaussian::At(k);
    jacobian.middleCols<3>(at) = (jacobian.middleCols<3>(at) * pose.Derivative(errors, state_, frame_, k)).eval();
    columns.push_back(column_[pose.joints[k]]);
  }
  const Eigen::MatrixXd information = jacobian.transpose() * jacobian;
  const Eigen::VectorXd gradient = jacobian.transpose() * residual;
  for (std::size_t b = 0; b < columns.size(); ++b) {
    for (std::size_t a = 0; a <= b; ++a)
      matrix_.block<3, 3>(columns[a], columns[b]) +=
          information.block<3, 3>(3 * static_cast<Eigen::Index>(a), 3 * static_cast<Eigen::Index>(b));
    gradient_.segment<3>(columns[b]) += gradient.segment<3>(3 * static_cast<Eigen::Index>(b));
  }
}

void CloudEquations::AddStep(const FixedNeighbourFrame& neighbour) {
  const int other = frame_ + neighbour.step;
  const double move_weight = 1.0 / (Square(options_.velocity_process_noise) * neighbour.seconds);
  const double rotation_term_weight = 1.0 / (Square(options_.rotation_process_noise) * neighbour.seconds);
  matrix_.topLeftCorner<3, 3>().diagonal().array() += move_weight;
  gradient_.head<3>() += move_weight * (state_.position(frame_, 0) - state_.position(other, 0));
  for (int j = 0; j < state_.joints(); ++j) {
    const int c = column_[j];
    if (c < 0) continue;
    const Vector3d rotation = LogMatrix(state_.local(other, j).transpose() * state_.local(frame_, j));
    const Matrix3d after = RightJacobianInverse(rotation) * state_.right_jacobian(frame_, j);
    matrix_.block<3, 3>(c, c).noalias() += rotation_term_weight * after.transpose() * after;
    gradient_.segment<3>(c).noalias() += rotation_term_weight * after.transpose() * rotation;
  }
}

void CloudEquations::Linearise() {
  matrix_ = Eigen::MatrixXd::Zero(size_, size_);
  gradient_ = Eigen::VectorXd::Zero(size_);
  SumPoints();
  SumJoints();
  AddPoints();
  AddPriors();
  AddPose();
  for (const FixedNeighbourFrame& neighbour : terms_.held) AddStep(neighbour);
}

Eigen::VectorXd CloudEquations::Parameters() const {
  const PoseState& state = state_;
  Eigen::VectorXd parameters(size_);
  parameters.head<3>() = Eigen::Map<const Vector3d>(state.translation(frame_));
  for (int j = 0; j < state.joints(); ++j) {
    if (column_[j] >= 0) parameters.segment<3>(column_[j]) = Eigen::Map<const Vector3d>(state.rotation(frame_, j));
  }
  return parameters;
}

void CloudEquations::SetParameters(const Eigen::VectorXd& parameters) {
  Eigen::Map<Vector3d>(state_.translation(frame_)) = parameters.head<3>();
  for (int j = 0; j < state_.joints(); ++j) {
    if (column_[j] >= 0) Eigen::Map<Vector3d>(state_.rotation(frame_, j)) = parameters.segment<3>(column_[j]);
  }
  state_.Update(frame_, frame_ + 1, true);
}

Expected<CloudSolution> SolveCloudEquations(CloudEquations& equations, int steps, double relative_tolerance) {
  TrustRegion region;
  Eigen::VectorXd parameters = equations.Parameters();
  equations.SetParameters(parameters);
  CloudSolution solution;
  double cost = solution.initial_cost = equations.Cost();
  if (!std::isfinite(cost)) return Fail(ErrorCode::kInconsistent, "the initial cost is not finite", "clouds");
  bool moved = true;
  for (int i = 0; i < steps && !region.exhausted(); ++i) {
    if (moved) equations.Linearise();
    moved = false;
    const Eigen::VectorXd damping = region.Damping(equations.matrix().diagonal());
    Eigen::MatrixXd damped = equations.matrix();
    damped.diagonal() += damping;
    const Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> factor(damped);
    if (factor.info() != Eigen::Success) {
      region.Reject();
      continue;
    }
    const Eigen::VectorXd step = -factor.solve(equations.gradient());
    const double predicted_decrease = 0.5 * (step.dot(damping.cwiseProduct(step)) - step.dot(equations.gradient()));
    equations.SetParameters(parameters + step);
    const double next = equations.Cost();
    const double gain = (cost - next) / predicted_decrease;
    if (!(predicted_decrease > 0.0) || !(gain > TrustRegion::kSmallestGain)) {
      equations.SetParameters(parameters);
      if (predicted_decrease <= 1e-3 * relative_tolerance * cost) break;
      region.Reject();
      continue;
    }
    parameters += step;
    region.Accept(gain);
    moved = true;
    const bool settled = cost - next <= relative_tolerance * cost;
    cost = next;
    if (settled) break;
  }
  solution.final_cost = cost;
  return solution;
}

}  // namespace mocurate
