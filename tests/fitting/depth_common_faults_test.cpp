// What is wrong with all depth views of a rig alike is told, and mended or refused: surfaces that several cameras see
// say so, the size of one person does not.

#include <gmock/gmock.h>
#include <unistd.h>

#include "fitting/clouds/cloud_rig_audit.h"
#include "tests/fitting/cloud_takes.h"
#include "tests/fitting/depth_rig_faults.h"
#include "tests/fitting/noisy_depth_takes.h"

namespace mocurate {
namespace {

using testing::HasSubstr;

std::filesystem::path CommonFaultsFolder(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) /
         ("mocurate_common_faults_" + std::to_string(getpid()) + "_" + name);
}

/// The studio's people before PHSPD's cameras.
using CommonFaults = NoisyDepthTakes<821, 3>;

TEST_F(CommonFaults, DepthsThatAreAllTooLongOrTooShortAreMended) {
  for (const double factor : {1.1, 0.92}) {
    for (const CloudTake& take : takes()) {
      std::vector<DepthView> views = take.evidence.depth_views;
      for (DepthView& view : views) view.metres_per_unit *= factor;
      const auto audited = AuditDepthRig(views, {});
      ASSERT_TRUE(audited) << audited.error().Message();
      ASSERT_EQ(audited->report.faults.size(), 1u) << take.clip.name << ": " << Told(audited->report);
      const RigFault& fault = audited->report.faults[0];
      EXPECT_EQ(fault.code, "camera_depths_off");
      EXPECT_EQ(fault.camera, "d1, d2, d3");
      EXPECT_GT(fault.value * (factor - 1.0), 0.0) << fault.message;
      EXPECT_TRUE(fault.corrected);
      for (const DepthView& view : audited->views) EXPECT_NEAR(view.metres_per_unit, 0.001, 0.00001);
      RigAuditOptions tell;
      tell.moved = AuditAction::kTell;
      const auto told = AuditDepthRig(views, tell);
      ASSERT_TRUE(told) << told.error().Message();
      EXPECT_DOUBLE_EQ(told->views[1].metres_per_unit, views[1].metres_per_unit);
      EXPECT_TRUE(told->report.IsDoubtful());
    }
  }
}

TEST_F(CommonFaults, ImagesThatAreAllMirroredAreRefused) {
  for (const CloudTake& take : takes()) {
    const auto views = WithMirroredImages(take.evidence.depth_views, CommonFaultsFolder("mirrored"));
    ASSERT_TRUE(views) << views.error().Message();
    const auto refused = AuditDepthRig(*views, {});
    ASSERT_FALSE(refused) << take.clip.name << ": " << Told(refused->report);
    EXPECT_THAT(refused.error().Message(), HasSubstr("images of all depth cameras are mirrored"));
    RigAuditOptions tell;
    tell.exchanged = AuditAction::kTell;
    const auto told = AuditDepthRig(*views, tell);
    ASSERT_TRUE(told) << told.error().Message();
    ASSERT_EQ(told->report.faults.size(), 1u) << Told(told->report);
    EXPECT_EQ(told->report.faults[0].code, "view_mirrored");
    EXPECT_TRUE(told->report.IsDoubtful());
  }
}

TEST_F(CommonFaults, DifferentImagesDoNotComeFromOnePlace) {
  const std::vector<DepthView>& good = takes()[0].evidence.depth_views;
  std::vector<DepthView> two = {good[0], good[1]}, one_of_three = good, all = good;
  two[1].camera.camera_from_world = good[0].camera.camera_from_world;
  one_of_three[1].camera.camera_from_world = good[0].camera.camera_from_world;
  for (DepthView& view : all) view.camera.camera_from_world = good[0].camera.camera_from_world;
  for (const auto* views : {&two, &one_of_three, &all}) {
    const auto refused = AuditDepthRig(*views, {});
    ASSERT_FALSE(refused) << Told(refused->report);
    EXPECT_THAT(refused.error().Message(), HasSubstr(views == &all ? "d1, d2, d3" : "d1, d2 "));
    EXPECT_THAT(refused.error().Message(), HasSubstr("is one file copied"));
    RigAuditOptions tell;
    tell.exchanged = AuditAction::kTell;
    const auto told = AuditDepthRig(*views, tell);
    ASSERT_TRUE(told) << told.error().Message();
    ASSERT_GE(told->report.faults.size(), 1u);
    EXPECT_EQ(told->report.faults[0].code, "cameras_in_one_place");
    EXPECT_LT(told->report.faults[0].value, 0.3);
    EXPECT_TRUE(told->report.IsDoubtful());
    for (std::size_t v = 0; v < views->size(); ++v) EXPECT_EQ(told->views[v].files, (*views)[v].files);
  }
}

TEST_F(CommonFaults, FilesThatAreGivenTwiceAreToldAsOneView) {
  std::vector<DepthView> views = takes()[0].evidence.depth_views;
  views[2] = views[0];
  views[2].camera.name = "d3";
  for (const int late : {0, 1}) {
    const auto told = AuditDepthRig(WithLateView(views, 2, late), {});
    ASSERT_TRUE(told) << told.error().Message();
    ASSERT_GE(told->report.faults.size(), 1u);
    EXPECT_EQ(told->report.faults[0].code, "cameras_in_one_place");
    EXPECT_EQ(told->report.faults[0].camera, "d1, d3");
    EXPECT_GT(told->report.faults[0].value, late == 0 ? 0.99 : 0.75);
    EXPECT_TRUE(told->report.IsDoubtful());
  }
}

}  // namespace
}  // namespace mocurate
