// An audit of keypoints says no more than the take shows: what it cannot tell it does not tell, or says so.

#include <gmock/gmock.h>

#include <cstdlib>

#include "core/base/random.h"
#include "fitting/audit/confidence.h"
#include "fitting/triangulation/keypoint_tracks.h"
#include "tests/fitting/keypoint_faults.h"
#include "tests/fitting/keypoint_takes.h"
#include "tests/fitting/studio_views.h"

namespace mocurate {
namespace {

using testing::HasSubstr;

Expected<KeypointTracks> TriangulatedInDoubt(const Evidence& evidence, const KeypointAuditOptions& audit = {}) {
  static const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  KeypointFitOptions options;
  options.audit = audit;
  return TriangulateKeypoints(evidence, *skeleton, options);
}

std::string ToldByDoubt(const KeypointTracks& found) {
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

TEST(Confidence, IsNotFooledByErrorsThatLastFromMomentToMoment) {
  int sure = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    Random random(seed, "lasting errors");
    std::vector<double> worse, better(32, 0.0);
    double lasting = random.Normal();
    for (int i = 0; i < 32; ++i) {
      worse.push_back(lasting);
      lasting = 0.8 * lasting + 0.6 * random.Normal();
    }
    sure += Confidence(worse, better) > 0.99 ? 1 : 0;
  }
  EXPECT_LT(sure, 20);  // a standard error of 32 independent moments is sure of 90
  EXPECT_GT(sure, 0);
}

TEST(Confidence, IsHighWhereEveryMomentSaysTheSame) {
  Random random(3, "same");
  std::vector<double> worse, better;
  for (int i = 0; i < 32; ++i) {
    worse.push_back(10.0 + 3.0 * random.Normal());
    better.push_back(3.0 * random.Normal());
  }
  EXPECT_GT(Confidence(worse, better), 0.999);
  EXPECT_LT(Confidence(better, worse), 0.001);
}

TEST(Confidence, IsNoneInWhatOnlyRoundingTellsApart) {
  std::vector<double> worse, better;
  for (int i = 0; i < 24; ++i) {
    better.push_back(0.06 + 1e-3 * i);
    worse.push_back(better.back() + 1.4e-17 + 1.4e-17 * (i % 3));
  }
  EXPECT_EQ(Confidence(worse, better), 0.0);
}

/// Both recorded trials of one rig, whose third camera stands elsewhere.
TEST(RigDoubt, PiecesOfRecordedTrialsInventNoMoves) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  int third = 0;
  for (const char* trial : {"single", "two"}) {
    const Evidence whole = ReadPose2Sim(std::filesystem::path(data) / "pose2sim", trial);
    for (int begin = 0; begin + 45 <= whole.keypoint_views[0].frames(); begin += 4) {
      const auto found = TriangulatedInDoubt(FramesOf(whole, begin, begin + 45));
      ASSERT_TRUE(found) << found.error().Message();
      if (FaultNamed(*found, "camera_moved") != nullptr) ++third;
      for (const RigFault& fault : found->report.faults) {
        if (fault.code == "camera_clock_off") continue;
        EXPECT_TRUE(fault.code != "camera_moved" || fault.camera == "cam03")
            << trial << begin << ": " << ToldByDoubt(*found);
        EXPECT_TRUE(fault.code != "views_disagree" || fault.camera == "cam01, cam03") << ToldByDoubt(*found);
      }
      EXPECT_FALSE(found->report.doubtful) << ToldByDoubt(*found);
    }
  }
  EXPECT_GE(third, 3);
}

/// The view as of a camera whose clock is late: what it stamps happened `frames` before.
void Delay(KeypointView& view, int frames) {
  const std::vector<double> given = view.values;
  const auto row = given.size() / static_cast<std::size_t>(view.frames());
  for (int f = frames; f < view.frames(); ++f) {
    std::copy_n(given.begin() + static_cast<std::ptrdiff_t>((f - frames) * row), row,
                view.values.begin() + static_cast<std::ptrdiff_t>(f * row));
  }
}

/// Somebody walks before a rig whose third camera stands elsewhere: a clock and a place look alike there.
TEST(RigDoubt, ADelayedCameraOfARecordedTrialIsOffByWhatIsSaid) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const Evidence whole = ReadPose2Sim(std::filesystem::path(data) / "pose2sim", "single");
  for (const std::size_t late : {0u, 1u, 3u}) {
    Evidence evidence = whole;
    Delay(evidence.keypoint_views[late], 6);
    const auto found = TriangulatedInDoubt(evidence);
    ASSERT_TRUE(found) << found.error().Message();
    const RigFault* clock = FaultNamed(*found, "camera_clock_off");
    ASSERT_NE(clock, nullptr) << late;
    const std::string words = "(standard deviation ";
    const double sigma_ms = std::stod(clock->message.substr(clock->message.find(words) + words.size()));
    EXPECT_LT(std::abs(clock->value + 100.0), 2.5 * sigma_ms) << clock->message;
    if (late != 3) continue;
    EXPECT_NE(FaultNamed(*found, "views_disagree"), nullptr) << ToldByDoubt(*found);
    EXPECT_GT(std::sqrt(found->report.place_doubt.trace()), 0.03);  // people come out 60 mm off
    EXPECT_TRUE(found->report.doubtful);
  }
}

/// Detections of a studio take with something done to them; what is told, and how far points are off.
struct Read {
  std::string code, camera;
  double value = 0.0, confidence = 0.0, error_m = 0.0;
  std::size_t faults = 0;
};

Read ReadingOf(const StudioView& take, const Evidence& altered) {
  const auto found = TriangulatedInDoubt(altered);
  if (!found) return {found.error().Message(), "", 0.0, 0.0, 0.0, 0};
  Read read{"", "", 0.0, 0.0, MeanError(found->tracks, take.truth), found->report.faults.size()};
  if (read.faults == 0) return read;
  const RigFault& fault = found->report.faults[0];
  read.code = fault.code, read.camera = fault.camera, read.value = fault.value, read.confidence = fault.confidence;
  return read;
}

TEST(RigDoubt, AMirroredImageIsNamedAndTurnedBackAndNoMovedCamera) {
  int named = 0;
  for (const StudioView& take : StudioViews(FourViews(26), 4)) {
    Evidence altered = take.evidence;
    Mirror(altered.keypoint_views[1]);
    const Read read = ReadingOf(take, altered);
    EXPECT_NE(read.code, "camera_moved") << take.name;
    if (read.code != "view_mirrored") continue;  // who stands in the middle of the image looks the same mirrored
    ++named;
    EXPECT_EQ(read.camera, altered.keypoint_views[1].camera.name);
    EXPECT_EQ(read.faults, 1u);
    EXPECT_GT(read.confidence, 0.99);
    EXPECT_LT(read.error_m, 0.025);
  }
  EXPECT_GE(named, 3);
}

/// Bystanders whom no other view sees hide how much better the rig agrees.
TEST(RigDoubt, AMirroredImageOfARecordedTrialWithBystandersIsNamed) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  for (const char* trial : {"single", "two"}) {
    const Evidence whole = ReadPose2Sim(std::filesystem::path(data) / "pose2sim", trial);
    for (std::size_t v = 0; v < 4; ++v) {
      Evidence altered = whole;
      Mirror(altered.keypoint_views[v]);
      const auto found = TriangulatedInDoubt(altered);
      ASSERT_TRUE(found) << found.error().Message();
      const RigFault* fault = FaultNamed(*found, "view_mirrored");
      ASSERT_NE(fault, nullptr) << trial << v << ": " << ToldByDoubt(*found);
      EXPECT_EQ(fault->camera, altered.keypoint_views[v].camera.name);
      EXPECT_TRUE(fault->corrected);
    }
    EXPECT_EQ(FaultNamed(*TriangulatedInDoubt(whole), "view_mirrored"), nullptr);
  }
}

TEST(RigDoubt, KeypointsOfImagesOfAnotherSizeAreNamedWithTheFactor) {
  for (const bool all : {false, true}) {
    for (const StudioView& take : StudioViews(FourViews(27), 3)) {
      Evidence altered = take.evidence;
      for (std::size_t v = 0; v < 4; ++v) {
        if (all || v == 2) Enlarge(altered.keypoint_views[v], 0.5);
      }
      const Read read = ReadingOf(take, altered);
      EXPECT_EQ(read.code, "keypoint_scale") << take.name << all;
      EXPECT_EQ(read.value, 2.0);
      EXPECT_LT(read.error_m, 0.025);
    }
  }
}

TEST(RigDoubt, ARingTurnedByItsOwnSymmetryIsTheSameRig) {
  for (const StudioView& take : StudioViews(FourViews(28), 4)) {
    Evidence altered = take.evidence;
    RotateFiles(altered);
    EXPECT_EQ(ReadingOf(take, altered).faults, 0u) << take.name;
  }
}

TEST(RigDoubt, AnUnknownOrderIsNotNamed) {
  Evidence evidence = Detections(Ring(4), {Swinging(30)}, 2.0);
  auto& names = evidence.keypoint_names;
  for (std::size_t shift : {5, 9, 13}) {
    Evidence altered = evidence;
    std::rotate(altered.keypoint_names.begin(), altered.keypoint_names.begin() + static_cast<std::ptrdiff_t>(shift),
                altered.keypoint_names.end());
    const auto refused = TriangulatedInDoubt(altered);
    ASSERT_FALSE(refused) << names.size();
    EXPECT_THAT(refused.error().Message(), testing::Not(HasSubstr("in the order of"))) << shift;
    EXPECT_THAT(refused.error().Message(), HasSubstr("proportions"));
  }
}

TEST(RigDoubt, ACameraThatSeesNobodyForMostOfTheTakeIsTold) {
  Evidence evidence = Detections(Ring(4), {Swinging(30)}, 2.0);
  auto& values = evidence.keypoint_views[3].values;
  std::fill(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() * 4 / 5), 0.0);
  const auto found = TriangulatedInDoubt(evidence);
  ASSERT_TRUE(found) << found.error().Message();
  const auto told = std::find_if(found->findings.begin(), found->findings.end(),
                                 [](const Finding& finding) { return finding.code == "camera_without_person"; });
  ASSERT_NE(told, found->findings.end());
  EXPECT_NEAR(told->value, 0.8, 0.01);
  EXPECT_THAT(told->message, HasSubstr("cam4"));
}

}  // namespace
}  // namespace mocurate
