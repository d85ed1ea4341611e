#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "core/base/median.h"
#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/fit_clouds.h"
#include "tests/fitting/depth_rig_faults.h"
#include "tests/fitting/view_agreement.h"

namespace mocurate {
namespace {

class Turntable : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("MOCURATE_DATA");
    if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
    const std::filesystem::path folder = std::filesystem::path(data) / "rgbd100" / "views";
    auto views = TurntableViews(folder);
    ASSERT_TRUE(views) << views.error().Message();
    clip_.rate = FrameRate{1, 1};
    clip_.evidence.depth_views = std::move(*views);
  }

  Clip clip_;
};

TEST_F(Turntable, EveryViewAgreesWithTheOthers) {
  auto rms = ViewAgreement(clip_.evidence.depth_views, 0.03, 7);
  ASSERT_TRUE(rms) << rms.error().Message();
  ASSERT_EQ(rms->size(), 80u);
  const double median = MeanMedian(*rms);
  RecordProperty("median_rms_mm", std::to_string(1e3 * median));
  EXPECT_LT(median, 0.0016);
  EXPECT_LT(*std::max_element(rms->begin(), rms->end()), 0.0065);
}

TEST_F(Turntable, ThreeViewsGiveTheSameJointsAsAll) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  PointCloudOptions options;
  options.solver = PoseSolver::kBanded;
  options.voxel_size = 0.02;
  const auto bones = MeasureBodyInClouds({clip_}, skeleton, options);
  ASSERT_TRUE(bones) << bones.error().Message();
  const auto all = FitClouds(clip_, bones->skeleton, bones->bone_length, options);
  ASSERT_TRUE(all) << all.error().Message();
  Clip three = clip_;
  const auto& views = clip_.evidence.depth_views;
  three.evidence.depth_views = {views[0], views[27], views[54]};
  const Vector3d front = all->motion.rotation_at(0, 0) * Vector3d::UnitZ();
  options.start.facing = std::atan2(front.x(), front.z());
  const auto some = FitClouds(three, bones->skeleton, bones->bone_length, options);
  ASSERT_TRUE(some) << some.error().Message();
  double sum = 0.0;
  int count = 0;
  for (int j = 0; j < skeleton->joint_count(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    if (all->motion.state[at] != JointState::kObserved || some->motion.state[at] != JointState::kObserved) continue;
    sum += (all->motion.joints.at(0, j) - some->motion.joints.at(0, j)).norm();
    ++count;
  }
  ASSERT_GT(count, 8);
  std::printf("80 views: %.1f mm to the surface, 3 views: %.1f mm, joints %.1f mm apart, scale %.2f\n",
              1e3 * all->residual_rms, 1e3 * some->residual_rms, 1e3 * sum / count,
              bones->bone_length[4] / skeleton->RestBoneLengths()[4]);
  EXPECT_LT(all->residual_rms, 0.02);
  EXPECT_LT(some->residual_rms, 0.02);
  EXPECT_LT(sum / count, 0.04);
}

}  // namespace
}  // namespace mocurate
