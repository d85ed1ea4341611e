// Frames whose axes are not those of the others are told from what people do, and from sides that a tracker exchanged.

#include "core/quality/axes_changes.h"

#include <gtest/gtest.h>

#include "tests/quality/people.h"

namespace mocurate::test {
namespace {

constexpr std::uint64_t kTurnedSeeds = 24;

Take Walker(std::uint64_t seed) {
  TakeOptions options;
  options.rate_hz = 60.0;
  options.noise = 0.001 * static_cast<double>(1 + seed % 10);
  return Perform(seed, options);
}

void Change(const Matrix3d& change, int begin, int end, Take& take) {
  for (int f = begin; f < end; ++f) {
    for (int k = 0; k < take.positions.joints; ++k)
      take.positions.at(f, k) = (change * Vector3d(take.positions.at(f, k))).eval();
  }
}

TEST(AxesChanges, APersonWhoIsUpsideDownFromSomeFrameOnIsTold) {
  for (std::uint64_t seed = 0; seed < kTurnedSeeds; ++seed) {
    for (const Vector3d& signs : {Vector3d(1, -1, 1), Vector3d(-1, -1, 1), Vector3d(1, -1, -1)}) {
      Take take = Walker(seed);
      const int begin = take.positions.frames / 2 + static_cast<int>(seed);
      Change(signs.asDiagonal(), begin, take.positions.frames, take);
      const std::vector<Finding> found = FindAxesChanges(take.view());
      ASSERT_EQ(found.size(), 1u) << "seed " << seed << ", signs " << signs.transpose();
      EXPECT_EQ(found[0].code, "axes_change");
      EXPECT_EQ(found[0].frame_begin, begin);
      EXPECT_EQ(found[0].frame_end, take.positions.frames);
      EXPECT_EQ(found[0].value, signs.prod());
    }
  }
}

/// Who walks in a mirror plane, with limbs alike on both sides, is then as one whose sides were exchanged.
TEST(AxesChanges, APersonBesideTheMirrorIsToldToBeMirroredFromSomeFrameOn) {
  for (std::uint64_t seed = 0; seed < kTurnedSeeds; ++seed) {
    Take take = Walker(seed);
    for (int f = 0; f < take.positions.frames; ++f) {
      for (int k = 0; k < take.positions.joints; ++k) take.positions.at(f, k) += Vector3d(0.5, 0.0, 0.0);
    }
    Change(Vector3d(-1, 1, 1).asDiagonal(), 50, take.positions.frames, take);
    const std::vector<Finding> found = FindAxesChanges(take.view());
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].value, -1.0);
  }
}

TEST(AxesChanges, FramesWithZUpAmongFramesWithYUpAreToldFromFirstToLast) {
  Matrix3d z_up;
  z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  for (std::uint64_t seed = 0; seed < kTurnedSeeds; ++seed) {
    Take take = Walker(seed);
    Change(z_up, 10, 30, take);
    const std::vector<Finding> found = FindAxesChanges(take.view());
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].frame_begin, 10);
    EXPECT_EQ(found[0].frame_end, 30);
    EXPECT_NE(found[0].message.find("y is -z, z is y"), std::string::npos) << found[0].message;
  }
}

TEST(AxesChanges, PeopleWhoMoveHaveNone) {
  for (std::uint64_t seed = 0; seed < kTurnedSeeds; ++seed) {
    for (const double rate : {10.0, 30.0, 120.0}) {
      TakeOptions options;
      options.rate_hz = rate;
      options.noise = 0.02;
      EXPECT_TRUE(FindAxesChanges(Perform(seed, options).view()).empty()) << "seed " << seed << ", " << rate << " Hz";
    }
  }
}

TEST(AxesChanges, SidesThatATrackerExchangedAreNoMirror) {
  for (std::uint64_t seed = 0; seed < kTurnedSeeds; ++seed) {
    Take take = Walker(seed);
    for (int f = 40; f < take.positions.frames; ++f) {
      for (const char* part : {"shoulder", "elbow", "wrist", "hand", "hip", "knee", "ankle", "foot"}) {
        const int left = take.Joint(std::string("left_") + part), right = take.Joint(std::string("right_") + part);
        const Vector3d place = take.positions.at(f, left);
        take.positions.at(f, left) = Vector3d(take.positions.at(f, right));
        take.positions.at(f, right) = place;
      }
    }
    EXPECT_TRUE(FindAxesChanges(take.view()).empty()) << "seed " << seed;
  }
}

TEST(AxesChanges, ScatteredPointsHaveNone) {
  for (std::uint64_t seed = 0; seed < kTurnedSeeds; ++seed) {
    Take take = Walker(seed);
    Random random(seed, "scatter", "");
    for (int f = 40; f < 60; ++f) {
      for (int k = 0; k < take.positions.joints; ++k)
        take.positions.at(f, k) = Vector3d(random.Uniform(), random.Uniform(), random.Uniform());
    }
    EXPECT_TRUE(FindAxesChanges(take.view()).empty()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace mocurate::test
