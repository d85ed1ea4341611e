#include <gtest/gtest.h>

#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "tests/fitting/fit_score.h"
#include "tests/fitting/studio_clips.h"

namespace mocurate {
namespace {

struct Scores {
  FitScore fit;
  SwapScore swaps;
  double contradicted = 0.0;  ///< samples, of all clips
};

Scores FitStudio(std::uint64_t seed, const StudioClipErrors& errors) {
  Scores scores;
  JointTrackOptions options;
  options.solver = PoseSolver::kBanded;
  const std::vector<StudioClip> clips = StudioClips(seed, 1, false, errors);
  std::vector<SkeletonTracks> tracks;
  for (const StudioClip& clip : clips) tracks.push_back(clip.tracks);
  const auto person = EstimateProportions(tracks, tracks.at(0).skeleton, ProportionsOptions{});
  for (const StudioClip& clip : clips) {
    const auto fit = RepairAndFit(clip.tracks, clip.truth.rate, person.bone_length, RepairOptions{}, options);
    EXPECT_TRUE(fit.has_value()) << fit.error().Message();
    if (!fit) continue;
    scores.fit.Add(*fit, clip);
    scores.swaps.Add(*fit, clip);
    for (const Finding& finding : fit->findings)
      scores.contradicted += finding.code == kSamplesContradicted ? finding.value : 0.0;
  }
  return scores;
}

/// 30 mm RMS of noise, 5 % dropouts, 2 % outliers, 2 % swapped frames; one clip of each of the 12 classes.
TEST(StudioAccuracy, JointsAreWithinTwelveMillimetresAndRotationsWithinSixDegrees) {
  const Scores scores = FitStudio(8, StudioClipErrors::Stated());
  EXPECT_LT(scores.fit.joint_mm(), 12.0);
  EXPECT_LT(scores.fit.rotation_deg(), 6.0);
  EXPECT_NEAR(scores.fit.within_one(), 0.683, 0.03);
  EXPECT_NEAR(scores.fit.within_two(), 0.954, 0.03);
  EXPECT_GT(scores.swaps.exchanged_samples, 100);
  EXPECT_GT(scores.swaps.corrected, 0.85 * scores.swaps.exchanged_samples);
  EXPECT_LT(scores.swaps.mistaken, 0.02 * scores.swaps.exchanged_samples);
}

TEST(StudioAccuracy, NoiseAloneContradictsNoBody) {
  StudioClipErrors noise;
  noise.swapped_frames = 0.0;
  noise.tracker.dropout_share = noise.tracker.outlier_share = noise.tracker.swap_share = 0.0;
  EXPECT_EQ(FitStudio(8, noise).contradicted, 0.0);
}

}  // namespace
}  // namespace mocurate
