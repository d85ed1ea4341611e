#include "core/motion/one_euro.h"

#include <gtest/gtest.h>

#include "tests/motion/builders.h"

namespace mocurate::test {
namespace {

/// A motionless person at 30 Hz, each joint with noise of `sigma` metres.
Motion NoisyStanding(double sigma, int frames) {
  const SkeletonPtr skeleton = Built("smpl24");
  Random random(3, "one euro", "");
  JointPositions joints(frames, skeleton->joint_count());
  for (double& value : joints.xyz) value = sigma * random.Normal();
  return MakeJointsOnly(skeleton, {30, 1}, std::move(joints));
}

double RmsStep(const Motion& motion) {
  double sum = 0.0;
  for (int f = 1; f < motion.frame_count(); ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) {
      sum += (motion.joints.at(f, j) - motion.joints.at(f - 1, j)).squaredNorm();
    }
  }
  return std::sqrt(sum / (motion.frame_count() - 1.0) / motion.joint_count());
}

TEST(OneEuro, FollowsItsEquationsFrameByFrame) {
  const Motion motion = NoisyStanding(0.1, 4);
  const OneEuro filter{1.2, 0.5, 0.8};
  const Motion filtered = OneEuroFiltered(motion, filter);
  // The authors' pseudocode, for one coordinate.
  const double period = 1.0 / 30.0;
  const auto weight = [&](double cutoff) { return 1.0 / (1.0 + 1.0 / (2.0 * M_PI * cutoff) / period); };
  double value = motion.joints.at(0, 5).y(), speed = 0.0;
  EXPECT_EQ(filtered.joints.at(0, 5).y(), value);
  for (int f = 1; f < 4; ++f) {
    const double given = motion.joints.at(f, 5).y();
    const double change = (given - value) / period;
    speed = weight(0.8) * change + (1.0 - weight(0.8)) * speed;
    const double a = weight(1.2 + 0.5 * std::abs(speed));
    value = a * given + (1.0 - a) * value;
    EXPECT_NEAR(filtered.joints.at(f, 5).y(), value, 1e-12) << f;
  }
}

TEST(OneEuro, RemovesNoiseOfAMotionlessPersonAndKeepsASteadyMotion) {
  const Motion noisy = NoisyStanding(0.01, 300);
  EXPECT_LT(RmsStep(OneEuroFiltered(noisy, {1.0, 0.007, 1.0})), 0.25 * RmsStep(noisy));
  const Motion still = NoisyStanding(0.0, 10);
  EXPECT_EQ(OneEuroFiltered(still, {1.0, 0.007, 1.0}).joints.xyz, still.joints.xyz);
  const Motion open = OneEuroFiltered(noisy, {1e3, 0.0, 1.0});
  EXPECT_LT((open.joints.at(200, 3) - noisy.joints.at(200, 3)).norm(), 1e-3) << "a cutoff far above the rate";
}

TEST(OneEuro, RotationsAreRemoved) {
  const Motion filtered = OneEuroFiltered(SwingingPerson(Built("smpl24"), 20), {1.0, 0.007, 1.0});
  EXPECT_TRUE(filtered.joints_only());
  EXPECT_EQ(filtered.frame_count(), 20);
}

}  // namespace
}  // namespace mocurate::test
