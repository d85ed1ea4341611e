#include "eval/metrics/sigma_quality.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/motion/limbs.h"

namespace mocurate {
namespace {

/// Twice the ranks from 1 on, so that mean ranks of equal values are whole numbers.
std::vector<std::int64_t> DoubledRanks(const std::vector<SigmaAndError>& samples, float SigmaAndError::*value) {
  std::vector<std::size_t> order(samples.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return samples[a].*value < samples[b].*value; });
  std::vector<std::int64_t> ranks(samples.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && samples[order[end]].*value == samples[order[begin]].*value) ++end;
    for (std::size_t i = begin; i < end; ++i) ranks[order[i]] = static_cast<std::int64_t>(begin + end + 1);
  }
  return ranks;
}

/// Sums of the errors of the first 1, 2, ... samples, which are in order of sigma; of equal sigma all count as their
/// mean.
std::vector<double> KeptSums(const std::vector<SigmaAndError>& sorted) {
  std::vector<double> sums;
  double sum = 0.0;
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    double of_equal = 0.0;
    for (; end < sorted.size() && sorted[end].sigma == sorted[begin].sigma; ++end)
      of_equal += static_cast<double>(sorted[end].error);
    for (std::size_t k = begin; k < end; ++k)
      sums.push_back(sum + of_equal * static_cast<double>(k + 1 - begin) / static_cast<double>(end - begin));
    sum += of_equal;
  }
  return sums;
}

std::optional<double> Share(std::int64_t count, std::int64_t of) {
  if (of == 0) return std::nullopt;
  return static_cast<double>(count) / static_cast<double>(of);
}

}  // namespace

void Calibration::Add(double standardised) {
  const double size = std::abs(standardised);
  ++components;
  for (std::size_t i = 0; i < within_quarters.size(); ++i)
    within_quarters[i] += size < 0.25 * static_cast<double>(i + 1) ? 1 : 0;
  const double probability = std::erf(size / std::sqrt(2.0));  // of a smaller one
  for (std::size_t i = 0; i < kLevels.size(); ++i) within_levels[i] += probability < kLevels[i] ? 1 : 0;
}

void Calibration::Append(const Calibration& other) {
  components += other.components;
  for (std::size_t i = 0; i < within_quarters.size(); ++i) within_quarters[i] += other.within_quarters[i];
  for (std::size_t i = 0; i < within_levels.size(); ++i) within_levels[i] += other.within_levels[i];
}

std::optional<double> Calibration::within_one_sigma() const { return Share(within_quarters[3], components); }
std::optional<double> Calibration::within_two_sigma() const { return Share(within_quarters[7], components); }

std::optional<double> Calibration::ece() const {
  if (components == 0) return std::nullopt;
  double sum = 0.0;
  for (std::size_t i = 0; i < kLevels.size(); ++i) sum += std::abs(*Share(within_levels[i], components) - kLevels[i]);
  return sum / static_cast<double>(kLevels.size());
}

void SigmaSamples::AddPosition(const Vector3d& error, const Matrix3d& covariance) {
  const Eigen::LLT<Matrix3d> root(covariance);
  if (root.info() != Eigen::Success) return;
  const Vector3d white = root.matrixL().solve(error);
  for (int i = 0; i < 3; ++i) calibration.Add(white[i]);
  pairs.push_back(
      {static_cast<float>(1e3 * std::sqrt(covariance.trace() / 3.0)), static_cast<float>(1e3 * error.norm())});
}

void SigmaSamples::AddAxis(double error, double sigma) {
  if (!(sigma > 0.0)) return;
  calibration.Add(error / sigma);
  pairs.push_back({static_cast<float>(sigma), static_cast<float>(std::abs(error))});
}

void SigmaSamples::Append(const SigmaSamples& other) {
  calibration.Append(other.calibration);
  pairs.insert(pairs.end(), other.pairs.begin(), other.pairs.end());
}

std::optional<double> SpearmanOf(const std::vector<SigmaAndError>& samples) {
  const auto of_sigma = DoubledRanks(samples, &SigmaAndError::sigma);
  const auto of_error = DoubledRanks(samples, &SigmaAndError::error);
  const auto mean = static_cast<std::int64_t>(samples.size() + 1);
  double both = 0.0, sigma = 0.0, error = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto a = static_cast<double>(of_sigma[i] - mean), b = static_cast<double>(of_error[i] - mean);
    both += a * b;
    sigma += a * a;
    error += b * b;
  }
  if (sigma == 0.0 || error == 0.0) return std::nullopt;
  return both / std::sqrt(sigma * error);
}

std::optional<double> RocAucOf(const std::vector<SigmaAndError>& samples, double large) {
  const auto ranks = DoubledRanks(samples, &SigmaAndError::sigma);
  std::int64_t sum = 0, positives = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!(static_cast<double>(samples[i].error) > large)) continue;
    sum += ranks[i];
    ++positives;
  }
  const std::int64_t negatives = static_cast<std::int64_t>(samples.size()) - positives;
  if (positives < kFewestOfClass || negatives < kFewestOfClass) return std::nullopt;
  const std::int64_t pairs_won_twice = sum - positives * (positives + 1);  // Mann and Whitney's U
  return static_cast<double>(pairs_won_twice) / (2.0 * static_cast<double>(positives) * static_cast<double>(negatives));
}

std::optional<RiskCoverage> RiskCoverageOf(std::vector<SigmaAndError> samples) {
  if (samples.empty()) return std::nullopt;
  std::sort(samples.begin(), samples.end(), [](const SigmaAndError& a, const SigmaAndError& b) {
    return std::pair(a.sigma, a.error) < std::pair(b.sigma, b.error);
  });
  const std::vector<double> sums = KeptSums(samples);
  RiskCoverage curve;
  for (std::size_t k = 0; k < sums.size(); ++k) curve.area += sums[k] / static_cast<double>(k + 1);
  curve.area /= static_cast<double>(sums.size());
  for (std::size_t i = 0; i < curve.risk.size(); ++i) {
    const std::size_t kept = ((i + 1) * sums.size() + curve.risk.size() - 1) / curve.risk.size();  // rounded up
    curve.risk[i] = sums[kept - 1] / static_cast<double>(kept);
  }
  return curve;
}

std::optional<RiskCoverage> IdealRiskCoverageOf(std::vector<SigmaAndError> samples) {
  for (SigmaAndError& sample : samples) sample.sigma = sample.error;
  return RiskCoverageOf(std::move(samples));
}

std::vector<BodyPart> BodyPartsOf(const Skeleton& skeleton) {
  const Limbs limbs = LimbsOf(skeleton);
  const auto joints = static_cast<std::size_t>(skeleton.joint_count());
  const auto before = [&](const Limb& limb) {  // joints from the root of the tree to the limb's
    std::vector<bool> passed(joints, false);
    for (int joint = limb.root; joint >= 0; joint = skeleton.joints[static_cast<std::size_t>(joint)].parent)
      passed[static_cast<std::size_t>(joint)] = true;
    return passed;
  };
  const std::array<std::vector<bool>, 4> paths = {before(limbs.arm[0]), before(limbs.arm[1]), before(limbs.leg[0]),
                                                  before(limbs.leg[1])};
  std::size_t fork = joints;  // the arms' lowest common ancestor; parents precede children
  for (std::size_t j = 0; j < joints; ++j) {
    if (paths[0][j] && paths[1][j]) fork = j;
  }
  std::vector<BodyPart> parts(joints, BodyPart::kTrunk);
  for (std::size_t j = 1; j < joints; ++j) {
    const auto parent = static_cast<std::size_t>(skeleton.joints[j].parent);
    const bool on_path = std::any_of(paths.begin(), paths.end(), [j](const auto& path) { return path[j]; });
    parts[j] = parts[parent];
    if (parent == fork && !on_path) parts[j] = BodyPart::kHead;
    for (std::size_t side = 0; side < 2; ++side) {
      if (static_cast<int>(j) == limbs.arm[side].root) parts[j] = BodyPart::kArms;
      if (static_cast<int>(j) == limbs.leg[side].root) parts[j] = BodyPart::kLegs;
    }
  }
  return parts;
}

void FitSamples::Append(const FitSamples& other) {
  positions.Append(other.positions);
  rotations.Append(other.rotations);
}

void SigmaByPart::Append(const SigmaByPart& other) {
  for (std::size_t part = 0; part < kBodyParts; ++part) {
    for (std::size_t observed = 0; observed < 2; ++observed)
      cells_[part][observed].Append(other.cells_[part][observed]);
  }
}

FitSamples SigmaByPart::Group(std::size_t group) const {
  FitSamples samples;
  for (std::size_t part = 0; part < kBodyParts; ++part) {
    if (group >= 1 && group <= kBodyParts && part != group - 1) continue;
    samples.Append(cells_[part][0]);
    if (group <= kBodyParts) samples.Append(cells_[part][1]);
  }
  return samples;
}

}  // namespace mocurate
