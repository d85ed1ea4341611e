#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "fitting/evidence/noise.h"
#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "fitting/solver/joint_track_fit.h"
#include "tests/fitting/takes.h"
#include "tests/fitting/track_problems.h"

namespace mocurate {
namespace {

Clip ClipOf(const PlayedTake& take) {
  Clip clip;
  clip.identity.recording = "bad";
  clip.rate = take.truth.rate;
  clip.evidence.tracks = AsSource(take.tracks);
  return clip;
}

/// Fits with both solvers and checks that every number is finite and that states, uncertainty and termination are set.
FitResult SoundFit(const Clip& clip, const std::vector<double>& bones = {}) {
  FittingOptions options;
  for (const PoseSolver solver : {PoseSolver::kCeres, PoseSolver::kBanded}) {
    options.joint_tracks.solver = solver;
    const auto fit = FitTracksOfClip(clip, TestSkeleton(), bones, options);
    EXPECT_TRUE(fit.has_value()) << fit.error().Message();
    if (!fit) return {};
    EXPECT_TRUE(fit->motion.Check().has_value()) << fit->motion.Check().error().Message();
    for (const float value : fit->motion.position_cov) EXPECT_TRUE(std::isfinite(value));
    for (const float value : fit->motion.rotation_sigma) EXPECT_TRUE(std::isfinite(value));
    EXPECT_FALSE(OutcomeOfFit(clip, *fit, options).summary["termination"].get<std::string>().empty());
    if (solver == PoseSolver::kBanded) return *fit;
  }
  return {};
}

double SigmaAt(const FitResult& fit, int frame, int joint) {
  const std::size_t at = static_cast<std::size_t>(frame) * fit.motion.joint_count() + static_cast<std::size_t>(joint);
  const float* c = fit.motion.position_cov.data() + 6 * at;
  return std::sqrt((c[0] + c[3] + c[5]) / 3.0);
}

long TimesReported(const FitResult& fit, const std::string& code) {
  return std::count_if(fit.findings.begin(), fit.findings.end(),
                       [&](const Finding& finding) { return finding.code == code; });
}

TEST(BadTracks, FitsOneAndTwoFrames) {
  for (const int frames : {1, 2}) {
    const PlayedTake take = SmoothTake(frames);
    const FitResult fit = SoundFit(ClipOf(take), take.truth.bone_length);
    EXPECT_LT(RmsError(fit.motion.joints, take.truth.joints), 2e-3) << frames;
    EXPECT_EQ(TimesReported(fit, "noise_not_measured"), 1);
    EXPECT_GT(SigmaAt(fit, 0, 5), 0.005) << "one frame cannot locate a joint to a millimetre";
  }
  EXPECT_EQ(TimesReported(SoundFit(ClipOf(SmoothTake(30))), "noise_not_measured"), 0);
}

TEST(BadTracks, RefusesAClipThatShowsTooFewJoints) {
  for (const int shown : {4, 6}) {
    PlayedTake take = SmoothTake(20);
    for (int f = 0; f < 20; ++f) {
      for (int j = shown; j < take.tracks.joints(); ++j)
        take.tracks.confidence[static_cast<std::size_t>(f) * take.tracks.joints() + j] = 0.0;
    }
    const auto fit = FitTracksOfClip(ClipOf(take), TestSkeleton(), {}, FittingOptions());
    ASSERT_EQ(fit.has_value(), shown == 6) << shown;
  }
}

/// 2-D points whose depth is a constant.
TEST(BadTracks, RefusesJointsInOnePlane) {
  PlayedTake take = SmoothTake(60);
  AddNoise(take.tracks, 0.01, 3);
  SoundFit(ClipOf(take));
  const Matrix3d tilted = ExpQuaternion(Vector3d(0.3, 0.7, 0.1)).toRotationMatrix();
  for (int f = 0; f < 60; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) {
      Vector3d place = take.tracks.positions.at(f, j);
      place.z() = 2.5;
      take.tracks.positions.at(f, j) = tilted * place;
    }
  }
  const auto fit = FitTracksOfClip(ClipOf(take), TestSkeleton(), {}, FittingOptions{});
  ASSERT_FALSE(fit.has_value());
  EXPECT_NE(fit.error().what.find("one plane (to 0 mm in the median) in 60 of 60 frames"), std::string::npos)
      << fit.error().what;
}

/// A tracker writes zeros where it sees no person: those samples are not observed.
TEST(BadTracks, TreatsZeroPositionsAsNotObserved) {
  PlayedTake take = SmoothTake(60);
  AddNoise(take.tracks, 0.01, 3);
  const auto zero_from = [&](int begin) {
    for (int f = begin; f < 60; ++f) {
      for (int j = 0; j < take.tracks.joints(); ++j) take.tracks.positions.at(f, j).setZero();
    }
  };
  zero_from(20);
  const FitResult fit = SoundFit(ClipOf(take), take.truth.bone_length);
  EXPECT_EQ(TimesReported(fit, "zero_frames"), 1);
  for (int f = 0; f < 60; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) {
      const JointState state = fit.motion.state[static_cast<std::size_t>(f) * 14 + static_cast<std::size_t>(j)];
      EXPECT_EQ(state == JointState::kObserved, f < 20) << f << " " << j;
    }
  }
  EXPECT_GT(SigmaAt(fit, 59, 5), 5.0 * SigmaAt(fit, 10, 5));
  zero_from(2);
  const auto hardly = FitTracksOfClip(ClipOf(take), TestSkeleton(), take.truth.bone_length, FittingOptions{});
  ASSERT_TRUE(hardly.has_value()) << "frames in one point must not count as a flat body: " << hardly.error().what;
  EXPECT_EQ(TimesReported(*hardly, "zero_frames"), 1);
  zero_from(0);
  const auto no_person = FitTracksOfClip(ClipOf(take), TestSkeleton(), {}, FittingOptions{});
  ASSERT_FALSE(no_person.has_value());
  EXPECT_NE(no_person.error().what.find("all joints lie in one point"), std::string::npos) << no_person.error().what;
}

TEST(BadTracks, RefusesInfinitiesNamingTheirPlace) {
  for (const double value : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    PlayedTake take = SmoothTake(10);
    take.tracks.positions.at(4, 2).x() = value;
    const auto fit = FitTracksOfClip(ClipOf(take), TestSkeleton(), {}, FittingOptions{});
    ASSERT_FALSE(fit.has_value());
    EXPECT_EQ(fit.error().code, ErrorCode::kMalformed);
    EXPECT_NE(fit.error().where.find("track 'head' frame 4"), std::string::npos) << fit.error().where;
  }
}

TEST(BadTracks, RefusesDuplicateTimesNamingFrameAndTime) {
  PlayedTake take = SmoothTake(10);
  take.tracks.time_s[6] = take.tracks.time_s[5];
  const auto fit = FitTracksOfClip(ClipOf(take), TestSkeleton(), {}, FittingOptions{});
  ASSERT_FALSE(fit.has_value());
  EXPECT_NE(fit.error().where.find("tracks frame 6"), std::string::npos);
  EXPECT_NE(fit.error().what.find("0.16666"), std::string::npos) << fit.error().what;
}

TEST(BadTracks, RefusesNoPersonAndReportsLargeUncertaintyInAGap) {
  PlayedTake take = SmoothTake(120);
  for (int f = 40; f < 85; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) Hide(take.tracks, f, j);
  }
  AddNoise(take.tracks, 0.01, 3);
  const FitResult fit = SoundFit(ClipOf(take), take.truth.bone_length);
  ASSERT_FALSE(fit.findings.empty());
  EXPECT_EQ(fit.findings[0].code, "frames_without_evidence");
  EXPECT_EQ(fit.findings[0].value, 45);
  EXPECT_GT(SigmaAt(fit, 62, 5), 5.0 * SigmaAt(fit, 20, 5));
  EXPECT_EQ(fit.motion.state[static_cast<std::size_t>(62) * 14 + 5], JointState::kInferred);
  for (int f = 0; f < 120; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) Hide(take.tracks, f, j);
  }
  const auto nothing = FitTracksOfClip(ClipOf(take), TestSkeleton(), {}, FittingOptions{});
  ASSERT_FALSE(nothing.has_value());
  EXPECT_NE(nothing.error().what.find("120 frames"), std::string::npos);
}

/// A person can move farther in two seconds than a sum of independent steps predicts.
TEST(BadTracks, UncertaintyInALongGapExceedsARandomWalk) {
  double sigma[2] = {};
  for (const int longer : {0, 1}) {
    PlayedTake take = SmoothTake(150);
    AddNoise(take.tracks, 0.01, 3);
    const int half = longer == 1 ? 30 : 7;
    for (int f = 75 - half; f <= 75 + half; ++f) {
      for (int j = 0; j < take.tracks.joints(); ++j) Hide(take.tracks, f, j);
    }
    sigma[longer] = SigmaAt(SoundFit(ClipOf(take), take.truth.bone_length), 75, 5);
  }
  EXPECT_GT(sigma[1], 4.0 * sigma[0]) << "a random walk would double it";
}

/// A tracker that loses a hand writes the wrist's position there: the sample carries no information on the hand or on
/// noise.
TEST(BadTracks, TreatsAJointAtItsParentsPositionAsMissing) {
  PlayedTake take = SmoothTake(120);
  AddNoise(take.tracks, 0.01, 4);
  const double noise = EstimateNoise(take.tracks, take.truth.bone_length).sigma;
  const int wrist = *TestSkeleton()->FindJoint("left_wrist");
  const int elbow = *TestSkeleton()->FindJoint("left_elbow");
  for (int f = 0; f < 120; ++f) {
    if (f % 3 != 0) take.tracks.positions.at(f, wrist) = Vector3d(take.tracks.positions.at(f, elbow));
    if (f % 30 == 1) {  // the whole arm: one finding per joint
      for (const int joint : {elbow, wrist})
        take.tracks.positions.at(f, joint) =
            Vector3d(take.tracks.positions.at(f, TestSkeleton()->joints[elbow].parent));
    }
  }
  EXPECT_NEAR(EstimateNoise(take.tracks, take.truth.bone_length).sigma, noise, 0.2 * noise);
  const auto person = EstimateProportions({take.tracks}, TestSkeleton(), ProportionsOptions{});
  EXPECT_NEAR(person.bone_length[wrist], take.truth.bone_length[wrist], 0.01);
  const FitResult fit = SoundFit(ClipOf(take), take.truth.bone_length);
  int reported = 0;
  for (const Finding& finding : fit.findings) reported += finding.code == "zero_length_bone" ? 1 : 0;
  EXPECT_EQ(reported, 40 + 4) << "spans of the wrist, frames of the elbow";
  for (int f = 0; f < 120; ++f) {
    const JointState state = fit.motion.state[static_cast<std::size_t>(f * fit.motion.joint_count() + wrist)];
    EXPECT_EQ(state == JointState::kObserved, f % 3 == 0) << f;
    EXPECT_LT((fit.motion.joints.at(f, wrist) - take.truth.joints.at(f, wrist)).norm(), 0.06) << f;
  }
}

TEST(BadTracks, FitsZeroLengthBonesWithALargeResidual) {
  PlayedTake take = SmoothTake(30);
  std::vector<double> bones = take.truth.bone_length;
  bones[4] = bones[5] = 0.0;
  const FitResult fit = SoundFit(ClipOf(take), bones);
  EXPECT_GT(fit.residual_p95, 0.1);
  for (int f = 0; f < 30; ++f) {  // the tracker places all joints in one point
    for (int j = 0; j < take.tracks.joints(); ++j) take.tracks.positions.at(f, j) = Vector3d(0.3, 1.0, -2.0);
  }
  const Clip clip = ClipOf(take);
  const auto tracks = MapTracks(*clip.evidence.tracks, TestSkeleton());
  ASSERT_TRUE(tracks.has_value());
  const auto person = EstimateProportions({*tracks}, TestSkeleton(), ProportionsOptions{});
  for (const double length : person.bone_length) EXPECT_TRUE(std::isfinite(length) && length >= 0.0);
  EXPECT_FALSE(FitTracksOfClip(clip, TestSkeleton(), take.truth.bone_length, FittingOptions{}).has_value());
}

/// After a pause of the recording nothing shows the person any more: where she is then, no prior knows.
TEST(BadTracks, StatesNoUncertaintyWhereNothingDeterminesTheRoot) {
  PlayedTake take = SmoothTake(60);
  for (int f = 40; f < 60; ++f) {
    take.tracks.time_s[static_cast<std::size_t>(f)] += 2.0 * kMaxGap_s;
    for (int j = 0; j < take.tracks.joints(); ++j) Hide(take.tracks, f, j);
  }
  for (const PoseSolver solver : {PoseSolver::kCeres, PoseSolver::kBanded}) {
    JointTrackOptions options;
    options.solver = solver;
    const auto fit = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, options);
    ASSERT_TRUE(fit) << fit.error().Message();
    EXPECT_TRUE(fit->motion.position_cov.empty());
    EXPECT_TRUE(fit->motion.rotation_sigma.empty());
    const auto finding = std::find_if(fit->findings.begin(), fit->findings.end(),
                                      [](const Finding& of_fit) { return of_fit.code == kNoUncertainty; });
    ASSERT_NE(finding, fit->findings.end());
    EXPECT_NE(finding->message.find("pelvis"), std::string::npos) << finding->message;

    double worst = 0.0;
    for (int f = 0; f < 40; ++f) {
      for (int j = 0; j < take.tracks.joints(); ++j)
        worst = std::max(worst, (fit->motion.joints.at(f, j) - take.truth.joints.at(f, j)).norm());
    }
    EXPECT_LT(worst, 0.01) << "the frames before are fitted";
  }
}

}  // namespace
}  // namespace mocurate
