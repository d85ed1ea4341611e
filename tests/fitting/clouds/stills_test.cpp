#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/clouds/fit_clouds.h"
#include "tests/fitting/cloud_scene.h"

namespace mocurate {
namespace {

/// One moment of a person as three depth cameras see it, with the truth.
struct Still {
  std::string name;
  Clip clip;
  JointPositions truth;
};

Expected<Still> ReadStill(const std::filesystem::path& folder, const std::string& name) {
  const Expected<std::string> bytes = ReadFile(folder / (name + ".json"));
  if (!bytes) return Forward(bytes);
  const auto sequence = ParseDepthSequence(*bytes, name);
  if (!sequence) return Forward(sequence);
  const auto truth = ParseDepthSequenceTruth(*bytes, name);
  if (!truth) return Forward(truth);
  const Matrix3d world_from_rig = Vector3d(1.0, -1.0, -1.0).asDiagonal();
  Still still;
  still.name = name;
  still.clip.rate = FrameRate{1, 1};
  for (const DepthSequenceView& given : sequence->views) {
    DepthView view;
    view.files = {folder / (name + "_" + given.name + ".png")};
    view.time_s = {0.0};
    const auto image = ReadDepthImage(view.files[0]);
    if (!image) return Forward(image);
    view.camera = {given.name, image->width, image->height, given.fx, given.fy, given.cx, given.cy, {}, {}};
    view.camera.camera_from_world =
        given.camera_from_rig * RigidTransform{Quaterniond(world_from_rig), Vector3d::Zero()};
    still.clip.evidence.depth_views.push_back(view);
  }
  still.truth = JointPositions(1, truth->joints);
  for (int j = 0; j < truth->joints; ++j) {
    still.truth.at(0, j) = world_from_rig * truth->joint[static_cast<std::size_t>(j)];
  }
  return still;
}

/// The still is the only frame of its person.
TEST(RenderedStills, FitsASquatWithAnUnknownFacing) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto still = ReadStill(std::filesystem::path(data) / "clouds" / "rendered_body", "female_squat");
  ASSERT_TRUE(still) << still.error().Message();
  PointCloudOptions options;
  options.solver = PoseSolver::kBanded;
  const auto bones = MeasureBodyInClouds({still->clip}, *LoadSkeleton("smpl24"), options);
  ASSERT_TRUE(bones) << bones.error().Message();
  const auto fit = FitClouds(still->clip, bones->skeleton, bones->bone_length, options);
  ASSERT_TRUE(fit) << fit.error().Message();
  EXPECT_LT(MeanJointError(fit->motion.joints, still->truth), 0.02);
}

/// One frame of three views does not show which camera is wrong, only that one is.
TEST(RenderedStills, SurfacesShowThatOneCamerasDepthsAreATenthTooLong) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const std::filesystem::path folder = std::filesystem::path(data) / "clouds" / "rendered_body";
  for (const char* name : {"male_tpose", "female_walk_noisy", "child_arms_down"}) {
    const auto still = ReadStill(folder, name);
    ASSERT_TRUE(still) << still.error().Message();
    const auto sound = AuditDepthRig(still->clip.evidence.depth_views, {});
    ASSERT_TRUE(sound) << sound.error().Message();
    EXPECT_TRUE(sound->report.faults.empty()) << name;
    for (std::size_t v = 0; v < 3; ++v) {
      std::vector<DepthView> views = still->clip.evidence.depth_views;
      views[v].metres_per_unit *= 1.1;
      const auto reported = AuditDepthRig(views, {});
      ASSERT_TRUE(reported) << reported.error().Message();
      ASSERT_EQ(reported->report.faults.size(), 3u) << name << v;
      EXPECT_EQ(reported->report.faults[0].code, "views_disagree");
      EXPECT_TRUE(reported->report.IsAmbiguous());
    }
  }
}

}  // namespace
}  // namespace mocurate
