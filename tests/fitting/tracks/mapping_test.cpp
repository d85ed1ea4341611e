#include <gtest/gtest.h>

#include <limits>

#include "fitting/fit_outcome.h"
#include "tests/fitting/takes.h"

namespace mocurate {
namespace {

/// The error of mapping invalid tracks.
Error ErrorOf(const JointTracks& tracks) {
  const auto mapped = MapTracks(tracks, TestSkeleton());
  EXPECT_FALSE(mapped.has_value());
  return mapped ? Error{} : mapped.error();
}

TEST(TrackMapping, FindsJointsByName) {
  const PlayedTake take = SmoothTake(5);
  const auto mapped = MapTracks(AsSource(take.tracks), TestSkeleton());
  ASSERT_TRUE(mapped.has_value()) << mapped.error().Message();
  EXPECT_EQ(mapped->positions.xyz, take.tracks.positions.xyz);
}

TEST(TrackMapping, NamesAllUnknownJoints) {
  JointTracks tracks = AsSource(SmoothTake(5).tracks);
  tracks.names[3] = "tail";
  tracks.names[8] = "third_eye";
  const Error error = ErrorOf(tracks);
  EXPECT_EQ(error.code, ErrorCode::kInconsistent);
  EXPECT_EQ(error.what, "skeleton 'test_body' has no joint named tail, third_eye");
  EXPECT_NE(error.hint.find("left_shoulder"), std::string::npos);
}

TEST(TrackMapping, RefusesTwoTracksOfOneJoint) {
  JointTracks tracks = AsSource(SmoothTake(5).tracks);
  tracks.names[4] = "head";
  EXPECT_NE(ErrorOf(tracks).what.find("are both joint 'head'"), std::string::npos);
}

TEST(TrackMapping, RefusesNonFiniteObservedValues) {
  JointTracks tracks = AsSource(SmoothTake(5).tracks);
  tracks.positions.at(2, 3).y() = std::numeric_limits<double>::quiet_NaN();
  const Error error = ErrorOf(tracks);
  EXPECT_EQ(error.code, ErrorCode::kMalformed);
  EXPECT_EQ(error.where, "track 'left_shoulder' frame 2");
}

TEST(TrackMapping, RefusesConfidenceOutsideItsRange) {
  for (const double confidence : {-0.1, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    JointTracks tracks = AsSource(SmoothTake(5).tracks);
    tracks.confidence[7] = confidence;
    EXPECT_EQ(ErrorOf(tracks).code, ErrorCode::kMalformed);
  }
}

TEST(TrackMapping, RefusesTimesThatDoNotIncrease) {
  JointTracks tracks = AsSource(SmoothTake(5).tracks);
  tracks.time_s[3] = tracks.time_s[2];
  EXPECT_EQ(ErrorOf(tracks).where, "tracks frame 3");
}

TEST(TrackMapping, RefusesShapesThatDisagree) {
  JointTracks tracks = AsSource(SmoothTake(5).tracks);
  tracks.confidence.pop_back();
  EXPECT_EQ(ErrorOf(tracks).code, ErrorCode::kInconsistent);
}

TEST(TrackMapping, RefusesAClipWithoutObservations) {
  JointTracks tracks = AsSource(SmoothTake(5).tracks);
  std::fill(tracks.confidence.begin(), tracks.confidence.end(), 0.0);
  EXPECT_EQ(ErrorOf(tracks).what, "no joint is seen at all in 5 frames");
}

TEST(FitOfClip, NeedsTracks) {
  const auto fit = FitTracksOfClip(Clip{}, TestSkeleton(), {}, FittingOptions{});
  ASSERT_FALSE(fit.has_value());
  EXPECT_EQ(fit.error().what, "the clip has no joint tracks");
}

TEST(FitOfClip, FlagsASkeletonThatContradictsTheEvidence) {
  PlayedTake take = SmoothTake(20);
  for (double& value : take.tracks.positions.xyz) value *= 10.0;  // centimetres declared as decimetres
  Clip clip;
  clip.rate = FrameRate{30, 1};
  clip.evidence.tracks = AsSource(take.tracks);
  const auto fit = FitTracksOfClip(clip, TestSkeleton(), {}, FittingOptions{});
  ASSERT_TRUE(fit.has_value());
  const StageOutcome outcome = OutcomeOfFit(clip, *fit, FittingOptions{});
  EXPECT_EQ(outcome.kind, OutcomeKind::kSuspect);
  EXPECT_EQ(outcome.findings.back().code, "large_residual");
}

TEST(FitOfClip, IsSuspectIfMostOfThePersonIsUnobserved) {
  PlayedTake take = SmoothTake(40);
  for (const int hidden : {10, 16}) {
    std::fill_n(take.tracks.confidence.begin() + 12 * take.tracks.joints(), hidden * take.tracks.joints(), 0.0);
    Clip clip;
    clip.rate = FrameRate{30, 1};
    clip.evidence.tracks = AsSource(take.tracks);
    const auto fit = FitTracksOfClip(clip, TestSkeleton(), {}, FittingOptions{});
    ASSERT_TRUE(fit) << fit.error().Message();
    const StageOutcome outcome = OutcomeOfFit(clip, *fit, FittingOptions{});
    const auto reported = std::find_if(outcome.findings.begin(), outcome.findings.end(),
                                       [](const Finding& finding) { return finding.code == "mostly_unobserved"; });
    ASSERT_EQ(reported != outcome.findings.end(), hidden > 12) << hidden << " of 40 frames";
    if (hidden <= 12) continue;
    EXPECT_NEAR(reported->value, hidden / 40.0, 1e-9);
    EXPECT_EQ(outcome.kind, OutcomeKind::kSuspect);
  }
}

TEST(FitOfClip, DoesNotDependOnTheScaleOfConfidences) {
  PlayedTake take = SmoothTake(40);
  AddNoise(take.tracks, 0.02, 5);
  for (int f = 0; f < 40; ++f) take.tracks.confidence[static_cast<std::size_t>(f) * take.tracks.joints() + 3] = 0.5;
  Clip clip;
  clip.rate = FrameRate{30, 1};
  clip.evidence.tracks = AsSource(take.tracks);
  const auto whole = FitTracksOfClip(clip, TestSkeleton(), {}, FittingOptions{});
  for (double& confidence : clip.evidence.tracks->confidence) confidence *= 0.05;
  const auto scaled = FitTracksOfClip(clip, TestSkeleton(), {}, FittingOptions{});
  ASSERT_TRUE(whole && scaled);
  EXPECT_NEAR(scaled->noise_sigma, whole->noise_sigma, 1e-9);
  for (std::size_t i = 0; i < whole->motion.joints.xyz.size(); ++i)
    ASSERT_NEAR(scaled->motion.joints.xyz[i], whole->motion.joints.xyz[i], 1e-6);
}

TEST(FittingOptions, RoundTripThroughJson) {
  FittingOptions options;
  options.method = FitMethod::kPointClouds;
  options.skeleton = "smpl24";
  options.joint_tracks.priors.rest = 0.2;
  const nlohmann::json json = OptionsToJson(options);
  EXPECT_EQ(json["method"], "point_clouds");
  const auto read = OptionsFromJson<FittingOptions>(json);
  ASSERT_TRUE(read.has_value()) << read.error().Message();
  EXPECT_EQ(OptionsToJson(*read), json);
  EXPECT_FALSE(OptionsFromJson<FittingOptions>(nlohmann::json{{"metod", "none"}}).has_value());
}

}  // namespace
}  // namespace mocurate
