// Frames of another unit are distinguished from bodies whose points coincide.

#include "core/quality/unit_changes.h"

#include <gtest/gtest.h>

#include "core/quality/repeats.h"
#include "tests/quality/people.h"

namespace mocurate::test {
namespace {

constexpr std::uint64_t kUnitSeeds = 24;

Take RandomPerson(std::uint64_t seed) {
  TakeOptions options;
  options.noise = 0.001 * static_cast<double>(1 + seed % 20);
  return Perform(seed, options);
}

TEST(UnitChanges, FramesOfAnotherUnitAreReportedFromFirstToLastWithTheirFactor) {
  for (std::uint64_t seed = 0; seed < kUnitSeeds; ++seed) {
    for (const double factor : {0.001, 0.01, 0.1, 10.0, 100.0, 1000.0}) {
      Take take = RandomPerson(seed);
      const int begin = static_cast<int>(seed), end = begin + 1 + static_cast<int>(seed) / 2;
      for (int f = begin; f < end; ++f) {
        for (int k = 0; k < take.positions.joints; ++k) take.positions.at(f, k) *= factor;
      }
      const std::vector<Finding> found = FindUnitChanges(take.view());
      ASSERT_EQ(found.size(), 1u) << "seed " << seed << ", factor " << factor;
      EXPECT_EQ(found[0].code, "units_change");
      EXPECT_EQ(found[0].frame_begin, begin);
      EXPECT_EQ(found[0].frame_end, end);
      EXPECT_NEAR(found[0].value, factor, 1e-9 * factor);
    }
  }
}

TEST(UnitChanges, ATakeOfOneUnitHasNone) {
  for (std::uint64_t seed = 0; seed < kUnitSeeds; ++seed)
    EXPECT_TRUE(FindUnitChanges(RandomPerson(seed).view()).empty());
}

/// Within a box of a few millimetres: about a hundredth of a body.
TEST(UnitChanges, CoincidingJointsAreNotABodyOfAnotherUnit) {
  for (std::uint64_t seed = 0; seed < kUnitSeeds; ++seed) {
    for (const double reach : {0.001, 0.005, 0.009}) {
      Take take = RandomPerson(seed);
      Random random(seed, "place", "");
      for (int f = 40; f < 60; ++f) {
        const Vector3d place = take.positions.at(f, 0);
        for (int k = 0; k < take.positions.joints; ++k) {
          const Vector3d off(random.Uniform(), random.Uniform(), random.Uniform());
          take.positions.at(f, k) = place + reach * off;
        }
      }
      EXPECT_TRUE(FindUnitChanges(take.view()).empty()) << "seed " << seed << ", within " << reach;
      const std::vector<Finding> blanks = FindBlanks(take.view());
      ASSERT_EQ(blanks.size(), 1u);
      EXPECT_EQ(blanks[0].code, "collapsed_frames");
      EXPECT_EQ(blanks[0].frame_begin, 40);
      EXPECT_EQ(blanks[0].frame_end, 60);
    }
  }
}

}  // namespace
}  // namespace mocurate::test
