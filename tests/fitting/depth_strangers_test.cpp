// One depth view that contradicts all others, which agree among themselves, is of another moment or of somebody else:
// it is left out, or the clip is in doubt.

#include <unistd.h>

#include <gmock/gmock.h>

#include "fitting/clouds/cloud_rig_audit.h"
#include "tests/fitting/cloud_scene.h"
#include "tests/fitting/noisy_depth_takes.h"

namespace mocurate {
namespace {

/// Somebody who waves both arms, facing `heading`, and sits or stands.
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

/// Three cameras at a third of a turn from each other, and what they see of three different moments.
class DepthStrangers : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("mocurate_strangers_" + std::to_string(getpid()));
    const SkeletonPtr skeleton = PlainSkeleton();
    for (const auto& [heading, seated] : {std::pair(0.0, 0.0), std::pair(1.5, 1.0), std::pair(-1.2, 0.6)}) {
      Expected<Clip> clip = RenderClip(Waving(skeleton, heading, seated), folder_ / std::to_string(moments_.size()));
      ASSERT_TRUE(clip) << clip.error().Message();
      moments_.push_back(clip->evidence.depth_views);
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::vector<std::vector<DepthView>> moments_;

 private:
  std::filesystem::path folder_;
};

TEST_F(DepthStrangers, AViewOfAnotherMomentIsLeftOut) {
  for (std::size_t v = 0; v < 3; ++v) {
    std::vector<DepthView> views = moments_[0];
    views[v].files = moments_[1][v].files;
    const auto audited = AuditDepthRig(views, {});
    ASSERT_TRUE(audited) << audited.error().Message();
    ASSERT_EQ(audited->report.faults.size(), 1u) << Told(audited->report);
    EXPECT_EQ(audited->report.faults[0].code, "views_disagree");
    EXPECT_EQ(audited->report.faults[0].camera, views[v].camera.name);
    EXPECT_FALSE(audited->report.IsDoubtful());
    EXPECT_EQ(FindingsOf(audited->report)[0].action, FindingAction::kLeftOut);
    views.erase(views.begin() + static_cast<std::ptrdiff_t>(v));
    ASSERT_EQ(audited->views.size(), 2u);
    for (std::size_t left = 0; left < 2; ++left) EXPECT_EQ(audited->views[left].files, views[left].files);
  }
}

TEST_F(DepthStrangers, WhereItIsOnlyToldTheClipIsInDoubt) {
  std::vector<DepthView> views = moments_[0];
  views[2].files = moments_[1][2].files;
  for (AuditAction RigAuditOptions::*kind :
       {&RigAuditOptions::clocks, &RigAuditOptions::moved, &RigAuditOptions::exchanged}) {
    RigAuditOptions options;
    options.*kind = AuditAction::kTell;
    const auto told = AuditDepthRig(views, options);
    ASSERT_TRUE(told) << told.error().Message();
    EXPECT_EQ(told->views.size(), 3u);
    EXPECT_TRUE(told->report.IsDoubtful()) << Told(told->report);
    EXPECT_EQ(FindingsOf(told->report)[0].action, FindingAction::kFlagged);
  }
}

TEST_F(DepthStrangers, WhereNoneAgreesWithAnotherNoneIsLeftOutAndTheClipIsInDoubt) {
  std::vector<DepthView> views = moments_[0];
  for (std::size_t v = 1; v < 3; ++v) views[v].files = moments_[v][v].files;
  const auto audited = AuditDepthRig(views, {});
  ASSERT_TRUE(audited) << audited.error().Message();
  EXPECT_EQ(audited->views.size(), 3u);
  EXPECT_TRUE(audited->report.IsDoubtful()) << Told(audited->report);
}

}  // namespace
}  // namespace mocurate
