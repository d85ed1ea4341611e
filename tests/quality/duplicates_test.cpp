#include "core/quality/duplicates.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/quality/people.h"

namespace mocurate::test {
namespace {

MotionSignature Of(const Take& take) { return SignatureOf(take.view()); }

/// Rotated about y, translated, and rounded as by another exporter.
Take Elsewhere(Take take, double angle, double round_to) {
  for (int f = 0; f < take.positions.frames; ++f) {
    for (int k = 0; k < take.positions.joints; ++k) {
      const Vector3d p = take.positions.at(f, k);
      const Vector3d moved(std::cos(angle) * p.x() + std::sin(angle) * p.z() + 3.0, p.y() + 0.2,
                           std::cos(angle) * p.z() - std::sin(angle) * p.x() - 1.0);
      for (int i = 0; i < 3; ++i) take.positions.at(f, k)[i] = std::round(moved[i] / round_to) * round_to;
    }
  }
  return take;
}

/// Every second frame: half the rate.
Take Thinned(const Take& take) {
  Take thin = take;
  thin.positions = JointPositions((take.positions.frames + 1) / 2, take.positions.joints);
  thin.time_s.clear();
  for (int f = 0; f < thin.positions.frames; ++f) {
    thin.time_s.push_back(take.time_s[static_cast<std::size_t>(2 * f)]);
    for (int k = 0; k < take.positions.joints; ++k) thin.positions.at(f, k) = take.positions.at(2 * f, k).eval();
  }
  thin.confidence.resize(static_cast<std::size_t>(thin.positions.frames) * 20);
  return thin;
}

Take Part(const Take& take, int begin, int end) {
  Take part = take;
  part.positions = JointPositions(end - begin, take.positions.joints);
  part.time_s.clear();
  for (int f = begin; f < end; ++f) {
    part.time_s.push_back((f - begin) / 30.0);
    for (int k = 0; k < take.positions.joints; ++k) part.positions.at(f - begin, k) = take.positions.at(f, k).eval();
  }
  part.confidence.resize(static_cast<std::size_t>(end - begin) * 20);
  return part;
}

Take Mirrored(Take take) {
  for (int f = 0; f < take.positions.frames; ++f) {
    for (int k = 0; k < take.positions.joints; ++k) take.positions.at(f, k).x() *= -1.0;
  }
  Exchange(take, 0, take.positions.frames, true, true);
  return take;
}

TEST(Duplicates, ACopyTransformedRoundedSubsampledOrMirroredIsFound) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    TakeOptions who;
    who.frames = 61 + 2 * static_cast<int>(seed);
    who.noise = 0.002;
    who.stature = 0.8 + 0.03 * static_cast<double>(seed);
    const Take take = Perform(seed, who);
    std::vector<MotionSignature> clips;
    for (std::uint64_t other = 100; other < 120; ++other) clips.push_back(Of(Perform(other, who)));
    clips.push_back(Of(take));  // 20
    EXPECT_TRUE(FindDuplicates(clips).empty()) << "people with similar walks are not duplicates";
    clips.push_back(Of(Elsewhere(take, 0.3 + static_cast<double>(seed), 1e-3)));
    clips.push_back(Of(Thinned(take)));
    clips.push_back(Of(Mirrored(take)));
    bool elsewhere = false, thinned = false, mirrored = false;
    for (const Duplicate& pair : FindDuplicates(clips)) {
      ASSERT_GE(pair.first, 20u) << "seed " << seed;
      if (pair.first != 20) continue;
      elsewhere |= pair.second == 21 && pair.whole && !pair.mirrored;
      thinned |= pair.second == 22 && pair.whole && !pair.mirrored;
      mirrored |= pair.second == 23 && pair.whole && pair.mirrored;
    }
    EXPECT_TRUE(elsewhere && thinned && mirrored) << "seed " << seed << elsewhere << thinned << mirrored;
  }
}

TEST(Duplicates, TwoCutsOfOneRecordingShareTheFramesTheyOverlapIn) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Take take = Perform(seed, {});
    const int overlap = 4 + static_cast<int>(seed);
    const auto found = FindDuplicates(
        {Of(Part(take, 0, 50)), Of(Perform(seed + 50, {})), Of(Elsewhere(Part(take, 50 - overlap, 90), 1.0, 1e-9))});
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_FALSE(found[0].whole);
    EXPECT_EQ(found[0].first, 0u);
    EXPECT_EQ(found[0].second, 2u);
    EXPECT_NEAR(found[0].shared, overlap, 1.0) << "a distance may be rounded differently";
    EXPECT_NEAR(found[0].frame_begin, 50 - overlap, 1.0);
    EXPECT_EQ(found[0].second_begin, found[0].frame_begin - (50 - overlap));
  }
}

TEST(Duplicates, MotionlessClipsAreNotDuplicates) {
  TakeOptions still;
  still.noise = 0.001;
  still.walk = 0.0;
  std::vector<MotionSignature> clips;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Take take = Perform(1, still);
    Random random(seed, "still", "");
    for (int f = 0; f < take.positions.frames; ++f) {
      for (int k = 0; k < take.positions.joints; ++k) {
        take.positions.at(f, k) = take.positions.at(0, k).eval();
      }
    }
    for (double& value : take.positions.xyz) value += 0.001 * random.Normal();
    clips.push_back(Of(take));
  }
  EXPECT_TRUE(FindDuplicates(clips).empty());
}

TEST(Duplicates, AWrongUnitDoesNotChangeTheResult) {
  for (const double scale : {1e-3, 1e-2, 1.0, 1e3}) {
    std::vector<MotionSignature> clips;
    for (const std::uint64_t seed : {1u, 2u, 3u, 1u}) {
      Take take = Perform(seed);
      for (double& value : take.positions.xyz) value *= scale;
      clips.push_back(Of(take));
    }
    const auto found = FindDuplicates(clips);
    ASSERT_EQ(found.size(), 1u) << scale;
    EXPECT_EQ(found[0].first, 0u);
    EXPECT_EQ(found[0].second, 3u);
    EXPECT_TRUE(found[0].whole && !found[0].mirrored);
  }
}

TEST(Duplicates, AnExactCopyOfStillClipsIsFoundByItsFrames) {
  Take take = Perform(1, {});
  const auto found = FindDuplicates({Of(take), Of(take)});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].whole && !found[0].mirrored);
  EXPECT_EQ(found[0].distance, 0.0);
  EXPECT_EQ(found[0].shared, 90);
}

}  // namespace
}  // namespace mocurate::test
