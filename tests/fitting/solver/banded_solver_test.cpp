#include <ceres/crs_matrix.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fitting/costs/hinge_cost.h"
#include "fitting/proportions.h"
#include "fitting/solver/track_equations.h"
#include "fitting/solver/track_problem.h"
#include "tests/fitting/takes.h"
#include "tests/fitting/track_problems.h"

namespace mocurate {
namespace {

constexpr double kSigma = 0.02;

/// A noisy take with everything that a cost depends on: hidden joints, confidences, outliers, a gap in time, a joint
/// with limits. The state differs from the truth.
class BandedWindow : public testing::TestWithParam<bool> {
 protected:
  BandedWindow() : take_(SmoothTake(6)) {
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

  TrackWindow Of(int begin, int end) { return {take_.tracks, *state_, kSigma, options_, begin, end, begin > 0}; }

  /// Cost, gradient and J'J of the Ceres problem, unknowns in the order of TrackEquations.
  void ExpectSameAsCeres(const TrackWindow& window) {
    TrackProblem problem(window);
    ceres::Problem::EvaluateOptions evaluate;
    for (int f = window.begin; f < window.end; ++f) {
      evaluate.parameter_blocks.push_back(state_->translation(f));
      for (int j = 0; j < state_->joints(); ++j) {
        if (state_->active(j)) evaluate.parameter_blocks.push_back(state_->rotation(f, j));
      }
    }
    double cost = 0.0;
    std::vector<double> gradient;
    ceres::CRSMatrix jacobian;
    ASSERT_TRUE(problem.problem().Evaluate(evaluate, &cost, nullptr, &gradient, &jacobian));
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(jacobian.num_rows, jacobian.num_cols);
    for (int r = 0; r < jacobian.num_rows; ++r) {
      for (int i = jacobian.rows[r]; i < jacobian.rows[r + 1]; ++i) rows(r, jacobian.cols[i]) = jacobian.values[i];
    }
    const Eigen::MatrixXd square = rows.transpose() * rows;

    TrackEquations track(window);
    const int frames = window.end - window.begin;
    const int n = track.size();
    BlockTridiagonal equations(frames, n);
    track.SetParameters(track.Parameters());
    EXPECT_NEAR(track.Cost(), cost, 1e-9 * cost);
    track.Linearise(equations);
    const Eigen::Map<const Eigen::VectorXd> expected(gradient.data(), static_cast<Eigen::Index>(gradient.size()));
    ASSERT_EQ(equations.GradientEntries().size(), expected.size());
    EXPECT_LT((equations.GradientEntries() - expected).norm(), 1e-9 * expected.norm());
    const double scale = 1e-9 * square.norm();
    for (int f = 0; f < frames; ++f) {
      const Eigen::MatrixXd diagonal = equations.Diagonal(f).triangularView<Eigen::Upper>();
      const Eigen::MatrixXd own = square.block(f * n, f * n, n, n).triangularView<Eigen::Upper>();
      EXPECT_LT((diagonal - own).norm(), scale) << "frame " << f;
      if (f + 1 < frames) {
        EXPECT_LT((equations.Next(f) - square.block(f * n, (f + 1) * n, n, n)).norm(), scale) << "step " << f;
      }
    }
  }

  PlayedTake take_;
  JointTrackOptions options_;
  std::unique_ptr<PoseState> state_;
};

TEST_F(BandedWindow, MatchesCeresInCostGradientAndInformation) { ExpectSameAsCeres(Of(0, 6)); }

TEST_F(BandedWindow, MatchesCeresWithPrecisionPerSample) {
  AddUnevenNoise(take_.tracks, 0.02, 6);
  ExpectSameAsCeres(Of(0, 6));
  ExpectSameAsCeres(Of(2, 5));
}

TEST_F(BandedWindow, MatchesCeresWithHingesProcessNoiseAndRestSigmas) {
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
  std::vector<double> rest;
  for (int j = 0; j < take_.tracks.joints(); ++j) rest.push_back(random.Uniform(0.2, 2.0));
  TrackWindow window = Of(0, 6);
  window.noise_scale = &scale;
  window.rest_sigmas = &rest;
  ExpectSameAsCeres(window);
}

TEST_F(BandedWindow, WithoutAToleranceEndsWhereNoStepReducesTheCost) {
  TrackWindow window = Of(0, 6);
  window.step.relative_tolerance = 0.0;
  window.step.max_iterations = 10000;
  const auto solution = SolveBanded(window);
  ASSERT_TRUE(solution) << solution.error().Message();
  EXPECT_LT(solution->iterations, 10000);
  EXPECT_TRUE(solution->converged || solution->exhausted);
}

TEST_F(BandedWindow, MatchesCeresBesideAFixedFrame) { ExpectSameAsCeres(Of(2, 5)); }

TEST_F(BandedWindow, MatchesCeresWithRecordedRotations) {
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
  TrackWindow window = Of(0, 6);
  window.rotations = &targets;
  ExpectSameAsCeres(window);
}

TEST_F(BandedWindow, MatchesCeresForOneFrame) { ExpectSameAsCeres(Of(0, 1)); }

JointTrackOptions With(TrackSolver solver) {
  JointTrackOptions options;
  options.solver = solver;
  options.steps = {{FreeParts::kPose, StepEvidence::kAll, 1e-9, 300}};
  return options;
}

TEST(BandedSolver, ConvergesToTheOptimumOfCeres) {
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
    const auto fit = [&](TrackSolver solver) {
      const auto result = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, With(solver));
      EXPECT_TRUE(result.has_value());
      EXPECT_TRUE(result->converged);
      return *result;
    };
    const FitResult ceres = fit(TrackSolver::kCeres);
    const FitResult banded = fit(TrackSolver::kBanded);
    EXPECT_NEAR(banded.final_cost, ceres.final_cost, 1e-6 * ceres.final_cost);
    EXPECT_LT(LargestError(banded.motion.joints, ceres.motion.joints), 2e-4);
  }
}

TEST(BandedSolver, SolvesClipsOfOneAndTwoFrames) {
  for (const int frames : {1, 2}) {
    PlayedTake take = SmoothTake(frames);
    const auto fit = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, With(TrackSolver::kBanded));
    ASSERT_TRUE(fit.has_value());
    EXPECT_LT(LargestError(fit->motion.joints, take.truth.joints), 1e-3);
  }
}

TEST(BandedSolver, FitsLongClipsInContinuousWindows) {
  PlayedTake take = SmoothTake(300);
  AddNoise(take.tracks, 0.01, 2);
  JointTrackOptions whole = With(TrackSolver::kBanded);
  JointTrackOptions windows = whole;
  windows.window_frames = 100;
  const auto one = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, whole);
  const auto many = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, windows);
  ASSERT_TRUE(one.has_value() && many.has_value());
  EXPECT_LT(LargestError(one->motion.joints, many->motion.joints), 1e-3);
}

}  // namespace
}  // namespace mocurate
