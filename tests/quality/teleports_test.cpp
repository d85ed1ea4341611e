// Implausible jumps of a person or a joint.

#include "tests/quality/recorded_people.h"

namespace mocurate::test {
namespace {

TEST(Teleports, FiveFramesAKilometreAwayAreAPositionJumpAndSoIsAMetreAndAHalf) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    TakeOptions who = RecordedPerson(seed);
    Take take = Perform(seed, who);
    const double far = seed % 2 == 0 ? 1000.0 : 1.5;
    const int begin = seed % 5 == 0 ? 0 : 10 + static_cast<int>(seed), length = 1 + static_cast<int>(seed % 5);
    for (int f = begin; f < begin + length; ++f) {
      for (int k = 0; k < take.positions.joints; ++k) take.positions.at(f, k).x() += far;
    }
    const auto found = Only("position_jump", take, who.rate_hz);
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].frame_begin, begin);
    EXPECT_EQ(found[0].frame_end, begin + length);
    EXPECT_NEAR(found[0].value, far, 0.5);
  }
}

/// A standing person does not move half a metre in a thirtieth of a second. Without a return, the wrong side of the
/// jump is ambiguous.
TEST(Teleports, HalfAMetreInOneFrameIsAPositionJumpOrAJump) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    TakeOptions who = RecordedPerson(seed);
    who.frames = 90;
    const Take given = Perform(seed, who);
    ASSERT_TRUE(Only("position_jump", given, who.rate_hz).empty()) << "seed " << seed;
    const double far = 0.3 + 50.0 / (who.rate_hz * who.rate_hz);
    const auto moved = [&](int begin, int end) {
      Take take = given;
      for (int f = begin; f < end; ++f) {
        for (int k = 0; k < take.positions.joints; ++k) take.positions.at(f, k).x() += far;
      }
      return take;
    };
    for (const int end : {41, 43, 50}) {
      const auto found = Only("position_jump", moved(40, end), who.rate_hz);
      ASSERT_EQ(found.size(), 1u) << "seed " << seed << " to " << end;
      EXPECT_EQ(found[0].frame_begin, 40);
      EXPECT_EQ(found[0].frame_end, end);
    }
    for (const int end : {30, 60, 89}) {
      const auto found = Only("unrecovered_jump", moved(0, end), who.rate_hz);
      ASSERT_EQ(found.size(), 1u) << "seed " << seed << " to " << end;
      EXPECT_EQ(found[0].frame_begin, end - 1);
      EXPECT_EQ(found[0].frame_end, end + 1);
      EXPECT_NEAR(found[0].value, far, 0.2);
    }
  }
}

/// The centre of the observed points moves, the person does not.
TEST(Teleports, APersonReducedToTheLegsHasNotMovedAndAJumpOfEightyCentimetresIsFound) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    TakeOptions who = RecordedPerson(seed);
    who.frames = 90;
    Take take = Perform(seed, who);
    take.confidence.assign(static_cast<std::size_t>(take.positions.frames * take.positions.joints), 1.0);
    const auto see_only = [&](int begin, int end, bool legs) {
      for (int f = begin; f < end; ++f) {
        for (int k = 0; k < take.positions.joints; ++k) {
          const std::string& name = take.names[static_cast<std::size_t>(k)];
          const bool of_legs = name.find("knee") != std::string::npos || name.find("ankle") != std::string::npos ||
                               name.find("foot") != std::string::npos;
          take.confidence[static_cast<std::size_t>(f * take.positions.joints + k)] = of_legs == legs ? 1.0 : 0.0;
        }
      }
    };
    see_only(40, 60, true);
    if (seed % 2 == 1) see_only(60, 70, false);
    EXPECT_TRUE(Only("position_jump", take, who.rate_hz).empty()) << "seed " << seed;
    for (int f = 45; f < 50; ++f) {
      for (int k = 0; k < take.positions.joints; ++k) take.positions.at(f, k).x() += 0.8 + 12.0 / who.rate_hz;
    }
    const auto found = Only("position_jump", take, who.rate_hz);
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].frame_begin, 45);
    EXPECT_EQ(found[0].frame_end, 50);
  }
}

TEST(Teleports, TheRootAloneFarAwayIsAJointFarFromItsBody) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const TakeOptions who = RecordedPerson(seed);
    Take take = Perform(seed, who);
    for (int f = 20; f < 25; ++f) take.positions.at(f, 0).z() += 1000.0;
    const auto found = Only("joint_far", take, who.rate_hz);
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].joint, "hip_center");
    EXPECT_EQ(found[0].frame_begin, 20);
    EXPECT_EQ(found[0].frame_end, 25);
    EXPECT_NEAR(found[0].value, 1000.0, 2.0);
  }
}

}  // namespace
}  // namespace mocurate::test
