// Mathematical properties of metrics; tests/eval/precision_test.cpp compares them with the released code.

#include <gtest/gtest.h>

#include <cmath>

#include "eval/metrics/accuracy.h"
#include "eval/metrics/feature_distances.h"
#include "eval/metrics/interval.h"

namespace mocurate {
namespace {

double Fid(const Features& a, const Features& b) {
  const auto first = StatisticsOf(a);
  const auto second = StatisticsOf(b);
  EXPECT_TRUE(first && second);
  const auto distance = FrechetDistance(*first, *second);
  EXPECT_TRUE(distance) << distance.error().Message();
  return distance.value_or(std::nan(""));
}

TEST(FrechetDistance, IsZeroForASetAndItself) {
  Random random(1, "test");
  Features a(50, 7);
  for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = random.Normal();
  EXPECT_NEAR(Fid(a, a), 0.0, 1e-9);
}

TEST(FrechetDistance, MatchesTheClosedFormInOneDimension) {
  Features a(2, 1);
  a << 0.0, 2.0;  // mean 1, variance 2
  Features b(2, 1);
  b << 3.0, 3.0;  // mean 3, variance 0
  EXPECT_NEAR(Fid(a, b), 4.0 + 2.0, 1e-12);
}

TEST(FrechetDistance, RefusesASingleMotionAndNumbersThatAreNotFinite) {
  EXPECT_EQ(StatisticsOf(Features::Zero(1, 3)).error().code, ErrorCode::kInconsistent);
  Features broken = Features::Zero(3, 3);
  broken(1, 1) = std::nan("");
  EXPECT_NE(StatisticsOf(broken).error().what.find("finite"), std::string::npos);
}

TEST(Multimodality, PairsStayInTheirClassAndFillTheQuota) {
  Random random(3, "test");
  const std::vector<int> labels = {0, 1, 2, 2, 1, 0, 0, -1};
  std::vector<int> per_class(3, 0);
  for (const auto& [a, b] : DrawMultimodalityPairs(labels, 3, 20, random)) {
    ASSERT_GE(labels[a], 0);
    EXPECT_EQ(labels[a], labels[b]);
    ++per_class[labels[a]];
  }
  EXPECT_EQ(per_class, (std::vector<int>{20, 20, 20}));
}

TEST(Multimodality, ClassWithoutMotionsHasNoPairs) {
  Random random(3, "test");
  EXPECT_EQ(DrawMultimodalityPairs({0, 0, 2}, 3, 20, random).size(), 40u);
}

TEST(FrechetDistance, StatisticsAreIndependentOfBlocks) {
  Random random(5, "test");
  Features rows(9000, 6);  // three blocks
  for (Eigen::Index i = 0; i < rows.size(); ++i) rows.data()[i] = 3.0 + random.Normal();
  const auto blocks = StatisticsOf(rows);
  ASSERT_TRUE(blocks);
  const Eigen::MatrixXd centred = rows.rowwise() - rows.colwise().mean();
  EXPECT_LT((centred.transpose() * centred / 8999.0 - blocks->covariance).cwiseAbs().maxCoeff(), 1e-12);
  rows(17, 3) = std::nan("");
  EXPECT_FALSE(StatisticsOf(rows));
}

Features Normals(Eigen::Index count, Eigen::Index size, double shift, const char* purpose) {
  Random random(7, purpose);
  Features features(count, size);
  for (Eigen::Index i = 0; i < features.size(); ++i) features.data()[i] = shift + random.Normal();
  return features;
}

TEST(KernelDistance, IsZeroOnAverageForOneDistributionAndGrowsWithAShift) {
  Random random(1, "subsets");
  double sum = 0.0;
  for (int i = 0; i < 20; ++i) {
    const auto same = KernelDistance(Normals(120, 4, 0.0, ("a" + std::to_string(i)).c_str()),
                                     Normals(120, 4, 0.0, ("b" + std::to_string(i)).c_str()), 10, 1000, random);
    ASSERT_TRUE(same);
    sum += same->mean / 20.0;
  }
  EXPECT_NEAR(sum, 0.0, 0.03) << "unbiased, unlike FID of 120 motions";
  const auto apart = KernelDistance(Normals(120, 4, 0.0, "a"), Normals(120, 4, 1.0, "b"), 10, 1000, random);
  EXPECT_GT(apart->mean, 1.0);
}

/// For one-dimensional sets, the estimate by hand: k(x, y) = (x y + 1)^3.
TEST(KernelDistance, IsTheUnbiasedEstimate) {
  Features a(2, 1), b(2, 1);
  a << 1.0, 2.0;
  b << 0.0, 3.0;
  Random random(1, "subsets");
  const auto k = [](double x, double y) { return std::pow(x * y + 1.0, 3); };
  const double expected = k(1, 2) + k(0, 3) - 2.0 * (k(1, 0) + k(1, 3) + k(2, 0) + k(2, 3)) / 4.0;
  EXPECT_NEAR(KernelDistance(a, b, 5, 10, random)->mean, expected, 1e-12);
}

TEST(Neighbours, CopiesHaveZeroDistanceAndCoverTheirOriginals) {
  const Features reference = Normals(300, 5, 0.0, "reference");
  const auto copies = CompareNeighbours(reference, reference);
  ASSERT_TRUE(copies);
  EXPECT_NEAR(copies->nearest, 0.0, 1e-6);
  EXPECT_NEAR(copies->coverage, 1.0, 1e-12);
  EXPECT_EQ(copies->precision, 1.0);
  EXPECT_EQ(copies->recall, 1.0);
  EXPECT_EQ(copies->memorised, 1.0);
  const auto fresh = CompareNeighbours(Normals(300, 5, 0.0, "fresh"), reference);
  EXPECT_NEAR(fresh->nearest, 1.0, 0.1);
  EXPECT_NEAR(fresh->density, 1.0, 0.15);
  EXPECT_GT(fresh->coverage, 0.9);
  EXPECT_GT(fresh->precision, 0.8);
  EXPECT_GT(fresh->recall, 0.8);
  EXPECT_EQ(fresh->memorised, 0.0);
  const auto narrow = CompareNeighbours(0.2 * Normals(300, 5, 0.0, "fresh"), reference);
  EXPECT_GT(narrow->precision, 0.98) << "all inside the reference";
  EXPECT_LT(narrow->recall, 0.1) << "and little of it covered";
  Features half_copied = Normals(300, 5, 0.0, "fresh");
  half_copied.topRows(150) = reference.topRows(150);
  EXPECT_EQ(CompareNeighbours(half_copied, reference)->memorised, 0.5);
  const auto far = CompareNeighbours(Normals(300, 5, 9.0, "far"), reference);
  EXPECT_EQ(far->density, 0.0);
  EXPECT_EQ(far->coverage, 0.0);
  EXPECT_EQ(far->precision, 0.0);
  EXPECT_EQ(far->recall, 0.0);
  EXPECT_GT(far->nearest, 5.0);
  EXPECT_FALSE(CompareNeighbours(reference, reference.topRows(5)));
}

TEST(Interval, StudentQuantileEqualsTheTable) {
  EXPECT_NEAR(StudentQuantile(0.975, 19), 2.093024, 1e-6);
  EXPECT_NEAR(StudentQuantile(0.975, 4), 2.776445, 1e-6);
}

TEST(Interval, OneRepetitionHasNoWidth) {
  EXPECT_EQ(Summarise({0.5}, IntervalKind::kStudent).half_width, 0.0);
  EXPECT_EQ(Summarise({}, IntervalKind::kStudent).mean, 0.0);
}

}  // namespace
}  // namespace mocurate
