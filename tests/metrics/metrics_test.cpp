// Metrics agree with the released code's numbers, and keep their own laws.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "eval/metrics/accuracy.h"
#include "eval/metrics/fid.h"
#include "eval/metrics/interval.h"
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
  const std::vector<int> labels = {0, 1, 2, 2, 1, 0, 0};
  const auto pairs = DrawMultimodalityPairs(labels, {"clap", "jump", "walk"}, 20, random);
  ASSERT_TRUE(pairs);
  std::vector<int> per_class(3, 0);
  for (const auto& [a, b] : *pairs) {
    EXPECT_EQ(labels[a], labels[b]);
    ++per_class[labels[a]];
  }
  EXPECT_EQ(per_class, (std::vector<int>{20, 20, 20}));
}

TEST(Spread, AClassWithoutMotionsIsAnErrorNotALoop) {
  Random random(3, "test");
  const auto pairs = DrawMultimodalityPairs({0, 0, 2}, {"clap", "jump", "walk"}, 20, random);
  ASSERT_FALSE(pairs);
  EXPECT_EQ(pairs.error().what, "class 'jump' has none of the 3 motions drawn");
  EXPECT_NE(pairs.error().hint.find("raise evaluate.motions"), std::string::npos);
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
