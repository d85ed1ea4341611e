#include "fitting/clouds/frame_finding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include "core/base/median.h"
#include "core/base/text.h"

namespace mocurate {
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
/// m; edge of the voxels that these areas and kObservingArea were measured with (numerical).
constexpr double kCoverageCell = 0.03;

// Fits within 10 mm of the ground truth have residuals of 5.5 to 8.8 mm, wrong ones of 9.4 to 17. Source: residuals of
// right and wrong fits
constexpr double kUsualResidual = 0.0075;  ///< m; residual of good fits
constexpr double kPoorResidual = 0.009;    ///< m; residual of a wrong fit, at least
constexpr double kPoorAgainstBest = 1.5;   ///< factor on the first quartile of the clip's residuals, at least

}  // namespace

std::vector<bool> CoverageSample(const FusedCloud& cloud, double voxel_size) {
  std::vector<bool> sample(static_cast<std::size_t>(cloud.size()), true);
  if (voxel_size >= kCoverageCell || cloud.size() == 0) return sample;
  const Vector3d origin = cloud.points.rowwise().minCoeff() - Vector3d::Constant(0.5 * kCoverageCell);
  std::set<std::array<int, 3>> occupied;
  for (int i = 0; i < cloud.size(); ++i) {
    const Vector3d cell = (cloud.points.col(i) - origin) / kCoverageCell;
    sample[static_cast<std::size_t>(i)] =
        occupied.insert({static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())}).second;
  }
  return sample;
}

double CoverageOfPoint(double voxel_size) {
  const double edge = std::max(voxel_size, kCoverageCell);
  return edge * edge;
}

double LowCoverageSigma(const FusedCloud& cloud, double voxel_size, double scale) {
  if (cloud.size() == 0) return 0.0;
  const double mean = cloud.normals.rowwise().mean().norm();
  const double beyond = (mean - kMeanNormalOfTwoSides) / (kMeanNormalOfOneSide - kMeanNormalOfTwoSides);
  const double of_side = kOneSideError * std::pow(std::max(0.0, beyond), kOneSideExponent);
  const std::vector<bool> sample = CoverageSample(cloud, voxel_size);
  const auto points = static_cast<double>(std::count(sample.begin(), sample.end(), true));
  const double area = points * CoverageOfPoint(voxel_size) / (scale * scale);
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
