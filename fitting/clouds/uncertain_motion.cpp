#include "fitting/clouds/uncertain_motion.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/geometry/symmetric.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/evidence/noise.h"

namespace mocurate {
namespace {

constexpr float kUnknownPlaceVariance = 1.0F;  ///< m^2, of a joint of which nothing is known
const float kUnknownAngleSigma = static_cast<float>(kPi / std::sqrt(3.0));  ///< rad
/// Without it ankles of 4 studio clips were 18 mm off per axis and 14.6 stated, feet 61 and 48 (bench_fit_clouds 4 30
/// 907 DIR hidden=7, 10).
constexpr double kUnseenFactor = 1.3;
/// Errors of `bench_fit_clouds 24 15 1311 DIR views=1` and 2, and of people who walked away from one camera to four
/// metres, where 0.87 to 0.91 came with 5 to 29 cm.
constexpr double kMeanNormalOfTwoSides = 0.6;  ///< length of the mean normal, no more is told
constexpr double kMeanNormalOfOneSide = 0.76;  ///< of one view from 2.5 m
constexpr double kOneSideError = 0.005;        ///< m, there
constexpr double kOneSideExponent = 5.0;
/// Points of three views of people who stand cover 0.9 m^2, of one 0.55. Of 0.12 m^2, of somebody who ran half out of
/// the views, a leg was fitted to the arm: pelvis and knee 12 and 35 cm off.
constexpr double kEnoughArea = 0.25;  ///< m^2, of a body of the rest skeleton's size
constexpr double kPartArea = 0.12;    ///< m^2
constexpr double kPartError = 0.1;    ///< m, there
/// Fits within 10 mm of the truth have residuals of 5.5 to 8.8 mm, wrong ones of 9.4 to 17.
constexpr double kUsualResidual = 0.0075;  ///< m
constexpr double kPoorResidual = 0.009;    ///< m, at least
constexpr double kPoorAgainstBest = 1.5;   ///< times the first quartile of the clip

}  // namespace

UncertainMotion::UncertainMotion(int frames, int joints) : joints_(joints) {
  const auto numbers = static_cast<std::size_t>(frames) * static_cast<std::size_t>(joints);
  position_cov_.assign(6 * numbers, 0.0F);
  for (std::size_t at = 0; at < numbers; ++at) {
    for (const int i : {0, 3, 5}) position_cov_[6 * at + static_cast<std::size_t>(i)] = kUnknownPlaceVariance;
  }
  rotation_sigma_.assign(3 * numbers, kUnknownAngleSigma);
  rotation_observed_.assign(3 * numbers, 0.0F);
}

UncertainMotion::UncertainMotion(const Motion& motion)
    : joints_(motion.joint_count()),
      position_cov_(motion.position_cov),
      rotation_sigma_(motion.rotation_sigma),
      rotation_observed_(motion.rotation_observed) {}

void UncertainMotion::SetPosition(std::size_t at, const Matrix3d& c) { ToSixNumbers(c, position_cov_.data() + 6 * at); }

void UncertainMotion::SetRotation(std::size_t at, const Vector3d& variance, const Vector3d& observed) {
  for (int i = 0; i < 3; ++i) {
    rotation_sigma_[3 * at + static_cast<std::size_t>(i)] = static_cast<float>(std::sqrt(variance[i]));
    rotation_observed_[3 * at + static_cast<std::size_t>(i)] = static_cast<float>(observed[i]);
  }
}

void UncertainMotion::Set(int frame, const CloudUncertainty& uncertainty, const std::vector<double>& body_error,
                          const std::vector<Vector3d>& body_turn) {
  for (int j = 0; j < joints_; ++j) {
    const auto at = static_cast<std::size_t>(frame) * static_cast<std::size_t>(joints_) + static_cast<std::size_t>(j);
    SetPosition(at, uncertainty.position[j] + body_error[j] * body_error[j] * Matrix3d::Identity());
    const Vector3d variance = (uncertainty.rotation[j] + body_turn[j]).cwiseMin(uncertainty.prior[j]);
    SetRotation(at, variance, (1.0 - variance.array() / uncertainty.prior[j]).cwiseMax(0.0));
  }
}

void UncertainMotion::Replace(int frame, const CloudUncertainty& uncertainty, const std::vector<bool>& turned,
                              const std::vector<Vector3d>& body_turn) {
  for (int j = 0; j < joints_; ++j) {
    const auto at = static_cast<std::size_t>(frame) * static_cast<std::size_t>(joints_) + static_cast<std::size_t>(j);
    SetPosition(at, uncertainty.position[j]);
    if (turned[j]) SetRotation(at, uncertainty.rotation[j] + body_turn[j], uncertainty.observed[j]);
  }
}

void UncertainMotion::Write(Motion& motion) const {
  motion.position_cov = position_cov_;
  motion.rotation_sigma = rotation_sigma_;
  motion.rotation_observed = rotation_observed_;
}

void WidenUnseen(const std::vector<bool>& seen, CloudUncertainty& uncertainty, std::vector<double>& body_error) {
  for (std::size_t j = 0; j < seen.size(); ++j) {
    if (seen[j]) continue;
    uncertainty.position[j] *= kUnseenFactor * kUnseenFactor;
    body_error[j] *= kUnseenFactor;
  }
}

double ErrorOfLittleSeen(const FusedCloud& cloud, double voxel_size, double scale) {
  if (cloud.size() == 0) return 0.0;
  const double mean = cloud.normals.rowwise().mean().norm();
  const double beyond = (mean - kMeanNormalOfTwoSides) / (kMeanNormalOfOneSide - kMeanNormalOfTwoSides);
  const double of_side = kOneSideError * std::pow(std::max(0.0, beyond), kOneSideExponent);
  const double area = cloud.size() * std::pow(voxel_size / scale, 2);
  const double of_part = kPartError * std::max(0.0, (kEnoughArea - area) / (kEnoughArea - kPartArea));
  return std::hypot(of_side, of_part);
}

void ReportLittleSeen(const std::vector<double>& error, std::vector<Finding>& findings) {
  std::vector<double> guesses;
  std::copy_if(error.begin(), error.end(), std::back_inserter(guesses),
               [](double of_frame) { return of_frame > kGuessedError; });
  if (guesses.empty()) return;
  Finding finding;
  finding.code = kLittleSeen;
  finding.value = static_cast<double>(guesses.size());
  finding.message =
      "in " + Counted(static_cast<long long>(guesses.size()), "frame") +
      " the views show a part of the person, or one side as flat as from afar: joints there may be off by " +
      std::to_string(std::lround(1e2 * Median(guesses))) + " cm an axis";
  finding.action = "inferred; stated deviations, where they are computed, widened";
  findings.push_back(std::move(finding));
}

double BodyErrorFactor(double residual) { return std::pow(std::max(1.0, residual / kUsualResidual), 2); }

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
  Finding finding;
  finding.code = kPoorlyExplained;
  finding.value = static_cast<double>(poor.size());
  finding.message = "in " + Counted(static_cast<long long>(poor.size()), "frame") + " points lie " +
                    std::to_string(std::lround(1e3 * Median(poor))) + " mm off the body, in the best quarter " +
                    std::to_string(std::lround(1e3 * known[known.size() / 4])) +
                    ": is it the same person, do all views show them, and does nothing else touch them?";
  finding.action = "kept; stated deviations, where they are computed, widened";
  findings.push_back(std::move(finding));
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

}  // namespace mocurate
