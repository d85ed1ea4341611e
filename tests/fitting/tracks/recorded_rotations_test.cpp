// Rotations that a source recorded, as evidence in addition to positions.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fitting/evidence/motion_tracks.h"
#include "fitting/solver/joint_track_fit.h"
#include "tests/fitting/takes.h"

namespace mocurate {
namespace {

constexpr double kRadiansOfDegree = 3.14159265358979323846 / 180.0;
constexpr int kRecordedElbow = 4;
constexpr int kShoulder = 3;
constexpr int kAnkle = 10;

Quaterniond WorldRotation(const Motion& motion, int frame, int joint) {
  const int parent = motion.skeleton->joints[joint].parent;
  return parent < 0 ? motion.rotation_at(frame, joint)
                    : WorldRotation(motion, frame, parent) * motion.rotation_at(frame, joint);
}

/// A take whose source also recorded rotations, each joint's in a frame of the source's own choice.
PlayedTake Recorded(double noise_rad, std::uint64_t seed = 5) {
  PlayedTake take = SmoothTake(90);
  Random random(seed, "recorded");
  std::vector<Quaterniond> convention;
  for (int j = 0; j < take.tracks.joints(); ++j)
    convention.push_back(ExpQuaternion(Vector3d(random.Normal(), random.Normal(), random.Normal())));
  for (int f = 0; f < take.tracks.frames(); ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) {
      const Vector3d noise = noise_rad * Vector3d(random.Normal(), random.Normal(), random.Normal());
      take.tracks.rotation.push_back(WorldRotation(take.truth, f, j) * ExpQuaternion(noise) * convention[j]);
      take.tracks.rotation_confidence.push_back(1.0);
    }
  }
  return take;
}

/// Error of a joint's twist about its bone, degrees: its mean, and the RMS of the rest.
struct TwistError {
  double mean = 0.0;
  double changing = 0.0;
};

TwistError TwistErrorOf(const Motion& fitted, const Motion& truth, int joint, const Vector3d& bone) {
  std::vector<double> twist;
  TwistError error;
  for (int f = 0; f < truth.frame_count(); ++f) {
    const Quaterniond away = WorldRotation(truth, f, joint).conjugate() * WorldRotation(fitted, f, joint);
    twist.push_back(LogQuaternion(away).dot(bone.normalized()) / kRadiansOfDegree);
    error.mean += twist.back() / truth.frame_count();
  }
  double square = 0.0;
  for (const double value : twist) square += (value - error.mean) * (value - error.mean) / truth.frame_count();
  error.changing = std::sqrt(square);
  return error;
}

FitResult FitRecorded(const PlayedTake& take, JointTrackOptions options = {}) {
  auto fit = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, options);
  EXPECT_TRUE(fit) << fit.error().Message();
  return *std::move(fit);
}

class RecordedRotations : public testing::TestWithParam<PoseSolver> {
 protected:
  JointTrackOptions Options() const {
    JointTrackOptions options;
    options.solver = GetParam();
    return options;
  }
};

INSTANTIATE_TEST_SUITE_P(Solvers, RecordedRotations, testing::Values(PoseSolver::kCeres, PoseSolver::kBanded),
                         [](const auto& solver) { return solver.param == PoseSolver::kCeres ? "Ceres" : "Banded"; });

TEST_P(RecordedRotations, DetermineChangesOfTwistInAnyFrameOfTheSource) {
  PlayedTake take = Recorded(2.0 * kRadiansOfDegree);
  AddNoise(take.tracks, 0.01, 8);
  const Vector3d forearm(1, 0, 0);
  const FitResult with = FitRecorded(take, Options());
  JointTrackOptions without = Options();
  without.recorded_rotations = false;
  const FitResult positions = FitRecorded(take, without);
  const TwistError recorded = TwistErrorOf(with.motion, take.truth, kRecordedElbow, forearm);
  const TwistError defaults = TwistErrorOf(positions.motion, take.truth, kRecordedElbow, forearm);
  EXPECT_LT(recorded.changing, 3.0);
  EXPECT_GT(defaults.changing, 3.0 * recorded.changing);
  EXPECT_NEAR(recorded.mean, defaults.mean, 10.0) << "the orientation of the source's frames is not a twist";
  const std::size_t at = 3 * (static_cast<std::size_t>(45) * take.tracks.joints() + kRecordedElbow);
  EXPECT_GT(with.motion.rotation_sigma[at], 0.15F) << "the mean twist is not observed";
}

TEST_P(RecordedRotations, AreEvidenceForJointsWithoutObservedChildren) {
  const PlayedTake take = Recorded(0.0);
  const FitResult with = FitRecorded(take, Options());
  EXPECT_LT(TwistErrorOf(with.motion, take.truth, kAnkle, Vector3d(1, 0, 0)).changing, 3.0);
}

TEST(RecordedRotationsOfTracks, MoveNoJointByMoreThanItsNoise) {
  PlayedTake take = Recorded(5.0 * kRadiansOfDegree);
  AddNoise(take.tracks, 0.005, 8);
  const FitResult with = FitRecorded(take);
  JointTrackOptions without;
  without.recorded_rotations = false;
  const FitResult positions = FitRecorded(take, without);
  double square = 0.0;
  for (std::size_t i = 0; i < with.motion.joints.xyz.size(); ++i) {
    const double moved = with.motion.joints.xyz[i] - positions.motion.joints.xyz[i];
    square += moved * moved / static_cast<double>(with.motion.joints.xyz.size());
  }
  EXPECT_LT(std::sqrt(square), 0.005);
}

TEST(RecordedRotationsOfTracks, AreReportedAndNotUsedWhereTheyContradictTheJoint) {
  PlayedTake take = Recorded(0.0);
  Random random(6, "wild");
  const auto joints = static_cast<std::size_t>(take.tracks.joints());
  for (int f = 0; f < take.tracks.frames(); ++f) {
    take.tracks.rotation[static_cast<std::size_t>(f) * joints + kShoulder] =
        ExpQuaternion(2.0 * Vector3d(random.Normal(), random.Normal(), random.Normal()));
  }
  const FitResult fit = FitRecorded(take);
  int reported = 0;
  for (const Finding& finding : fit.findings) {
    if (finding.code != "rotations_disagree") continue;
    ++reported;
    EXPECT_EQ(finding.joint, "left_shoulder");
    EXPECT_GT(finding.value, 30.0);
  }
  EXPECT_EQ(reported, 1);
}

TEST(RecordedRotationsOfTracks, AreReportedAsTooFewInShortClips) {
  for (const int frames : {1, 2, 5}) {
    PlayedTake take = Recorded(0.0);
    take.tracks = CutTracks(take.tracks, 0, frames);
    take.truth = {};
    const auto fit = FitJointTracks(take.tracks, FrameRate{30, 1}, take.tracks.skeleton->RestBoneLengths(), {});
    ASSERT_TRUE(fit) << fit.error().Message();
    int reported = 0;
    for (const Finding& finding : fit->findings) reported += finding.code == "rotations_too_few" ? 1 : 0;
    EXPECT_EQ(reported, 1) << frames;
  }
}

TEST(RecordedRotationsOfTracks, AreNotReadAtZeroConfidence) {
  PlayedTake take = Recorded(0.0);
  PlayedTake other = take;
  const Quaterniond nothing(std::numeric_limits<double>::quiet_NaN(), 0, 0, 0);
  for (PlayedTake* one : {&take, &other}) {
    for (std::size_t i = 0; i < one->tracks.rotation.size(); i += 3) {
      one->tracks.rotation[i] = one == &take ? nothing : Quaterniond::Identity();
      one->tracks.rotation_confidence[i] = 0.0;
    }
  }
  EXPECT_EQ(FitRecorded(take).motion.joints.xyz, FitRecorded(other).motion.joints.xyz);
}

TEST(RecordedRotationsOfTracks, AreRefusedByPlaceIfTheyAreNotRotations) {
  const PlayedTake take = Recorded(0.0);
  JointTracks source = AsSource(take.tracks);
  source.rotation = take.tracks.rotation;
  source.rotation_confidence = take.tracks.rotation_confidence;
  ASSERT_TRUE(MapTracks(source, take.tracks.skeleton));
  source.rotation[14 + 3].w() = std::numeric_limits<double>::quiet_NaN();
  const auto mapped = MapTracks(source, take.tracks.skeleton);
  ASSERT_FALSE(mapped);
  EXPECT_EQ(mapped.error().where, "track 'left_shoulder' frame 1");
}

TEST(RecordedRotationsOfTracks, KeepTheTwistOfAGivenMotionOnAnotherSkeleton) {
  const PlayedTake take = SmoothTake(90);
  auto other = std::make_shared<Skeleton>(*take.truth.skeleton);  // the same joints, another rest pose: arms down
  other->name = "arms_down";
  for (Joint& joint : other->joints) {
    if (joint.name.find("elbow") != std::string::npos || joint.name.find("wrist") != std::string::npos)
      joint.rest_offset = Vector3d(0, -joint.rest_offset.norm(), 0);
  }
  const auto tracks = TracksOfMotion(take.truth, *other);
  ASSERT_TRUE(tracks);
  const auto mapped = MapTracks(*tracks, other);
  ASSERT_TRUE(mapped);
  const auto fit = FitJointTracks(*mapped, take.truth.rate, other->RestBoneLengths(), {});
  ASSERT_TRUE(fit);
  double worst = 0.0;
  const Quaterniond first =
      WorldRotation(take.truth, 0, kRecordedElbow).conjugate() * WorldRotation(fit->motion, 0, kRecordedElbow);
  for (int f = 0; f < take.truth.frame_count(); ++f) {
    const Quaterniond here =
        WorldRotation(take.truth, f, kRecordedElbow).conjugate() * WorldRotation(fit->motion, f, kRecordedElbow);
    worst = std::max(worst, first.angularDistance(here));
  }
  EXPECT_LT(worst, 3.0 * kRadiansOfDegree) << "the elbow rotates as before, except for its rest frame";
}

}  // namespace
}  // namespace mocurate
