#include "fitting/evidence/motion_tracks.h"

#include <gtest/gtest.h>

#include "tests/fitting/takes.h"

namespace mocurate {
namespace {

TEST(MotionTracks, InterpolatedSamplesAreNotEvidence) {
  Motion motion = SmoothTake(20).truth;
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  motion.state.assign(20 * joints, JointState::kObserved);
  motion.state[5 * joints + 3] = JointState::kInterpolated;
  const auto tracks = TracksOfMotion(motion, *motion.skeleton);
  ASSERT_TRUE(tracks.has_value()) << tracks.error().Message();
  ASSERT_EQ(tracks->confidence.size(), 20 * joints);
  EXPECT_EQ(tracks->confidence[5 * joints + 3], 0.0);
  EXPECT_EQ(tracks->confidence[4 * joints + 3], 1.0);
  EXPECT_EQ(tracks->confidence[5 * joints + 2], 1.0);
  ASSERT_EQ(tracks->rotation_confidence.size(), 20 * joints);
  EXPECT_EQ(tracks->rotation_confidence[5 * joints + 3], 0.0);
  EXPECT_EQ(tracks->rotation_confidence[4 * joints], 1.0);
}

}  // namespace
}  // namespace mocurate
