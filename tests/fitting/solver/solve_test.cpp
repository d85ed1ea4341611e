#include <gtest/gtest.h>

#include <cmath>

#include "fitting/proportions.h"
#include "fitting/solver/solve.h"
#include "fitting/solver/track_problem.h"
#include "tests/fitting/takes.h"
#include "tests/fitting/term_rows.h"
#include "tests/fitting/track_problems.h"

namespace mocurate {
namespace {

constexpr double kSigma = 0.02;

/// A noisy take with everything that a cost depends on: hidden joints, confidences, outliers, a gap in time, a joint
/// with limits. The state differs from the truth.
class TracksOfATake : public testing::Test {
 protected:
  TracksOfATake() : take_(SmoothTake(6)) {
    auto limited = std::make_shared<Skeleton>(*take_.tracks.skeleton);
    limited->joints[4].limits = JointLimits{Vector3d(-0.1, -0.1, -0.1), Vector3d(0.1, 0.1, 0.1)};
    take_.tracks.skeleton = limited;
    Random random(4, "window");
    for (int f = 0; f < take_.tracks.frames(); ++f) {
      if (f >= 4) take_.tracks.time_s[f] += 2.0;  // a gap
      for (int j = 0; j < take_.tracks.joints(); ++j) {
        take_.tracks.positions.at(f, j) += 0.03 * Vector3d(random.Normal(), random.Normal(), random.Normal());
        take_.tracks.confidence[static_cast<std::size_t>(f) * take_.tracks.joints() + j] =
            random.Uniform() < 0.2 ? 0.0 : random.Uniform(0.3, 1.0);
      }
    }
    take_.tracks.positions.at(2, 5) += Vector3d(0.8, 0, 0);  // in the linear part of the loss
    std::vector<bool> active(take_.tracks.joints(), true);
    active[2] = active[5] = false;
    state_ = std::make_unique<PoseState>(*limited, take_.tracks.frames(), take_.truth.bone_length, active);
    for (int f = 0; f < take_.tracks.frames(); ++f) {
      Eigen::Map<Vector3d>(state_->translation(f)) = take_.truth.joints.at(f, 0);
      for (int j = 0; j < take_.tracks.joints(); ++j) {
        if (!active[j]) continue;
        Eigen::Map<Vector3d>(state_->rotation(f, j)) =
            LogQuaternion(take_.truth.rotation_at(f, j)) + Vector3d::Constant(0.05 * random.Normal());
      }
    }
  }

  PoseTerms Terms(int begin, int end, bool after_fixed) {
    problem_.emplace(take_.tracks, *state_, kSigma, options_);
    return problem_->Terms(begin, end, after_fixed);
  }

  PlayedTake take_;
  JointTrackOptions options_;
  std::unique_ptr<PoseState> state_;
  std::optional<TrackProblem> problem_;
};

TEST_F(TracksOfATake, RowsGiveBothSolversTheSameEquations) {
  const PoseTerms terms = Terms(0, 6, false);
  ExpectSameEquations(terms, *state_);
  ExpectDerivatives(terms, *state_, 1e-4, 1e-6);
}

TEST_F(TracksOfATake, MatchesCeresWithPrecisionPerSample) {
  AddUnevenNoise(take_.tracks, 0.02, 6);
  ExpectSameEquations(Terms(0, 6, false), *state_);
  ExpectSameEquations(Terms(2, 5, true), *state_);
}

TEST_F(TracksOfATake, MatchesCeresWithHingesProcessNoiseAndRestSigmas) {
  auto hinged = std::make_shared<Skeleton>(*take_.tracks.skeleton);
  for (const int joint : {4, 7}) {  // elbows; swinging takes both beyond the hinge's plane and its bend
    const double way = joint == 4 ? 1.0 : -1.0;
    hinged->joints[joint].limits =
        JointLimits{Vector3d(-0.5, way > 0.0 ? -0.2 : -2.4, -0.5), Vector3d(0.5, way > 0.0 ? 2.4 : 0.2, 0.5)};
  }
  ASSERT_TRUE(HingesOf(*hinged)[4] && HingesOf(*hinged)[7]);
  take_.tracks.skeleton = hinged;
  Random random(8, "scales");
  ProcessNoiseScale scale = ProcessNoiseScale::Ones(take_.tracks.confidence.size());
  for (double& value : scale.rotation) value = random.Uniform(0.3, 3.0);
  for (double& value : scale.position) value = random.Uniform(0.3, 3.0);
  TrackProblem problem(take_.tracks, *state_, kSigma, options_);
  problem.noise_scale = &scale;
  for (double& sigma : problem.rest_sigma) sigma = random.Uniform(0.2, 2.0);
  const PoseTerms terms = problem.Terms(0, 6, false);
  ExpectSameEquations(terms, *state_);
  ExpectDerivatives(terms, *state_, 1e-5, 1e-6);
}

TEST_F(TracksOfATake, WithoutAToleranceEndsWhereNoStepReducesTheCost) {
  const auto solution = Solve(Terms(0, 6, false), *state_, {PoseSolver::kBanded, 0.0, 10000});
  ASSERT_TRUE(solution) << solution.error().Message();
  EXPECT_LT(solution->iterations, 10000);
  EXPECT_TRUE(solution->converged || solution->exhausted);
}

TEST_F(TracksOfATake, MatchesCeresBesideAFixedFrame) {
  const PoseTerms terms = Terms(2, 5, true);
  state_->Update(1, 2, true);
  ExpectSameEquations(terms, *state_);
  ExpectDerivatives(terms, *state_, 1e-4, 1e-6);
}

TEST_F(TracksOfATake, MatchesCeresWithRecordedRotations) {
  Random random(9, "recorded");
  RotationTargets targets;
  for (int f = 0; f < take_.tracks.frames(); ++f) {
    for (int j = 0; j < take_.tracks.joints(); ++j) {
      const bool recorded = state_->active(j) && random.Uniform() < 0.7;
      const double scale = random.Uniform() < 0.1 ? 1.0 : 0.1;  // one in ten in the linear part of the loss
      const Vector3d away = scale * Vector3d(random.Normal(), random.Normal(), random.Normal());
      state_->Update(f, f + 1, false);
      targets.world_from_joint.push_back(Quaterniond(state_->global(f, j)) * ExpQuaternion(away));
      targets.weight.push_back(recorded ? random.Uniform(0.3, 1.0) / 0.1 : 0.0);
    }
  }
  TrackProblem problem(take_.tracks, *state_, kSigma, options_);
  problem.rotations = &targets;
  const PoseTerms terms = problem.Terms(0, 6, false);
  ExpectSameEquations(terms, *state_);
  ExpectDerivatives(terms, *state_, 1e-4, 1e-6);
}

TEST_F(TracksOfATake, MatchesCeresForOneFrame) { ExpectSameEquations(Terms(0, 1, false), *state_); }

JointTrackOptions With(PoseSolver solver) {
  JointTrackOptions options;
  options.solver = solver;
  options.steps = {{FreeParts::kPose, StepEvidence::kAll, 1e-9, 300}};
  return options;
}

TEST(PoseSolvers, ConvergesToTheOptimumOfCeres) {
  for (const bool damaged : {false, true}) {
    PlayedTake take = SmoothTake(80);
    if (damaged) {
      AddUnevenNoise(take.tracks, 0.02, 9);
    } else {
      AddNoise(take.tracks, 0.02, 9);
    }
    for (int f = 20; damaged && f < 35; ++f) {
      for (const int j : {4, 5, 12}) Hide(take.tracks, f, j);
    }
    const auto fit = [&](PoseSolver solver) {
      const auto result = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, With(solver));
      EXPECT_TRUE(result.has_value());
      EXPECT_TRUE(result->converged);
      return *result;
    };
    const FitResult ceres = fit(PoseSolver::kCeres);
    const FitResult banded = fit(PoseSolver::kBanded);
    EXPECT_NEAR(banded.final_cost, ceres.final_cost, 1e-6 * ceres.final_cost);
    EXPECT_LT(LargestError(banded.motion.joints, ceres.motion.joints), 2e-4);
  }
}

TEST(PoseSolvers, SolvesClipsOfOneAndTwoFrames) {
  for (const int frames : {1, 2}) {
    PlayedTake take = SmoothTake(frames);
    const auto fit = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, With(PoseSolver::kBanded));
    ASSERT_TRUE(fit.has_value());
    EXPECT_LT(LargestError(fit->motion.joints, take.truth.joints), 1e-3);
  }
}

TEST(PoseSolvers, FitsLongClipsInContinuousWindows) {
  PlayedTake take = SmoothTake(300);
  AddNoise(take.tracks, 0.01, 2);
  JointTrackOptions whole = With(PoseSolver::kBanded);
  JointTrackOptions windows = whole;
  windows.window_frames = 100;
  const auto one = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, whole);
  const auto many = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, windows);
  ASSERT_TRUE(one.has_value() && many.has_value());
  EXPECT_LT(LargestError(one->motion.joints, many->motion.joints), 1e-3);
}

TEST(HuberSigmas, HasOneShareOfCleanSamplesForAnyCoordinates) {
  EXPECT_NEAR(HuberSigmas(0.1, 1), 1.6449, 1e-4);  // normal distribution, two sides
  EXPECT_NEAR(HuberSigmas(0.1, 3), 2.5003, 1e-4);  // chi distribution of three coordinates
  EXPECT_NEAR(HuberSigmas(0.0455, 1), 2.0, 1e-3);
}

}  // namespace
}  // namespace mocurate
