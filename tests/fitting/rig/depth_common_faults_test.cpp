// Faults common to all depth views of a rig are reported, and corrected or refused. Surfaces that several cameras
// observe reveal them; the size of one person does not.

#include <gmock/gmock.h>
#include "fitting/clouds/cloud_rig_audit.h"
#include "tests/fitting/cloud_takes.h"
#include "tests/fitting/depth_rig_faults.h"
#include "tests/fitting/noisy_depth_takes.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using testing::HasSubstr;

std::filesystem::path CommonFaultsFolder(const std::string& name) { return SharedScratch("common_faults_" + name); }

/// The studio's people before PHSPD's cameras.
using CommonFaults = NoisyDepthTakes<821, 3>;

TEST_F(CommonFaults, CorrectsDepthsThatAreAllTooLongOrTooShort) {
  for (const double factor : {1.1, 0.92}) {
    for (const CloudTake& take : takes()) {
      std::vector<DepthView> views = take.evidence.depth_views;
      for (DepthView& view : views) view.metres_per_unit *= factor;
      const auto audited = AuditDepthRig(views, {});
      ASSERT_TRUE(audited) << audited.error().Message();
      ASSERT_EQ(audited->report.faults.size(), 1u) << take.clip.name << ": " << FaultLines(audited->report);
      const RigFault& fault = audited->report.faults[0];
      EXPECT_EQ(fault.code, "camera_depths_off");
      EXPECT_EQ(fault.camera, "d1, d2, d3");
      EXPECT_GT(fault.value * (factor - 1.0), 0.0) << fault.message;
      EXPECT_TRUE(fault.corrected);
      for (const DepthView& view : audited->views) EXPECT_NEAR(view.metres_per_unit, 0.001, 0.00001);
      RigAuditOptions report_only;
      report_only.moved = AuditAction::kReport;
      const auto reported = AuditDepthRig(views, report_only);
      ASSERT_TRUE(reported) << reported.error().Message();
      EXPECT_DOUBLE_EQ(reported->views[1].metres_per_unit, views[1].metres_per_unit);
      EXPECT_TRUE(reported->report.IsAmbiguous());
    }
  }
}

TEST_F(CommonFaults, RefusesImagesThatAreAllMirrored) {
  for (const CloudTake& take : takes()) {
    const auto views = WithMirroredImages(take.evidence.depth_views, CommonFaultsFolder("mirrored"));
    ASSERT_TRUE(views) << views.error().Message();
    const auto refused = AuditDepthRig(*views, {});
    ASSERT_FALSE(refused) << take.clip.name << ": " << FaultLines(refused->report);
    EXPECT_THAT(refused.error().Message(), HasSubstr("images of all depth cameras are mirrored"));
    RigAuditOptions report_only;
    report_only.exchanged = AuditAction::kReport;
    const auto reported = AuditDepthRig(*views, report_only);
    ASSERT_TRUE(reported) << reported.error().Message();
    ASSERT_EQ(reported->report.faults.size(), 1u) << FaultLines(reported->report);
    EXPECT_EQ(reported->report.faults[0].code, "view_mirrored");
    EXPECT_TRUE(reported->report.IsAmbiguous());
  }
}

TEST_F(CommonFaults, RefusesDifferentImagesFromOnePlace) {
  const std::vector<DepthView>& good = takes()[0].evidence.depth_views;
  std::vector<DepthView> two = {good[0], good[1]}, one_of_three = good, all = good;
  two[1].camera.camera_from_world = good[0].camera.camera_from_world;
  one_of_three[1].camera.camera_from_world = good[0].camera.camera_from_world;
  for (DepthView& view : all) view.camera.camera_from_world = good[0].camera.camera_from_world;
  for (const auto* views : {&two, &one_of_three, &all}) {
    const auto refused = AuditDepthRig(*views, {});
    ASSERT_FALSE(refused) << FaultLines(refused->report);
    EXPECT_THAT(refused.error().Message(), HasSubstr(views == &all ? "d1, d2, d3" : "d1, d2 "));
    EXPECT_THAT(refused.error().Message(), HasSubstr("is one file copied"));
    RigAuditOptions report_only;
    report_only.exchanged = AuditAction::kReport;
    const auto reported = AuditDepthRig(*views, report_only);
    ASSERT_TRUE(reported) << reported.error().Message();
    ASSERT_GE(reported->report.faults.size(), 1u);
    EXPECT_EQ(reported->report.faults[0].code, "cameras_in_one_place");
    EXPECT_LT(reported->report.faults[0].value, 0.3);
    EXPECT_TRUE(reported->report.IsAmbiguous());
    for (std::size_t v = 0; v < views->size(); ++v) EXPECT_EQ(reported->views[v].files, (*views)[v].files);
  }
}

TEST_F(CommonFaults, ReportsDuplicateFilesAsOneView) {
  std::vector<DepthView> views = takes()[0].evidence.depth_views;
  views[2] = views[0];
  views[2].camera.name = "d3";
  for (const int late : {0, 1}) {
    const auto reported = AuditDepthRig(WithClockOffset(views, 2, late), {});
    ASSERT_TRUE(reported) << reported.error().Message();
    ASSERT_GE(reported->report.faults.size(), 1u);
    EXPECT_EQ(reported->report.faults[0].code, "cameras_in_one_place");
    EXPECT_EQ(reported->report.faults[0].camera, "d1, d3");
    EXPECT_GT(reported->report.faults[0].value, late == 0 ? 0.99 : 0.75);
    EXPECT_TRUE(reported->report.IsAmbiguous());
  }
}

}  // namespace
}  // namespace mocurate
