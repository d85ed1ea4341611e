#include "core/quality/duplicates.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

/// A person who moves all joints by a few slow sines; `seed` selects the movement.
Clip Moving(int seed, int frames, double hz) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  Random random(11, "movement", std::to_string(seed));
  std::vector<double> rate, phase;
  for (int i = 0; i < 3 * skeleton->joint_count(); ++i) {
    rate.push_back(random.Uniform(1.0, 4.0));
    phase.push_back(random.Uniform(0.0, 6.28));
  }
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) {
    root.emplace_back(0.3 * f / hz, 1.0, 0.0);
    for (std::size_t j = 0; j < skeleton->joints.size(); ++j) {
      Vector3d turn;
      for (std::size_t a = 0; a < 3; ++a)
        turn[static_cast<int>(a)] = 0.25 * std::sin(rate[3 * j + a] * f / hz + phase[3 * j + a]);
      rotation.push_back(ExpQuaternion(turn));
    }
  }
  Clip clip;
  clip.rate = FrameRate::FromHz(hz);
  clip.identity.end_frame = frames;
  clip.motion = MakeMotion(skeleton, clip.rate, std::move(root), std::move(rotation), skeleton->RestBoneLengths());
  return clip;
}

Clip WithNoise(Clip clip, double sigma) {
  Random random(5, "noise", "");
  for (double& value : clip.motion->joints.xyz) value += sigma * random.Normal();
  return clip;
}

/// With another position and heading.
Clip Turned(Clip clip) {
  Transform({Quaterniond(Eigen::AngleAxisd(2.0, Vector3d::UnitY())), Vector3d(3, 0, -1)}, clip);
  return clip;
}

std::vector<Duplicate> Search(const std::vector<Clip>& clips) {
  return FindDuplicates(clips.size(), [&](std::size_t i) { return &*clips[i].motion; });
}

TEST(SharedStretches, CopiesAreFoundMovedMirroredCroppedNoisyAndAtOtherRates) {
  const Clip clip = Moving(1, 150, 30.0);
  const Clip middle = Turned(*Cut(clip, 45, 105));
  const std::pair<const char*, Clip> variants[] = {
      {"moved", Turned(clip)},
      {"mirrored", Mirror(clip)},
      {"cropped", middle},
      {"cropped and noisy", WithNoise(middle, 0.002)},
      {"cropped, mirrored, other rate", Resample(Mirror(middle), {24, 1})}};
  for (const auto& [name, variant] : variants) {
    const std::vector<Duplicate> found = Search({Moving(2, 150, 30.0), clip, Moving(3, 90, 30.0), variant});
    ASSERT_EQ(found.size(), 1u) << name;
    EXPECT_EQ(found[0].first, 1u) << name;
    EXPECT_EQ(found[0].second, 3u) << name;
    const std::string text = name;
    EXPECT_EQ(found[0].mirrored, text.find("mirrored") != std::string::npos) << name;
    const bool crop = text.find("cropped") != std::string::npos;
    EXPECT_EQ(found[0].whole, !crop) << name;
    EXPECT_NEAR(found[0].frame_begin, crop ? 45 : 0, 2) << name;
    EXPECT_NEAR(found[0].frame_end, crop ? 105 : 150, 5) << name;
    EXPECT_NEAR(found[0].second_begin, 0, 2) << name;
  }
}

TEST(SharedStretches, TakesOfOneMovementAndMotionlessPeopleAreNotCopies) {
  std::vector<Clip> takes;
  for (int take = 0; take < 6; ++take) {
    Clip clip = Moving(1, 150, 30.0);  // the same movement, each joint slowly displaced by centimetres
    Random random(7, "take", std::to_string(take));
    for (int j = 0; j < clip.motion->joint_count(); ++j) {
      const double phase = random.Uniform(0.0, 6.28), reach = random.Uniform(0.02, 0.05);
      for (int f = 0; f < 150; ++f) clip.motion->joints.at(f, j).z() += reach * std::sin(phase + 0.05 * f);
    }
    takes.push_back(std::move(clip));
  }
  EXPECT_TRUE(Search(takes).empty());
  Clip standing = Moving(1, 150, 30.0);
  for (int f = 0; f < 150; ++f) {
    for (int j = 0; j < standing.motion->joint_count(); ++j)
      standing.motion->joints.at(f, j) = standing.motion->joints.at(0, j);
  }
  EXPECT_TRUE(Search({standing, WithNoise(standing, 0.001)}).empty());
  EXPECT_TRUE(Search({}).empty());
  EXPECT_TRUE(Search({Moving(1, 1, 30.0), Moving(1, 2, 30.0)}).empty());
}

TEST(SharedStretches, MotionsAreNotEstimatedBetweenFramesThatLieFarApart) {
  for (const double hz : {4.0, 1.5}) {
    const Clip clip = Moving(1, 60, hz);
    EXPECT_EQ(Search({clip, WithNoise(clip, 0.001)}).size(), hz == 4.0 ? 1u : 0u) << hz;
  }
}

TEST(SharedStretches, SpansOfOneRecordingShareTheirOverlap) {
  const Clip clip = Moving(4, 240, 30.0);
  const std::vector<Duplicate> found = Search({*Cut(clip, 0, 150), *Cut(clip, 90, 240)});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].frame_begin, 90, 2);
  EXPECT_NEAR(found[0].frame_end, 150, 2);
  EXPECT_NEAR(found[0].second_begin, 0, 2);
  EXPECT_NEAR(found[0].second_end, 60, 2);
}

}  // namespace
}  // namespace mocurate
