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

Expected<KeypointTracks> Triangulated(const Evidence& evidence, const KeypointAuditOptions& audit = {}) {
  static const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  KeypointFitOptions options;
  options.audit = audit;
  return TriangulateKeypoints(evidence, *skeleton, options);
}

std::string Told(const KeypointTracks& found) {
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

/// Both recorded trials of one rig, whose third camera stands elsewhere.
TEST(RigDoubt, PiecesOfRecordedTrialsInventNoMoves) {
  const char* data = std::getenv("MOCURATE_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_TEST_DATA is not set";
  int third = 0;
  for (const char* trial : {"single", "two"}) {
    const Evidence whole = ReadPose2Sim(std::filesystem::path(data) / "pose2sim", trial);
    for (int begin = 0; begin + 45 <= whole.keypoint_views[0].frames(); begin += 4) {
      const auto found = Triangulated(FramesOf(whole, begin, begin + 45));
      ASSERT_TRUE(found) << found.error().Message();
      if (FaultNamed(*found, "camera_moved") != nullptr) ++third;
      for (const RigFault& fault : found->report.faults) {
        if (fault.code == "camera_clock_off") continue;
        EXPECT_TRUE(fault.code != "camera_moved" || fault.camera == "cam03") << trial << begin << ": " << Told(*found);
        EXPECT_TRUE(fault.code != "views_disagree" || fault.camera == "cam01, cam03") << Told(*found);
      }
      EXPECT_FALSE(found->report.doubtful) << Told(*found);
    }
  }
  EXPECT_GE(third, 3);
}

}  // namespace
}  // namespace mocurate
