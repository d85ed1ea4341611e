#include "fitting/clouds/joint_cloud_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/geometry/rotation.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/cloud_terms.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/cloud_uncertainty.h"
#include "fitting/stop_request.h"
#include "fitting/terms/huber.h"
#include "fitting/uncertainty/calibration.h"

namespace mocurate {
namespace {

/// Evenly spaced frames for the estimates of body shape and surface weight (numerical).
constexpr int kShownFrames = 24;
constexpr std::size_t kBodyFrames = 4;  ///< of them, at most, in which the response to the body is computed (numerical)
constexpr double kMinSurfaceWeight = 0.02;  ///< weight of clouds that contradict the tracks, at least
/// Chi square of three degrees of freedom, ninth decile. Source: chi-square distribution
constexpr double kContradictingSquare = 6.25;
constexpr double kMaxExcessShare = 2.0;  ///< factor on the template's usual variance: more is not due to body
                                         ///< shape
constexpr double kClear = 4.0;           ///< factor on a joint's variance from which the modalities disagree

constexpr double kUnsure = 0.012;  ///< m, stated sigma of joints; above, the depth-only pose is tried as a start
/// m, the same for all joints, those without keypoints included: a limb is in no colour image. Source:
/// bench_fit_keypoints_clouds 24 15 4242 (8 to 17 mm with all limbs in an image, 181 to 186 mm without legs)
constexpr double kUnseenLimb = 0.05;

Matrix3d CovarianceAt(const std::vector<float>& values, std::size_t at) {
  return FromSixNumbers(values.data() + 6 * at);
}

/// What the tracks' fit knows of the pose of a frame: rotations of joints that it and `moving` (J) have. Correlations
/// are those of its covariance as solved; standard deviations are those that the motion states, of rotations by axis,
/// of the translation by axis of the world. `factor` (J) on the variance of a joint's place widens the rotations that
/// move it first. Error kInconsistent where the covariance is not positive definite.
Expected<PoseGaussian> PoseOf(const Motion& motion, const PoseCovariances& poses, int frame,
                              const std::vector<double>& factor, const std::vector<bool>& moving) {
  const auto first = static_cast<std::size_t>(frame) * static_cast<std::size_t>(motion.joint_count());
  const Eigen::MatrixXd& solved = poses.frame[static_cast<std::size_t>(frame)];
  PoseGaussian pose;
  pose.translation = motion.root_translation[static_cast<std::size_t>(frame)];
  std::vector<int> columns{0};
  std::vector<double> scale;  // of each unknown: stated over solved standard deviation
  const Matrix3d place = CovarianceAt(motion.position_cov, first);
  for (int i = 0; i < 3; ++i) scale.push_back(std::sqrt(std::max(factor[0], 1.0) * place(i, i) / solved(i, i)));
  for (int j = 0; j < motion.joint_count(); ++j) {
    const int column = poses.column[static_cast<std::size_t>(j)];
    if (column < 0 || !moving[static_cast<std::size_t>(j)]) continue;
    pose.joints.push_back(j);
    pose.rotation.push_back(motion.rotation_at(frame, j).toRotationMatrix());
    pose.rest.push_back(1.0 / Square(poses.rest_sigma[static_cast<std::size_t>(j)]));
    columns.push_back(column);
    double widening = 1.0;
    for (int child = j + 1; child < motion.joint_count(); ++child) {
      if (motion.skeleton->joints[static_cast<std::size_t>(child)].parent == j)
        widening = std::max(widening, factor[static_cast<std::size_t>(child)]);
    }
    for (int i = 0; i < 3; ++i) {
      const double stated =
          motion.rotation_sigma[3 * (first + static_cast<std::size_t>(j)) + static_cast<std::size_t>(i)];
      scale.push_back(stated * std::sqrt(widening / solved(column + i, column + i)));
    }
  }
  const auto size = static_cast<Eigen::Index>(scale.size());
  Eigen::MatrixXd covariance(size, size);
  for (std::size_t a = 0; a < columns.size(); ++a) {
    for (std::size_t b = 0; b < columns.size(); ++b) {
      covariance.block<3, 3>(3 * static_cast<Eigen::Index>(a), 3 * static_cast<Eigen::Index>(b)) =
          solved.block<3, 3>(columns[a], columns[b]);
    }
  }
  const Eigen::Map<const Eigen::VectorXd> scales(scale.data(), size);
  covariance = scales.asDiagonal() * covariance * scales.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> root(covariance);
  if (root.info() != Eigen::Success) {
    return Fail(ErrorCode::kInconsistent, "the fit of the joint tracks does not determine the pose",
                "frame " + std::to_string(frame), "fit one of them alone: fitting.method joint_tracks or point_clouds");
  }
  pose.whitening = root.matrixL().solve(Eigen::MatrixXd::Identity(size, size));
  return pose;
}

/// Variance of each joint of the motion per axis, mean over frames; 1 m^2 for an unknown joint. (J)
std::vector<double> MeanVariance(const Motion& motion, const std::vector<int>& frames, const std::vector<bool>& known) {
  std::vector<double> variance(known.size(), 0.0);
  for (std::size_t j = 0; j < variance.size(); ++j) variance[j] = known[j] ? 0.0 : 1.0;
  for (const int f : frames) {
    for (std::size_t j = 0; j < variance.size(); ++j) {
      if (!known[j]) continue;
      const std::size_t at = static_cast<std::size_t>(f) * variance.size() + j;
      variance[j] += CovarianceAt(motion.position_cov, at).trace() / (3.0 * static_cast<double>(frames.size()));
    }
  }
  return variance;
}

/// Factor on the weight of points such that poses from the clouds alone are as uncertain as they are wrong. Compares
/// two variances: the stated one, and the squared distance of their joints from the tracks' less the tracks' variance.
/// The latter is at least the unexplained body shape (the share `unknown` of its `usual` variance, m^2). With poses of
/// the clouds `alone`, the tracks may be wrong too, and an excess beyond the usual variance is attributed to them.
Expected<double> EstimateSurfaceWeight(const Motion& motion, const std::vector<FusedCloud>& clouds,
                                       const std::vector<int>& frames, const CapsuleBody& body, PoseState state,
                                       const PoseState* alone, const std::vector<bool>& known, double unknown,
                                       double usual, const PointCloudOptions& options) {
  if (!options.rules.on(FittingRule::kSurfaceWeight)) return 1.0;
  const double scale = BodyScale(*motion.skeleton, motion.bone_length);
  std::vector<double> apart, claimed, of_tracks, of_coverage;
  for (const int f : frames) {
    if (Status on = StopIfInterrupted("fit of joints and depth views"); !on) return Forward(on);
    if (alone != nullptr) state.SetFrameParameters(f, alone->FrameParameters(f));
    const FrameFit fit = FitOf(f, options);
    const auto fitted = FitCloudFrame(body, clouds[f], fit, state, options);
    if (!fitted) return Forward(fitted);
    const auto uncertainty = UncertaintyOfFrame(body, clouds[f], fit, fitted->sigma, {}, state, options);
    if (!uncertainty) return Forward(uncertainty);
    for (int j = 0; j < state.joints(); ++j) {
      if (!known[static_cast<std::size_t>(j)]) continue;
      const std::size_t at = static_cast<std::size_t>(f) * state.joints() + static_cast<std::size_t>(j);
      apart.push_back((state.position(f, j) - motion.joints.at(f, j)).squaredNorm());
      claimed.push_back(uncertainty->position[j].trace());
      of_tracks.push_back(CovarianceAt(motion.position_cov, at).trace());
      of_coverage.push_back(3.0 * std::pow(LowCoverageSigma(clouds[f], options, scale), 2));
    }
  }
  if (apart.empty()) return 1.0;
  const double least = unknown * usual;
  double real = std::max({MeanMedian(apart) - MeanMedian(of_tracks), 0.1 * MeanMedian(apart), least});
  if (alone != nullptr) real = std::min(real, kMaxExcessShare * usual + MeanMedian(of_coverage));
  return std::clamp(std::sqrt(MeanMedian(claimed) / real), kMinSurfaceWeight, 1.0);
}

/// Variance per axis that capsules which are not the person's add to the places of the joints (m^2, (J)), mean over
/// some frames of poses of the clouds.
std::vector<double> VarianceOfBody(const std::vector<FusedCloud>& clouds, const std::vector<int>& frames,
                                   const CapsuleBody& body, PoseState state, const PointCloudOptions& options) {
  std::vector<double> variance(static_cast<std::size_t>(state.joints()), 0.0);
  const double scale = BodyScale(*body.skeleton, state.bone_lengths());
  const BodyDeviations deviations = DeviationsInClouds(*body.skeleton, scale, 0.0, options.rules);
  const std::size_t step = (frames.size() + kBodyFrames - 1) / kBodyFrames;
  double count = 0.0;
  for (std::size_t i = 0; i < frames.size(); i += step, count += 1.0) {
    const int f = frames[i];
    state.Update(f, f + 1, true);
    PoseTerms terms = CloudTerms(body, options);
    terms.frames = {TermsOfFit(body, clouds[f], FitOf(f, options),
                               MatchPoints(body, state, f, clouds[f], options.max_distance), kComparedSigma, options)};
    const double residual = ResidualOf(terms.frames.front().surface.matches);
    const BodyResponse response(terms, state, 0, deviations.Times(BodyErrorFactor(residual, options.rules)));
    for (std::size_t j = 0; j < variance.size(); ++j) variance[j] += response.position()[j].trace() / 3.0;
  }
  for (double& of_joint : variance) of_joint /= count;
  return variance;
}

/// Factor on the variance of each joint of tracks that poses of the clouds alone contradict: where the distance exceeds
/// both uncertainties in most frames. (J) at least 1.
std::vector<double> VarianceInflation(const Motion& motion, const std::vector<FusedCloud>& clouds,
                                      const std::vector<int>& frames, const CapsuleBody& body,
                                      const PointCloudOptions& options, PoseState alone) {
  const double scale = BodyScale(*motion.skeleton, motion.bone_length);
  const std::vector<double> of_body = VarianceOfBody(clouds, frames, body, alone, options);
  std::vector<double> factor(static_cast<std::size_t>(motion.joint_count()), 1.0);
  alone.SetActive(body.MovingJoints());
  alone.Update(0, alone.frames(), false);
  for (int j = 0; j < motion.joint_count(); ++j) {
    std::vector<double> squares;
    for (const int f : frames) {
      const std::size_t at = static_cast<std::size_t>(f) * motion.joint_count() + static_cast<std::size_t>(j);
      const double of_coverage_sigma = LowCoverageSigma(clouds[static_cast<std::size_t>(f)], options, scale);
      const Matrix3d both = CovarianceAt(motion.position_cov, at) +
                            (of_body[static_cast<std::size_t>(j)] + Square(of_coverage_sigma)) * Matrix3d::Identity();
      const Vector3d apart = alone.position(f, j) - motion.joints.at(f, j);
      squares.push_back(apart.dot(both.ldlt().solve(apart)));
    }
    factor[static_cast<std::size_t>(j)] = std::max(1.0, MeanMedian(squares) / kContradictingSquare);
  }
  return factor;
}

/// Poses of the clouds alone, tracked from the tracks' heading. None where the tracks are certain, or where tracking
/// fails; error kInterrupted.
Expected<std::optional<PoseState>> SecondStart(const Motion& motion, const std::vector<FusedCloud>& clouds,
                                               const std::vector<int>& shown, PointCloudOptions options) {
  const bool unsure = StatedSigma(motion, shown, false) > kUnsure || StatedSigma(motion, shown, true) > kUnseenLimb;
  if (!unsure || !options.rules.on(FittingRule::kSecondStart)) return std::optional<PoseState>();
  if (!options.start.facing) {
    const Vector3d front = motion.rotation_at(shown.front(), 0) * Vector3d::UnitZ();
    options.start.facing = std::atan2(front.x(), front.z());
  }
  std::vector<double> time_s;
  for (int f = 0; f < motion.frame_count(); ++f) time_s.push_back(motion.rate.FrameTime(f));
  Expected<CloudTrack> track = TrackClouds(clouds, motion.skeleton, motion.bone_length, time_s, options);
  if (!track && track.error().code == ErrorCode::kInterrupted) return Forward(track);
  if (!track) return std::optional<PoseState>();
  return std::optional<PoseState>(std::move(track->state));
}

/// Fits from the pose in the state, and from `alone` if given; keeps the cheaper result.
Expected<CapsuleFitOutcome> FitFromBoth(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                        PoseState& state, const PoseState* alone, const PointCloudOptions& options) {
  auto first = FitCloudFrame(body, cloud, fit, state, options);
  if (!first || alone == nullptr) return first;
  FrameFit compared = fit;
  compared.sigma = first->sigma;
  const double cost = PoseCost(body, cloud, compared, state, options);
  const std::vector<double> pose = state.FrameParameters(fit.frame);
  state.SetFrameParameters(fit.frame, alone->FrameParameters(fit.frame));
  auto second = FitCloudFrame(body, cloud, compared, state, options);
  if (!second) return second;
  second->iterations += first->iterations;
  if (PoseCost(body, cloud, compared, state, options) < cost) return second;
  state.SetFrameParameters(fit.frame, pose);
  state.Update(fit.frame, fit.frame + 1, false);
  return first;
}

Status CheckBothShowOne(const Motion& motion, const std::vector<FusedCloud>& clouds, const std::vector<int>& frames,
                        const CapsuleBody& body, const PoseState& state, const PointCloudOptions& options) {
  double near = 0.0, all = 0.0;
  for (const int f : frames) {
    near += static_cast<double>(MatchPoints(body, state, f, clouds[f], options.max_distance).size());
    all += clouds[f].size();
  }
  if (near >= kNearBodyShare * all) return {};
  return Fail(ErrorCode::kInconsistent,
              "only " + std::to_string(std::lround(100.0 * near / all)) +
                  " % of the depth points lie near the body of the joint tracks",
              motion.skeleton->name,
              "check that tracks and depth views are of one person, one clock and one world frame");
}

Status CheckTracks(const Motion& motion, const PoseCovariances& poses, const std::vector<FusedCloud>& clouds) {
  if (static_cast<int>(clouds.size()) != motion.frame_count()) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(clouds.size()) + " frames of depth images, " + std::to_string(motion.frame_count()) +
                    " of joint tracks",
                "evidence", "fit one of them alone: fitting.method joint_tracks or point_clouds");
  }
  if (motion.position_cov.empty()) {
    return Fail(ErrorCode::kInconsistent, "the fit of the joint tracks has no uncertainty", "evidence",
                "set fitting.joint_tracks.uncertainty to true, and let the last of its steps free the pose");
  }
  if (poses.empty())
    return Fail(ErrorCode::kInternal, "the fit of the joint tracks has no pose covariances", "evidence");
  return {};
}

/// Reports joints for which the modalities disagree although both are certain.
void ReportDisagreement(const std::vector<double>& factor, FitResult& result) {
  const auto clear = std::count_if(factor.begin(), factor.end(), [](double f) { return f > kClear; });
  if (3 * clear < static_cast<std::ptrdiff_t>(factor.size())) return;
  result.findings.push_back(
      MakeFinding("modalities_disagree", Severity::kWarning, static_cast<double>(clear),
                  std::to_string(clear) + " of " + std::to_string(factor.size()) +
                      " joints lie elsewhere in the depth views than in the other evidence, by more than both "
                      "uncertainties explain; the fit follows the depth views there",
                  FindingAction::kKept));
}

void ReportEmptyClouds(const std::vector<FusedCloud>& clouds, FitResult& result) {
  const auto without =
      std::count_if(clouds.begin(), clouds.end(), [](const FusedCloud& cloud) { return cloud.size() < kFewestPoints; });
  if (without == 0) return;
  result.findings.push_back(MakeFinding("frames_without_depth", Severity::kInfo, static_cast<double>(without),
                                        "too few depth points in " + std::to_string(without) + " of " +
                                            Counted(static_cast<long long>(clouds.size()), "frame") +
                                            "; these frames are fitted to the other evidence alone",
                                        FindingAction::kKept));
}

}  // namespace

double StatedSigma(const Motion& motion, const std::vector<int>& frames, bool all) {
  double sum = 0.0;
  double count = 0.0;
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  for (const int f : frames) {
    for (std::size_t j = 0; j < joints; ++j) {
      const std::size_t at = static_cast<std::size_t>(f) * joints + j;
      if (!all && motion.state[at] == JointState::kInferred) continue;
      const float* c = motion.position_cov.data() + 6 * at;
      sum += (static_cast<double>(c[0]) + c[3] + c[5]) / 3.0;
      count += 1.0;
    }
  }
  return std::sqrt(sum / std::max(count, 1.0));
}

std::vector<bool> KnownJoints(const Motion& motion) {
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  std::vector<bool> known(joints, motion.state.empty());
  for (std::size_t at = 0; at < motion.state.size(); ++at) {
    if (motion.state[at] != JointState::kInferred) known[at % joints] = true;
  }
  for (std::size_t j = joints - 1; j > 0; --j) {
    if (known[j]) known[static_cast<std::size_t>(motion.skeleton->joints[j].parent)] = true;
  }
  return known;
}

std::vector<int> ShownFrames(const std::vector<FusedCloud>& clouds) {
  std::vector<int> with_points;
  for (std::size_t f = 0; f < clouds.size(); ++f) {
    if (clouds[f].size() >= kFewestPoints) with_points.push_back(static_cast<int>(f));
  }
  const auto available = static_cast<int>(with_points.size());
  const int count = std::min(available, kShownFrames);
  std::vector<int> shown;
  for (int i = 0; i < count; ++i) shown.push_back(with_points[static_cast<std::size_t>(i * available / count)]);
  return shown;
}

PoseState StateOf(const Motion& motion, const CapsuleBody& body) {
  const std::vector<bool> all(static_cast<std::size_t>(motion.joint_count()), true);
  PoseState state(*motion.skeleton, motion.frame_count(), motion.bone_length, all);
  for (int f = 0; f < motion.frame_count(); ++f) {
    Eigen::Map<Vector3d>(state.translation(f)) = motion.root_translation[static_cast<std::size_t>(f)];
    for (int j = 0; j < motion.joint_count(); ++j) {
      Eigen::Map<Vector3d>(state.rotation(f, j)) = LogQuaternion(motion.rotation_at(f, j));
    }
  }
  state.Update(0, motion.frame_count(), false);
  state.SetActive(body.MovingJoints());
  return state;
}

Status CheckOneClock(const std::vector<double>& track_s, const std::vector<double>& depth_s, double step_s,
                     const std::string& clip) {
  double furthest = 0.0;
  std::size_t frame = 0;
  for (std::size_t f = 0; f < std::min(track_s.size(), depth_s.size()); ++f) {
    const double apart = std::abs(track_s[f] - depth_s[f]);
    if (apart <= furthest) continue;
    furthest = apart;
    frame = f;
  }
  if (furthest <= 0.5 * step_s) return {};
  return Fail(ErrorCode::kInconsistent,
              "depth images and joint tracks are up to " + RoundedText(1e3 * furthest, 3) + " ms apart (frame " +
                  std::to_string(frame) + "), half a step is " + RoundedText(500.0 * step_s, 3) + " ms",
              clip, "give both with one clock, or fit one of them alone: fitting.method joint_tracks or point_clouds");
}

Expected<FitResult> FitTracksAndClouds(FitResult tracks, const std::vector<FusedCloud>& clouds,
                                       const PointCloudOptions& options) {
  const PoseCovariances poses = std::exchange(tracks.poses, {});
  const Motion& motion = tracks.motion;
  if (Status can = CheckTracks(motion, poses, clouds); !can) return Forward(can);
  CapsuleBody body = CapsuleBody::Make(motion.skeleton, BodyScale(*motion.skeleton, motion.bone_length));
  PoseState state = StateOf(motion, body);
  const std::vector<int> shown = ShownFrames(clouds);
  if (shown.empty()) {
    return Fail(ErrorCode::kInconsistent, "no frame has " + std::to_string(kFewestPoints) + " points of the person",
                "depth views", "check depth_unit, cameras and masks, or set fitting.method to joint_tracks");
  }
  if (Status one = CheckBothShowOne(motion, clouds, shown, body, state, options); !one) return Forward(one);
  const Expected<std::optional<PoseState>> second = SecondStart(motion, clouds, shown, options);
  if (!second) return Forward(second);
  const PoseState* alone = *second ? &**second : nullptr;
  const std::vector<bool> known = KnownJoints(motion);
  const double unknown =
      FitCapsuleOffsets(clouds, state, shown, options.max_distance, MeanVariance(motion, shown, known), body);
  const double usual =
      3.0 * MeanMedian(VarianceOfBody(clouds, shown, body, alone != nullptr ? *alone : state, options));
  const auto surface_weight =
      EstimateSurfaceWeight(motion, clouds, shown, body, state, alone, known, unknown, usual, options);
  if (!surface_weight) return Forward(surface_weight);

  const std::vector<bool> moving = body.MovingJoints();
  std::vector<double> factor(known.size(), 1.0);
  if (alone != nullptr && options.rules.on(FittingRule::kVarianceInflation))
    factor = VarianceInflation(motion, clouds, shown, body, options, *alone);
  for (std::size_t j = 0; j < known.size(); ++j) factor[j] = known[j] ? factor[j] : 0.0;
  FitResult result = tracks;
  result.initial_cost = result.final_cost = 0.0;  // of the frames, each with what the tracks know
  ReportDisagreement(factor, result);
  UncertainMotion uncertain(motion);
  const BodyDeviations deviations = DeviationsInClouds(
      *motion.skeleton, BodyScale(*motion.skeleton, motion.bone_length), kMeasuredBones, options.rules);
  std::vector<double> residuals;
  int unsettled = 0;
  for (int f = 0; f < motion.frame_count(); ++f) {
    if (clouds[f].size() < kFewestPoints) continue;
    if (Status on = StopIfInterrupted("fit of joints and depth views"); !on) return Forward(on);
    const Expected<PoseGaussian> pose = PoseOf(motion, poses, f, factor, moving);
    if (!pose) return Forward(pose);
    FrameFit fit = FitOf(f, options);
    fit.pose = &*pose;
    fit.point_weight = *surface_weight;
    fit.solver = options.solver;
    const auto fitted = FitFromBoth(body, clouds[f], fit, state, alone, options);
    if (!fitted) return Forward(fitted);
    const auto posterior = UncertaintyOfFrame(body, clouds[f], fit, fitted->sigma, deviations, state, options);
    if (!posterior) return Forward(posterior);
    uncertain.Replace(f, *posterior, moving);
    for (const CloudMatch& match : MatchPoints(body, state, f, clouds[f], options.max_distance)) {
      residuals.push_back(std::abs(match.distance));
    }
    result.iterations += fitted->iterations;
    result.initial_cost += fitted->initial_cost;
    result.final_cost += fitted->final_cost;
    if (!fitted->converged) ++unsettled;
  }
  if (unsettled > 0) {
    result.converged = false;
    result.termination =
        "iteration limit in " + std::to_string(unsettled) + " of " + std::to_string(clouds.size()) + " frames";
  }
  ReportEmptyClouds(clouds, result);
  result.motion = MotionOf(state, motion.skeleton, motion.rate);
  result.motion.state = motion.state;
  uncertain.Write(result.motion);
  SetResiduals(std::move(residuals), result);
  result.capsule_radii = RadiiText(body);
  result.surface_weight = *surface_weight;
  return result;
}

}  // namespace mocurate
