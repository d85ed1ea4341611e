// Measures of stated uncertainty: values that follow from the samples, and properties.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "eval/metrics/sigma_quality.h"

namespace mocurate {
namespace {

Vector3d Normal3(Random& random) { return Vector3d(random.Normal(), random.Normal(), random.Normal()); }

/// Positions with errors of covariances from 1 to 9 cm^2, which the fit states times `stated`^2.
SigmaSamples Positions(int count, double stated) {
  Random random(3, "positions");
  SigmaSamples samples;
  for (int i = 0; i < count; ++i) {
    Matrix3d root = Matrix3d::Zero();
    root.diagonal() = Vector3d(random.Uniform(0.01, 0.03), random.Uniform(0.01, 0.03), random.Uniform(0.01, 0.03));
    root(1, 0) = random.Uniform(-0.01, 0.01);
    root(2, 1) = random.Uniform(-0.01, 0.01);
    samples.AddPosition(root * Normal3(random), stated * stated * root * root.transpose());
  }
  return samples;
}

/// Errors whose sizes have nothing to do with the stated deviations.
std::vector<SigmaAndError> Unrelated(int count) {
  Random random(4, "unrelated");
  std::vector<SigmaAndError> samples;
  for (int i = 0; i < count; ++i) {
    samples.push_back({static_cast<float>(random.Uniform(1.0, 2.0)), static_cast<float>(random.Uniform(0.0, 100.0))});
  }
  return samples;
}

TEST(SigmaQuality, ErrorsOfTheStatedCovarianceAreCalibrated) {
  const SigmaSamples samples = Positions(20000, 1.0);
  EXPECT_EQ(samples.calibration.components, 60000);
  EXPECT_NEAR(*samples.calibration.within_one_sigma(), 0.6827, 0.006);
  EXPECT_NEAR(*samples.calibration.within_two_sigma(), 0.9545, 0.003);
  EXPECT_LT(*samples.calibration.ece(), 0.004);
  EXPECT_GT(*SpearmanOf(samples.pairs), 0.3);
  EXPECT_GT(*RocAucOf(samples.pairs, kLargeErrorMm), 0.6);
}

TEST(SigmaQuality, HalfOfTheDeviationIsAKnownCalibrationErrorAndTheSameOrder) {
  const SigmaSamples half = Positions(20000, 0.5), right = Positions(20000, 1.0);
  EXPECT_NEAR(*half.calibration.within_one_sigma(), std::erf(0.5 / std::sqrt(2.0)), 0.006);
  double expected = 0.0;
  for (const double level : Calibration::kLevels) {
    double low = 0.0, high = 4.0;  // bisection of the interval's half-width
    while (high - low > 1e-12) (std::erf(0.5 * (low + high)) < level ? low : high) = 0.5 * (low + high);
    expected += (level - std::erf(0.5 * low)) / 10.0;
  }
  EXPECT_NEAR(*half.calibration.ece(), expected, 0.004);
  EXPECT_DOUBLE_EQ(*SpearmanOf(half.pairs), *SpearmanOf(right.pairs));
  EXPECT_DOUBLE_EQ(*RocAucOf(half.pairs, kLargeErrorMm), *RocAucOf(right.pairs, kLargeErrorMm));
  EXPECT_DOUBLE_EQ(RiskCoverageOf(half.pairs)->area, RiskCoverageOf(right.pairs)->area);
}

TEST(SigmaQuality, UnrelatedDeviationsOrderNothing) {
  const auto samples = Unrelated(10000);
  EXPECT_NEAR(*SpearmanOf(samples), 0.0, 0.03);
  EXPECT_NEAR(*RocAucOf(samples, 50.0), 0.5, 0.02);
  EXPECT_NEAR(RiskCoverageOf(samples)->area, 50.0, 1.5);
  EXPECT_NEAR(IdealRiskCoverageOf(samples)->area, 25.0, 0.5);
}

TEST(SigmaQuality, DeviationsEqualToTheErrorsOrderThemIdeally) {
  auto samples = Unrelated(1000);
  for (SigmaAndError& sample : samples) sample.sigma = sample.error;
  EXPECT_DOUBLE_EQ(*SpearmanOf(samples), 1.0);
  EXPECT_EQ(*RocAucOf(samples, 50.0), 1.0);
  EXPECT_EQ(RiskCoverageOf(samples)->area, IdealRiskCoverageOf(samples)->area);
  for (SigmaAndError& sample : samples) sample.sigma = 200.0F - sample.error;
  EXPECT_DOUBLE_EQ(*SpearmanOf(samples), -1.0);
  EXPECT_EQ(*RocAucOf(samples, 50.0), 0.0);
}

TEST(SigmaQuality, ValuesOfSmallSetsAreThoseByHand) {
  const std::vector<SigmaAndError> samples = {{3, 0}, {1, 2}, {4, 10}, {2, 4}};
  const auto curve = RiskCoverageOf(samples), ideal = IdealRiskCoverageOf(samples);
  EXPECT_DOUBLE_EQ(curve->area, (2.0 + 3.0 + 2.0 + 4.0) / 4.0);
  EXPECT_DOUBLE_EQ(ideal->area, (0.0 + 1.0 + 2.0 + 4.0) / 4.0);
  EXPECT_EQ(curve->risk, (std::array<double, 10>{2, 2, 3, 3, 3, 2, 2, 4, 4, 4}));
  EXPECT_DOUBLE_EQ(*SpearmanOf(samples), 1.0 - 6.0 * (1 + 1 + 4 + 0) / (4.0 * 15.0));
  Calibration exact;
  exact.Add(0.0);
  EXPECT_DOUBLE_EQ(*exact.ece(), 0.5);
  exact.Add(-1e9);
  EXPECT_DOUBLE_EQ(*exact.ece(), (0.45 + 0.35 + 0.25 + 0.15 + 0.05) / 5.0);
}

TEST(SigmaQuality, EqualDeviationsCountAsTheirMeanInAnyOrder) {
  std::vector<SigmaAndError> samples;  // 30 of 40 with the larger deviation have large errors, 10 of 40 of the others
  for (int i = 0; i < 80; ++i) {
    const bool second = i >= 40, large = second ? i < 70 : i < 10;
    samples.push_back({second ? 2.0F : 1.0F, large ? 60.0F : 20.0F});
  }
  const auto curve = RiskCoverageOf(samples);
  EXPECT_DOUBLE_EQ(*RocAucOf(samples, 50.0), 0.75 * 0.75 + 0.5 * (2.0 * 0.25 * 0.75));
  EXPECT_DOUBLE_EQ(*SpearmanOf(samples), 0.5);
  for (int i = 0; i < 5; ++i) EXPECT_DOUBLE_EQ(curve->risk[i], 30.0);
  EXPECT_DOUBLE_EQ(curve->risk[9], 40.0);
  std::reverse(samples.begin(), samples.end());
  EXPECT_EQ(RiskCoverageOf(samples)->area, curve->area);
  for (SigmaAndError& sample : samples) sample.sigma = 7.0F;
  EXPECT_FALSE(SpearmanOf(samples));
  EXPECT_DOUBLE_EQ(*RocAucOf(samples, 50.0), 0.5);
  EXPECT_DOUBLE_EQ(RiskCoverageOf(samples)->area, 40.0);
}

TEST(SigmaQuality, WhatIsUndefinedIsEmpty) {
  const SigmaSamples none;
  EXPECT_FALSE(none.calibration.ece() || none.calibration.within_one_sigma() || SpearmanOf(none.pairs));
  EXPECT_FALSE(RiskCoverageOf(none.pairs) || IdealRiskCoverageOf(none.pairs) || RocAucOf(none.pairs, 50.0));
  std::vector<SigmaAndError> few(100, {1.0F, 20.0F});
  for (int i = 0; i < 9; ++i) few[i].error = 60.0F;
  EXPECT_FALSE(RocAucOf(few, 50.0)) << "nine large errors";
  few[9].error = 60.0F;
  EXPECT_TRUE(RocAucOf(few, 50.0));
  SigmaSamples refused;
  refused.AddPosition(Vector3d::Ones(), Matrix3d::Zero());
  refused.AddAxis(0.1, 0.0);
  EXPECT_TRUE(refused.pairs.empty());
  EXPECT_EQ(refused.calibration.components, 0);
}

TEST(SigmaQuality, GroupsAreThePartsAndWhatIsNotObserved) {
  SigmaByPart sigma;
  sigma.At(BodyPart::kTrunk, true).positions.AddPosition(Vector3d(0.01, 0.0, 0.0), 1e-4 * Matrix3d::Identity());
  sigma.At(BodyPart::kLegs, false).positions.AddPosition(Vector3d(0.0, 0.03, 0.0), 4e-4 * Matrix3d::Identity());
  sigma.At(BodyPart::kLegs, false).rotations.AddAxis(-0.2, 0.1);
  SigmaByPart twice = sigma;
  twice.Append(sigma);
  const std::size_t positions[] = {4, 2, 0, 0, 2, 2}, rotations[] = {2, 0, 0, 0, 2, 2};
  for (std::size_t g = 0; g < SigmaByPart::kGroups.size(); ++g) {
    const FitSamples group = twice.Group(g);
    EXPECT_EQ(group.positions.pairs.size(), positions[g]) << SigmaByPart::kGroups[g];
    EXPECT_EQ(group.positions.calibration.components, 3 * static_cast<std::int64_t>(positions[g]));
    EXPECT_EQ(group.rotations.pairs.size(), rotations[g]) << SigmaByPart::kGroups[g];
  }
  const SigmaAndError leg = twice.Group(4).positions.pairs.front();
  EXPECT_FLOAT_EQ(leg.sigma, 20.0F);
  EXPECT_FLOAT_EQ(leg.error, 30.0F);
}

}  // namespace
}  // namespace mocurate
