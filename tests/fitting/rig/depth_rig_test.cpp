// The audit of depth cameras reports and corrects a rig whose views of the person disagree, and leaves a sound rig
// unchanged.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/clouds/view_registration.h"
#include "tests/fitting/cloud_scene.h"
#include "tests/fitting/cloud_takes.h"
#include "tests/fitting/depth_rig_faults.h"
#include "tests/fitting/noisy_depth_takes.h"
#include "tests/support/depth_files.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = 0.017453292519943295;
constexpr double kStep_ms = 1000.0 / 30.0;

std::filesystem::path RigFolder(const std::string& name) { return SharedScratch("depth_rig_" + name); }

/// A person who swings arms and legs, or stands.
Motion SwingingOrStanding(const SkeletonPtr& skeleton, int frames, bool moves) {
  const int joints = skeleton->joint_count();
  std::vector<Vector3d> translation;
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(frames) * joints, Quaterniond::Identity());
  for (int f = 0; f < frames; ++f) {
    const double t = moves ? f / 30.0 : 0.2;
    translation.emplace_back(0.1 * std::sin(2.0 * t), 0.05, 0.05 * std::cos(3.0 * t));
    const auto turn = [&](const char* name, const Vector3d& by) {
      rotation[static_cast<std::size_t>(f) * joints + *skeleton->FindJoint(name)] = ExpQuaternion(by);
    };
    rotation[static_cast<std::size_t>(f) * joints] = ExpQuaternion({0.0, 0.3 * std::sin(2.0 * t), 0.0});
    turn("plain_left_shoulder", {0.0, 0.0, -0.5 + 0.8 * std::sin(5.0 * t)});
    turn("plain_right_shoulder", {0.8 * std::sin(4.0 * t), 0.0, 0.7});
    turn("plain_left_hip", {0.4 * std::sin(4.0 * t), 0.0, 0.0});
    turn("plain_right_hip", {-0.4 * std::sin(4.0 * t), 0.0, 0.0});
  }
  return MakeMotion(skeleton, FrameRate{30, 1}, translation, rotation, skeleton->RestBoneLengths());
}

/// Displacement of the person if camera `view` has its pose of `rig` instead of `truth`, relative to camera `still`.
CameraMoveAt Off(const std::vector<DepthView>& rig, const std::vector<DepthView>& truth, std::size_t view,
                 std::size_t still) {
  Camera is = rig[view].camera, was = truth[view].camera;
  is.camera_from_world = is.camera_from_world * Inverse(rig[still].camera.camera_from_world);
  was.camera_from_world = was.camera_from_world * Inverse(truth[still].camera.camera_from_world);
  return MoveBetween(was, is, truth[still].camera.camera_from_world * Vector3d(0.0, 0.1, 0.0));
}

/// Three cameras, 120 degrees apart, around a body of capsules; no noise.
class DepthRig : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    skeleton_ = PlainSkeleton();
    moving_ = new Clip(*RenderClip(SwingingOrStanding(skeleton_, 24, true), RigFolder("moving")));
    standing_ = new Clip(*RenderClip(SwingingOrStanding(skeleton_, 12, false), RigFolder("standing")));
  }

  static const std::vector<DepthView>& Moving() { return moving_->evidence.depth_views; }
  static const std::vector<DepthView>& Standing() { return standing_->evidence.depth_views; }

  static SkeletonPtr skeleton_;
  static Clip* moving_;
  static Clip* standing_;
};

SkeletonPtr DepthRig::skeleton_;
Clip* DepthRig::moving_ = nullptr;
Clip* DepthRig::standing_ = nullptr;

void ExpectLeftAlone(const std::vector<DepthView>& views) {
  const auto audited = AuditDepthRig(views, {});
  ASSERT_TRUE(audited) << audited.error().Message();
  EXPECT_TRUE(audited->report.faults.empty()) << FaultLines(audited->report);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const RigidTransform &is = audited->views[v].camera.camera_from_world, &was = views[v].camera.camera_from_world;
    EXPECT_EQ(is.translation, was.translation);
    EXPECT_EQ(is.rotation.coeffs(), was.rotation.coeffs());
    EXPECT_EQ(audited->views[v].files, views[v].files);
  }
}

TEST_F(DepthRig, SoundRigIsNotChanged) {
  ExpectLeftAlone(Moving());
  ExpectLeftAlone(Standing());
}

TEST_F(DepthRig, CorrectsAMovedCamera) {
  for (const auto* good : {&Moving(), &Standing()}) {
    for (std::size_t moved = 0; moved < 3; ++moved) {
      Random random(7, "moved", std::to_string(moved));
      std::vector<DepthView> views = *good;
      views[moved].camera = Knocked(views[moved].camera, 0.03, 2.0, random);
      const auto audited = AuditDepthRig(views, {});
      ASSERT_TRUE(audited) << audited.error().Message();
      ASSERT_EQ(audited->report.faults.size(), 1u) << FaultLines(audited->report);
      const RigFault& fault = audited->report.faults[0];
      EXPECT_EQ(fault.code, "camera_moved");
      EXPECT_EQ(fault.camera, "c" + std::to_string(moved));
      EXPECT_NEAR(fault.value, 30.0, 20.0);
      EXPECT_GT(fault.confidence, 0.99);
      EXPECT_TRUE(fault.corrected);
      const std::size_t still = (moved + 1) % 3;
      const CameraMoveAt before = Off(views, *good, moved, still), after = Off(audited->views, *good, moved, still);
      EXPECT_LT(after.shift, 0.006);
      EXPECT_LT(after.turn, 0.7 * kDegree);
      EXPECT_LT(after.shift, 0.25 * before.shift);
      EXPECT_LT(audited->report.loss_after[moved], 0.7 * audited->report.loss[moved]);
      EXPECT_FALSE(audited->report.IsAmbiguous());
    }
  }
}

TEST_F(DepthRig, CorrectsACameraMovedBeyondTheOverlapOfSurfaces) {
  for (std::size_t moved = 0; moved < 3; ++moved) {
    std::vector<DepthView> views = Moving();
    views[moved].camera.camera_from_world =
        views[moved].camera.camera_from_world * RigidTransform{Quaterniond::Identity(), Vector3d(0.25, 0.1, -0.2)};
    const auto audited = AuditDepthRig(views, {});
    ASSERT_TRUE(audited) << audited.error().Message();
    ASSERT_EQ(audited->report.faults.size(), 1u) << FaultLines(audited->report);
    EXPECT_EQ(audited->report.faults[0].code, "camera_moved");
    EXPECT_EQ(audited->report.faults[0].camera, "c" + std::to_string(moved));
    EXPECT_LT(Off(audited->views, Moving(), moved, (moved + 1) % 3).shift, 0.01);
  }
}

/// An offset also enlarges the person: no camera pose corrects it.
TEST_F(DepthRig, CorrectsDepthsThatAreTooLongOrTooShort) {
  for (const double factor : {0.9, 1.12}) {
    std::vector<DepthView> views = Moving();
    views[1].metres_per_unit *= factor;
    const auto audited = AuditDepthRig(views, {});
    ASSERT_TRUE(audited) << audited.error().Message();
    ASSERT_FALSE(audited->report.faults.empty());
    const RigFault& fault = audited->report.faults[0];
    EXPECT_EQ(fault.code, "camera_depths_off") << FaultLines(audited->report);
    EXPECT_EQ(fault.camera, "c1");
    EXPECT_GT(fault.value * (factor - 1.0), 0.0) << fault.message;
    EXPECT_TRUE(fault.corrected);
    EXPECT_NEAR(audited->views[1].metres_per_unit / Moving()[1].metres_per_unit, 1.0, 0.006);
    RigAuditOptions report_only;
    report_only.moved = AuditAction::kReport;
    const auto reported = AuditDepthRig(views, report_only);
    ASSERT_TRUE(reported) << reported.error().Message();
    EXPECT_DOUBLE_EQ(reported->views[1].metres_per_unit, views[1].metres_per_unit);
    EXPECT_TRUE(reported->report.IsAmbiguous());
  }
}

TEST_F(DepthRig, ReportOnlyChangesNothing) {
  Random random(7, "moved", "0");
  std::vector<DepthView> views = Moving();
  views[0].camera = Knocked(views[0].camera, 0.03, 2.0, random);
  RigAuditOptions options;
  options.moved = AuditAction::kReport;
  const auto audited = AuditDepthRig(views, options);
  ASSERT_TRUE(audited) << audited.error().Message();
  ASSERT_EQ(audited->report.faults.size(), 1u) << FaultLines(audited->report);
  EXPECT_FALSE(audited->report.faults[0].corrected);
  EXPECT_TRUE(audited->report.IsAmbiguous());
  EXPECT_EQ(audited->views[0].camera.camera_from_world.translation, views[0].camera.camera_from_world.translation);
  options.moved = AuditAction::kOff;
  const auto silent = AuditDepthRig(views, options);
  ASSERT_TRUE(silent) << silent.error().Message();
  for (const RigFault& fault : silent->report.faults) EXPECT_NE(fault.code, "camera_moved");
}

TEST_F(DepthRig, CorrectsAClockOffsetByTheTimesOfImages) {
  for (const int late : {2, -3, 6}) {
    const std::vector<DepthView> views = WithClockOffset(Moving(), 1, late);
    const auto audited = AuditDepthRig(views, {});
    ASSERT_TRUE(audited) << audited.error().Message();
    ASSERT_EQ(audited->report.faults.size(), 1u) << FaultLines(audited->report);
    const RigFault& fault = audited->report.faults[0];
    EXPECT_EQ(fault.code, "camera_clock_off");
    EXPECT_EQ(fault.camera, "c1");
    EXPECT_NEAR(fault.value, -late * kStep_ms, 10.0);
    const auto& files = audited->views[1].files;
    for (std::size_t f = 0; f < files.size(); ++f) {
      const auto at = static_cast<std::ptrdiff_t>(f) + late;
      const bool known = at >= 0 && at < static_cast<std::ptrdiff_t>(files.size());
      EXPECT_EQ(files[f], known ? views[1].files[static_cast<std::size_t>(at)] : std::filesystem::path());
    }
    EXPECT_EQ(audited->views[0].files, views[0].files);
    EXPECT_TRUE(ReadFrame(audited->views, 0)) << "a frame without an image observes nothing";
  }
}

TEST_F(DepthRig, ReportsNoClockOffsetForAPersonWhoStandsStill) { ExpectLeftAlone(WithClockOffset(Standing(), 1, 2)); }

TEST_F(DepthRig, ExchangedFilesOfASymmetricRigAreAmbiguous) {
  std::vector<DepthView> views = Moving();
  ExchangeFiles(views[0], views[2]);
  const auto audited = AuditDepthRig(views, {});
  ASSERT_TRUE(audited) << audited.error().Message();
  ASSERT_EQ(audited->report.faults.size(), 1u) << FaultLines(audited->report);
  EXPECT_EQ(audited->report.faults[0].code, "cameras_exchanged");
  EXPECT_FALSE(audited->report.faults[0].corrected);
  EXPECT_THAT(audited->report.faults[0].message, HasSubstr("ambiguous"));
  EXPECT_EQ(audited->views[0].files, views[0].files);
  // Rotated by its own symmetry it is the same rig in a rotated world.
  views = Moving();
  ExchangeFiles(views[0], views[1]);
  ExchangeFiles(views[1], views[2]);
  ExpectLeftAlone(views);
}

TEST_F(DepthRig, RefusesOrCorrectsLengthsInAWrongUnit) {
  std::vector<DepthView> depths = Moving(), places = Moving();
  for (DepthView& view : depths) view.metres_per_unit = 1.0;
  for (DepthView& view : places) view.camera.camera_from_world.translation *= 1000.0;
  const auto refused = AuditDepthRig(depths, {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().Message(), HasSubstr("depths are 1000 times too long"));
  const auto places_refused = AuditDepthRig(places, {});
  ASSERT_FALSE(places_refused);
  EXPECT_THAT(places_refused.error().Message(), HasSubstr("places of cameras are 1000 times too long"));
  RigAuditOptions options;
  options.unit = AuditAction::kCorrect;
  for (const auto* wrong : {&depths, &places}) {
    const auto corrected = AuditDepthRig(*wrong, options);
    ASSERT_TRUE(corrected) << corrected.error().Message();
    ASSERT_EQ(corrected->report.faults.size(), 1u) << FaultLines(corrected->report);
    EXPECT_EQ(corrected->report.faults[0].code, "calibration_unit");
    EXPECT_EQ(corrected->report.faults[0].value, 1000.0);
    EXPECT_NEAR(corrected->views[1].metres_per_unit, 0.001, 1e-12);
    EXPECT_LT(
        (corrected->views[1].camera.camera_from_world.translation - Moving()[1].camera.camera_from_world.translation)
            .norm(),
        1e-9);
  }
}

TEST_F(DepthRig, ReportsTwoViewsThatDisagree) {
  const std::vector<DepthView> good = {Moving()[0], Moving()[1]};
  ExpectLeftAlone(good);
  Random random(3, "moved");
  std::vector<DepthView> views = good;
  views[1].camera = Knocked(views[1].camera, 0.03, 2.0, random);
  const auto audited = AuditDepthRig(views, {});
  ASSERT_TRUE(audited) << audited.error().Message();
  ASSERT_EQ(audited->report.faults.size(), 1u) << FaultLines(audited->report);
  EXPECT_EQ(audited->report.faults[0].camera, "c1");
  // 120 degrees apart the views share little surface: a correction would remove less than half of the residual.
  EXPECT_FALSE(audited->report.faults[0].corrected);
  EXPECT_EQ(audited->views[1].camera.camera_from_world.translation, views[1].camera.camera_from_world.translation);
}

TEST_F(DepthRig, ViewWithoutAPersonAndASingleViewAreNotFaults) {
  std::vector<DepthView> views = Moving();
  const DepthImage nothing{320, 300, std::vector<std::uint16_t>(320 * 300, 0)};
  std::filesystem::create_directories(RigFolder("empty"));
  const std::filesystem::path file = RigFolder("empty") / "empty.png";
  ASSERT_TRUE(WriteDepthImage(nothing, file));
  for (auto& name : views[2].files) name = file;
  const auto audited = AuditDepthRig(views, {});
  ASSERT_TRUE(audited) << audited.error().Message();
  EXPECT_TRUE(audited->report.faults.empty()) << FaultLines(audited->report);
  for (double residual : audited->report.residual_mm[2]) EXPECT_EQ(residual, 0.0);
  const auto findings = FindingsOf(audited->report);
  ASSERT_GE(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "camera_without_person");
  EXPECT_EQ(findings[0].value, 1.0);
  EXPECT_THAT(findings[0].message, HasSubstr(views[2].camera.name));
  for (DepthView& view : views) view.files.assign(view.files.size(), file);
  const auto empty = AuditDepthRig(views, {});
  ASSERT_TRUE(empty) << empty.error().Message();
  EXPECT_THAT(empty->report.not_audited, HasSubstr("0 comparisons"));
  const auto alone = AuditDepthRig({Moving()[0]}, {});
  ASSERT_TRUE(alone) << alone.error().Message();
  EXPECT_TRUE(alone->report.faults.empty() && alone->report.not_audited.empty()) << FaultLines(alone->report);
  EXPECT_TRUE(AuditDepthRig({}, {}));
}

TEST_F(DepthRig, RefusesAWallAsAPerson) {
  std::vector<DepthView> views = Moving();
  DepthImage wall{320, 300, {}};
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 320; ++x) wall.values.push_back(static_cast<std::uint16_t>(2500 + 2 * x + (x * 7 + y * 3) % 9));
  }
  std::filesystem::create_directories(RigFolder("wall"));
  const std::filesystem::path file = RigFolder("wall") / "wall.png";
  ASSERT_TRUE(WriteDepthImage(wall, file));
  for (DepthView& view : views) view.files.assign(view.files.size(), file);
  const auto refused = AuditDepthRig(views, {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().Message(), HasSubstr("flat"));
}

TEST_F(DepthRig, OneFrameIsTooLittleToAudit) {
  std::vector<DepthView> views = Moving();
  for (DepthView& view : views) view.files.resize(1), view.time_s.resize(1);
  const auto audited = AuditDepthRig(views, {});
  ASSERT_TRUE(audited) << audited.error().Message();
  EXPECT_THAT(audited->report.not_audited, HasSubstr("3 comparisons"));
}

TEST_F(DepthRig, FitsWellFromACorrectedCamera) {
  Random random(7, "moved", "0");
  Clip clip = *moving_;
  for (DepthView& view : clip.evidence.depth_views) view.files.resize(16), view.time_s.resize(16);
  clip.evidence.depth_views[0].camera = Knocked(clip.evidence.depth_views[0].camera, 0.03, 2.0, random);
  PointCloudOptions options;
  options.solver = PoseSolver::kBanded;
  options.start.facing = 0.0;
  const auto audited = FitClouds(clip, skeleton_, {}, options);
  ASSERT_TRUE(audited) << audited.error().Message();
  options.audit.moved = AuditAction::kOff;
  const auto as_given = FitClouds(clip, skeleton_, {}, options);
  ASSERT_TRUE(as_given) << as_given.error().Message();
  EXPECT_THAT(audited->rig_audit, HasSubstr("camera_moved"));
  EXPECT_THAT(audited->rig_audit, HasSubstr("\"c0\""));
  EXPECT_TRUE(as_given->rig_audit.empty()) << as_given->rig_audit;
  const JointPositions truth = SwingingOrStanding(skeleton_, 16, true).joints;
  const double error = MeanJointError(audited->motion.joints, truth);
  RecordProperty("joints_mm", std::to_string(1e3 * error));
  EXPECT_LT(error, 0.02);
  EXPECT_LT(error, 0.7 * MeanJointError(as_given->motion.joints, truth));
}

/// The studio's people before PHSPD's cameras, with a Kinect's errors.
using NoisyDepthRig = NoisyDepthTakes<811, 4>;

TEST_F(NoisyDepthRig, SoundRigIsNotChanged) {
  for (const CloudTake& take : takes()) ExpectLeftAlone(take.evidence.depth_views);
}

/// Floor and wall are in the images, as in unmasked captures.
TEST(DepthRigInARoom, SoundRigIsNotChanged) {
  CloudTakeOptions options;
  options.seed = 812;
  options.subjects = 1;
  options.clips = 1;
  options.frames = 12;
  options.room = true;
  const std::vector<CloudTake> takes = CloudTakes(options, RigFolder("room"));
  if (takes.empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  for (const CloudTake& take : takes) ExpectLeftAlone(take.evidence.depth_views);
}

TEST_F(NoisyDepthRig, CorrectsExchangedFilesAndAMovedCamera) {
  for (const CloudTake& take : takes()) {
    const std::vector<DepthView>& good = take.evidence.depth_views;
    std::vector<DepthView> views = good;
    ExchangeFiles(views[0], views[1]);
    const auto exchanged = AuditDepthRig(views, {});
    ASSERT_TRUE(exchanged) << exchanged.error().Message();
    ASSERT_EQ(exchanged->report.faults.size(), 1u) << FaultLines(exchanged->report);
    EXPECT_EQ(exchanged->report.faults[0].camera, "d1, d2");
    for (std::size_t v = 0; v < 3; ++v) EXPECT_EQ(exchanged->views[v].files, good[v].files);

    Random random(5, "moved", take.clip.name);
    views = good;
    views[1].camera = Knocked(views[1].camera, 0.03, 2.0, random);
    const auto moved = AuditDepthRig(views, {});
    ASSERT_TRUE(moved) << moved.error().Message();
    ASSERT_EQ(moved->report.faults.size(), 1u) << FaultLines(moved->report);
    EXPECT_EQ(moved->report.faults[0].camera, "d2");
    EXPECT_LT(Off(moved->views, good, 1, 0).shift, 0.01);
    EXPECT_LT(Off(moved->views, good, 1, 0).turn, 1.0 * kDegree);
  }
}

TEST(RealDepthRig, CorrectsACameraOfTheRenderedSequence) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto read = ReadRenderedSequence(std::filesystem::path(data) / "clouds" / "rendered_seq", 24);
  ASSERT_TRUE(read) << read.error().Message();
  const std::vector<DepthView>& good = read->clip.evidence.depth_views;
  ExpectLeftAlone(good);
  Random random(11, "moved");
  std::vector<DepthView> views = good;
  views[1].camera = Knocked(views[1].camera, 0.03, 2.0, random);
  const auto audited = AuditDepthRig(views, {});
  ASSERT_TRUE(audited) << audited.error().Message();
  ASSERT_EQ(audited->report.faults.size(), 1u) << FaultLines(audited->report);
  EXPECT_EQ(audited->report.faults[0].camera, good[1].camera.name);
  EXPECT_LT(Off(audited->views, good, 1, 0).shift, 0.006);
}

TEST(RealDepthRig, CorrectsOneOfEightyViewsOfARotatingPerson) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto good = TurntableViews(std::filesystem::path(data) / "rgbd100" / "views");
  ASSERT_TRUE(good) << good.error().Message();
  ExpectLeftAlone(*good);
  std::vector<DepthView> views = *good;
  Random random(13, "moved");
  views[30].camera = Knocked(views[30].camera, 0.03, 2.0, random);
  const auto audited = AuditDepthRig(views, {});
  ASSERT_TRUE(audited) << audited.error().Message();
  ASSERT_EQ(audited->report.faults.size(), 1u) << FaultLines(audited->report);
  EXPECT_EQ(audited->report.faults[0].camera, views[30].camera.name);
  const auto& person = (*good)[30].camera;
  const Vector3d centre = Inverse(person.camera_from_world) * Vector3d(0.0, 0.0, 0.9);
  EXPECT_LT(MoveBetween(person, audited->views[30].camera, centre).shift, 0.005);
  EXPECT_GT(MoveBetween(person, views[30].camera, centre).shift, 0.02);
}

}  // namespace
}  // namespace mocurate
