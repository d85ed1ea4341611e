// The audit of keypoints reports only what the take determines; it reports ambiguity as ambiguous.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "core/base/median.h"
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

/// Costs that differ from 10 by errors of standard deviation 1, each of which keeps `kept` of the one before.
std::vector<double> CostsWithLastingErrors(std::size_t count, double kept, Random& random) {
  std::vector<double> costs;
  double error = random.Normal();
  for (std::size_t i = 0; i < count; ++i) {
    costs.push_back(10.0 + error);
    error = kept * error + std::sqrt(1.0 - kept * kept) * random.Normal();
  }
  return costs;
}

TEST(Confidence, BoundsTheErrorsOfAllTestsTogether) {
  constexpr int kRigs = 500;
  constexpr std::size_t kTests = 12;
  int wrong = 0, wrong_alone = 0;
  for (int rig = 0; rig < kRigs; ++rig) {
    bool any = false, any_alone = false;
    for (std::size_t test = 0; test < kTests; ++test) {
      Random random(static_cast<std::uint64_t>(rig), "lasting errors", std::to_string(test));
      const std::vector<double> worse = CostsWithLastingErrors(kMomentsOfTake, 0.8, random);
      const double confidence = Confidence(worse, std::vector<double>(worse.size(), 10.0));
      any = any || ConfidenceOfTests(confidence, kTests) > 0.99;
      any_alone = any_alone || confidence > 0.99;
    }
    wrong += any ? 1 : 0;
    wrong_alone += any_alone ? 1 : 0;
  }
  std::printf("%d of %d rigs, %d where the number of tests is ignored\n", wrong, kRigs, wrong_alone);
  EXPECT_LE(wrong, 10);  // 5 are expected
  EXPECT_GT(wrong_alone, 30);
}

/// Hypotheses that are all wrong: the best of many always seems better than as given.
TEST(Confidence, OfTheBestOfManyIsLowWhereHalfOfTheMomentsJudges) {
  constexpr int kTakes = 300;
  int wrong = 0, wrong_in_sample = 0;
  for (int take = 0; take < kTakes; ++take) {
    Random random(static_cast<std::uint64_t>(take), "hypotheses");
    const std::vector<double> given = CostsWithLastingErrors(24, 0.5, random);
    std::vector<std::vector<double>> all;
    for (int i = 0; i < 77; ++i) all.push_back(CostsWithLastingErrors(24, 0.5, random));
    const auto best = std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return std::accumulate(a.begin(), a.end(), 0.0) < std::accumulate(b.begin(), b.end(), 0.0);
    });
    wrong_in_sample += Confidence(given, *best) > 0.99 ? 1 : 0;
    wrong += Confidence(given, HeldOutCosts(all, FirstAndSecondHalf(given.size()))) > 0.99 ? 1 : 0;
  }
  std::printf("%d of %d takes, %d in sample\n", wrong, kTakes, wrong_in_sample);
  EXPECT_LE(wrong, 6);  // 3 are expected
  EXPECT_GT(wrong_in_sample, 30);
}

TEST(Confidence, HalvesAreAlternateSpansThatJudgeEachOther) {
  const std::vector<int> halves = HalvesOf(20);
  for (std::size_t i = 0; i < halves.size(); ++i) EXPECT_EQ(halves[i], static_cast<int>(i / 2 % 2));
  EXPECT_EQ(HalvesOf(kMomentsOfTake + 1)[3], 0);
  EXPECT_EQ(HalvesOf(kMomentsOfTake + 1)[4], 1) << "two takes have spans twice as many";
  EXPECT_EQ(HeldOutCosts({{1, 1, 5, 5}, {2, 2, 3, 3}}, {0, 0, 1, 1}), (std::vector<double>{2, 2, 5, 5}));
  EXPECT_EQ(HeldOutCosts({{1, 1, -1, -1}, {2, 2, 3, 3}}, {0, 0, 1, 1}), (std::vector<double>{2, 2, -1, -1}));
}

TEST(Confidence, IsHighWhereEveryMomentAgrees) {
  Random random(3, "same");
  std::vector<double> worse, better;
  for (int i = 0; i < 32; ++i) {
    worse.push_back(30.0 + 3.0 * random.Normal());
    better.push_back(20.0 + 3.0 * random.Normal());
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

/// Median distance of the points that both have, metres.
double DistanceOf(const JointTracks& a, const JointTracks& b) {
  std::vector<double> apart;
  for (std::size_t i = 0; i < std::min(a.confidence.size(), b.confidence.size()); ++i) {
    if (a.confidence[i] <= 0.0 || b.confidence[i] <= 0.0) continue;
    const Eigen::Map<const Vector3d> one(a.positions.xyz.data() + 3 * i), other(b.positions.xyz.data() + 3 * i);
    apart.push_back((one - other).norm());
  }
  EXPECT_FALSE(apart.empty());
  EXPECT_EQ(a.confidence.size(), b.confidence.size());
  return MeanMedian(apart);
}

/// A person walks before a rig whose third camera is misplaced: clock offset and displacement are nearly ambiguous
/// there.
TEST(RigAmbiguity, ClockOffsetOfARecordedTrialIsFoundAndThePointsAreRestored) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const Evidence whole = ReadPose2Sim(std::filesystem::path(data) / "pose2sim", "single");
  const auto given = TriangulatedTake(whole);
  ASSERT_TRUE(given) << given.error().Message();
  for (std::size_t late = 0; late < 4; ++late) {
    Evidence evidence = whole;
    Delay(evidence.keypoint_views[late], 6);
    const auto found = TriangulatedTake(evidence);
    ASSERT_TRUE(found) << found.error().Message();
    double clock_ms = 0.0;
    for (const RigFault& fault : found->report.faults) {
      const bool of_it = fault.camera == whole.keypoint_views[late].camera.name;
      if (of_it && fault.code == "camera_clock_off") clock_ms = fault.value;
    }
    EXPECT_NEAR(clock_ms, -100.0, 20.0) << late << ": " << ReportedByCheck(*found);
    EXPECT_LT(DistanceOf(found->tracks, given->tracks), 0.015) << late;
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
