#include "fitting/clouds/cloud_smoothing.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/geometry/rotation.h"
#include "fitting/clouds/cloud_equations.h"
#include "fitting/costs/huber.h"
#include "fitting/solver/block_tridiagonal.h"
#include "fitting/stop_request.h"

namespace mocurate {
namespace {

constexpr std::size_t kPart = 300;      ///< frames of a part (numerical)
constexpr std::size_t kContext = 30;    ///< frames on either side that are fitted with a part (numerical)
constexpr int kPathRounds = 10;         ///< matchings, at most (numerical)
constexpr int kHalvings = 4;            ///< of a step that does not lower the cost (numerical)
constexpr double kLongestStep_s = 0.4;  ///< between neighbours that are coupled: later a limb may have any pose

/// Frames `begin` to `end` of a chain, fitted together.
class ChainPart {
 public:
  ChainPart(const CapsuleBody& body, const std::vector<FusedCloud>& clouds, const std::vector<FrameFit>& chain,
            std::size_t begin, std::size_t end, const std::vector<double>& time_s, const PointCloudOptions& options,
            PoseState& state)
      : body_(body),
        clouds_(clouds),
        chain_(chain),
        begin_(begin),
        count_(end - begin),
        time_s_(time_s),
        options_(options),
        state_(state),
        matches_(count_) {
    Match();
    for (const std::vector<CloudMatch>& matches : matches_) {
      std::vector<double> distances;
      for (const CloudMatch& match : matches) distances.push_back(match.distance);
      sigma_.push_back(RobustSigma(std::move(distances)));
    }
    size_ = static_cast<int>(EquationsOf(0).Parameters().size());
  }

  /// Whether the joints settled.
  Expected<bool> Solve() {
    double before = Cost();
    for (int round = 0; round < kPathRounds; ++round) {
      if (Status on = StopIfInterrupted("fit of depth views"); !on) return Forward(on);
      if (!std::isfinite(before)) return Fail(ErrorCode::kInconsistent, "the cost is not finite", Frames());
      if (Status factored = Factor(); !factored) return Forward(factored);
      const Eigen::VectorXd step = equations_.Solve();
      const std::vector<Eigen::VectorXd> poses = Poses();
      double share = 1.0;
      double moved = Move(poses, step, share);
      double after = Cost();
      for (int i = 0; i < kHalvings && !(after < before); ++i) {
        moved = Move(poses, step, share *= 0.5);
        after = Cost();
      }
      if (!(after < before)) {
        Move(poses, step, 0.0);
        return true;
      }
      Match();
      if (moved < kSettled) return true;
      before = Cost();
    }
    return false;
  }

  /// Uncertainty of the frames [from, to) of the chain, in order, at the present poses.
  Status Uncertainty(std::size_t from, std::size_t to, std::vector<CloudUncertainty>& out) {
    if (Status factored = Factor(); !factored) return factored;
    equations_.VisitInverse([&](int i, const Eigen::MatrixXd& covariance, const Eigen::MatrixXd&) {
      const std::size_t at = begin_ + static_cast<std::size_t>(i);
      if (at < from || at >= to) return;
      const CloudEquations equations = EquationsOf(static_cast<std::size_t>(i));
      out[at] = UncertaintyOfCovariance(equations, FrameAt(static_cast<std::size_t>(i)), covariance, state_, options_);
    });
    return {};
  }

 private:
  std::string Frames() const {
    return "frames " + std::to_string(FrameAt(0)) + " to " + std::to_string(FrameAt(count_ - 1));
  }
  int FrameAt(std::size_t i) const { return chain_[begin_ + i].frame; }

  CloudEquations EquationsOf(std::size_t i) {
    const FrameFit& fit = chain_[begin_ + i];
    const FusedCloud& cloud = clouds_[static_cast<std::size_t>(fit.frame)];
    const double share = fit.point_weight * PatchShare(options_);
    return {body_,
            state_,
            {fit.frame, cloud, matches_[i], share / sigma_[i], share * options_.huber_sigmas, {}, fit.joints, fit.pose},
            options_};
  }

  void Match() {
    for (std::size_t i = 0; i < count_; ++i) {
      const int f = FrameAt(i);
      state_.Update(f, f + 1, true);
      matches_[i] = MatchPoints(body_, state_, f, clouds_[static_cast<std::size_t>(f)], options_.max_distance);
    }
  }

  /// Seconds to the next frame; 0 where the two are not coupled.
  double StepAfter(std::size_t i) const {
    if (i + 1 >= count_) return 0.0;
    const double step =
        time_s_[static_cast<std::size_t>(FrameAt(i + 1))] - time_s_[static_cast<std::size_t>(FrameAt(i))];
    return step <= kLongestStep_s ? step : 0.0;
  }

  Vector3d RotationStep(std::size_t i, int joint) const {
    return LogMatrix(state_.local(FrameAt(i), joint).transpose() * state_.local(FrameAt(i + 1), joint));
  }
  Vector3d RootStep(std::size_t i) const { return state_.position(FrameAt(i + 1), 0) - state_.position(FrameAt(i), 0); }

  double Cost() {
    double cost = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
      const CloudEquations frame = EquationsOf(i);
      cost += frame.Cost();
      const double step = StepAfter(i);
      if (step == 0.0) continue;
      double square = RootStep(i).squaredNorm() / Square(options_.velocity_process_noise);
      for (int j = 0; j < state_.joints(); ++j) {
        if (frame.column(j) >= 0) square += RotationStep(i, j).squaredNorm() / Square(options_.rotation_process_noise);
      }
      cost += 0.5 * square / step;
    }
    return cost;
  }

  Status Factor() {
    equations_.Resize(static_cast<int>(count_), size_);
    equations_.SetZero();
    for (std::size_t i = 0; i < count_; ++i) {
      const int block = static_cast<int>(i);
      CloudEquations frame = EquationsOf(i);
      frame.Linearise();
      equations_.Diagonal(block) += frame.matrix();
      equations_.Gradient(block) += frame.gradient();
      if (StepAfter(i) > 0.0) AddStep(i, frame);
    }
    if (equations_.Factor(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count_) * size_))) return {};
    return Fail(ErrorCode::kInconsistent, "the points of the depth views do not determine a pose of the body", Frames(),
                "check that the views show a person, and check their calibration");
  }

  /// Process noise from frame i to the next: Log(R_i^T R_i+1) and the root's way, as in RotationSmoothnessCost and
  /// JointVelocityCost.
  void AddStep(std::size_t i, const CloudEquations& frame) {
    const int block = static_cast<int>(i);
    const double root_weight = 1.0 / (Square(options_.velocity_process_noise) * StepAfter(i));
    const Vector3d root_gradient = root_weight * RootStep(i);
    equations_.Diagonal(block).topLeftCorner<3, 3>().diagonal().array() += root_weight;
    equations_.Diagonal(block + 1).topLeftCorner<3, 3>().diagonal().array() += root_weight;
    equations_.Next(block).topLeftCorner<3, 3>().diagonal().array() -= root_weight;
    equations_.Gradient(block).head<3>() -= root_gradient;
    equations_.Gradient(block + 1).head<3>() += root_gradient;
    const double weight = 1.0 / (Square(options_.rotation_process_noise) * StepAfter(i));
    for (int j = 0; j < state_.joints(); ++j) {
      const int c = frame.column(j);
      if (c < 0) continue;
      const Vector3d rotation = RotationStep(i, j);
      const Matrix3d inverse = RightJacobianInverse(rotation);
      const Matrix3d before = -inverse.transpose() * state_.right_jacobian(FrameAt(i), j);
      const Matrix3d after = inverse * state_.right_jacobian(FrameAt(i + 1), j);
      equations_.Diagonal(block).block<3, 3>(c, c).noalias() += weight * before.transpose() * before;
      equations_.Diagonal(block + 1).block<3, 3>(c, c).noalias() += weight * after.transpose() * after;
      equations_.Next(block).block<3, 3>(c, c).noalias() += weight * before.transpose() * after;
      equations_.Gradient(block).segment<3>(c).noalias() += weight * before.transpose() * rotation;
      equations_.Gradient(block + 1).segment<3>(c).noalias() += weight * after.transpose() * rotation;
    }
  }

  std::vector<Eigen::VectorXd> Poses() {
    std::vector<Eigen::VectorXd> poses;
    for (std::size_t i = 0; i < count_; ++i) poses.push_back(EquationsOf(i).Parameters());
    return poses;
  }

  /// Sets the poses plus a share of the step. Mean movement of the joints in the frame that moves most, m.
  double Move(const std::vector<Eigen::VectorXd>& poses, const Eigen::VectorXd& step, double share) {
    double most = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
      const int f = FrameAt(i);
      std::vector<Vector3d> joints;
      for (int j = 0; j < state_.joints(); ++j) joints.push_back(state_.position(f, j));
      EquationsOf(i).SetParameters(poses[i] + share * step.segment(static_cast<Eigen::Index>(i) * size_, size_));
      double sum = 0.0;
      for (int j = 0; j < state_.joints(); ++j)
        sum += (state_.position(f, j) - joints[static_cast<std::size_t>(j)]).norm();
      most = std::max(most, sum / state_.joints());
    }
    return most;
  }

  const CapsuleBody& body_;
  const std::vector<FusedCloud>& clouds_;
  const std::vector<FrameFit>& chain_;
  const std::size_t begin_;
  const std::size_t count_;
  const std::vector<double>& time_s_;
  const PointCloudOptions& options_;
  PoseState& state_;
  std::vector<std::vector<CloudMatch>> matches_;
  std::vector<double> sigma_;  ///< (count) m, of a point's distance
  BlockTridiagonal equations_;
  int size_ = 0;
};

}  // namespace

Expected<SmoothedChain> SmoothChain(const CapsuleBody& body, const std::vector<FusedCloud>& clouds,
                                    const std::vector<FrameFit>& chain, const std::vector<double>& time_s,
                                    const PointCloudOptions& options, PoseState& state) {
  SmoothedChain smoothed{std::vector<CloudUncertainty>(chain.size()), true};
  for (std::size_t begin = 0; begin < chain.size(); begin += kPart) {
    const std::size_t end = std::min(chain.size(), begin + kPart);
    const std::size_t first = begin - std::min(begin, kContext);
    std::vector<std::vector<double>> stated;  // poses of frames that the part before stated
    for (std::size_t i = first; i < begin; ++i) stated.push_back(state.FrameParameters(chain[i].frame));
    ChainPart part(body, clouds, chain, first, std::min(chain.size(), end + kContext), time_s, options, state);
    const Expected<bool> settled = part.Solve();
    if (!settled) return Forward(settled);
    smoothed.settled = smoothed.settled && *settled;
    if (options.uncertainty) {
      if (Status added = part.Uncertainty(begin, end, smoothed.uncertainty); !added) return Forward(added);
    }
    for (std::size_t i = first; i < begin; ++i) {
      const int f = chain[i].frame;
      state.SetFrameParameters(f, stated[i - first]);
      state.Update(f, f + 1, true);
    }
  }
  return smoothed;
}

}  // namespace mocurate
