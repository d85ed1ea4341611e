// Inserted defects are found at their frames, for different bodies and motions; takes without defects have no finding.

#include <gtest/gtest.h>

#include "core/quality/rate.h"
#include "tests/quality/recorded_people.h"

namespace mocurate::test {
namespace {

TEST(Defects, ATakeWithoutDefectsHasNone) {
  for (std::uint64_t seed = 0; seed < 4 * kSeeds; ++seed) {
    const TakeOptions who = RecordedPerson(seed);
    EXPECT_TRUE(Only("none", Perform(seed, who), who.rate_hz).empty()) << "seed " << seed;
  }
}

TEST(Defects, AStreamThatHangsIsFoundFrameForFrame) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const TakeOptions who = RecordedPerson(seed);
    Take take = Perform(seed, who);
    const int begin = 5 + static_cast<int>(seed), length = 2 + static_cast<int>(seed % 7);
    for (int f = begin + 1; f < begin + length; ++f) {
      for (int k = 0; k < take.positions.joints; ++k) take.positions.at(f, k) = take.positions.at(begin, k).eval();
    }
    const auto found = Only("frozen_frames", take, who.rate_hz);
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].frame_begin, begin);
    EXPECT_EQ(found[0].frame_end, begin + length);
    EXPECT_EQ(found[0].value, length);
    EXPECT_EQ(found[0].severity, length == 2 ? Severity::kInfo : Severity::kWarning);
  }
}

/// 30 Hz in a file of 60 or 90, or of 72 (some frames twice, some three times): the stream does not hang.
TEST(Defects, FramesRepeatedThroughoutAreReportedOnce) {
  for (const auto& [each, more] : {std::pair{2, 0}, {3, 0}, {2, 1}}) {
    const TakeOptions who = RecordedPerson(3);
    const Take once = Perform(3, who);
    std::vector<int> from;
    for (int f = 0; f < once.positions.frames; ++f) from.insert(from.end(), each + (f % 2 == 0 ? more : 0), f);
    Take take = once;
    take.positions = JointPositions(static_cast<int>(from.size()), once.positions.joints);
    take.confidence.clear();
    take.time_s.clear();
    for (std::size_t f = 0; f < from.size(); ++f) {
      take.time_s.push_back(static_cast<double>(f) / who.rate_hz / each);
      for (int k = 0; k < once.positions.joints; ++k)
        take.positions.at(static_cast<int>(f), k) = once.positions.at(from[f], k).eval();
    }
    const std::vector<Finding> found = FindRepeats(take.view());
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].code, "repeated_frames");
    EXPECT_NEAR(found[0].value, each + 0.5 * more, 0.01);
  }
}

/// 9 frames twice, one 900 times, 30 once: this is not a constant lower rate.
TEST(Defects, AStreamThatHangsForMostOfAClipIsNotALowerRate) {
  const Take once = Perform(3, {});
  std::vector<int> from;
  for (int f = 0; f < 40; ++f) from.insert(from.end(), f < 9 ? 2 : f == 9 ? 900 : 1, f);
  Take take = once;
  take.positions = JointPositions(static_cast<int>(from.size()), once.positions.joints);
  take.confidence.clear();
  take.time_s.clear();
  for (std::size_t f = 0; f < from.size(); ++f) {
    take.time_s.push_back(static_cast<double>(f) / 30.0);
    for (int k = 0; k < once.positions.joints; ++k)
      take.positions.at(static_cast<int>(f), k) = once.positions.at(from[f], k).eval();
  }
  const std::vector<Finding> found = FindRepeats(take.view());
  ASSERT_EQ(found.size(), 10u);
  for (const Finding& finding : found) EXPECT_EQ(finding.code, "frozen_frames");
  EXPECT_EQ(found.back().frame_begin, 18);
  EXPECT_EQ(found.back().value, 900.0);
}

TEST(Defects, AGapFilledWithTheLastValueIsARepeatedValueAndTwoEqualSamplesAreNot) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const TakeOptions who = RecordedPerson(seed);
    Take take = Perform(seed, who);
    const int joint = static_cast<int>(seed % 20), begin = 4 + static_cast<int>(seed);
    const int length = 2 + static_cast<int>(seed % 6);
    for (int f = begin + 1; f < begin + length; ++f)
      take.positions.at(f, joint) = take.positions.at(begin, joint).eval();
    const auto found = Only("repeated_value", take, who.rate_hz);
    ASSERT_EQ(found.size(), length >= 3 ? 1u : 0u) << "seed " << seed;
    if (found.empty()) continue;
    EXPECT_EQ(found[0].joint, take.names[static_cast<std::size_t>(joint)]);
    EXPECT_EQ(found[0].frame_begin, begin);
    EXPECT_EQ(found[0].frame_end, begin + length);
  }
}

TEST(Defects, AJointRepeatedThroughoutIsFoundAndAFixedRootIsNot) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const TakeOptions who = RecordedPerson(seed);
    Take take = Perform(seed, who);
    const int joint = 1 + static_cast<int>(seed % 18);
    for (int f = 1; f < who.frames; ++f) take.positions.at(f, joint) = take.positions.at(0, joint).eval();
    const std::vector<Finding> found = FindRepeats(take.view());
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].code, "repeated_value");
    EXPECT_EQ(found[0].joint, take.names[static_cast<std::size_t>(joint)]);
    EXPECT_EQ(found[0].frame_begin, 0);
    EXPECT_EQ(found[0].frame_end, who.frames);
    // As the root of a tree, with another joint fixed to it.
    const int bound = joint + 1;
    for (int f = 1; f < who.frames; ++f) take.positions.at(f, bound) = take.positions.at(0, bound).eval();
    std::vector<int> parents(20, joint);
    parents[static_cast<std::size_t>(joint)] = -1;
    const TrackedPoints tree{take.positions, take.confidence, take.time_s, take.names, parents};
    EXPECT_TRUE(FindRepeats(tree).empty()) << "seed " << seed;
  }
}

/// Samples rounded as in a file of whole numbers.
Take Rounded(Take take, double step) {
  for (double& value : take.positions.xyz) value = step * std::round(value / step);
  return take;
}

TEST(Defects, SamplesOnACoarseGridRepeatByChanceAndAFilledGapIsReportedThereToo) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    TakeOptions who = RecordedPerson(seed);
    who.noise = 0.0005;
    who.walk = 0.0;
    for (const Finding& finding : CheckPoints(Rounded(Perform(seed, who), 0.01).view(), who.rate_hz))
      EXPECT_NE(finding.code, "repeated_value") << seed;
    who.walk = 1.0;
    Take take = Rounded(Perform(seed, who), 0.001);
    EXPECT_TRUE(Only("repeated_value", take, who.rate_hz).empty()) << seed;
    const int joint = static_cast<int>(seed % 20), begin = 10 + static_cast<int>(seed);
    for (int f = begin + 1; f < begin + 6; ++f) take.positions.at(f, joint) = take.positions.at(begin, joint).eval();
    const auto found = Only("repeated_value", take, who.rate_hz);
    ASSERT_EQ(found.size(), 1u) << seed;
    EXPECT_EQ(found[0].joint, take.names[static_cast<std::size_t>(joint)]);
  }
}

TEST(Defects, APlantedFootInNoiselessMotionIsNotAFilledGap) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    TakeOptions who = RecordedPerson(seed);
    who.noise = 0.0;
    Take take = Perform(seed, who);
    // One foot lands within a frame, two joints stop softly, as at the end of a keyframed walk.
    const int foot = take.Joint("left_foot"), begin = 20 + static_cast<int>(seed);
    for (int f = begin + 1; f < begin + 4; ++f) take.positions.at(f, foot) = take.positions.at(begin, foot).eval();
    for (const char* joint : {"left_knee", "right_hand"}) {
      const int k = take.Joint(joint);
      const Vector3d end = take.positions.at(who.frames - 1, k);
      for (int f = who.frames - 12; f < who.frames; ++f) {
        const double rest = std::max(0.0, (who.frames - 7 - f) / 5.0);
        take.positions.at(f, k) = end + Vector3d(0, 0, -0.1 * rest * rest * rest);
      }
    }
    for (const Finding& finding : CheckPoints(take.view(), who.rate_hz))
      EXPECT_NE(finding.code, "repeated_value") << seed;
  }
}

TEST(Defects, ZeroFramesAndZeroJointsAreFoundAndAMissingOneIsNeither) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const TakeOptions who = RecordedPerson(seed);
    Take take = Perform(seed, who);
    const int begin = 3 + static_cast<int>(seed);
    for (int f = begin; f < begin + 4; ++f) {
      for (int k = 0; k < take.positions.joints; ++k) take.positions.at(f, k).setZero();
    }
    const auto found = Only("zero_frames", take, who.rate_hz);
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].frame_begin, begin);
    EXPECT_EQ(found[0].frame_end, begin + 4);
    for (int f = begin; f < begin + 4; ++f) {
      for (int k = 0; k < take.positions.joints; ++k)
        take.confidence[static_cast<std::size_t>(f) * 20 + static_cast<std::size_t>(k)] = 0.0;
    }
    EXPECT_TRUE(Only("none", take, who.rate_hz).empty()) << "missing samples are not a defect";
  }
}

TEST(Defects, OneJointAtTheOriginIsFound) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Take take = Perform(seed, {});
    const int joint = static_cast<int>(seed % 20);
    take.positions.at(40, joint).setZero();
    const auto found = Only("zero_joint", take, 30.0);
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].joint, take.names[static_cast<std::size_t>(joint)]);
    EXPECT_EQ(found[0].frame_begin, 40);
    EXPECT_EQ(found[0].frame_end, 41);
  }
}

TEST(Defects, SwappedSidesAreFoundInTheirFrames) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    TakeOptions who = RecordedPerson(seed);
    who.noise = 0.01;
    Take take = Perform(seed, who);
    const bool arms = seed % 3 != 1, legs = seed % 3 != 0;
    const int begin = seed % 4 == 3 ? 0 : 10 + static_cast<int>(seed % 10), length = 1 + static_cast<int>(seed % 8);
    Exchange(take, begin, begin + length, arms, legs);
    const auto found = Only("swapped_sides", take, who.rate_hz);
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].frame_begin, begin);
    EXPECT_EQ(found[0].frame_end, begin + length);
  }
}

TEST(Defects, HalfAStrideOfLostFramesIsNotASwapOfTheLegs) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    for (const int lost : {10, 15, 20}) {
      TakeOptions who;
      who.walk = 1.2;
      Take take = Perform(seed, who);
      const auto joints = static_cast<std::ptrdiff_t>(take.positions.xyz.size()) / who.frames;
      auto& xyz = take.positions.xyz;
      xyz.erase(xyz.begin() + 40 * joints, xyz.begin() + (40 + lost) * joints);
      take.positions.frames -= lost;
      take.time_s.resize(take.time_s.size() - static_cast<std::size_t>(lost));
      for (const Finding& finding : CheckPoints(take.view(), who.rate_hz))
        EXPECT_NE(finding.code, "swapped_sides") << seed;
    }
  }
}

TEST(Defects, ASwapWhoseChangeBackIsLostEndsWhereTheLimbsLieAsBefore) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    TakeOptions who = RecordedPerson(seed);
    who.rate_hz = 60.0;
    who.noise = 0.01;
    Take take = Perform(seed, who);
    const bool at_begin = seed % 2 == 0;
    const int begin = 20 + static_cast<int>(seed % 10), lost = at_begin ? begin : begin + 2;
    Exchange(take, begin, begin + 2, true, true);
    // In the first frame of the new state the limbs are outliers, so that neither assignment of the sides fits.
    for (std::size_t k = 5; k < take.names.size(); ++k) {
      const int stray = static_cast<int>(k), away = k % 2 == 0 ? 1 : -1;
      if (k != 8 && k != 12 && k != 16) take.positions.at(lost, stray) += Vector3d(0.2 * away, 0.5, 0.4 * away);
    }
    int found = 0;
    for (const Finding& finding : CheckPoints(take.view(), who.rate_hz)) {
      if (finding.code != "swapped_sides") continue;
      ++found;
      EXPECT_GE(finding.frame_begin, begin) << seed;
      EXPECT_LE(finding.frame_end, begin + 3) << seed << ": " << finding.message;
    }
    EXPECT_GE(found, 1) << seed;
  }
}

TEST(Defects, LieParametersAreNotJointPositionsAndGetNoFurtherChecks) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Take take = Perform(seed, {});
    Random random(seed, "lie", "");
    std::vector<double> mean(60);
    for (double& value : mean) value = random.Normal();
    for (std::size_t i = 0; i < take.positions.xyz.size(); ++i) {
      const double swing = std::sin(0.07 * static_cast<double>(i / 60) + mean[i % 60]);
      take.positions.xyz[i] = std::remainder(mean[i % 60] + 0.1 * swing + 0.01 * random.Normal(), 6.28);
    }
    const auto found = Only("not_joint_positions", take, 30.0);
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].severity, Severity::kError);
  }
}

TEST(Defects, HoppingRevealsARateThatIsTooHigh) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    TakeOptions who;
    who.rate_hz = seed % 2 == 0 ? 60.0 : 30.0;
    who.frames = static_cast<int>(3.0 * who.rate_hz);
    who.noise = 0.002;
    who.stature = 0.7 + 0.02 * static_cast<double>(seed);
    who.hop_s = 0.3 + 0.01 * static_cast<double>(seed % 10);
    Take take = Perform(seed, who);
    EXPECT_TRUE(Only("none", take, who.rate_hz).empty()) << "seed " << seed;
    for (const double factor : {2.0, 4.0}) {
      Take marked = take;
      for (double& time : marked.time_s) time /= factor;
      const auto found = Only("rate_suspect", marked, factor * who.rate_hz);
      ASSERT_EQ(found.size(), 1u) << "seed " << seed << " factor " << factor;
      EXPECT_GE(found[0].value, who.rate_hz) << "the highest rate that the motion allows";
    }
  }
}

TEST(Defects, WalkingAsAnInvertedPendulumRevealsARateThatIsTooHighOrTooLow) {
  for (const double rate : {30.0, 60.0, 120.0}) {
    const Take take = WalkAsAPendulum(rate, 4.0);
    const RateLimits limits = MeasureRate(take.view());
    EXPECT_TRUE(limits.Allows(rate)) << rate << ": " << limits.evidence;
    for (const double factor : {0.125, 0.25, 0.5, 3.0, 4.0, 8.0}) {
      EXPECT_FALSE(limits.Allows(factor * rate)) << rate << " marked " << factor * rate << ": " << limits.evidence;
    }
  }
}

TEST(Defects, PuppetMotionNeverReportsARateThatIsTooLow) {
  for (std::uint64_t seed = 0; seed < 2 * kSeeds; ++seed) {
    const TakeOptions who = RecordedPerson(seed);
    const RateLimits limits = MeasureRate(Perform(seed, who).view());
    EXPECT_EQ(limits.lowest, 0.0) << "seed " << seed << ": " << limits.evidence;
    EXPECT_TRUE(limits.Allows(who.rate_hz)) << "seed " << seed << ": " << limits.evidence;
  }
}

TEST(Defects, AnImpossibleAccelerationOfAHandReportsARateThatIsTooHigh) {
  TakeOptions who;
  who.rate_hz = 60.0;
  who.frames = 180;
  who.noise = 1e-4;
  who.walk = 0.0;
  Take take = Perform(4, who);
  const int hand = take.Joint("left_wrist");
  for (int f = 0; f < who.frames; ++f)
    take.positions.at(f, hand).y() += 0.25 * std::sin(6.0 * M_PI * f / who.rate_hz);  // 89 m/s2
  EXPECT_TRUE(MeasureRate(take.view()).Allows(60.0));
  EXPECT_FALSE(MeasureRate(take.view()).Allows(240.0));
  EXPECT_NEAR(MeasureRate(take.view()).highest, 80.0, 8.0);
}

TEST(Defects, WithoutAConstantRateNothingIsMeasured) {
  Take take = WalkAsAPendulum(60.0, 4.0);
  for (std::size_t f = 100; f < take.time_s.size(); ++f) take.time_s[f] += 0.5;
  EXPECT_FALSE(MeasureRate(take.view()).IsConclusive());
}

TEST(Defects, ManyFindingsOfOneCodeAreCountedNotListed) {
  Take take = Perform(3, {});
  for (int f = 0; f + 4 < take.positions.frames; f += 4) {
    for (int i = 1; i < 3; ++i) take.positions.at(f + i, 7) = take.positions.at(f, 7).eval();
  }
  CheckLimits limits;
  limits.most_per_code = 5;
  const auto found = CheckPoints(take.view(), 30.0, limits);
  ASSERT_EQ(found.size(), 6u);
  EXPECT_EQ(found.back().value, 17.0) << "22 holds, of which 5 are listed";
  EXPECT_DOUBLE_EQ(CoveredShare(found, "repeated_value", 90), 82.0 / 90.0) << "5 times 3, and all from the sixth on";
}

}  // namespace
}  // namespace mocurate::test
