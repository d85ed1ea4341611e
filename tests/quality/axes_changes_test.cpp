// Frames with other axes are distinguished from human motion and from left-right exchanges by a tracker.

#include "core/quality/axes_changes.h"

#include <gtest/gtest.h>

#include "tests/quality/people.h"

namespace mocurate::test {
namespace {

constexpr std::uint64_t kTurnedSeeds = 24;
constexpr std::uint64_t kManySeeds = 200;

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

TEST(AxesChanges, APersonUpsideDownFromSomeFrameOnIsReported) {
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

/// A symmetric walker in the mirror plane would look like one with exchanged sides.
TEST(AxesChanges, APersonMirroredFromSomeFrameOnIsReported) {
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

TEST(AxesChanges, FramesWithZUpAmongFramesWithYUpAreReportedFromFirstToLast) {
  Matrix3d z_up;
  z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  for (std::uint64_t seed = 0; seed < kTurnedSeeds; ++seed) {
    Take take = Walker(seed);
    Change(z_up, 10, 30, take);
    const std::vector<Finding> found = FindAxesChanges(take.view());
    ASSERT_EQ(found.size(), 1u) << "seed " << seed;
    EXPECT_EQ(found[0].frame_begin, 10);
    EXPECT_EQ(found[0].frame_end, 30);
    EXPECT_EQ(found[0].value, 1.0) << "rotated, not mirrored";
  }
}

TEST(AxesChanges, MovingPeopleHaveNone) {
  for (std::uint64_t seed = 0; seed < kTurnedSeeds; ++seed) {
    for (const double rate : {10.0, 30.0, 120.0}) {
      TakeOptions options;
      options.rate_hz = rate;
      options.noise = 0.02;
      EXPECT_TRUE(FindAxesChanges(Perform(seed, options).view()).empty()) << "seed " << seed << ", " << rate << " Hz";
    }
  }
}

void ExchangeSides(int begin, int end, Take& take) {
  for (const char* part : {"shoulder", "elbow", "wrist", "hand", "hip", "knee", "ankle", "foot"}) {
    const int left = take.Joint(std::string("left_") + part), right = take.Joint(std::string("right_") + part);
    for (int f = begin; f < end; ++f) {
      const Vector3d place = take.positions.at(f, left);
      take.positions.at(f, left) = Vector3d(take.positions.at(f, right));
      take.positions.at(f, right) = place;
    }
  }
}

/// A person who moves symmetrically, as in a bow or a squat: each frame is nearly its own mirror image.
Take Symmetric(std::uint64_t seed, double noise, double walk) {
  TakeOptions options;
  options.noise = 0.0;
  options.walk = walk;
  Take take = Perform(seed, options);
  Random random(seed, "noise", "");
  for (int k = 0; k < take.positions.joints; ++k) {
    const std::string& name = take.names[static_cast<std::size_t>(k)];
    if (name.rfind("left", 0) != 0) continue;
    const int other = take.Joint("right" + name.substr(4));
    for (int f = 0; f < take.positions.frames; ++f) {
      const Vector3d place = take.positions.at(f, k);
      take.positions.at(f, other) = Vector3d(-place.x(), place.y(), place.z());
    }
  }
  for (double& value : take.positions.xyz) value += noise * random.Normal();
  return take;
}

/// A tracker that loses joints for some frames and misplaces others.
void Track(std::uint64_t seed, Take& take) {
  Random random(seed, "tracker", "");
  for (int k = 0; k < take.positions.joints; ++k) {
    int lost = 0;
    for (int f = 0; f < take.positions.frames; ++f) {
      if (lost == 0 && random.Uniform() < 0.03) lost = 1 + static_cast<int>(8.0 * random.Uniform());
      if (lost > 0) {
        --lost;
        take.confidence[static_cast<std::size_t>(f) * static_cast<std::size_t>(take.positions.joints) +
                        static_cast<std::size_t>(k)] = 0.0;
      }
      if (random.Uniform() < 0.02) take.positions.at(f, k) += 0.2 * Vector3d(random.Normal(), random.Normal(), 1.0);
    }
  }
}

TEST(AxesChanges, ExchangedSidesAreNotAMirrorImage) {
  for (std::uint64_t seed = 0; seed < kTurnedSeeds; ++seed) {
    Take take = Walker(seed);
    ExchangeSides(40, take.positions.frames, take);
    EXPECT_TRUE(FindAxesChanges(take.view()).empty()) << "seed " << seed;
  }
}

/// At a clip's start, in its middle and at its end, of nearly symmetric people, for one frame and for several.
TEST(AxesChanges, SidesExchangedForSomeFramesAreNotAMirrorImageEvenWithLostJoints) {
  const int frames = TakeOptions().frames, last = frames - 1;
  for (std::uint64_t seed = 0; seed < kManySeeds; ++seed) {
    for (const int begin : {0, 9, 45, last - 9, last}) {
      for (const double walk : {0.0, 1.0}) {
        Take take = Symmetric(seed, 0.01, walk);
        ExchangeSides(begin, std::min(begin + 1 + static_cast<int>(seed % 4), frames), take);
        Track(seed, take);
        const std::vector<Finding> found = FindAxesChanges(take.view());
        EXPECT_TRUE(found.empty()) << "seed " << seed << " from " << begin << ": " << found[0].frame_begin << "-"
                                   << found[0].frame_end << " " << found[0].message;
      }
    }
  }
}

/// A change within unusable frames may be missed, but correct frames are not reported for it.
TEST(AxesChanges, TheSpanOfOtherAxesIsExactEvenWithLostJointsOrFrames) {
  TakeOptions options;
  options.noise = 0.01;
  int takes = 0, missed = 0;
  for (std::uint64_t seed = 0; seed < kManySeeds; ++seed) {
    for (const auto& [begin, end] : {std::pair(0, 20), std::pair(30, 45), std::pair(70, options.frames)}) {
      for (const Vector3d& signs : {Vector3d(1, -1, 1), Vector3d(-1, -1, 1)}) {
        Take take = Perform(seed, options);
        Change(signs.asDiagonal(), begin, end, take);
        Track(seed, take);
        const int edge = seed % 2 == 0 ? begin : end, lost = static_cast<int>(seed % 5);
        for (int f = std::max(edge - lost, 0); f < std::min(edge + lost, options.frames); ++f) {
          std::fill_n(take.confidence.begin() + static_cast<std::ptrdiff_t>(f) * take.positions.joints,
                      take.positions.joints, 0.0);
        }
        const std::vector<Finding> found = FindAxesChanges(take.view());
        ++takes;
        if (found.empty()) ++missed;
        for (const Finding& one : found) {
          EXPECT_GE(one.frame_begin, begin - lost) << "seed " << seed << " from " << begin << ", lost " << lost;
          EXPECT_LE(one.frame_end, end + lost) << "seed " << seed << " from " << begin << ", lost " << lost;
          EXPECT_EQ(one.value, signs.prod()) << "seed " << seed;
        }
      }
    }
  }
  EXPECT_LE(missed, takes / 3);
}

TEST(AxesChanges, OfPartsWithDifferentAxesOneIsFound) {
  for (std::uint64_t seed = 0; seed < kTurnedSeeds; ++seed) {
    for (const int begin : {45, 35, 20}) {
      Take take = Perform(seed);
      Change(Vector3d(1, -1, 1).asDiagonal(), 0, begin, take);
      const std::vector<Finding> found = FindAxesChanges(take.view());
      ASSERT_EQ(found.size(), 1u) << "seed " << seed;
      EXPECT_EQ(found[0].value, -1.0);
    }
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
