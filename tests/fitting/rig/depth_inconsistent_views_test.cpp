// A depth view that contradicts all others, which agree, shows another moment or person. It is excluded, or the clip is
// suspect.

#include <gmock/gmock.h>

#include "fitting/clouds/cloud_rig_audit.h"
#include "tests/fitting/cloud_scene.h"
#include "tests/fitting/noisy_depth_takes.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

/// A person who waves both arms, facing `heading` (radians), sitting (`seated` 1) or standing (0).
Motion Waving(const SkeletonPtr& skeleton, double heading, double seated) {
  constexpr int frames = 12;
  const int joints = skeleton->joint_count();
  std::vector<Vector3d> translation;
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(frames) * joints, Quaterniond::Identity());
  for (int f = 0; f < frames; ++f) {
    translation.emplace_back(0.0, 0.05 - 0.35 * seated, 0.01 * f);
    const auto turn = [&](const char* name, const Vector3d& by) {
      rotation[static_cast<std::size_t>(f) * joints + *skeleton->FindJoint(name)] = ExpQuaternion(by);
    };
    rotation[static_cast<std::size_t>(f) * joints] = ExpQuaternion({0.0, heading, 0.0});
    turn("plain_left_shoulder", {0.0, 0.0, 0.08 * f - 0.9 * seated});
    turn("plain_right_shoulder", {0.0, 0.0, 0.9 * seated - 0.08 * f});
    for (const char* hip : {"plain_left_hip", "plain_right_hip"}) turn(hip, {-1.5 * seated, 0.0, 0.0});
    for (const char* knee : {"plain_left_knee", "plain_right_knee"}) turn(knee, {1.5 * seated, 0.0, 0.0});
  }
  return MakeMotion(skeleton, FrameRate{30, 1}, translation, rotation, skeleton->RestBoneLengths());
}

/// Three cameras, 120 degrees apart, and their images of three different moments.
class DepthInconsistentViews : public ::testing::Test {
 protected:
  void SetUp() override {
    const SkeletonPtr skeleton = PlainSkeleton();
    for (const auto& [heading, seated] : {std::pair(0.0, 0.0), std::pair(1.5, 1.0), std::pair(-1.2, 0.6)}) {
      Expected<Clip> clip = RenderClip(Waving(skeleton, heading, seated), folder_ / std::to_string(moments_.size()));
      ASSERT_TRUE(clip) << clip.error().Message();
      moments_.push_back(clip->evidence.depth_views);
    }
  }
  std::vector<std::vector<DepthView>> moments_;

 private:
  ScratchFolder folder_;
};

TEST_F(DepthInconsistentViews, ExcludeAViewOfAnotherMoment) {
  for (std::size_t v = 0; v < 3; ++v) {
    std::vector<DepthView> views = moments_[0];
    views[v].files = moments_[1][v].files;
    const auto audited = AuditDepthRig(views, {});
    ASSERT_TRUE(audited) << audited.error().Message();
    ASSERT_EQ(audited->report.faults.size(), 1u) << FaultLines(audited->report);
    EXPECT_EQ(audited->report.faults[0].code, "views_disagree");
    EXPECT_EQ(audited->report.faults[0].camera, views[v].camera.name);
    EXPECT_FALSE(audited->report.IsAmbiguous());
    EXPECT_EQ(FindingsOf(audited->report)[0].action, FindingAction::kExcluded);
    views.erase(views.begin() + static_cast<std::ptrdiff_t>(v));
    ASSERT_EQ(audited->views.size(), 2u);
    for (std::size_t left = 0; left < 2; ++left) EXPECT_EQ(audited->views[left].files, views[left].files);
  }
}

TEST_F(DepthInconsistentViews, ReportOnlyMakesTheClipSuspect) {
  std::vector<DepthView> views = moments_[0];
  views[2].files = moments_[1][2].files;
  for (AuditAction RigAuditOptions::*action :
       {&RigAuditOptions::clocks, &RigAuditOptions::moved, &RigAuditOptions::exchanged}) {
    RigAuditOptions options;
    options.*action = AuditAction::kReport;
    const auto reported = AuditDepthRig(views, options);
    ASSERT_TRUE(reported) << reported.error().Message();
    EXPECT_EQ(reported->views.size(), 3u);
    EXPECT_TRUE(reported->report.IsAmbiguous()) << FaultLines(reported->report);
    EXPECT_EQ(FindingsOf(reported->report)[0].action, FindingAction::kFlagged) << FaultLines(reported->report);
  }
}

TEST_F(DepthInconsistentViews, KeepAllViewsOfASuspectClipWhereNoTwoAgree) {
  std::vector<DepthView> views = moments_[0];
  for (std::size_t v = 1; v < 3; ++v) views[v].files = moments_[v][v].files;
  const auto audited = AuditDepthRig(views, {});
  ASSERT_TRUE(audited) << audited.error().Message();
  EXPECT_EQ(audited->views.size(), 3u);
  EXPECT_TRUE(audited->report.IsAmbiguous()) << FaultLines(audited->report);
}

}  // namespace
}  // namespace mocurate
