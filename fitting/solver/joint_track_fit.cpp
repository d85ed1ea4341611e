#include "fitting/solver/joint_track_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/motion/gaps.h"
#include "core/motion/kinematics.h"
#include "core/quality/tracked_points.h"
#include "fitting/contacts/foot_contacts.h"
#include "fitting/evidence/noise.h"
#include "fitting/fit_result.h"
#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/closed_form_start.h"
#include "fitting/solver/solve.h"
#include "fitting/solver/track_problem.h"
#include "fitting/uncertainty/process_noise_scale.h"
#include "fitting/uncertainty/track_uncertainty.h"

namespace mocurate {
namespace {

constexpr double kNearlyExact = 1e-3;  ///< metres, for tracks too short to show their noise
/// m from a sample to its fitted joint; nearer ones agree with the body. Source: 3DPCK, Mehta et al., 3DV 2017
constexpr double kContradictedDistance = 0.15;
/// Chi square of a sample's distance from its fitted joint, beyond four of its own standard deviations. Source:
/// chi-square distribution, three degrees of freedom, 99.9 %
constexpr double kContradictedChiSquare = 16.3;

/// Solves windows one after the other: a window of W frames keeps its first W - overlap, the rest is fitted again.
Status SolveWindows(const TrackProblem& problem, const TrackStep& step, PoseSolver solver, FitResult& result) {
  const JointTrackOptions& options = problem.options;
  const int frames = problem.frames();
  const int length = static_cast<int>(options.window_frames);
  const int stride = std::max(1, length - static_cast<int>(options.window_overlap));
  result.converged = true;
  result.termination = "converged";
  const bool several = frames > length;
  const auto cost_of_all = [&] {  // windows overlap: the sum of their costs would count frames twice
    double cost = 0.0;
    for (int begin = 0; begin < frames; begin += length)
      cost += Cost(problem.Terms(begin, std::min(begin + length, frames), begin > 0), problem.state);
    return cost;
  };
  if (several) result.initial_cost = cost_of_all();
  for (int begin = 0; begin < frames; begin += stride) {
    const int end = frames - begin <= length ? frames : begin + length;
    const auto solution = Solve(problem.Terms(begin, end, begin > 0), problem.state,
                                {solver, step.relative_tolerance, static_cast<int>(step.max_iterations),
                                 "fit of joint tracks", problem.memory});
    if (!solution) return tl::unexpected<Error>(solution.error());
    result.iterations += solution->iterations;
    if (!several) result.initial_cost = solution->initial_cost;
    result.final_cost = solution->final_cost;
    if (!solution->converged) {
      result.converged = false;
      result.termination = (solution->exhausted ? "no step reduces the cost" : "iteration limit") +
                           (" in frames " + std::to_string(begin) + " to " + std::to_string(end - 1)) +
                           " (fitting.joint_tracks.steps: max_iterations)";
    }
    if (end == frames) break;
  }
  if (several) result.final_cost = cost_of_all();
  return {};
}

/// Solves a step of the fit. All but the last use the banded solver, the fastest; a loosely converged solution would
/// differ between the solvers.
Status SolveStep(TrackProblem problem, const std::vector<bool>& active, const TrackStep& step, bool last,
                 FitResult& result) {
  problem.state.Update(0, problem.frames(), false);
  std::vector<bool> free = active;
  if (step.free == FreeParts::kRoot) std::fill(free.begin() + 1, free.end(), false);
  problem.state.SetActive(free);
  if (step.evidence == StepEvidence::kPositions) problem.rotations = nullptr;
  Status solved = SolveWindows(problem, step, last ? problem.options.solver : PoseSolver::kBanded, result);
  problem.state.SetActive(active);
  return solved;
}

/// A tracker's error varies slowly beside its white noise; only the white part may be smoothed. With sigma of all noise
/// and white of the white part, data and process noise are balanced for sqrt(sigma * white): the process noise is
/// multiplied by sqrt(sigma / white), at most threefold.
double ProcessNoiseWidening(const NoiseEstimate& noise) {
  return noise.white > 0.0 ? std::clamp(std::sqrt(noise.sigma / noise.white), 1.0, 3.0) : 1.0;
}

/// States of each joint by GapStates; `contradicted` samples (F*J) do not count as observed. (F*J)
std::vector<JointState> StatesOf(const SkeletonTracks& tracks, const std::vector<bool>& contradicted, double frame_s,
                                 double max_gap_s) {
  std::vector<JointState> states(tracks.confidence.size());
  const auto joints = static_cast<std::size_t>(tracks.joints());
  std::vector<bool> observed(static_cast<std::size_t>(tracks.frames()));
  const std::vector<bool> shown = tracks.ObservedSamples();
  for (int j = 0; j < tracks.joints(); ++j) {
    for (int f = 0; f < tracks.frames(); ++f) {
      const std::size_t at = static_cast<std::size_t>(f) * joints + static_cast<std::size_t>(j);
      observed[static_cast<std::size_t>(f)] = shown[at] && !contradicted[at];
    }
    const std::vector<JointState> of_joint = GapStates(observed, tracks.time_s, frame_s, max_gap_s);
    for (std::size_t f = 0; f < of_joint.size(); ++f) states[f * joints + static_cast<std::size_t>(j)] = of_joint[f];
  }
  return states;
}

/// Residuals of the fit. Where samples have precisions, distances are weighted by them, since rays that hardly cross
/// leave metres open along them. Such samples that are as far off as those of RejectOutliers are rejected too, unless
/// most are: then the fit is wrong.
void MeasureResiduals(const SkeletonTracks& tracks, double sigma, const std::vector<bool>& rejected,
                      FitResult& result) {
  std::vector<double> residuals, used;
  for (int f = 0; f < tracks.frames(); ++f) {
    for (int j = 0; j < tracks.joints(); ++j) {
      if (!tracks.seen(f, j)) continue;
      const Vector3d off = result.motion.joints.at(f, j) - tracks.positions.at(f, j);
      residuals.push_back(tracks.precision.empty() ? off.norm() : std::sqrt(off.dot(tracks.precision_at(f, j) * off)));
      if (tracks.precision.empty() || residuals.back() <= OutlierLimit(sigma)) used.push_back(residuals.back());
    }
  }
  if (residuals.empty()) return;
  result.residual_median = MeanMedian(residuals);
  if (2 * used.size() < residuals.size()) used = residuals;
  double square = 0.0;
  for (const double residual : used) square += residual * residual;
  result.residual_rms = std::sqrt(square / static_cast<double>(used.size()));
  const auto place = used.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(used.size() - 1));
  std::nth_element(used.begin(), place, used.end());
  result.residual_p95 = *place;
  const auto before = static_cast<double>(std::count(rejected.begin(), rejected.end(), true));
  const double all = before + static_cast<double>(residuals.size());
  result.rejected_share = (all - static_cast<double>(used.size())) / all;
}

/// Observed samples that contradict the fitted body (`joints`): farther from their joint than kContradictedDistance and
/// than their own covariance explains (kContradictedChiSquare). `variance` (m^2 per axis) is that of a sample whose
/// precision is the identity. (F*J)
std::vector<bool> FindContradictedSamples(const SkeletonTracks& tracks, const JointPositions& joints, double variance) {
  std::vector<bool> contradicted(tracks.confidence.size(), false);
  for (int f = 0; f < tracks.frames(); ++f) {
    for (int j = 0; j < tracks.joints(); ++j) {
      if (!tracks.seen(f, j)) continue;
      const Vector3d off = joints.at(f, j) - tracks.positions.at(f, j);
      const std::size_t at = static_cast<std::size_t>(f) * tracks.joints() + j;
      contradicted[at] = off.norm() > kContradictedDistance &&
                         off.dot(tracks.precision_at(f, j) * off) > kContradictedChiSquare * variance;
    }
  }
  return contradicted;
}

/// Frames of a joint that are marked in a mask (F*J), in order.
std::vector<int> MarkedFrames(const std::vector<bool>& marked, const SkeletonTracks& tracks, int joint) {
  std::vector<int> frames;
  for (int f = 0; f < tracks.frames(); ++f) {
    if (marked[static_cast<std::size_t>(f) * tracks.joints() + joint]) frames.push_back(f);
  }
  return frames;
}

/// One finding per joint that has samples rejected.
void ReportOutliers(const SkeletonTracks& tracks, const std::vector<bool>& rejected, FitResult& result) {
  for (int j = 0; j < tracks.joints(); ++j) {
    const std::vector<int> frames = MarkedFrames(rejected, tracks, j);
    if (frames.empty()) continue;
    const auto count = static_cast<long long>(frames.size());
    Finding finding =
        FrameFinding(kOutliersRejected, frames.front(), frames.back() + 1, tracks.skeleton->joints[j].name,
                     static_cast<double>(count), Counted(count, "sample") + " rejected: far from neighbouring frames");
    finding.severity = Severity::kInfo;
    finding.action = FindingAction::kMissing;
    result.findings.push_back(std::move(finding));
  }
}

/// One finding per joint that has samples that contradict the body.
void ReportContradictedSamples(const SkeletonTracks& tracks, const std::vector<bool>& contradicted, FitResult& result) {
  for (int j = 0; j < tracks.joints(); ++j) {
    const std::vector<int> frames = MarkedFrames(contradicted, tracks, j);
    if (frames.empty()) continue;
    double farthest = 0.0;
    for (const int f : frames)
      farthest = std::max(farthest, (result.motion.joints.at(f, j) - tracks.positions.at(f, j)).norm());
    const auto count = static_cast<long long>(frames.size());
    Finding finding = FrameFinding(
        kSamplesContradicted, frames.front(), frames.back() + 1, tracks.skeleton->joints[j].name,
        static_cast<double>(count),
        Counted(count, "sample") + " up to " + RoundedText(1e3 * farthest, 3) +
            " mm from the fitted joint (limits: 150 mm and four standard deviations): with constant bone lengths no "
            "pose explains all joints. Which samples are wrong is unknown. The joint counts as not observed there; "
            "look at these frames, or train with the joints' states");
    finding.severity = Severity::kInfo;
    result.findings.push_back(std::move(finding));
  }
}

void ReportAssumedNoise(int frames, double sigma, FitResult& result) {
  result.findings.push_back(MakeFinding(
      "noise_not_measured", Severity::kWarning, 1e3 * sigma,
      Counted(frames, "frame") + " are too few to estimate the noise of the tracks: " + RoundedText(1e3 * sigma, 3) +
          " mm are assumed, which the stated uncertainty is based on"));
}

}  // namespace

Expected<FitResult> FitJointTracks(const SkeletonTracks& given, const FrameRate& rate,
                                   const std::vector<double>& bone_length, const JointTrackOptions& options) {
  FitResult result;
  NoiseEstimate noise = EstimateNoise(given, bone_length);
  if (noise.measured && !options.rules.on(FittingRule::kBoneNoise)) noise.sigma = std::max(noise.white, kNearlyExact);
  result.noise_sigma = noise.sigma;
  // Priors do not use an assumed noise; only the uncertainty does.
  const double sigma = noise.measured ? noise.sigma : kNearlyExact;
  SkeletonTracks tracks = given;
  if (!options.recorded_rotations) {
    tracks.rotation.clear();
    tracks.rotation_confidence.clear();
  }
  std::vector<bool> rejected(tracks.confidence.size(), false);
  if (options.rules.on(FittingRule::kOutlierRejection)) rejected = RejectOutliers(tracks, sigma);
  JointTrackOptions widened = options;
  const double widening = options.rules.on(FittingRule::kProcessNoiseWidening) ? ProcessNoiseWidening(noise) : 1.0;
  widened.priors.rotation_noise *= widening;
  widened.priors.position_noise *= widening;
  const std::vector<bool> active = JointsWithEvidenceBelow(tracks);
  PoseState state(*tracks.skeleton, tracks.frames(), bone_length, active);
  ClosedFormStart(tracks, state);
  result.converged = true;
  result.termination = "closed form";
  std::optional<ProcessNoiseScale> factors;
  std::optional<RotationTargets> rotations;
  TrackProblem whole(tracks, state, sigma, widened);
  BlockTridiagonal memory;
  whole.memory = &memory;
  std::vector<Finding> disagreements;
  for (const TrackStep& step : options.steps) {
    const bool last = &step == &options.steps.back();
    if (!tracks.rotation.empty() && step.evidence == StepEvidence::kAll) {
      // The offsets of recorded frames are estimated from the present pose, more exactly each time.
      state.Update(0, state.frames(), false);
      disagreements.clear();
      rotations = AlignRotations(tracks, state, &disagreements);
      whole.rotations = &*rotations;
    }
    if (Status solved = SolveStep(whole, active, step, last, result); !solved)
      return tl::unexpected<Error>(solved.error());
    if (last) break;
    if (step.refit_process_noise) {
      auto refitted = RefitProcessNoise(whole);
      if (!refitted && refitted.error().code != ErrorCode::kInconsistent) return Forward(refitted);
      if (refitted) factors = std::move(*refitted);  // else a frame is not determined, which the uncertainty says
    }
    if (options.contact_process_noise) {
      if (!factors) factors = ProcessNoiseScale::Ones(tracks.confidence.size());
      state.Update(0, state.frames(), false);
      HoldStandingFeet(MotionOf(state, tracks.skeleton, rate), whole, *factors);
    }
    if (factors) whole.noise_scale = &*factors;
  }
  state.Update(0, state.frames(), false);
  result.findings = std::move(disagreements);
  result.motion = MotionOf(state, tracks.skeleton, rate);
  // From positions and priors alone. The offsets of recorded frames are estimated from the same pose; taking them as
  // known would understate the uncertainty of the mean twist. Without steps there is no uncertainty.
  whole.rotations = nullptr;
  const bool solved = !options.steps.empty() && options.steps.back().free == FreeParts::kPose;
  if (options.uncertainty && solved) {
    const double assumed = noise.sigma / sigma;
    const bool unmeasured = !noise.measured && options.rules.on(FittingRule::kUnmeasuredNoise);
    auto uncertainty = UncertaintyOfTracks(whole, unmeasured ? assumed * assumed : 0.0);
    if (uncertainty) {
      result.motion.position_cov = std::move(uncertainty->position_cov);
      result.motion.rotation_sigma = std::move(uncertainty->rotation_sigma);
      result.motion.rotation_observed = std::move(uncertainty->rotation_observed);
      result.variance_factor = uncertainty->variance_factor;
      result.poses = std::move(uncertainty->poses);
    } else {
      result.findings.push_back(NoUncertainty(uncertainty.error()));
    }
  }
  const std::vector<bool> contradicted =
      FindContradictedSamples(tracks, result.motion.joints, result.variance_factor * sigma * sigma);
  result.motion.state = StatesOf(tracks, contradicted, rate.FrameTime(1), options.max_gap_s);
  MeasureResiduals(tracks, sigma, rejected, result);
  std::vector<bool> unseen = tracks.ObservedFrames();
  unseen.flip();
  ReportFramesWithout(unseen, "no joint is observed", result.findings);
  ReportOutliers(tracks, rejected, result);
  ReportContradictedSamples(tracks, contradicted, result);
  if (!noise.measured) ReportAssumedNoise(given.frames(), noise.sigma, result);
  return result;
}

}  // namespace mocurate
