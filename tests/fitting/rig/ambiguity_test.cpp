// The audit of keypoints reports only what the take determines; it reports ambiguity as ambiguous.

#include <gmock/gmock.h>

#include <cstdlib>

#include "core/base/random.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/triangulation/keypoint_tracks.h"
#include "tests/fitting/keypoint_faults.h"
#include "tests/fitting/keypoint_takes.h"
#include "tests/fitting/studio_views.h"

namespace mocurate {
namespace {

using testing::HasSubstr;

Expected<KeypointTracks> TriangulatedTake(const Evidence& evidence, const KeypointAuditOptions& audit = {}) {
  static const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  KeypointFitOptions options;
  options.audit = audit;
  return TriangulateKeypoints(evidence, *skeleton, options);
}

std::string ReportedByCheck(const KeypointTracks& found) {
  std::string text;
  for (const RigFault& fault : found.report.faults) text += fault.code + ": " + fault.message + "\n";
  return text;
}

const RigFault* FaultNamed(const KeypointTracks& found, const std::string& code) {
  for (const RigFault& fault : found.report.faults) {
    if (fault.code == code) return &fault;
  }
  return nullptr;
}

TEST(Confidence, IsLowForAutocorrelatedErrors) {
  int confident = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    Random random(seed, "lasting errors");
    std::vector<double> worse, better(32, 0.0);
    double correlated = random.Normal();
    for (int i = 0; i < 32; ++i) {
      worse.push_back(correlated);
      correlated = 0.8 * correlated + 0.6 * random.Normal();
    }
    confident += Confidence(worse, better) > 0.99 ? 1 : 0;
  }
  EXPECT_LT(confident, 20);  // a standard error of 32 independent moments would accept 90
  EXPECT_GT(confident, 0);
}

TEST(Confidence, IsHighWhereEveryMomentAgrees) {
  Random random(3, "same");
  std::vector<double> worse, better;
  for (int i = 0; i < 32; ++i) {
    worse.push_back(10.0 + 3.0 * random.Normal());
    better.push_back(3.0 * random.Normal());
  }
  EXPECT_GT(Confidence(worse, better), 0.999);
  EXPECT_LT(Confidence(better, worse), 0.001);
}

TEST(Confidence, IsZeroForRoundingDifferences) {
  std::vector<double> worse, better;
  for (int i = 0; i < 24; ++i) {
    better.push_back(0.06 + 1e-3 * i);
    worse.push_back(better.back() + 1.4e-17 + 1.4e-17 * (i % 3));
  }
  EXPECT_EQ(Confidence(worse, better), 0.0);
}

/// Both recorded trials of one rig, whose third camera is misplaced.
TEST(RigAmbiguity, ExtractsOfRecordedTrialsReportNoFalseMoves) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  int third = 0;
  for (const char* trial : {"single", "two"}) {
    const Evidence whole = ReadPose2Sim(std::filesystem::path(data) / "pose2sim", trial);
    for (int begin = 0; begin + 45 <= whole.keypoint_views[0].frames(); begin += 4) {
      const auto found = TriangulatedTake(FramesOf(whole, begin, begin + 45));
      ASSERT_TRUE(found) << found.error().Message();
      if (FaultNamed(*found, "camera_moved") != nullptr) ++third;
      for (const RigFault& fault : found->report.faults) {
        if (fault.code == "camera_clock_off") continue;
        EXPECT_TRUE(fault.code != "camera_moved" || fault.camera == "cam03")
            << trial << begin << ": " << ReportedByCheck(*found);
        EXPECT_TRUE(fault.code != "views_disagree" || fault.camera == "cam01, cam03") << ReportedByCheck(*found);
      }
      EXPECT_FALSE(found->report.suspect) << ReportedByCheck(*found);
    }
  }
  EXPECT_GE(third, 3);
}

/// The view of a camera whose clock is late: its frames show what happened `frames` earlier.
void Delay(KeypointView& view, int frames) {
  const std::vector<double> given = view.values;
  const auto row = given.size() / static_cast<std::size_t>(view.frames());
  for (int f = frames; f < view.frames(); ++f) {
    std::copy_n(given.begin() + static_cast<std::ptrdiff_t>((f - frames) * row), row,
                view.values.begin() + static_cast<std::ptrdiff_t>(f * row));
  }
}

/// A person walks before a rig whose third camera is misplaced: clock offset and displacement are ambiguous there.
TEST(RigAmbiguity, ClockOffsetOfARecordedTrialIsWithinItsStandardDeviation) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const Evidence whole = ReadPose2Sim(std::filesystem::path(data) / "pose2sim", "single");
  for (const std::size_t late : {0u, 1u, 3u}) {
    Evidence evidence = whole;
    Delay(evidence.keypoint_views[late], 6);
    const auto found = TriangulatedTake(evidence);
    ASSERT_TRUE(found) << found.error().Message();
    const RigFault* clock = FaultNamed(*found, "camera_clock_off");
    ASSERT_NE(clock, nullptr) << late;
    const std::string sigma_prefix = "(standard deviation ";
    const double sigma_ms = std::stod(clock->message.substr(clock->message.find(sigma_prefix) + sigma_prefix.size()));
    EXPECT_LT(std::abs(clock->value + 100.0), 2.5 * sigma_ms) << clock->message;
    if (late != 3) continue;
    EXPECT_NE(FaultNamed(*found, "views_disagree"), nullptr) << ReportedByCheck(*found);
    EXPECT_GT(std::sqrt(found->report.place_covariance.trace()), 0.03);  // the fit is 60 mm off
    EXPECT_TRUE(found->report.suspect);
  }
}

/// The first fault reported for altered detections of a studio take, and the error of points.
struct FirstFault {
  std::string code, camera;
  double value = 0.0, confidence = 0.0, error_m = 0.0;
  std::size_t faults = 0;
};

FirstFault FirstFaultOf(const StudioView& take, const Evidence& altered) {
  const auto found = TriangulatedTake(altered);
  if (!found) return {found.error().Message(), "", 0.0, 0.0, 0.0, 0};
  FirstFault first{"", "", 0.0, 0.0, MeanError(found->tracks, take.truth), found->report.faults.size()};
  if (first.faults == 0) return first;
  const RigFault& fault = found->report.faults[0];
  first.code = fault.code, first.camera = fault.camera, first.value = fault.value, first.confidence = fault.confidence;
  return first;
}

TEST(RigAmbiguity, CorrectsAMirroredImageWithoutReportingAMovedCamera) {
  int named = 0;
  for (const StudioView& take : StudioViews(FourViews(26), 4)) {
    Evidence altered = take.evidence;
    Mirror(altered.keypoint_views[1]);
    const FirstFault first = FirstFaultOf(take, altered);
    EXPECT_NE(first.code, "camera_moved") << take.name;
    if (first.code != "view_mirrored") continue;  // a person in the middle of the image looks the same mirrored
    ++named;
    EXPECT_EQ(first.camera, altered.keypoint_views[1].camera.name);
    EXPECT_EQ(first.faults, 1u);
    EXPECT_GT(first.confidence, 0.99);
    EXPECT_LT(first.error_m, 0.025);
  }
  EXPECT_GE(named, 3);
}

/// Bystanders in no other view hide how much the agreement improves.
TEST(RigAmbiguity, ReportsAMirroredImageOfARecordedTrialWithBystanders) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  for (const char* trial : {"single", "two"}) {
    const Evidence whole = ReadPose2Sim(std::filesystem::path(data) / "pose2sim", trial);
    for (std::size_t v = 0; v < 4; ++v) {
      Evidence altered = whole;
      Mirror(altered.keypoint_views[v]);
      const auto found = TriangulatedTake(altered);
      ASSERT_TRUE(found) << found.error().Message();
      const RigFault* fault = FaultNamed(*found, "view_mirrored");
      ASSERT_NE(fault, nullptr) << trial << v << ": " << ReportedByCheck(*found);
      EXPECT_EQ(fault->camera, altered.keypoint_views[v].camera.name);
      EXPECT_TRUE(fault->corrected);
    }
    EXPECT_EQ(FaultNamed(*TriangulatedTake(whole), "view_mirrored"), nullptr);
  }
}

TEST(RigAmbiguity, ReportsTheScaleOfKeypointsOfResizedImages) {
  for (const bool all : {false, true}) {
    for (const StudioView& take : StudioViews(FourViews(27), 3)) {
      Evidence altered = take.evidence;
      for (std::size_t v = 0; v < 4; ++v) {
        if (all || v == 2) Enlarge(altered.keypoint_views[v], 0.5);
      }
      const FirstFault first = FirstFaultOf(take, altered);
      EXPECT_EQ(first.code, "keypoint_scale") << take.name << all;
      EXPECT_EQ(first.value, 2.0);
      EXPECT_LT(first.error_m, 0.025);
    }
  }
}

TEST(RigAmbiguity, RingRotatedByItsSymmetryIsTheSameRig) {
  for (const StudioView& take : StudioViews(FourViews(28), 4)) {
    Evidence altered = take.evidence;
    RotateFiles(altered);
    EXPECT_EQ(FirstFaultOf(take, altered).faults, 0u) << take.name;
  }
}

TEST(RigAmbiguity, DoesNotNameAnUnknownKeypointOrder) {
  Evidence evidence = Detections(Ring(4), {Swinging(30)}, 2.0);
  auto& names = evidence.keypoint_names;
  for (std::size_t shift : {5, 9, 13}) {
    Evidence altered = evidence;
    std::rotate(altered.keypoint_names.begin(), altered.keypoint_names.begin() + static_cast<std::ptrdiff_t>(shift),
                altered.keypoint_names.end());
    const auto refused = TriangulatedTake(altered);
    ASSERT_FALSE(refused) << names.size();
    EXPECT_THAT(refused.error().Message(), testing::Not(HasSubstr("in the order of"))) << shift;
    EXPECT_THAT(refused.error().Message(), HasSubstr("proportions"));
  }
}

TEST(RigAmbiguity, ReportsACameraWithoutAPersonInMostFrames) {
  Evidence evidence = Detections(Ring(4), {Swinging(30)}, 2.0);
  auto& values = evidence.keypoint_views[3].values;
  std::fill(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() * 4 / 5), 0.0);
  const auto found = TriangulatedTake(evidence);
  ASSERT_TRUE(found) << found.error().Message();
  const auto reported = std::find_if(found->findings.begin(), found->findings.end(),
                                     [](const Finding& finding) { return finding.code == "camera_without_person"; });
  ASSERT_NE(reported, found->findings.end());
  EXPECT_NEAR(reported->value, 0.8, 0.01);
  EXPECT_THAT(reported->message, HasSubstr("cam4"));
}

}  // namespace
}  // namespace mocurate
