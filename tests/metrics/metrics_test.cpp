// Metrics agree with the released code's numbers, and keep their own laws.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "eval/metrics/accuracy.h"
#include "eval/metrics/fid.h"
#include "eval/metrics/interval.h"
#include "eval/metrics/kernel_distance.h"
#include "eval/metrics/neighbours.h"
#include "eval/metrics/permutation_test.h"
#include "eval/metrics/spread.h"
#include "tests/support/golden.h"

namespace mocurate {
namespace {

#define REQUIRE_GOLDENS()                                              \
  const char* goldens = std::getenv("MOCURATE_GOLDENS");               \
  if (goldens == nullptr) GTEST_SKIP() << "MOCURATE_GOLDENS is unset"; \
  const golden::File file(std::string(goldens) + "/metrics.h5")

Features AsFeatures(const golden::Array<double>& array) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(array.values.data(), static_cast<Eigen::Index>(array.rows()),
                                    static_cast<Eigen::Index>(array.row_size()));
}

std::vector<int> AsInts(const golden::Array<std::int64_t>& array) {
  return std::vector<int>(array.values.begin(), array.values.end());
}

double Fid(const Features& a, const Features& b) {
  const auto first = StatisticsOf(a);
  const auto second = StatisticsOf(b);
  EXPECT_TRUE(first && second);
  const auto distance = FrechetDistance(*first, *second);
  EXPECT_TRUE(distance) << distance.error().Message();
  return distance.value_or(std::nan(""));
}

TEST(FrechetDistance, EqualsTheReleasedCodeOnEveryStoredCase) {
  REQUIRE_GOLDENS();
  const auto cases = file.Children("fid");
  EXPECT_EQ(cases.size(), 16u);
  for (const std::string& name : cases) {
    const std::string at = "fid/" + name + "/";
    const Features a = AsFeatures(file.Doubles(at + "A"));
    const Features b = AsFeatures(file.Doubles(at + "B"));
    const bool full_rank = a.rows() > a.cols() && b.rows() > b.cols();
    const double ours = Fid(a, b);
    EXPECT_NEAR(ours, file.Doubles(at + "fid_symmetric_eigen")[0], 2e-5) << name;
    // float32 means of the reference limit agreement for float32 features.
    EXPECT_NEAR(ours, file.Doubles(at + "fid")[0], full_rank ? 1e-5 : 2e-5) << name;
  }
}

TEST(FrechetDistance, IsZeroForASetAndItself) {
  Random random(1, "test");
  Features a(50, 7);
  for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = random.Normal();
  EXPECT_NEAR(Fid(a, a), 0.0, 1e-9);
}

TEST(FrechetDistance, OfTwoPointCloudsAlongALineIsTheKnownFormula) {
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

TEST(Spread, EqualsTheReleasedCodeForItsOwnDraws) {
  REQUIRE_GOLDENS();
  for (const std::string& name : file.Children("divmm")) {
    const Features features = AsFeatures(file.Doubles("divmm/" + name + "/activations"));
    for (const std::string& seed : file.Children("divmm/" + name)) {
      if (seed.rfind("seed", 0) != 0) continue;
      const std::string at = "divmm/" + name + "/" + seed + "/";
      const auto first = AsInts(file.Integers(at + "div_first"));
      const auto second = AsInts(file.Integers(at + "div_second"));
      IndexPairs any;
      for (std::size_t i = 0; i < first.size(); ++i) any.emplace_back(first[i], second[i]);
      EXPECT_NEAR(MeanDistance(features, any), file.Doubles(at + "diversity")[0], 1e-5) << at;
      const auto pairs = AsInts(file.Integers(at + "mm_pairs"));
      IndexPairs same;
      for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) same.emplace_back(pairs[i], pairs[i + 1]);
      EXPECT_NEAR(MeanDistance(features, same), file.Doubles(at + "multimodality")[0], 1e-5) << at;
    }
  }
}

TEST(Spread, MultimodalityPairsStayInTheirClassAndFillTheQuota) {
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

TEST(Spread, AClassWithoutMotionsHasNoPairs) {
  Random random(3, "test");
  EXPECT_EQ(DrawMultimodalityPairs({0, 0, 2}, 3, 20, random).size(), 40u);
}

TEST(FrechetDistance, OfFloatRowsInBlocksEqualsThatOfDoubles) {
  Random random(5, "test");
  const Eigen::Index count = 9000, size = 6;  // three blocks
  std::vector<float> rows(static_cast<std::size_t>(count * size));
  for (float& value : rows) value = static_cast<float>(3.0 + random.Normal());
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto whole = StatisticsOf(Features(Eigen::Map<const RowMajor>(rows.data(), count, size).cast<double>()));
  const auto blocks = StatisticsOf(rows.data(), count, size);
  ASSERT_TRUE(whole && blocks);
  EXPECT_LT((whole->mean - blocks->mean).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((whole->covariance - blocks->covariance).cwiseAbs().maxCoeff(), 1e-12);
  rows[17] = std::nanf("");
  EXPECT_FALSE(StatisticsOf(rows.data(), count, size));
}

TEST(Accuracy, OfEquivalentLabelsEqualsMultiActsCounts) {
  REQUIRE_GOLDENS();
  const auto logits = file.Floats("multiact_accuracy/logits");
  const auto truth = AsInts(file.Integers("multiact_accuracy/true"));
  const auto synonyms = file.Integers("multiact_accuracy/synonyms");
  const auto listed = file.Integers("multiact_accuracy/has_synonyms");
  EquivalentClasses equivalent(53);
  for (int c = 0; c < 53; ++c) {
    for (int p = 0; p < 53; ++p) {
      if (listed[c] != 0 && synonyms[c * 53 + p] != 0) equivalent[c].push_back(p);
    }
  }
  const auto share = [&](const char* name) {
    return static_cast<double>(file.Integers(std::string("multiact_accuracy/") + name)[0]) / truth.size();
  };
  const float* values = logits.values.data();
  EXPECT_DOUBLE_EQ(AcceptedShare(truth, values, 53, 1, equivalent), share("correct_top1"));
  EXPECT_DOUBLE_EQ(AcceptedShare(truth, values, 53, 5, equivalent), share("correct_top5"));
  EXPECT_DOUBLE_EQ(AcceptedShare(truth, values, 53, 1), share("strict_top1"));
  EXPECT_DOUBLE_EQ(AcceptedShare(truth, values, 53, 5), share("strict_top5"));
}

TEST(Spread, EqualsMultiActForItsOwnDrawsAlsoWhereClassesAreMissing) {
  REQUIRE_GOLDENS();
  for (const std::string name : {"all_classes", "missing_classes"}) {
    const std::string at = "multiact_divmm/" + name + "/";
    const Features features = AsFeatures(file.Doubles(at + "activations"));
    const auto pairs = AsInts(file.Integers(at + "mm_pairs"));
    IndexPairs same;
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) same.emplace_back(pairs[i], pairs[i + 1]);
    const double divisor = 20.0 * static_cast<double>(file.Integers(at + "num_labels")[0]);
    const double ours = MeanDistance(features, same) * static_cast<double>(same.size()) / divisor;
    EXPECT_NEAR(ours, file.Doubles(at + "multimodality")[0], 1e-5) << name;
  }
}

Features Normals(Eigen::Index count, Eigen::Index size, double shift, const char* purpose) {
  Random random(7, purpose);
  Features features(count, size);
  for (Eigen::Index i = 0; i < features.size(); ++i) features.data()[i] = shift + random.Normal();
  return features;
}

TEST(KernelDistance, OfTwoDrawsOfOneDistributionIsZeroOnAverageAndGrowsWithAShift) {
  Random random(1, "subsets");
  double sum = 0.0;
  for (int i = 0; i < 20; ++i) {
    const auto same = KernelDistance(Normals(120, 4, 0.0, ("a" + std::to_string(i)).c_str()),
                                     Normals(120, 4, 0.0, ("b" + std::to_string(i)).c_str()), 10, 1000, random);
    ASSERT_TRUE(same);
    sum += *same / 20.0;
  }
  EXPECT_NEAR(sum, 0.0, 0.03) << "unbiased, unlike FID of 120 motions";
  const auto apart = KernelDistance(Normals(120, 4, 0.0, "a"), Normals(120, 4, 1.0, "b"), 10, 1000, random);
  EXPECT_GT(*apart, 1.0);
}

/// Of one-dimensional sets the estimate by hand: k(x, y) = (x y + 1)^3.
TEST(KernelDistance, IsTheUnbiasedEstimate) {
  Features a(2, 1), b(2, 1);
  a << 1.0, 2.0;
  b << 0.0, 3.0;
  Random random(1, "subsets");
  const auto k = [](double x, double y) { return std::pow(x * y + 1.0, 3); };
  const double expected = k(1, 2) + k(0, 3) - 2.0 * (k(1, 0) + k(1, 3) + k(2, 0) + k(2, 3)) / 4.0;
  EXPECT_NEAR(*KernelDistance(a, b, 5, 10, random), expected, 1e-12);
}

TEST(Neighbours, CopiesAreAtNoDistanceAndCoverWhatTheyCopy) {
  const Features reference = Normals(300, 5, 0.0, "reference");
  const auto copies = CompareNeighbours(reference, reference);
  ASSERT_TRUE(copies);
  EXPECT_NEAR(copies->nearest, 0.0, 1e-6);
  EXPECT_NEAR(copies->coverage, 1.0, 1e-12);
  const auto fresh = CompareNeighbours(Normals(300, 5, 0.0, "fresh"), reference);
  EXPECT_NEAR(fresh->nearest, 1.0, 0.1);
  EXPECT_NEAR(fresh->density, 1.0, 0.15);
  EXPECT_GT(fresh->coverage, 0.9);
  const auto far = CompareNeighbours(Normals(300, 5, 9.0, "far"), reference);
  EXPECT_EQ(far->density, 0.0);
  EXPECT_EQ(far->coverage, 0.0);
  EXPECT_GT(far->nearest, 5.0);
  EXPECT_FALSE(CompareNeighbours(reference, reference.topRows(5)));
}

TEST(PermutationTest, FindsADifferenceInEveryRepetitionAndNoneBetweenEqualRows) {
  std::vector<double> a, b, c;
  Random random(2, "values");
  for (int i = 0; i < 20; ++i) {
    const double shared = random.Normal();
    a.push_back(shared + 0.1 * random.Normal());
    b.push_back(shared + 0.3 + 0.1 * random.Normal());
    c.push_back(shared + 0.1 * random.Normal());
  }
  EXPECT_LT(PairedSignTest(a, b, 10000, random), 0.001);
  EXPECT_GT(PairedSignTest(a, c, 10000, random), 0.01);
  EXPECT_EQ(PairedSignTest(a, a, 100, random), 1.0);
}

TEST(Interval, ByResamplingHoldsTheMeanNineteenTimesInTwenty) {
  Random random(4, "values");
  int inside = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<double> values;
    for (int i = 0; i < 60; ++i) values.push_back(random.Normal());
    const auto interval = CentralInterval(ResampledMeans(values, 300, random));
    ASSERT_TRUE(interval);
    inside += (*interval)[0] <= 0.0 && (*interval)[1] >= 0.0 ? 1 : 0;
  }
  EXPECT_NEAR(inside / 400.0, 0.95, 0.04);
}

TEST(Accuracy, EqualsTheReleasedConfusionAndTrace) {
  REQUIRE_GOLDENS();
  const auto confusion =
      ConfusionMatrix(AsInts(file.Integers("accuracy/true")), AsInts(file.Integers("accuracy/pred")), 12);
  const auto expected = file.Integers("accuracy/confusion");
  for (int r = 0; r < 12; ++r) {
    for (int c = 0; c < 12; ++c) EXPECT_EQ(confusion(r, c), expected[r * 12 + c]);
  }
  EXPECT_NEAR(Accuracy(confusion), file.Doubles("accuracy/a2m_trace_over_num_motions")[0], 1e-12);
}

TEST(Interval, EachConventionEqualsItsCodeBase) {
  REQUIRE_GOLDENS();
  for (const std::string& name : file.Children("ci")) {
    const std::string at = "ci/" + name + "/";
    const std::vector<double> values = file.Doubles(at + "values").values;
    EXPECT_NEAR(Summarise(values, IntervalKind::kStudent).half_width, file.Doubles(at + "multiact_halfwidth")[0], 1e-9);
    EXPECT_NEAR(Summarise(values, IntervalKind::kActor).half_width, file.Doubles(at + "actor_interval")[0], 1e-9);
    EXPECT_NEAR(Summarise(values, IntervalKind::kActor).mean, file.Doubles(at + "mean")[0], 1e-9);
  }
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
