// The audit finds and names faults of a rig, its calibration and its files, and corrects clear ones.

#include "fitting/audit/rig_audit.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <numeric>

#include "core/formats/openpose.h"
#include "fitting/audit/keypoint_order.h"
#include "fitting/triangulation/keypoint_tracks.h"
#include "tests/fitting/keypoint_takes.h"
#include "tests/fitting/studio_views.h"

namespace mocurate {
namespace {

using testing::HasSubstr;

const Skeleton& AuditedBody() {
  static const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  return *skeleton;
}

Expected<KeypointTracks> TriangulatedWithAudit(const Evidence& evidence, const KeypointAuditOptions& audit = {}) {
  KeypointFitOptions options;
  options.audit = audit;
  return TriangulateKeypoints(evidence, AuditedBody(), options);
}

std::vector<RigFault> FaultsNamed(const KeypointTracks& found, const std::string& code) {
  std::vector<RigFault> faults;
  for (const RigFault& fault : found.report.faults) {
    if (fault.code == code) faults.push_back(fault);
  }
  return faults;
}

std::string ReportedByAudit(const KeypointTracks& found) {
  std::string text;
  for (const RigFault& fault : found.report.faults) text += fault.code + ": " + fault.message + "\n";
  return text;
}

KeypointAuditOptions Nothing() {
  KeypointAuditOptions audit;
  audit.clocks = audit.moved = audit.exchanged = audit.unit = audit.order = audit.sides = AuditAction::kOff;
  return audit;
}

TEST(RigAudit, FindsNothingInASoundRig) {
  for (const StudioView& take : StudioViews(FourViews(21), 12)) {
    const auto found = TriangulatedWithAudit(take.evidence);
    ASSERT_TRUE(found) << found.error().Message();
    EXPECT_TRUE(found->report.faults.empty()) << take.name << ": " << ReportedByAudit(*found);
    ASSERT_EQ(found->report.residual_px.size(), 4u);
    for (const auto& camera : found->report.residual_px) {
      for (const double px : camera) EXPECT_LT(px, 10.0);
    }
  }
}

TEST(RigAudit, EstimatesClockOffsetsToMilliseconds) {
  StudioOptions options = FourViews(22);
  options.rig.clock_offset_s = 0.08;
  int off = 0;
  int reported = 0;
  double error = 0.0;
  for (const StudioView& take : StudioViews(options, 12)) {
    const auto found = TriangulatedWithAudit(take.evidence);
    ASSERT_TRUE(found) << found.error().Message();
    const auto faults = FaultsNamed(*found, "camera_clock_off");
    const auto clock_of = [&](std::size_t c) {
      for (const RigFault& fault : faults) {
        if (fault.camera == take.evidence.keypoint_views[c].camera.name) return 1e-3 * fault.value;
      }
      return 0.0;
    };
    EXPECT_TRUE(FaultsNamed(*found, "camera_moved").empty()) << take.name << ": " << ReportedByAudit(*found);
    for (std::size_t c = 1; c < 4; ++c) {
      const double truth = take.faults.clock_s[c] - take.faults.clock_s[0];
      if (std::abs(truth) < 0.02) continue;
      ++off;
      const double away = std::abs(clock_of(c) - clock_of(0) - truth);
      if (faults.empty()) continue;
      ++reported;
      error += away;
    }
  }
  EXPECT_GE(reported, 3 * off / 4);
  EXPECT_LT(error / reported, 0.006);
}

TEST(RigAudit, CorrectedClocksRestoreThePoints) {
  StudioOptions options = FourViews(22);
  options.rig.clock_offset_s = 0.08;
  StudioOptions sound_options = FourViews(22);
  const auto takes = StudioViews(options, 4);
  const auto sound = StudioViews(sound_options, 4);
  double after = 0.0, without = 0.0;
  for (std::size_t i = 0; i < takes.size(); ++i) {
    const auto corrected = TriangulatedWithAudit(takes[i].evidence);
    const auto as_given = TriangulatedWithAudit(takes[i].evidence, Nothing());
    const auto without_fault = TriangulatedWithAudit(sound[i].evidence);
    ASSERT_TRUE(corrected && as_given && without_fault);
    after += MeanError(corrected->tracks, takes[i].truth);
    without += MeanError(without_fault->tracks, takes[i].truth);
    EXPECT_LE(MeanError(corrected->tracks, takes[i].truth), MeanError(as_given->tracks, takes[i].truth));
  }
  EXPECT_LE(after, 1.2 * without);
}

TEST(RigAudit, RefitsACameraFromTheFrameInWhichItMoved) {
  StudioOptions options = FourViews(23);
  options.rig.moved = 0.12;
  for (const StudioView& take : StudioViews(options, 6, 60)) {
    const auto found = TriangulatedWithAudit(take.evidence);
    ASSERT_TRUE(found) << found.error().Message();
    const auto faults = FaultsNamed(*found, "camera_moved");
    ASSERT_EQ(faults.size(), 1u) << take.name << ": " << ReportedByAudit(*found);
    const std::size_t last = take.evidence.keypoint_views.size() - 1;
    EXPECT_EQ(faults[0].camera, take.evidence.keypoint_views[last].camera.name);
    EXPECT_NEAR(faults[0].frame_begin, 60, 2) << take.name;
    const double moved = (take.faults.real[last].Centre() - take.evidence.keypoint_views[last].camera.Centre()).norm();
    EXPECT_NEAR(faults[0].value, 1e3 * moved, 0.6 * 1e3 * moved) << take.name;
    EXPECT_GT(faults[0].confidence, 0.99);
    EXPECT_LT(MeanError(found->tracks, take.truth), 0.022);
    const auto as_given = TriangulatedWithAudit(take.evidence, Nothing());
    ASSERT_TRUE(as_given);
    EXPECT_LT(MeanError(found->tracks, take.truth), MeanError(as_given->tracks, take.truth));
  }
}

TEST(RigAudit, ExchangesFilesOfTwoCamerasBack) {
  for (const auto& [a, b] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 3}}) {
    StudioOptions options = FourViews(24);
    options.rig.kind = RigKind::kHuman36m;  // a ring looks the same from every camera
    for (StudioView take : StudioViews(options, 6)) {
      std::vector<std::size_t> order(4);
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::swap(order[a], order[b]);
      auto& views = take.evidence.keypoint_views;
      std::swap(views[a].values, views[b].values);
      const auto found = TriangulatedWithAudit(take.evidence);
      ASSERT_TRUE(found) << take.name << " " << a << b << ": " << found.error().Message();
      const auto faults = FaultsNamed(*found, "cameras_exchanged");
      ASSERT_EQ(faults.size(), 1u) << take.name << " " << a << b;
      EXPECT_THAT(faults[0].camera, HasSubstr(views[a].camera.name));
      EXPECT_THAT(faults[0].camera, HasSubstr(views[b].camera.name));
      EXPECT_TRUE(faults[0].corrected) << faults[0].confidence;
      EXPECT_LT(MeanError(found->tracks, take.truth), 0.04);
    }
  }
}

TEST(RigAudit, CorrectsExchangedLimbsOfAViewBeforeTriangulation) {
  int exchanged = 0;
  int corrected = 0;
  int mistaken = 0;
  for (StudioView take : StudioViews(FourViews(25), 8)) {
    KeypointView& view = take.evidence.keypoint_views[1];
    const auto& names = take.evidence.keypoint_names;
    const int begin = 20;
    const int end = std::min(35, view.frames());
    for (const char* part : {"hip", "knee", "ankle", "foot"}) {
      const auto left =
          static_cast<std::size_t>(std::find(names.begin(), names.end(), std::string("left_") + part) - names.begin());
      const auto right =
          static_cast<std::size_t>(std::find(names.begin(), names.end(), std::string("right_") + part) - names.begin());
      for (int f = begin; f < end; ++f) {
        const std::size_t first = static_cast<std::size_t>(f) * names.size();
        for (std::size_t i = 0; i < 3; ++i) {
          std::swap(view.values[3 * (first + left) + i], view.values[3 * (first + right) + i]);
        }
      }
    }
    const auto found = TriangulatedWithAudit(take.evidence);
    ASSERT_TRUE(found) << found.error().Message();
    exchanged += end - begin;
    for (const RigFault& fault : FaultsNamed(*found, "view_swaps_sides")) {
      const bool right = fault.camera == view.camera.name && fault.limb == "legs";
      const int within = std::max(0, std::min(end, fault.frame_end) - std::max(begin, fault.frame_begin));
      corrected += right ? within : 0;
      mistaken += fault.frame_end - fault.frame_begin - (right ? within : 0);
    }
  }
  std::printf("%d of %d exchanged frames corrected, %d by mistake\n", corrected, exchanged, mistaken);
  EXPECT_GT(corrected, exchanged * 7 / 10);  // legs that overlap in the image cannot be corrected
  EXPECT_LT(mistaken, 6);
}

TEST(RigAudit, CorrectsACalibrationInMillimetresIfConfigured) {
  const Motion person = Swinging(20);
  Evidence evidence = Detections(Ring(4), {person}, 2.0);
  for (KeypointView& view : evidence.keypoint_views) view.camera.camera_from_world.translation *= 1000.0;
  const auto refused = TriangulatedWithAudit(evidence);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().Message(), HasSubstr("millimetres read as metres"));
  KeypointAuditOptions audit;
  audit.unit = AuditAction::kCorrect;
  const auto found = TriangulatedWithAudit(evidence, audit);
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_LT(MeanError(found->tracks, person), 0.015);
  ASSERT_EQ(FaultsNamed(*found, "calibration_unit").size(), 1u);
  EXPECT_EQ(FaultsNamed(*found, "calibration_unit")[0].value, 1000.0);
}

TEST(RigAudit, KnowsTheKeypointOrdersOfTheReaders) {
  ASSERT_EQ(KnownOrders().size(), KeypointLayouts().size());
  for (std::size_t i = 0; i < KnownOrders().size(); ++i) {
    EXPECT_EQ(KnownOrders()[i].name, KeypointLayouts()[i].name);
    EXPECT_EQ(KnownOrders()[i].points, KeypointLayouts()[i].points);
  }
}

TEST(RigAudit, IsOneLineOfProvenance) {
  RigFault fault;
  fault.code = "camera_clock_off";
  fault.camera = "cam02";
  fault.value = 33.3;
  fault.confidence = 0.999;
  fault.corrected = true;
  EXPECT_EQ(FaultsText({fault}),
            R"([{"camera":"cam02","code":"camera_clock_off","confidence":0.999,)"
            R"("confidence_of":"spans_of_one_take","corrected":true,"frames":[0,0],"value":33.3}])");
  EXPECT_EQ(FindingOf(fault).action, FindingAction::kRepaired);
}

/// The recorded single trial, altered.
class AlteredTrial : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("MOCURATE_DATA");
    if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
    folder_ = std::filesystem::path(data) / "pose2sim";
    evidence_ = ReadPose2Sim(folder_, "single");
  }

  std::filesystem::path folder_;
  Evidence evidence_;
};

TEST_F(AlteredTrial, AsRecordedOnlyTheThirdCameraIsMoved) {
  const auto found = TriangulatedWithAudit(evidence_);
  ASSERT_TRUE(found) << found.error().Message();
  for (const RigFault& fault : FaultsNamed(*found, "camera_moved"))
    EXPECT_EQ(fault.camera, "cam03") << ReportedByAudit(*found);
  EXPECT_TRUE(FaultsNamed(*found, "cameras_exchanged").empty());
  EXPECT_FALSE(FaultsNamed(*found, "camera_moved").empty());
}

TEST_F(AlteredTrial, ReportsACameraThatMovesHalfway) {
  // Detections of cam01 after a rotation: pixels mapped by the homography of a pure rotation.
  KeypointView& view = evidence_.keypoint_views[0];
  Matrix3d k;
  k << view.camera.fx, 0, view.camera.cx, 0, view.camera.fy, view.camera.cy, 0, 0, 1;
  const Matrix3d homography = k * ExpMatrix(Vector3d(0.0, 0.03, 0.01)) * k.inverse();
  const int points = view.points();
  for (int f = 40; f < view.frames(); ++f) {
    for (int i = 0; i < view.people * points; ++i) {
      double* value = view.values.data() + 3 * (static_cast<std::size_t>(f) * view.people * points + i);
      const Vector3d at = homography * Vector3d(value[0], value[1], 1.0);
      value[0] = at.x() / at.z();
      value[1] = at.y() / at.z();
    }
  }
  const auto found = TriangulatedWithAudit(evidence_);
  ASSERT_TRUE(found) << found.error().Message();
  bool reported = false;
  for (const RigFault& fault : FaultsNamed(*found, "camera_moved")) {
    if (fault.camera != view.camera.name || fault.frame_begin == 0) continue;
    reported = true;
    EXPECT_NEAR(fault.frame_begin, 40, 3);
    EXPECT_GT(fault.confidence, 0.98);
  }
  EXPECT_TRUE(reported) << ReportedByAudit(*found);
}

TEST_F(AlteredTrial, ReportsACameraWithShiftedFrames) {
  for (const int frames : {4, -3}) {
    Evidence shifted = evidence_;
    KeypointView& view = shifted.keypoint_views[1];
    for (double& time : view.time_s) time += frames / 60.0;
    const auto found = TriangulatedWithAudit(shifted);
    ASSERT_TRUE(found) << found.error().Message();
    const auto faults = FaultsNamed(*found, "camera_clock_off");
    double clock = 0.0;
    for (const RigFault& fault : faults) {
      if (fault.camera == view.camera.name) clock = fault.value;
    }
    EXPECT_NEAR(clock, -1e3 * frames / 60.0, 12.0) << ReportedByAudit(*found);
  }
}

TEST_F(AlteredTrial, ReportsExchangedFoldersOfTwoCameras) {
  auto& views = evidence_.keypoint_views;
  std::swap(views[0].values, views[3].values);
  std::swap(views[0].people, views[3].people);
  const auto found = TriangulatedWithAudit(evidence_);
  ASSERT_TRUE(found) << found.error().Message();
  const auto faults = FaultsNamed(*found, "cameras_exchanged");
  ASSERT_EQ(faults.size(), 1u) << ReportedByAudit(*found);
  EXPECT_EQ(faults[0].camera, views[0].camera.name + ", " + views[3].camera.name);
  EXPECT_TRUE(faults[0].corrected) << faults[0].confidence;
  EXPECT_LE(found->report.median_px, 8.5);
}

TEST_F(AlteredTrial, ReportsTheKeypointOrderOfAnotherDetector) {
  const Evidence wrong = ReadPose2Sim(folder_, "single", "BODY_25");
  const auto refused = TriangulatedWithAudit(wrong);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().Message(), HasSubstr("in the order of BODY_25B"));
  KeypointAuditOptions audit;
  audit.order = AuditAction::kCorrect;
  const auto found = TriangulatedWithAudit(wrong, audit);
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_EQ(found->report.keypoint_names, evidence_.keypoint_names);
  EXPECT_EQ(FaultsNamed(*found, "keypoint_order").size(), 1u);
}

TEST_F(AlteredTrial, ReportsACalibrationInMillimetres) {
  for (KeypointView& view : evidence_.keypoint_views) view.camera.camera_from_world.translation *= 1000.0;
  KeypointAuditOptions audit;
  audit.unit = AuditAction::kCorrect;
  const auto found = TriangulatedWithAudit(evidence_, audit);
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_EQ(FaultsNamed(*found, "calibration_unit").size(), 1u);
  EXPECT_LE(found->report.median_px, 8.5);
}

}  // namespace
}  // namespace mocurate
