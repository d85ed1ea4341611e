#include "fitting/clouds/cloud_smoothing.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "fitting/clouds/cloud_terms.h"
#include "fitting/solver/one_thread.h"
#include "fitting/solver/pose_equations.h"
#include "fitting/solver/rest_sigmas.h"
#include "fitting/solver/solve.h"

namespace mocurate {
namespace {

constexpr std::size_t kPart = 300;      ///< frames of a part (numerical)
constexpr std::size_t kContext = 30;    ///< frames on either side that are fitted with a part (numerical)
constexpr int kPathRounds = 10;         ///< matchings, at most (numerical)
constexpr int kTries = 5;               ///< of a step that lowers the cost, ever shorter (numerical)
constexpr double kTolerance = 1e-6;     ///< relative change of the cost that is none (numerical)
constexpr double kLongestStep_s = 0.4;  ///< between neighbours that are coupled: later a limb may have any pose

/// Frames of a chain, fitted together.
class ChainPart {
 public:
  ChainPart(const CapsuleBody& body, const std::vector<FusedCloud>& clouds, const std::vector<FrameFit>& chain,
            const std::vector<double>& time_s, const PointCloudOptions& options, PoseState& state)
      : terms_(CloudTerms(body, options)), options_(options), state_(state) {
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const auto f = static_cast<std::size_t>(chain[i].frame);
      FrameFit fit = chain[i];
      fit.held.clear();
      clouds_.push_back(&clouds[f]);
      terms_.frames.push_back(TermsOfFit(body, clouds[f], fit, {}, 1.0, options));
      state.Update(fit.frame, fit.frame + 1, true);
      if (i + 1 == chain.size()) break;
      const double step = time_s[static_cast<std::size_t>(chain[i + 1].frame)] - time_s[f];
      if (step <= kLongestStep_s) terms_.frames.back().next = StepInClouds(state.joints(), step, options);
    }
    CountRestOnce();
    Match();
    for (FrameTerms& frame : terms_.frames) frame.surface.weight /= RobustSigma(frame.surface.matches);
  }

  /// Matches and solves in turn: a step that lowers the cost, then other matches, until the joints settle.
  Status MatchAndSolve(SmoothedChain& chain) {
    const SolveOptions solve{options_.solver, kTolerance, kTries, "fit of depth views", &equations_, true};
    double cost = 0.0;
    bool settled = false;
    for (int round = 0; round < kPathRounds && !settled; ++round) {
      const std::vector<Vector3d> before = Joints();
      const auto solution = Solve(terms_, state_, solve);
      if (!solution) return Forward(solution);
      if (round == 0) chain.initial_cost += solution->initial_cost;
      cost = solution->final_cost;
      settled = solution->converged && LargestMove(before) < kSettled;
      Match();
    }
    chain.final_cost += cost;
    chain.settled = chain.settled && settled;
    return {};
  }

  /// Uncertainty of the frames [from, to) of the part, in order, at the present poses.
  Status Uncertainty(std::size_t from, std::size_t to, PosePosterior* out) {
    const OneThread one_thread;
    PoseEquations pose(state_);
    equations_.Resize(static_cast<int>(terms_.frames.size()), pose.columns().size());
    pose.Linearise(terms_, state_, equations_);
    const Skeleton& skeleton = *terms_.body->skeleton;
    Status factored = FactorInformation(equations_, pose.columns(), skeleton, terms_.frames.front().frame);
    if (!factored) return factored;
    const BodyDeviations deviations =
        DeviationsInClouds(skeleton, BodyScale(skeleton, state_.bone_lengths()), 1.0, options_.rules);
    const std::vector<Vector3d> prior = PriorInClouds(skeleton, options_);
    equations_.VisitInverse([&](int i, const Eigen::MatrixXd& covariance, const Eigen::MatrixXd&) {
      const auto at = static_cast<std::size_t>(i);
      if (at < from || at >= to) return;
      const double residual = ResidualOf(terms_.frames[at].surface.matches);
      out[at - from] = PosteriorOf(pose.columns(), state_, terms_.frames[at].frame, covariance, prior);
      Add(BodyResponse(terms_, state_, i, deviations.Times(BodyErrorFactor(residual, options_.rules))), out[at - from]);
    });
    return {};
  }

 private:
  /// The rest pose counts once for frames that are coupled, not once per frame (RestShareOfStep).
  void CountRestOnce() {
    for (int j = 1; j < state_.joints(); ++j) {
      const auto at = static_cast<std::size_t>(j);
      double before = kRestAtAnEnd;  // for the step from the frame before
      for (FrameTerms& frame : terms_.frames) {
        double& rest = frame.priors[at].rest;
        const double after =
            frame.next.rotation.empty() ? kRestAtAnEnd : RestShareOfStep(rest, frame.next.rotation[at]);
        rest *= before + after;
        before = after;
      }
    }
  }

  /// The kinematics are up to date.
  void Match() {
    for (std::size_t i = 0; i < clouds_.size(); ++i) {
      FrameTerms& frame = terms_.frames[i];
      frame.surface.matches = MatchPoints(*terms_.body, state_, frame.frame, *clouds_[i], options_.max_distance);
    }
  }

  std::vector<Vector3d> Joints() const {
    std::vector<Vector3d> joints;
    for (const FrameTerms& frame : terms_.frames) {
      for (int j = 0; j < state_.joints(); ++j) joints.push_back(state_.position(frame.frame, j));
    }
    return joints;
  }

  /// Mean movement of the joints in the frame that moved most, m.
  double LargestMove(const std::vector<Vector3d>& before) const {
    const std::vector<Vector3d> after = Joints();
    double most = 0.0;
    for (std::size_t at = 0; at < after.size();) {
      double sum = 0.0;
      for (int j = 0; j < state_.joints(); ++j, ++at) sum += (after[at] - before[at]).norm();
      most = std::max(most, sum / state_.joints());
    }
    return most;
  }

  PoseTerms terms_;
  std::vector<const FusedCloud*> clouds_;  ///< of the terms' frames
  const PointCloudOptions& options_;
  PoseState& state_;
  BlockTridiagonal equations_;
};

}  // namespace

Expected<SmoothedChain> SmoothChain(const CapsuleBody& body, const std::vector<FusedCloud>& clouds,
                                    const std::vector<FrameFit>& chain, const std::vector<double>& time_s,
                                    const PointCloudOptions& options, PoseState& state) {
  SmoothedChain smoothed{std::vector<PosePosterior>(chain.size())};
  for (std::size_t begin = 0; begin < chain.size(); begin += kPart) {
    const std::size_t end = std::min(chain.size(), begin + kPart);
    const std::size_t first = begin - std::min(begin, kContext);
    std::vector<std::vector<double>> stated;  // poses of frames that the part before stated
    for (std::size_t i = first; i < begin; ++i) stated.push_back(state.FrameParameters(chain[i].frame));
    const std::vector<FrameFit> frames(
        chain.begin() + static_cast<std::ptrdiff_t>(first),
        chain.begin() + static_cast<std::ptrdiff_t>(std::min(chain.size(), end + kContext)));
    ChainPart part(body, clouds, frames, time_s, options, state);
    if (Status solved = part.MatchAndSolve(smoothed); !solved) return Forward(solved);
    if (options.uncertainty && !smoothed.undetermined) {
      if (Status added = part.Uncertainty(begin - first, end - first, &smoothed.uncertainty[begin]); !added)
        smoothed.undetermined = added.error();
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
