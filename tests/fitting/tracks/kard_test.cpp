#include <gtest/gtest.h>

#include "core/quality/measures.h"
#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "tests/fitting/track_problems.h"

namespace mocurate {
namespace {

class Kard : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("MOCURATE_DATA");
    if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA (unpacked data) is not set";
    auto skeleton = LoadSkeleton("openni16");
    ASSERT_TRUE(skeleton.has_value()) << skeleton.error().Message();
    skeleton_ = *skeleton;
    for (const char* name : {"a01_s03_e01", "a09_s03_e01", "a12_s03_e01", "a14_s03_e01", "a17_s03_e01"}) {
      Clip clip;
      clip.identity.source = "kard";
      clip.identity.recording = name;
      clip.rate = FrameRate{30, 1};
      clip.evidence.tracks =
          ReadKardText(std::filesystem::path(data) / "kinect" / "kard" / (std::string(name) + "_realworld.txt"));
      clips_.push_back(std::move(clip));
      auto tracks = MapTracks(*clips_.back().evidence.tracks, skeleton_);
      ASSERT_TRUE(tracks.has_value()) << tracks.error().Message();
      tracks_.push_back(std::move(*tracks));
    }
  }

  SkeletonPtr skeleton_;
  std::vector<Clip> clips_;
  std::vector<SkeletonTracks> tracks_;
};

/// Of joints with state observed: the largest distance from their track among those that are more than four standard
/// deviations (chi square of three degrees of freedom, 99.9 %) off.
double FarthestObserved(const FitResult& fit, const SkeletonTracks& tracks) {
  double farthest = 0.0;
  for (int f = 0; f < tracks.frames(); ++f) {
    for (int j = 0; j < tracks.joints(); ++j) {
      const std::size_t at = static_cast<std::size_t>(f) * tracks.joints() + static_cast<std::size_t>(j);
      if (fit.motion.state[at] != JointState::kObserved) continue;
      const double off = (fit.motion.joints.at(f, j) - tracks.positions.at(f, j)).norm();
      const double variance = fit.variance_factor * fit.noise_sigma * fit.noise_sigma;
      if (off * off > 16.3 * variance) farthest = std::max(farthest, off);
    }
  }
  return farthest;
}

TEST_F(Kard, ClipsShareThePersonsBonesAndStayNearTheirTracks) {
  const auto person = EstimateProportions(tracks_, skeleton_, ProportionsOptions{});
  const double stature = Stature(*skeleton_, person.bone_length);
  EXPECT_GT(stature, 1.2);  // ankle to head centre
  EXPECT_LT(stature, 1.8);
  double contradicted = 0.0;
  for (std::size_t i = 0; i < clips_.size(); ++i) {
    const Clip& clip = clips_[i];
    const auto fit = FitTracksOfClip(clip, person.skeleton, person.bone_length, FittingOptions{});
    ASSERT_TRUE(fit.has_value()) << fit.error().Message();
    const StageOutcome outcome = OutcomeOfFit(clip, *fit, FittingOptions{});
    const nlohmann::json& summary = outcome.summary;
    EXPECT_TRUE(fit->converged) << clip.id();
    EXPECT_LT(summary["residual_rms_mm"].get<double>(), 60.0) << clip.id();
    EXPECT_GT(summary["before"]["bone_spread_mm"].get<double>(), 2.0) << clip.id();
    EXPECT_LT(summary["after"]["bone_spread_mm"].get<double>(), 1e-6) << clip.id();
    EXPECT_LT(summary["after"]["jerk"].get<double>(), summary["before"]["jerk"].get<double>()) << clip.id();
    EXPECT_TRUE(fit->motion.Check().has_value()) << clip.id();
    EXPECT_EQ(fit->motion.state[0], JointState::kInferred);  // no track of the pelvis
    EXPECT_EQ(fit->motion.state[1], JointState::kObserved);
    EXPECT_LE(FarthestObserved(*fit, tracks_[i]), 0.15) << clip.id();
    for (const Finding& finding : fit->findings)
      contradicted += finding.code == kSamplesContradicted ? finding.value : 0.0;
  }
  EXPECT_GT(contradicted, 0.0) << "the legs of a17_s03_e01 are tracked too short";
}

TEST_F(Kard, PelvisLiesBetweenTheHips) {
  const auto person = EstimateProportions(tracks_, skeleton_, ProportionsOptions{});
  const auto fit = FitTracksOfClip(clips_[0], person.skeleton, person.bone_length, FittingOptions{});
  ASSERT_TRUE(fit.has_value());
  const int left = *skeleton_->FindJoint("left_hip");
  const int right = *skeleton_->FindJoint("right_hip");
  const JointPositions& observed = tracks_[0].positions;
  for (int f = 0; f < observed.frames; ++f) {
    const Vector3d middle = 0.5 * (observed.at(f, left) + observed.at(f, right));
    EXPECT_LT((fit->motion.joints.at(f, 0) - middle).norm(), 0.06) << "frame " << f;
  }
}

}  // namespace
}  // namespace mocurate
