#include "fitting/uncertainty/walk_factors.h"

#include <algorithm>
#include <cmath>

#include "fitting/uncertainty/carried_twists.h"
#include "fitting/uncertainty/frame_covariances.h"

namespace mocurate {
namespace {
constexpr double kReach_s = 0.12;    ///< steps that are nearby in time
constexpr double kJointSteps = 5.0;  ///< that the joint's mean counts for beside them
constexpr double kAllSteps = 10.0;   ///< that the mean of all joints counts for beside the joint's
constexpr double kSmallest = 0.05;   ///< nobody is a statue
constexpr double kLargest = 4.0;

/// Squares of steps in units of the variances that the options give them. (F*J); negative where there is no step.
struct Steps {
  std::vector<double> turn;
  std::vector<double> move;
};

class Expectation {
 public:
  Expectation(const TrackWindow& window, Steps& steps) : window_(window), steps_(steps) {}

  void Read(const FrameCovariance& covariance) {
    const int f = covariance.frame;
    if (f + 1 < window_.end && window_.Joined(f)) {
      AddMoves(covariance);
      for (int j = 0; j < window_.state.joints(); ++j) AddTurn(covariance, j);
    }
  }

 private:
  void AddMoves(const FrameCovariance& covariance) {
    const int f = covariance.frame;
    const PoseState& state = window_.state;
    const CarriedTwists here(state, covariance.track, f);
    const CarriedTwists there(state, covariance.track, f + 1);
    const std::vector<Matrix6d> own = here.CovarianceWith(here, covariance.own);
    const std::vector<Matrix6d> next = there.CovarianceWith(there, covariance.next);
    const std::vector<Matrix6d> cross = here.CovarianceWith(there, covariance.with_next);
    const double unit = window_.options.velocity_walk * window_.options.velocity_walk * window_.Step(f);
    for (int j = 0; j < state.joints(); ++j) {
      const double square = (state.position(f + 1, j) - state.position(f, j)).squaredNorm();
      const auto before = here.PositionDerivative(j);
      const auto after = there.PositionDerivative(j);
      const double variance = (before * own[j]).cwiseProduct(before).sum() +
                              (after * next[j]).cwiseProduct(after).sum() -
                              2.0 * (before * cross[j]).cwiseProduct(after).sum();
      steps_.move[window_.Index(f, j)] = (square + variance) / (3.0 * unit);
    }
  }

  void AddTurn(const FrameCovariance& covariance, int j) {
    const int f = covariance.frame;
    const PoseState& state = window_.state;
    const int c = covariance.track.column(j);
    if (c < 0) return;
    const Vector3d turn = LogMatrix(state.local(f, j).transpose() * state.local(f + 1, j));
    const Matrix3d inverse = RightJacobianInverse(turn);
    const Matrix3d before = -inverse.transpose() * state.right_jacobian(f, j);
    const Matrix3d after = inverse * state.right_jacobian(f + 1, j);
    const double own = (before * covariance.own.block<3, 3>(c, c) * before.transpose()).trace();
    const double next = (after * covariance.next.block<3, 3>(c, c) * after.transpose()).trace();
    const double cross = (before * covariance.with_next.block<3, 3>(c, c) * after.transpose()).trace();
    const double unit = window_.options.rotation_walk * window_.options.rotation_walk * window_.Step(f);
    steps_.turn[window_.Index(f, j)] = (turn.squaredNorm() + own + next + 2.0 * cross) / (3.0 * unit);
  }

  const TrackWindow& window_;
  Steps& steps_;
};

struct Sum {
  double value = 0.0;
  double count = 0.0;
  void Add(double square) {
    value += square;
    count += 1.0;
  }
  double Towards(double mean, double weight) const { return (value + weight * mean) / (count + weight); }
};

/// Factors from the squares of the steps.
void Average(const TrackWindow& window, const std::vector<double>& squares, std::vector<double>& factors) {
  const int frames = window.end;
  const int joints = window.tracks.joints();
  Sum all;
  for (const double square : squares) {
    if (square >= 0.0) all.Add(square);
  }
  if (all.count == 0.0) return;
  for (int j = 0; j < joints; ++j) {
    Sum joint;
    for (int f = 0; f < frames; ++f) {
      if (squares[window.Index(f, j)] >= 0.0) joint.Add(squares[window.Index(f, j)]);
    }
    const double mean = joint.Towards(all.value / all.count, kAllSteps);
    Sum nearby;
    int first = 0;
    int last = 0;  // [first, last) is nearby
    for (int f = 0; f < frames; ++f) {
      const double time = window.tracks.time_s[f];
      for (; last < frames && window.tracks.time_s[last] <= time + kReach_s; ++last) {
        if (squares[window.Index(last, j)] >= 0.0) nearby.Add(squares[window.Index(last, j)]);
      }
      for (; window.tracks.time_s[first] < time - kReach_s; ++first) {
        if (squares[window.Index(first, j)] < 0.0) continue;
        nearby.value -= squares[window.Index(first, j)];
        nearby.count -= 1.0;
      }
      if (squares[window.Index(f, j)] < 0.0) continue;
      factors[window.Index(f, j)] = std::clamp(std::sqrt(nearby.Towards(mean, kJointSteps)), kSmallest, kLargest);
    }
  }
}

}  // namespace

Expected<WalkFactors> RefitWalks(const TrackWindow& window) {
  const std::size_t numbers = window.tracks.confidence.size();
  Steps steps{std::vector<double>(numbers, -1.0), std::vector<double>(numbers, -1.0)};
  Expectation expectation(window, steps);
  Status visited = VisitCovariances(window, [&](const FrameCovariance& covariance) { expectation.Read(covariance); });
  if (!visited) return tl::unexpected<Error>(visited.error());
  WalkFactors factors = WalkFactors::Ones(numbers);
  if (window.walks != nullptr) factors = *window.walks;
  Average(window, steps.turn, factors.rotation);
  Average(window, steps.move, factors.position);
  return factors;
}

}  // namespace mocurate
