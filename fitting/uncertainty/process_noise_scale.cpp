#include "fitting/uncertainty/process_noise_scale.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/solver/block_tridiagonal.h"
#include "fitting/uncertainty/frame_covariances.h"

namespace mocurate {
namespace {
constexpr double kStepReach_s = 0.12;  ///< steps within this time are averaged
constexpr double kJointSteps = 5.0;    ///< weight of the joint's mean, in steps
constexpr double kAllSteps = 10.0;     ///< weight of the mean of all joints against the joint's, in steps
constexpr int kPriorSteps = 3;         ///< frames that share one prior covariance (numerical)
constexpr double kLeastKnown = 1e-4;   ///< share of a step that evidence determines, at least (numerical)
/// Factor on the process noise, at least: people never stand perfectly still.
constexpr double kSmallestStepFactor = 0.05;
constexpr double kLargestStepFactor = 4.0;  ///< factor on the process noise, at most

/// Steps of the solved fit relative to the process noise that it was solved with. (F*J)
struct Steps {
  std::vector<double> square;  ///< in units of the variance that the options give a step; negative: no step
  std::vector<double> known;   ///< share of the process noise's variance that the evidence determined, and that a fit's
                               ///< steps therefore show
};

class StepReader {
 public:
  StepReader(const TrackProblem& window, Steps& rotations, Steps& translations)
      : window_(window), rotations_(rotations), translations_(translations) {}

  void Read(const FrameCovariance& covariance) {
    const int f = covariance.frame;
    if (f + 1 >= window_.frames() || !window_.Joined(f)) return;
    UpdatePrior(covariance);
    if (prior_.size() == 0) return;
    AddMoves(covariance);
    for (int j = 0; j < window_.state.joints(); ++j) AddRotation(covariance, j);
  }

 private:
  /// Covariance of a step from all process noises together, which is less than that of each alone.
  void UpdatePrior(const FrameCovariance& covariance) {
    // Groups of frames, independent of where windows begin.
    if (prior_.size() > 0 && group_ == covariance.frame / kPriorSteps) return;
    group_ = covariance.frame / kPriorSteps;
    Eigen::MatrixXd inverse = -0.5 * (covariance.tie + covariance.tie.transpose());
    if (InvertInPlace(inverse)) prior_ = std::move(inverse);
  }

  static void Add(double square, double unit, double prior, double posterior, double variance, std::size_t at,
                  Steps& steps) {
    steps.square[at] = square / (3.0 * unit);
    steps.known[at] = std::max((prior - posterior) / (3.0 * variance), kLeastKnown);
  }

  void AddMoves(const FrameCovariance& covariance) {
    const int f = covariance.frame;
    const PoseState& state = window_.state;
    const TwistPropagation here(state, covariance.columns, f);
    const TwistPropagation there(state, covariance.columns, f + 1);
    const std::vector<Matrix6d> own = here.CovarianceWith(here, covariance.own);
    const std::vector<Matrix6d> next = there.CovarianceWith(there, covariance.next);
    const std::vector<Matrix6d> cross = here.CovarianceWith(there, covariance.with_next);
    const std::vector<Matrix6d> prior_twists = here.CovarianceWith(here, prior_);
    const double unit = window_.options.priors.position_noise * window_.options.priors.position_noise * window_.Step(f);
    for (int j = 0; j < state.joints(); ++j) {
      const double square = (state.position(f + 1, j) - state.position(f, j)).squaredNorm();
      const auto before = here.PositionDerivative(j);
      const auto after = there.PositionDerivative(j);
      const double prior = (before * prior_twists[j]).cwiseProduct(before).sum();
      const double posterior = (before * own[j]).cwiseProduct(before).sum() +
                               (after * next[j]).cwiseProduct(after).sum() -
                               2.0 * (before * cross[j]).cwiseProduct(after).sum();
      Add(square, unit, prior, posterior, window_.MoveVariance(f, j), window_.Index(f, j), translations_);
    }
  }

  void AddRotation(const FrameCovariance& covariance, int j) {
    const int f = covariance.frame;
    const PoseState& state = window_.state;
    const int c = covariance.columns.of(j);
    if (c < 0) return;
    const Vector3d turn = LogMatrix(state.local(f, j).transpose() * state.local(f + 1, j));
    const Matrix3d inverse = RightJacobianInverse(turn);
    const Matrix3d before = -inverse.transpose() * state.right_jacobian(f, j);
    const Matrix3d after = inverse * state.right_jacobian(f + 1, j);
    const double own = (before * covariance.own.block<3, 3>(c, c) * before.transpose()).trace();
    const double next = (after * covariance.next.block<3, 3>(c, c) * after.transpose()).trace();
    const double cross = (before * covariance.with_next.block<3, 3>(c, c) * after.transpose()).trace();
    const double prior = (after * prior_.block<3, 3>(c, c) * after.transpose()).trace();
    const double unit = window_.options.priors.rotation_noise * window_.options.priors.rotation_noise * window_.Step(f);
    Add(turn.squaredNorm(), unit, prior, own + next + 2.0 * cross, window_.RotationVariance(f, j), window_.Index(f, j),
        rotations_);
  }

  const TrackProblem& window_;
  Steps& rotations_;
  Steps& translations_;
  Eigen::MatrixXd prior_;
  int group_ = 0;
};

/// Squares of steps, and their known share.
struct StepSum {
  double square = 0.0;
  double known = 0.0;
  double count = 0.0;
  void Add(const Steps& steps, std::size_t at, double sign = 1.0) {
    if (steps.square[at] < 0.0) return;
    count += sign;
    square += sign * steps.square[at];
    known += sign * steps.known[at];
  }
  /// Square of the factor, shrunk towards that of more steps, which count as `weight` known steps.
  double Towards(double factor, double weight) const { return (square + weight * factor) / (known + weight); }
};

void Average(const TrackProblem& window, const Steps& steps, std::vector<double>& factors) {
  const int frames = window.frames();
  const int joints = window.tracks.joints();
  StepSum all;
  for (std::size_t at = 0; at < steps.square.size(); ++at) all.Add(steps, at);
  if (all.known == 0.0) return;
  const double usual = all.known / all.count;  // of a step
  for (int j = 0; j < joints; ++j) {
    StepSum joint;
    for (int f = 0; f < frames; ++f) joint.Add(steps, window.Index(f, j));
    const double mean = joint.Towards(all.square / all.known, kAllSteps * usual);
    StepSum nearby;
    int first = 0;
    int last = 0;  // steps [first, last) are averaged
    for (int f = 0; f < frames; ++f) {
      const double time = window.tracks.time_s[f];
      for (; last < frames && window.tracks.time_s[last] <= time + kStepReach_s; ++last) {
        nearby.Add(steps, window.Index(last, j));
      }
      for (; window.tracks.time_s[first] < time - kStepReach_s; ++first)
        nearby.Add(steps, window.Index(first, j), -1.0);
      if (steps.square[window.Index(f, j)] < 0.0) continue;
      const double square = std::max(nearby.Towards(mean, kJointSteps * usual), 0.0);
      factors[window.Index(f, j)] = std::clamp(std::sqrt(square), kSmallestStepFactor, kLargestStepFactor);
    }
  }
}

}  // namespace

Expected<ProcessNoiseScale> RefitProcessNoise(const TrackProblem& window) {
  const std::size_t numbers = window.tracks.confidence.size();
  Steps rotations{std::vector<double>(numbers, -1.0), std::vector<double>(numbers, 0.0)};
  Steps translations = rotations;
  StepReader reader(window, rotations, translations);
  Status visited = VisitCovariances(window, [&](const FrameCovariance& covariance) { reader.Read(covariance); });
  if (!visited) return tl::unexpected<Error>(visited.error());
  ProcessNoiseScale factors = ProcessNoiseScale::Ones(numbers);
  if (window.noise_scale != nullptr) factors = *window.noise_scale;
  Average(window, rotations, factors.rotation);
  Average(window, translations, factors.position);
  return factors;
}

}  // namespace mocurate
