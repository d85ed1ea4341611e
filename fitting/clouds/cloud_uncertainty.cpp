#include "fitting/clouds/cloud_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "core/base/median.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/geometry/rotation.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/cloud_terms.h"
#include "fitting/solver/one_thread.h"
#include "fitting/solver/rest_sigmas.h"
#include "fitting/terms/huber.h"
#include "fitting/uncertainty/body_response.h"
#include "fitting/uncertainty/calibration.h"

namespace mocurate {

BodyDeviations DeviationsInClouds(const Skeleton& skeleton, double scale, double bones, const Rules& rules) {
  BodyDeviations deviations{std::vector<double>(skeleton.joints.size(), 0.0)};
  if (!rules.on(FittingRule::kBodyErrors)) return deviations;
  if (skeleton.shape == BodyShape{} && rules.on(FittingRule::kUnknownShape)) scale *= kUnknownShape;
  for (int j = 1; j < skeleton.joint_count(); ++j)
    deviations.bone[static_cast<std::size_t>(j)] = bones * scale * SpreadOfBone(skeleton, j);
  deviations.capsule_end = scale * kCapsuleSigma;
  deviations.capsule_radius = scale * kCapsuleSigma / 1.5;
  return deviations;
}

std::vector<Vector3d> PriorInClouds(const Skeleton& skeleton, const PointCloudOptions& options) {
  std::vector<Vector3d> prior;
  for (const double sigma : RestPoseSigmas(skeleton, options.priors.rest))
    prior.emplace_back(Vector3d::Constant(std::min(Square(sigma), kUnknownAngle)));
  prior.front().setConstant(kUnknownAngle);
  return prior;
}

Expected<PosePosterior> UncertaintyOfFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                           double sigma, const BodyDeviations& deviations, PoseState& state,
                                           const PointCloudOptions& options) {
  const OneThread one_thread;
  state.Update(fit.frame, fit.frame + 1, true);
  PoseTerms terms = CloudTerms(body, options);
  terms.frames = {
      TermsOfFit(body, cloud, fit, MatchPoints(body, state, fit.frame, cloud, options.max_distance), sigma, options)};
  PoseEquations pose(state);
  BlockTridiagonal equations(1, pose.columns().size());
  pose.Linearise(terms, state, equations);
  if (Status factored = FactorInformation(equations, pose.columns(), *body.skeleton, fit.frame); !factored)
    return Forward(factored);
  PosePosterior posterior;
  equations.VisitInverse([&](int, const Eigen::MatrixXd& covariance, const Eigen::MatrixXd&) {
    posterior = PosteriorOf(pose.columns(), state, fit.frame, covariance, PriorInClouds(*body.skeleton, options));
  });
  if (!deviations.bone.empty()) {
    const double residual = ResidualOf(terms.frames.front().surface.matches);
    Add(BodyResponse(terms, state, 0, deviations.Times(BodyErrorFactor(residual, options.rules))), posterior);
  }
  return posterior;
}

namespace {

constexpr float kUnknownPlaceVariance = 1.0F;  ///< m^2, of a joint without information (numerical)
constexpr double kLever = 0.25;                ///< m; usual bone of a limb: places that are unsure rotate it

}  // namespace

UncertainMotion::UncertainMotion(int frames, const std::vector<Vector3d>& prior)
    : joints_(static_cast<int>(prior.size())) {
  const auto numbers = static_cast<std::size_t>(frames) * prior.size();
  position_cov_.assign(6 * numbers, 0.0F);
  rotation_observed_.assign(3 * numbers, 0.0F);
  for (std::size_t at = 0; at < numbers; ++at) {
    for (const int i : {0, 3, 5}) position_cov_[6 * at + static_cast<std::size_t>(i)] = kUnknownPlaceVariance;
    for (int i = 0; i < 3; ++i) rotation_sigma_.push_back(static_cast<float>(std::sqrt(prior[at % prior.size()][i])));
  }
}

UncertainMotion::UncertainMotion(const Motion& motion)
    : joints_(motion.joint_count()),
      position_cov_(motion.position_cov),
      rotation_sigma_(motion.rotation_sigma),
      rotation_observed_(motion.rotation_observed) {}

void UncertainMotion::SetPosition(std::size_t at, const Matrix3d& c) { ToSixNumbers(c, position_cov_.data() + 6 * at); }

void UncertainMotion::SetRotation(std::size_t at, const Vector3d& variance, const Vector3d& prior) {
  for (int i = 0; i < 3; ++i) {
    const double stated = std::min(variance[i], prior[i]);
    rotation_sigma_[3 * at + static_cast<std::size_t>(i)] = static_cast<float>(std::sqrt(stated));
    rotation_observed_[3 * at + static_cast<std::size_t>(i)] = static_cast<float>(1.0 - stated / prior[i]);
  }
}

void UncertainMotion::Set(int frame, const PosePosterior& posterior, double more) {
  for (int j = 0; j < joints_; ++j) {
    const auto at = static_cast<std::size_t>(frame) * static_cast<std::size_t>(joints_) + static_cast<std::size_t>(j);
    SetPosition(at, posterior.position[j] + Square(more) * Matrix3d::Identity());
    SetRotation(at, posterior.rotation[j] + Vector3d::Constant(Square(more / kLever)), posterior.prior[j]);
  }
}

void UncertainMotion::Replace(int frame, const PosePosterior& posterior, const std::vector<bool>& moving) {
  for (int j = 0; j < joints_; ++j) {
    const auto at = static_cast<std::size_t>(frame) * static_cast<std::size_t>(joints_) + static_cast<std::size_t>(j);
    SetPosition(at, posterior.position[j]);
    if (moving[j]) SetRotation(at, posterior.rotation[j], posterior.prior[j]);
  }
}

void UncertainMotion::Write(Motion& motion) const {
  motion.position_cov = position_cov_;
  motion.rotation_sigma = rotation_sigma_;
  motion.rotation_observed = rotation_observed_;
}

void SetResiduals(std::vector<double> distances, FitResult& result) {
  if (distances.empty()) return;
  double square = 0.0;
  for (const double distance : distances) square += distance * distance;
  result.residual_rms = std::sqrt(square / static_cast<double>(distances.size()));
  result.noise_sigma = RobustSigma(distances);
  const auto place = distances.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), place, distances.end());
  result.residual_p95 = *place;
}

namespace {

// Errors where one side is seen, and of people who walked away from one camera to four metres: 0.87 to 0.91 came with
// 5 to 29 cm. Source: bench_fit_clouds 24 15 1311 DIR views=1, and views=2
constexpr double kMeanNormalOfTwoSides = 0.6;  ///< length of the mean normal, up to which no error is added
constexpr double kMeanNormalOfOneSide = 0.76;  ///< length of the mean normal of one view from 2.5 m
constexpr double kOneSideError = 0.005;        ///< m; error there
constexpr double kOneSideExponent = 5.0;       ///< exponent of the error beyond kMeanNormalOfTwoSides

// Points of three views of standing people cover 0.9 m^2, of one view 0.55. At 0.12 m^2 (a person half out of the
// views) a leg was fitted to the arm: pelvis and knee were 12 and 35 cm off. Source: fits of these views
constexpr double kEnoughArea = 0.25;  ///< m^2 of visible surface of a body of the rest skeleton's size; below, error
constexpr double kPartArea = 0.12;    ///< m^2 of visible surface of a person half out of the views
constexpr double kPartError = 0.1;    ///< m; error there

// Fits within 10 mm of the ground truth have residuals of 5.5 to 8.8 mm, wrong ones of 9.4 to 17. Source: residuals of
// right and wrong fits
constexpr double kUsualResidual = 0.0075;  ///< m; residual of good fits
constexpr double kPoorResidual = 0.009;    ///< m; residual of a wrong fit, at least
constexpr double kPoorAgainstBest = 1.5;   ///< factor on the first quartile of the clip's residuals, at least

}  // namespace

double CoverageOfPoint(double voxel_size) {
  const double edge = std::max(voxel_size, kCoverageCell);
  return edge * edge;
}

double LowCoverageSigma(const FusedCloud& cloud, const PointCloudOptions& options, double scale) {
  if (cloud.size() == 0 || !options.rules.on(FittingRule::kLowCoverage)) return 0.0;
  const double mean = cloud.normals.rowwise().mean().norm();
  const double beyond = (mean - kMeanNormalOfTwoSides) / (kMeanNormalOfOneSide - kMeanNormalOfTwoSides);
  const double of_side = kOneSideError * std::pow(std::max(0.0, beyond), kOneSideExponent);
  const std::vector<bool> sample = CoverageSample(cloud, options.voxel_size);
  const auto points = static_cast<double>(std::count(sample.begin(), sample.end(), true));
  const double area = points * CoverageOfPoint(options.voxel_size) / (scale * scale);
  const double of_part = kPartError * std::max(0.0, (kEnoughArea - area) / (kEnoughArea - kPartArea));
  return std::hypot(of_side, of_part);
}

void ReportLowCoverage(const std::vector<double>& error, std::vector<Finding>& findings) {
  std::vector<double> large_errors;
  std::copy_if(error.begin(), error.end(), std::back_inserter(large_errors),
               [](double of_frame) { return of_frame > kUnobservedError; });
  if (large_errors.empty()) return;
  findings.push_back(MakeFinding(
      kLowCoverage, Severity::kWarning, static_cast<double>(large_errors.size()),
      "in " + Counted(static_cast<long long>(large_errors.size()), "frame") +
          " the views show only a part of the person, or a side that looks flat: the joint error there may be " +
          std::to_string(std::lround(1e2 * MeanMedian(large_errors))) +
          " cm per axis; inferred; stated standard deviations, where computed, are widened",
      FindingAction::kKept));
}

double ResidualOf(const std::vector<CloudMatch>& matches) {
  double squares = 0.0;
  for (const CloudMatch& match : matches) squares += match.distance * match.distance;
  return std::sqrt(squares / std::max(1.0, static_cast<double>(matches.size())));
}

double BodyErrorFactor(double residual, const Rules& rules) {
  return rules.on(FittingRule::kBodyErrorFactor) ? std::pow(std::max(1.0, residual / kUsualResidual), 2) : 1.0;
}

void ReportPoorlyExplained(const std::vector<double>& residual, std::vector<Finding>& findings) {
  std::vector<double> known;
  std::copy_if(residual.begin(), residual.end(), std::back_inserter(known),
               [](double of_frame) { return of_frame > 0.0; });
  if (known.empty()) return;
  std::sort(known.begin(), known.end());
  const double limit = std::max(kPoorResidual, kPoorAgainstBest * known[known.size() / 4]);
  std::vector<double> poor;
  std::copy_if(known.begin(), known.end(), std::back_inserter(poor), [&](double of_frame) { return of_frame > limit; });
  if (poor.empty()) return;
  findings.push_back(MakeFinding(kPoorlyExplained, Severity::kWarning, static_cast<double>(poor.size()),
                                 "in " + Counted(static_cast<long long>(poor.size()), "frame") + " points lie " +
                                     std::to_string(std::lround(1e3 * MeanMedian(poor))) +
                                     " mm from the body, in the best quarter of the frames " +
                                     std::to_string(std::lround(1e3 * known[known.size() / 4])) +
                                     " mm: check that all views show the same person, and that no object touches them; "
                                     "kept; stated standard deviations, where computed, are widened",
                                 FindingAction::kKept));
}

}  // namespace mocurate
