#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <sstream>

#include "core/base/file.h"
#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/depth_agreement.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/evidence/noise.h"

namespace mocurate {
namespace {

/// The numbers of a matrix in an OpenCV XML file.
std::vector<double> MatrixOf(const std::string& bytes, const std::string& name) {
  const std::size_t begin = bytes.find("<data>", bytes.find("<" + name)) + 6;
  std::istringstream text(bytes.substr(begin, bytes.find("</data>", begin) - begin));
  return {std::istream_iterator<double>(text), {}};
}

/// Head and upper body of one person from 80 sides, as configs/sources/rgbd100.yaml reads them: the person turned
/// before a fixed sensor, the world is y down.
class Turntable : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("MOCURATE_TEST_DATA");
    if (data == nullptr) GTEST_SKIP() << "MOCURATE_TEST_DATA is not set";
    const std::filesystem::path folder = std::filesystem::path(data) / "rgbd100" / "views";
    const RigidTransform canonical{Quaterniond(Matrix3d(Vector3d(1, -1, -1).asDiagonal())), Vector3d::Zero()};
    clip_.rate = FrameRate{1, 1};
    for (int i = 0; i < 100; ++i) {
      if (i % 5 == 2) continue;
      char number[16];
      std::snprintf(number, sizeof number, "%010d", i);
      const std::string stem = number;
      const auto bytes = ReadFile(folder / (stem + "_camera.xml"));
      ASSERT_TRUE(bytes) << bytes.error().Message();
      const std::vector<double> r = MatrixOf(*bytes, "R"), t = MatrixOf(*bytes, "t");
      ASSERT_EQ(r.size(), 9u);
      ASSERT_EQ(t.size(), 3u);
      Matrix3d rotation;
      rotation << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
      const RigidTransform world_from_camera{Quaterniond(rotation).normalized(), Vector3d(t[0], t[1], t[2])};
      DepthView view;
      view.camera = {stem, 640, 480, 525.0, 525.0, 320.0, 240.0, {}, {}};
      view.camera.camera_from_world = Inverse(canonical * world_from_camera);
      view.files = {folder / (stem + "_depth.png")};
      view.masks = {folder / (stem + "_mask.jpg")};
      view.mask_sha256 = {""};
      view.time_s = {0.0};
      clip_.evidence.depth_views.push_back(view);
    }
  }

  Clip clip_;
};

TEST_F(Turntable, EveryViewLiesOnTheOthers) {
  auto rms = ViewAgreement(clip_.evidence.depth_views, 0, 0.03, 7);
  ASSERT_TRUE(rms) << rms.error().Message();
  ASSERT_EQ(rms->size(), 80u);
  const double median = Median(*rms);
  RecordProperty("median_rms_mm", std::to_string(1e3 * median));
  EXPECT_LT(median, 0.0016);
  EXPECT_LT(*std::max_element(rms->begin(), rms->end()), 0.0065);
}

TEST_F(Turntable, ThreeViewsGiveTheJointsThatAllOfThemGive) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  PointCloudOptions options;
  options.solver = TrackSolver::kBanded;
  options.voxel_size = 0.015;
  const auto bones = BoneLengthsFromClouds({clip_}, skeleton, options);
  ASSERT_TRUE(bones) << bones.error().Message();
  const auto all = FitClouds(clip_, skeleton, *bones, options);
  ASSERT_TRUE(all) << all.error().Message();
  Clip three = clip_;
  const auto& views = clip_.evidence.depth_views;
  three.evidence.depth_views = {views[0], views[27], views[54]};
  const Vector3d front = all->motion.rotation_at(0, 0) * Vector3d::UnitZ();
  options.start.facing = std::atan2(front.x(), front.z());
  const auto some = FitClouds(three, skeleton, *bones, options);
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
              (*bones)[4] / skeleton->RestBoneLengths()[4]);
  EXPECT_LT(all->residual_rms, 0.02);
  EXPECT_LT(some->residual_rms, 0.02);
  EXPECT_LT(sum / count, 0.04);
}

}  // namespace
}  // namespace mocurate
