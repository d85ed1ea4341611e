// Intervals and tests of features hold what they say on distributions whose true distances are known. Draws are keyed:
// the counts are the same in every run. tests/benchmarks/metric_intervals.cpp has more trials and the papers' sizes.

#include "eval/metrics/sampling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "eval/metrics/accuracy.h"
#include "eval/metrics/frechet_sampling.h"
#include "tests/support/known_features.h"

namespace mocurate {
namespace {

constexpr int kTrials = 200;

struct Mean {
  double sum = 0.0, squares = 0.0;
  int count = 0;

  void Add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double value() const { return sum / count; }
  double variance() const { return squares / count - value() * value(); }
  double error() const { return std::sqrt(variance() / count); }
};

bool Holds(const std::optional<SampledInterval>& interval, double truth) {
  return interval && interval->ends[0] <= truth && truth <= interval->ends[1];
}

TEST(EqualSizes, CopiesOfTheRealDistributionScoreAsRealAndOthersWorse) {
  for (const bool bent : {false, true}) {
    Mean difference;
    for (int trial = 0; trial < kTrials; ++trial) {
      const KnownFeatures known(4, bent, trial);
      const Features row = known.Motions(50, "row").features;
      const auto fid = FidAtEqualSizes(&row, known.Motions(80, "real").features, 10, 1);
      ASSERT_TRUE(fid);
      EXPECT_EQ(fid->motions, 40);
      difference.Add(fid->row - fid->real);
    }
    EXPECT_LT(std::abs(difference.value()), 2.5 * difference.error()) << bent;
  }
  const KnownFeatures known(4, false, 1);
  const Features real = known.Motions(80, "real").features;
  const Features same = known.Motions(50, "row").features, other = known.Motions(50, "row", 2.0).features;
  const auto copies = FidAtEqualSizes(&same, real, 10, 1), moved = FidAtEqualSizes(&other, real, 10, 1);
  EXPECT_EQ(copies->real, moved->real) << "the same halves for every row";
  EXPECT_GT(moved->row, 2.0 * moved->real);
  EXPECT_FALSE(FidAtEqualSizes(nullptr, real.topRows(3), 10, 1));
}

TEST(NoDifference, FiresAsOftenAsItSaysOnCopiesAndAlwaysOnOthers) {
  for (const int persons : {0, 20}) {
    int fired = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      const KnownFeatures known(4, false, trial);
      const FeatureSample real = persons > 0 ? known.Persons(persons, 5, "real") : known.Motions(100, "real");
      Random random(1, "exchanges", std::to_string(trial));
      const auto none = FidsOfNoDifference(known.Motions(100, "row"), real, 99, random);
      ASSERT_TRUE(none);
      fired += none->p <= 0.05 ? 1 : 0;
    }
    EXPECT_GE(fired, kTrials / 50) << persons;
    EXPECT_LE(fired, kTrials / 10) << persons;
  }
  const KnownFeatures known(4, false, 1);
  Random random(1, "exchanges");
  EXPECT_LT(FidsOfNoDifference(known.Motions(100, "row", 1.5), known.Motions(100, "real"), 99, random)->p, 0.02);
  FeatureSample one = known.Motions(10, "real");
  std::fill(one.unit.begin(), one.unit.end(), 0);
  one.units = 1;
  EXPECT_FALSE(FidsOfNoDifference(one, known.Motions(10, "row"), 9, random));
}

TEST(NoDifference, LabelsKeepTheirNumbersInEveryExchange) {
  // Two labels far apart, equally often on both sides: without labels an exchange would unbalance them.
  const KnownFeatures known(3, false, 5);
  FeatureSample a = known.Motions(80, "row"), b = known.Motions(80, "real");
  for (FeatureSample* sample : {&a, &b}) {
    for (int i = 0; i < sample->count(); ++i) {
      sample->label[static_cast<std::size_t>(i)] = i % 2;
      if (i % 2 == 1) sample->features.row(i).array() += 50.0;
    }
  }
  Random random(1, "exchanges");
  const auto within = FidsOfNoDifference(a, b, 99, random);
  a.label.assign(a.label.size(), 0);
  b.label = a.label;
  const auto across = FidsOfNoDifference(a, b, 99, random);
  EXPECT_GT(across->variance, 100.0 * within->variance);
}

TEST(NoDifference, SamplesOfOtherLabelsAreComparedAsIfOfOne) {
  const KnownFeatures known(4, false, 1);
  FeatureSample row = known.Motions(100, "row", 3.0), real = known.Motions(100, "real");
  row.label.assign(row.label.size(), -1);
  Random random(1, "exchanges");
  EXPECT_EQ(FidsOfNoDifference(row, real, 99, random)->p, 0.01) << "not 1: no motion could be exchanged";
  EXPECT_EQ(DifferenceOfFids(row, real, known.Motions(100, "reference").features, 99, random)->p, 0.01);
}

TEST(ExtrapolatedFid, NeedsUnitsOfWhichNoneHasHalfOfTheMotions) {
  const KnownFeatures known(3, false, 1);
  FeatureSample persons = known.Persons(10, 12, "real");
  EXPECT_TRUE(*ExtrapolatedFid(known.Motions(100, "row"), persons, 1));
  for (int& unit : persons.unit) unit = unit < 8 ? 0 : unit - 7;
  persons.units = 3;
  EXPECT_FALSE(*ExtrapolatedFid(known.Motions(100, "row"), persons, 1));
  EXPECT_EQ(KindOf(persons), SampledKind::kSpread);
}

TEST(ExtrapolatedFid, IsUnbiasedAndItsIntervalHoldsTheTruth) {
  for (const double shift : {0.0, 0.7, 1.5}) {
    int held = 0;
    Mean extrapolated, whole;
    for (int trial = 0; trial < kTrials; ++trial) {
      const KnownFeatures known(4, false, trial);
      const FeatureSample row = known.Motions(120, "row", shift), real = known.Motions(100, "real");
      const auto limit = ExtrapolatedFid(row, real, 1);
      ASSERT_TRUE(limit && *limit);
      Random random(1, "exchanges", std::to_string(trial));
      const double variance = *FirstOrderVariance(row, real) + FidsOfNoDifference(row, real, 99, random)->variance;
      held += Holds(IntervalAbout(**limit, variance, 100, SampledKind::kMotions), shift * shift) ? 1 : 0;
      extrapolated.Add(**limit);
      whole.Add(*FrechetDistance(*StatisticsOf(row.features), *StatisticsOf(real.features)));
    }
    EXPECT_GE(held, kTrials * 9 / 10) << shift;
    EXPECT_LT(std::abs(extrapolated.value() - shift * shift), 3.0 * extrapolated.error() + 0.02) << shift;
    EXPECT_GT(whole.value() - shift * shift, 3.0 * std::abs(extrapolated.value() - shift * shift)) << shift;
  }
  const KnownFeatures known(4, false, 1);
  EXPECT_FALSE(*ExtrapolatedFid(known.Motions(39, "row"), known.Motions(100, "real"), 1)) << "ten a feature";
}

TEST(FirstOrderVariance, IsTheVarianceOverSamplesAndOverPersons) {
  Mean fid, predicted, of_persons, predicted_by_persons, predicted_by_motions;
  for (int trial = 0; trial < 5 * kTrials; ++trial) {
    const KnownFeatures known(3, false, trial);
    const FeatureSample row = known.Motions(300, "row", 2.0), real = known.Motions(300, "real");
    FeatureSample persons = known.Persons(30, 10, "persons");
    fid.Add(*FrechetDistance(*StatisticsOf(row.features), *StatisticsOf(real.features)));
    predicted.Add(*FirstOrderVariance(row, real));
    of_persons.Add(*FrechetDistance(*StatisticsOf(row.features), *StatisticsOf(persons.features)));
    predicted_by_persons.Add(*FirstOrderVariance(row, persons));
    for (std::size_t i = 0; i < persons.unit.size(); ++i) persons.unit[i] = static_cast<int>(i);
    persons.units = persons.count();
    predicted_by_motions.Add(*FirstOrderVariance(row, persons));
  }
  EXPECT_NEAR(predicted.value() / fid.variance(), 1.0, 0.12);
  EXPECT_NEAR(predicted_by_persons.value() / of_persons.variance(), 1.0, 0.15);
  EXPECT_LT(predicted_by_motions.value() / of_persons.variance(), 0.6) << "motions of a person are not independent";
}

TEST(KernelDistanceOfAll, IsUnbiasedAndItsIntervalHoldsTheTruth) {
  for (const double shift : {0.0, 1.0}) {
    Mean truth;  // over many other samples
    for (int trial = 0; trial < 3 * kTrials; ++trial) {
      const KnownFeatures other(3, false, 10000 + trial);
      truth.Add(KernelDistanceOfAll(other.Motions(200, "a", shift), other.Motions(200, "b"))->value);
    }
    int held = 0;
    Mean value;
    for (int trial = 0; trial < kTrials; ++trial) {
      const KnownFeatures known(3, false, trial);
      const auto kid = KernelDistanceOfAll(known.Motions(80, "row", shift), known.Motions(80, "real"));
      ASSERT_TRUE(kid);
      held += Holds(IntervalAbout(kid->value, kid->variance, 80, SampledKind::kMotions), truth.value()) ? 1 : 0;
      value.Add(kid->value);
    }
    EXPECT_GE(held, kTrials * 9 / 10) << shift;
    EXPECT_LT(std::abs(value.value() - truth.value()), 3.0 * value.error() + 2.0 * truth.error()) << shift;
  }
}

TEST(IntervalOfShare, HoldsTheTrueAccuracyAlsoOfPersons) {
  for (const double truth : {0.5, 0.95}) {
    for (const int persons : {0, 25}) {
      int held = 0;
      for (int trial = 0; trial < kTrials; ++trial) {
        Random random(3, "right", std::to_string(trial));
        FeatureSample sample;
        sample.features.resize(100, 1);
        sample.units = persons > 0 ? persons : 100;
        Eigen::VectorXd right(100);
        double of_person = 0.0;
        for (int i = 0; i < 100; ++i) {
          // A person's motions are all right with the same chance: truth on average.
          if (persons == 0 || i % 4 == 0) of_person = persons == 0 ? truth : random.Uniform() < 0.5 ? 2 * truth - 1 : 1;
          right(i) = random.Uniform() < of_person ? 1.0 : 0.0;
          sample.unit.push_back(persons > 0 ? i / 4 : i);
        }
        held += Holds(IntervalOfShare(right, sample), truth) ? 1 : 0;
      }
      EXPECT_GE(held, kTrials * 9 / 10) << truth << " " << persons;
    }
  }
  FeatureSample sample;
  sample.features.resize(20, 1);
  for (int i = 0; i < 20; ++i) sample.unit.push_back(i);
  sample.units = 20;
  const auto all = IntervalOfShare(Eigen::VectorXd::Ones(20), sample);
  EXPECT_LT(all->ends[0], 0.9) << "20 of 20 are not certain";
  EXPECT_NEAR(all->ends[1], 1.0, 1e-12);
}

TEST(DistancesOfAll, IntervalsHoldTheTrueMeanDistance) {
  const KnownFeatures many(3, false, 777);
  const Features far = many.Motions(4000, "a").features;
  double truth = 0.0;
  for (Eigen::Index i = 0; i < 2000; ++i) truth += (far.row(i) - far.row(i + 2000)).norm() / 2000.0;
  int held = 0, of_all = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const FeatureSample sample = KnownFeatures(3, false, trial).Motions(100, "row");
    Random random(1, "pairs", std::to_string(trial));
    const double value = MeanDistance(sample.features, DrawDiversityPairs(100, 200, random));
    const auto all = DistancesOfAll(sample, false);
    held += Holds(all->About(value, 200), truth) ? 1 : 0;
    of_all += Holds(all->About(all->mean, 0), truth) ? 1 : 0;
    EXPECT_NEAR(value, all->mean, 1.2) << "drawn pairs are of the same motions";
  }
  EXPECT_GE(held, kTrials * 9 / 10);
  EXPECT_GE(of_all, kTrials * 9 / 10);
}

TEST(SampledKind, FewOrUnknownPersonsAreASpread) {
  const KnownFeatures known(2, false, 1);
  EXPECT_EQ(KindOf(known.Motions(30, "a")), SampledKind::kMotions);
  EXPECT_EQ(KindOf(known.Persons(12, 2, "a")), SampledKind::kPersons);
  EXPECT_EQ(KindOf(known.Persons(9, 4, "a")), SampledKind::kSpread);
  EXPECT_EQ(KindOf(known.Motions(30, "a"), known.Persons(12, 2, "b")), SampledKind::kPersons);
  FeatureSample unknown = known.Motions(30, "a");
  unknown.independent = false;
  EXPECT_EQ(KindOf(unknown), SampledKind::kSpread);
}

TEST(DifferenceOfFids, FindsTheWorseRowAndNoneBetweenEqualOnes) {
  const KnownFeatures known(4, false, 1);
  const Features reference = known.Motions(200, "real").features;
  Random random(1, "exchanges");
  const FeatureSample good = known.Motions(100, "good"), worse = known.Motions(80, "worse", 2.5);
  const auto apart = DifferenceOfFids(good, worse, reference, 99, random);
  EXPECT_EQ(apart->motions, 80);
  EXPECT_LT(apart->difference, -3.0);
  EXPECT_EQ(apart->p, 0.01) << "the smallest of 99 exchanges";
  EXPECT_EQ(DifferenceOfFids(good, good, reference, 99, random)->p, 1.0);
}

TEST(Normalised, RowsHaveLengthOneAndZerosStay) {
  Features rows(2, 2);
  rows << 3.0, 4.0, 0.0, 0.0;
  const Features normalised = Normalised(rows);
  EXPECT_DOUBLE_EQ(normalised(0, 1), 0.8);
  EXPECT_EQ(normalised.row(1).norm(), 0.0);
}

}  // namespace
}  // namespace mocurate
