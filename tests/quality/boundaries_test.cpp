// Found boundaries are matched to true ones one to one, as many as the tolerance allows.

#include "tests/support/boundary_score.h"

#include <gtest/gtest.h>

namespace mocurate {
namespace {

TEST(Boundaries, AreMatchedOneToOneWithinTheTolerance) {
  const BoundaryScore score = ScoreBoundaries({3.0, 1.1, 5.0}, {1.0, 1.2, 3.3}, 0.5);
  EXPECT_EQ(score.matched(), 2);  // 1.1 is nearer to 1.0 or to 1.2, and is one boundary
  EXPECT_NEAR(score.precision(), 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(score.recall(), 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(score.f1(), 2.0 / 3.0, 1e-12);
}

TEST(Boundaries, AsManyAreMatchedAsPossible) {
  // 1.4 is nearest to 1.5, but then 1.8 would have no match; nor may 1.0 be matched by 1.4 alone.
  const auto pairs = MatchBoundaries({1.4, 1.8}, {1.0, 1.5}, 0.45);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0], (std::pair<int, int>(0, 0)));
  EXPECT_EQ(pairs[1], (std::pair<int, int>(1, 1)));
}

TEST(Boundaries, OfEquallyManyPairsTheNearestAreTaken) {
  const auto pairs = MatchBoundaries({1.0, 1.3}, {1.35}, 0.5);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].first, 1);
}

TEST(Boundaries, TheToleranceIsInclusiveAndEmptyListsArePerfect) {
  EXPECT_EQ(ScoreBoundaries({1.5}, {1.0}, 0.5).matched(), 1);
  EXPECT_EQ(ScoreBoundaries({1.6}, {1.0}, 0.5).matched(), 0);
  EXPECT_EQ(ScoreBoundaries({}, {}, 0.5).f1(), 1.0);
  EXPECT_EQ(ScoreBoundaries({}, {1.0}, 0.5).precision(), 1.0);
  EXPECT_EQ(ScoreBoundaries({}, {1.0}, 0.5).f1(), 0.0);
}

TEST(Boundaries, SumsOverRecordingsCountAndKeepTheMedian) {
  BoundaryScore sum = ScoreBoundaries({1.0, 2.0}, {1.1, 2.3}, 0.5);
  sum.Add(ScoreBoundaries({4.0}, {4.2, 9.0}, 0.5));
  EXPECT_EQ(sum.found, 3);
  EXPECT_EQ(sum.truth, 4);
  EXPECT_NEAR(sum.recall(), 0.75, 1e-12);
  EXPECT_NEAR(sum.median_s(), 0.2, 1e-12);
}

}  // namespace
}  // namespace mocurate
