#include "fitting/uncertainty/calibration.h"
#include "fitting/uncertainty/track_uncertainty.h"

#include <ceres/covariance.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "fitting/solver/ceres_poses.h"
#include "fitting/solver/joint_track_fit.h"
#include "fitting/solver/track_problem.h"
#include "fitting/uncertainty/body_response.h"
#include "fitting/uncertainty/process_noise_scale.h"
#include "fitting/uncertainty/variance_inflation.h"
#include "tests/fitting/takes.h"
#include "tests/fitting/track_problems.h"

namespace mocurate {
namespace {

Matrix3d CovarianceAt(const Motion& motion, int frame, int joint) {
  return FromSixNumbers(motion.position_cov.data() +
                        6 * (static_cast<std::size_t>(frame) * motion.joint_count() + joint));
}

/// Shares of whitened error components within one and two standard deviations.
struct Coverage {
  int within_one = 0;
  int within_two = 0;
  int count = 0;

  void Add(const Motion& motion, const JointPositions& truth) {
    for (int f = 0; f < motion.frame_count(); ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) {
        const Eigen::LLT<Matrix3d> root(CovarianceAt(motion, f, j));
        const Vector3d white = root.matrixL().solve(Vector3d(motion.joints.at(f, j) - truth.at(f, j)));
        for (int i = 0; i < 3; ++i) {
          within_one += std::abs(white[i]) < 1.0;
          within_two += std::abs(white[i]) < 2.0;
          ++count;
        }
      }
    }
  }
  double one() const { return static_cast<double>(within_one) / count; }
  double two() const { return static_cast<double>(within_two) / count; }
};

FitResult FitWithUncertainty(const PlayedTake& take, const JointTrackOptions& options = {}) {
  auto fit = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, options);
  EXPECT_TRUE(fit.has_value()) << fit.error().Message();
  return std::move(*fit);
}

float ValueAt(const std::vector<float>& values, const Motion& motion, int frame, int joint, int axis) {
  return values[3 * (static_cast<std::size_t>(frame) * motion.joint_count() + joint) + axis];
}

TEST(TrackUncertainty, MatchesTheDenseCovarianceOfCeres) {
  PlayedTake take = SmoothTake(5);
  AddUnevenNoise(take.tracks, 0.01, 8);
  const double sigma = 0.01;
  JointTrackOptions options;
  options.rules.SwitchOff(FittingRule::kBodyErrors);
  PoseState state(*take.tracks.skeleton, 5, take.truth.bone_length,
                  {true, true, true, true, true, false, true, true, false, true, false, true, false, false});
  for (int f = 0; f < 5; ++f) {
    Eigen::Map<Vector3d>(state.translation(f)) = take.truth.joints.at(f, 0);
    for (int j = 0; j < take.tracks.joints(); ++j) {
      if (state.active(j)) Eigen::Map<Vector3d>(state.rotation(f, j)) = LogQuaternion(take.truth.rotation_at(f, j));
    }
  }
  const TrackProblem window(take.tracks, state, sigma, options);
  const auto uncertainty = UncertaintyOfTracks(window);
  ASSERT_TRUE(uncertainty.has_value()) << uncertainty.error().Message();

  const double stated_share = uncertainty->variance_factor * kUncertaintyCalibration;
  const PoseTerms terms = window.Terms(0, 5, false);
  CeresPoses problem(terms, state);
  ceres::Covariance::Options dense;
  dense.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(dense);
  std::vector<std::pair<const double*, const double*>> blocks;
  for (int f = 0; f < 5; ++f) {
    blocks.emplace_back(state.translation(f), state.translation(f));
    blocks.emplace_back(state.rotation(f, 3), state.rotation(f, 3));
  }
  ASSERT_TRUE(covariance.Compute(blocks, &problem.problem()));
  for (int f = 0; f < 5; ++f) {
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> block;
    covariance.GetCovarianceBlock(state.translation(f), state.translation(f), block.data());
    const float* root = uncertainty->position_cov.data() + 6 * (static_cast<std::size_t>(f) * 14);
    EXPECT_NEAR(root[0], stated_share * block(0, 0), 1e-5 * root[0]);
    EXPECT_NEAR(root[4], stated_share * block(1, 2), 1e-5 * root[0]);
    covariance.GetCovarianceBlock(state.rotation(f, 3), state.rotation(f, 3), block.data());
    const Matrix3d turned = state.right_jacobian(f, 3) * block * state.right_jacobian(f, 3).transpose();
    for (int i = 0; i < 3; ++i) {
      const std::size_t at = 3 * (static_cast<std::size_t>(f) * 14 + 3) + i;
      const double stated = std::pow(uncertainty->rotation_sigma[at], 2);
      const double prior = stated / (1.0 - uncertainty->rotation_observed[at]);
      // What the evidence adds to the prior, scaled by the a-posteriori variance and calibrated.
      const double expected = (1.0 / turned(i, i) - 1.0 / prior) / stated_share;
      EXPECT_NEAR(1.0 / stated - 1.0 / prior, expected, 1e-3 * expected);
    }
  }
}

/// Precision of a chain of angles: `rest` is each frame's precision of the rest-pose prior, the process noise links
/// frames.
Eigen::MatrixXd PrecisionOfChain(const std::vector<double>& rest, double process_variance) {
  const auto frames = static_cast<Eigen::Index>(rest.size());
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(frames, frames);
  for (Eigen::Index f = 0; f < frames; ++f) {
    precision(f, f) += rest[static_cast<std::size_t>(f)];
    if (f + 1 == frames) break;
    precision(f, f) += 1.0 / process_variance;
    precision(f + 1, f + 1) += 1.0 / process_variance;
    precision(f, f + 1) = precision(f + 1, f) = -1.0 / process_variance;
  }
  return precision;
}

TEST(TrackUncertainty, CountsTheRestPoseOnceForAnyClipLengthAndProcessNoise) {
  const PlayedTake take = SmoothTake(300);
  const double sigma = 0.01;
  PoseState state(*take.tracks.skeleton, 300, take.truth.bone_length, std::vector<bool>(take.tracks.joints(), true));
  for (const double process_noise : {0.05, 0.5, 2.0}) {
    for (const int frames : {1, 2, 30, 300}) {
      JointTrackOptions options;
      options.priors.rotation_noise = process_noise;
      const SkeletonTracks tracks = CutTracks(take.tracks, 0, frames);
      const TrackProblem window(tracks, state, sigma, options);
      std::vector<double> rest;
      for (int f = 0; f < frames; ++f) rest.push_back(window.RestInformation(f, 4));
      const Eigen::MatrixXd covariance =
          PrecisionOfChain(rest, frames > 1 ? window.RotationVariance(0, 4) : 1.0).inverse();
      for (int f = 0; f < frames; ++f) {
        EXPECT_NEAR(covariance(f, f), 1.0, 1e-9) << process_noise << " " << frames << " " << f;
      }
    }
  }
}

/// (F*J*3) standard deviations of rotations at a take's truth, and what other bodies add to their squares.
std::vector<double> AddedByBodies(const PlayedTake& take) {
  const double sigma = 1e-4;
  JointTrackOptions options;
  PoseState state(*take.tracks.skeleton, take.tracks.frames(), take.truth.bone_length,
                  std::vector<bool>(static_cast<std::size_t>(take.tracks.joints()), true));
  for (int f = 0; f < take.tracks.frames(); ++f) {
    Eigen::Map<Vector3d>(state.translation(f)) = take.truth.joints.at(f, 0);
    for (int j = 0; j < take.tracks.joints(); ++j)
      Eigen::Map<Vector3d>(state.rotation(f, j)) = LogQuaternion(take.truth.rotation_at(f, j));
  }
  const auto all = UncertaintyOfTracks(TrackProblem(take.tracks, state, sigma, options));
  options.rules.SwitchOff(FittingRule::kBodyErrors);
  const auto without = UncertaintyOfTracks(TrackProblem(take.tracks, state, sigma, options));
  EXPECT_TRUE(all && without);
  std::vector<double> added;
  for (std::size_t i = 0; i < all->rotation_sigma.size(); ++i)
    added.push_back(std::pow(all->rotation_sigma[i], 2) - std::pow(without->rotation_sigma[i], 2));
  return added;
}

TEST(TrackUncertainty, OfRotationsIncludesTheVariationOfBodies) {
  const PlayedTake take = SmoothTake(10);
  const Skeleton& skeleton = *take.tracks.skeleton;
  const int elbow = *skeleton.FindJoint("left_elbow");
  const int wrist = skeleton.Children()[static_cast<std::size_t>(elbow)].front();
  const auto across = [&](const std::vector<double>& added) {  // rad, of the forearm's direction, per axis
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) sum += added[3 * (5 * static_cast<std::size_t>(skeleton.joint_count()) + elbow) + i];
    return std::sqrt(sum);
  };
  const double added = across(AddedByBodies(take));
  const double length = take.truth.bone_length[static_cast<std::size_t>(wrist)];
  EXPECT_GT(added, std::sqrt(2.0) * kLimbSigma / length) << "its own bone, and the upper arm's";
  EXPECT_LT(added, 0.2);
  PlayedTake beside = take;
  beside.tracks.place_sigma.assign(take.tracks.joints(), 0.0);
  beside.tracks.place_sigma[wrist] = 0.02;
  EXPECT_GT(across(AddedByBodies(beside)), std::hypot(added, 0.9 * 0.02 / length)) << "a point that is not the joint";
}

TEST(TrackUncertainty, TwistOfAStraightLimbIsNotObserved) {
  PlayedTake take = SmoothTake(60);
  for (int f = 0; f < 60; ++f) {
    for (int j = 1; j < take.truth.joint_count(); ++j) take.truth.rotation_at(f, j).setIdentity();
  }
  take.truth = MakeMotion(take.truth.skeleton, take.truth.rate, take.truth.root_translation, take.truth.rotation,
                          take.truth.bone_length);
  take.tracks.positions = take.truth.joints;
  const Motion motion = FitWithUncertainty(take).motion;
  for (const int shoulder : {3, 6}) {  // arms straight out sideways: twist is about x
    EXPECT_LT(ValueAt(motion.rotation_observed, motion, 30, shoulder, 0), 0.1);
    EXPECT_GT(ValueAt(motion.rotation_observed, motion, 30, shoulder, 1), 0.95);
    EXPECT_GT(ValueAt(motion.rotation_observed, motion, 30, shoulder, 2), 0.95);
    EXPECT_GT(ValueAt(motion.rotation_sigma, motion, 30, shoulder, 0), 0.3F);
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_GT(ValueAt(motion.rotation_observed, motion, 30, 0, i), 0.99);  // hips and chest determine the root
    EXPECT_EQ(ValueAt(motion.rotation_observed, motion, 30, 5, i), 0.0F);  // a wrist has no children
  }
}

/// The hinge and the limits of a knee are known without evidence: they do not count as observed.
TEST(TrackUncertainty, AHingeWithoutEvidenceIsNotObserved) {
  PlayedTake take = SmoothTake(330, Quaterniond::Identity(), 30.0, 0.4, LoadSkeleton("smpl24").value());
  const Skeleton& body = *take.truth.skeleton;
  const int knee = *body.FindJoint("left_knee"), ankle = *body.FindJoint("left_ankle"),
            toes = *body.FindJoint("left_foot");
  ASSERT_TRUE(HingesOf(body)[static_cast<std::size_t>(knee)].has_value());
  for (int f = 10; f < 310; ++f) {
    for (const int below : {ankle, toes}) Hide(take.tracks, f, below);
  }
  JointTrackOptions options;
  options.solver = PoseSolver::kBanded;
  const Motion motion = FitWithUncertainty(take, options).motion;
  for (const int i : {1, 2}) EXPECT_LE(ValueAt(motion.rotation_observed, motion, 160, knee, i), 0.1F) << i;
  EXPECT_LE(ValueAt(motion.rotation_observed, motion, 160, knee, 0), 0.5F);  // people keep a posture for seconds
  EXPECT_GT(ValueAt(motion.rotation_observed, motion, 5, knee, 0), 0.9F);
}

TEST(TrackUncertainty, ALongerGapIsNotMoreCertain) {
  PlayedTake take = SmoothTake(90);
  AddNoise(take.tracks, 0.04, 3);  // four times as stated: the factor of the residuals is large
  const double sigma = 0.01;
  const JointTrackOptions options;
  const int elbow = *take.truth.skeleton->FindJoint("left_elbow"),
            wrist = *take.truth.skeleton->FindJoint("left_wrist");
  const auto sigma_in_middle = [&](int end) {
    PlayedTake gap = take;
    for (int f = 40; f < end; ++f) Hide(gap.tracks, f, wrist);
    PoseState state(*gap.tracks.skeleton, 90, gap.truth.bone_length, std::vector<bool>(gap.tracks.joints(), true));
    for (int f = 0; f < 90; ++f) {
      Eigen::Map<Vector3d>(state.translation(f)) = gap.truth.joints.at(f, 0);
      for (int j = 0; j < gap.tracks.joints(); ++j)
        Eigen::Map<Vector3d>(state.rotation(f, j)) = LogQuaternion(gap.truth.rotation_at(f, j));
    }
    const TrackProblem window(gap.tracks, state, sigma, options);
    const auto uncertainty = UncertaintyOfTracks(window);
    EXPECT_GT(uncertainty->variance_factor, 4.0);
    Vector3d of_elbow;
    for (int i = 0; i < 3; ++i) of_elbow[i] = uncertainty->rotation_sigma[3 * (48 * 14 + elbow) + i];
    return of_elbow;
  };
  const Vector3d shorter = sigma_in_middle(57), longer = sigma_in_middle(60);  // 0.6 s and 0.7 s between samples
  for (int i = 0; i < 3; ++i) EXPECT_GE(longer[i], 0.99 * shorter[i]) << i;
}

TEST(TrackUncertainty, GrowsWhereAJointIsNotObserved) {
  PlayedTake take = SmoothTake(90);
  for (int f = 30; f < 60; ++f) Hide(take.tracks, f, 5);
  AddNoise(take.tracks, 0.01, 4);
  const Motion motion = FitWithUncertainty(take).motion;
  EXPECT_GT(CovarianceAt(motion, 45, 5).trace(), 4.0 * CovarianceAt(motion, 15, 5).trace());
  EXPECT_GT(CovarianceAt(motion, 45, 5).trace(), CovarianceAt(motion, 32, 5).trace());
  EXPECT_LT(std::sqrt(CovarianceAt(motion, 45, 5).trace()), 0.5);  // the elbow bounds it
}

/// All joints observe the motion of the whole body. Counted as independent samplers they would make its process noise
/// too certain by the number of joints, and the swaying would count as noise.
TEST(TrackUncertainty, CoversABodyThatSwaysAsAWhole) {
  PlayedTake take = SmoothTake(120);
  for (int f = 0; f < 120; ++f) {
    for (int j = 0; j < take.truth.joint_count(); ++j) take.truth.rotation_at(f, j) = take.truth.rotation_at(0, j);
    take.truth.root_translation[f] = Vector3d(0.0, 1.0, 0.025 * std::sin(0.4 * f));
  }
  take.truth = MakeMotion(take.truth.skeleton, take.truth.rate, take.truth.root_translation, take.truth.rotation,
                          take.truth.bone_length);
  take.tracks.positions = take.truth.joints;
  AddNoise(take.tracks, 0.02, 6);
  const Motion motion = FitWithUncertainty(take).motion;
  Coverage coverage;
  coverage.Add(motion, take.truth.joints);
  EXPECT_NEAR(coverage.one(), 0.683, 0.08);
  EXPECT_GT(coverage.two(), 0.9);
}

TEST(TrackUncertainty, IsIndependentOfWindows) {
  PlayedTake take = SmoothTake(200);
  AddNoise(take.tracks, 0.01, 4);
  JointTrackOptions windows;
  windows.window_frames = 70;
  const FitResult fit_of_whole = FitWithUncertainty(take), fit_of_parts = FitWithUncertainty(take, windows);
  EXPECT_NEAR(fit_of_parts.final_cost, fit_of_whole.final_cost, 0.01 * fit_of_whole.final_cost);
  EXPECT_NEAR(fit_of_parts.initial_cost, fit_of_whole.initial_cost, 0.05 * fit_of_whole.initial_cost);
  const Motion& whole = fit_of_whole.motion;
  const Motion& parts = fit_of_parts.motion;
  for (int f = 0; f < 200; ++f) {
    const double expected = CovarianceAt(whole, f, 8).trace();
    EXPECT_NEAR(CovarianceAt(parts, f, 8).trace(), expected, 0.02 * expected) << "frame " << f;
  }
}

TEST(TrackUncertainty, NeverExceedsThatOfAUniformAngle) {
  PlayedTake take = SmoothTake(3);
  for (int j = 1; j < take.tracks.joints(); ++j) {
    for (int f = 0; f < 3; ++f) Hide(take.tracks, f, j);
  }
  const Motion motion = FitWithUncertainty(take).motion;  // one joint does not observe any rotation
  for (const float sigma : motion.rotation_sigma) EXPECT_LE(sigma, 1.8139F);
  for (const float observed : motion.rotation_observed) EXPECT_LT(observed, 0.01F);
  EXPECT_TRUE(motion.Check().has_value());
}

/// A fit to the joints of a fitted motion: they are smooth, and their own error does not show in them.
TEST(StatedUncertainty, OfARefitIsNoLessThanThatOfTheFirstFit) {
  PlayedTake take = SmoothTake(60);
  AddNoise(take.tracks, 0.02, 5);
  Clip clip;
  clip.rate = take.truth.rate;
  clip.motion = FitWithUncertainty(take).motion;
  clip.motion->state[7] = JointState::kInferred;
  const auto again = FitTracksOfClip(clip, take.tracks.skeleton, take.truth.bone_length, FittingOptions{});
  ASSERT_TRUE(again.has_value()) << again.error().Message();
  for (const int joint : {0, 5, 12}) {
    EXPECT_GE(CovarianceAt(again->motion, 30, joint).trace(), CovarianceAt(*clip.motion, 30, joint).trace());
  }
  EXPECT_EQ(again->motion.state[7], JointState::kInferred);
  EXPECT_EQ(again->motion.state[8], JointState::kObserved);
}

/// 68.3 and 95.4 % are right. Motion and noise of these problems differ from those of the calibration. Of one problem
/// alone, 120 frames of one person, the shares are 63 to 70 and 91 to 95 %.
TEST(StatedUncertainty, CoversTheErrorsOfTheReferenceProblems) {
  if (ReferenceFolder().empty()) GTEST_SKIP() << "no reference problems: set MOCURATE_REFERENCE to their folder";
  Coverage coverage;
  for (const char* name :
       {"platform_seed0", "platform_seed1", "platform_seed2", "platform_dropouts5_seed0", "platform_dropouts5_seed1"}) {
    const ReferenceProblem problem = ReadReferenceProblem(ReferenceFolder() / (std::string(name) + ".h5"));
    const auto fit = FitJointTracks(problem.tracks, problem.rate, problem.bone_length, {});
    ASSERT_TRUE(fit.has_value()) << name;
    coverage.Add(fit->motion, problem.truth);
  }
  EXPECT_NEAR(coverage.one(), 0.683, 0.03);
  EXPECT_NEAR(coverage.two(), 0.954, 0.03);
}

TEST(TrackUncertainty, CoversSamplesThatAreBiasedForLong) {
  PlayedTake take = SmoothTake(120);
  AddNoise(take.tracks, 0.006, 9);
  const int ankle = *take.truth.skeleton->FindJoint("left_ankle");
  const int hip = *take.truth.skeleton->FindJoint("left_hip");
  const auto stated = [&](const FitResult& fit, int frame) {
    return std::sqrt(CovarianceAt(fit.motion, frame, ankle).trace());
  };
  const FitResult before = FitWithUncertainty(take);
  for (int f = 40; f < 70; ++f) {  // the leg appears longer
    const Vector3d leg = take.truth.joints.at(f, ankle) - take.truth.joints.at(f, hip);
    take.tracks.positions.at(f, ankle) += 0.06 * leg.normalized();
  }
  const FitResult fit = FitWithUncertainty(take);
  for (int f = 45; f < 65; ++f) {
    const double off = (fit.motion.joints.at(f, ankle) - take.tracks.positions.at(f, ankle)).norm();
    EXPECT_GT(stated(fit, f), 0.5 * off) << "frame " << f;
  }
  EXPECT_LT(stated(fit, 100), 1.5 * stated(before, 100));  // elsewhere nothing changes
}

TEST(TrackUncertainty, CoversAutocorrelatedErrors) {
  Coverage coverage;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    PlayedTake take = SmoothTake(150);
    Random random(seed, "lasting noise");
    const auto normal = [&] { return Vector3d(random.Normal(), random.Normal(), random.Normal()); };
    for (int j = 0; j < take.tracks.joints(); ++j) {
      Vector3d correlated = 0.015 * normal();
      for (int f = 0; f < take.tracks.frames(); ++f) {
        take.tracks.positions.at(f, j) += correlated + 0.015 * normal();
        correlated = 0.9 * correlated + 0.015 * std::sqrt(1.0 - 0.81) * normal();
      }
    }
    coverage.Add(FitWithUncertainty(take).motion, take.truth.joints);
  }
  EXPECT_GT(coverage.one(), 0.55);  // uncorrelated errors would be stated as half as large
  EXPECT_GT(coverage.two(), 0.85);
  EXPECT_LT(coverage.one(), 0.80);
}

/// Autocorrelated errors reduce the weight of a sample; a frame without a sample must not gain from that.
TEST(TrackUncertainty, FrameWithoutASampleIsNotMoreCertainThanItsNeighbours) {
  PlayedTake take = SmoothTake(150);
  Random random(1, "lasting noise");
  const auto normal = [&] { return Vector3d(random.Normal(), random.Normal(), random.Normal()); };
  for (int j = 0; j < take.tracks.joints(); ++j) {
    Vector3d correlated = 0.02 * normal();
    for (int f = 0; f < take.tracks.frames(); ++f) {
      take.tracks.positions.at(f, j) += correlated;
      correlated = 0.9 * correlated + 0.02 * std::sqrt(1.0 - 0.81) * normal();
    }
  }
  const int ankle = *take.truth.skeleton->FindJoint("left_ankle");
  for (const int frame : {30, 31, 60, 90, 91, 120}) Hide(take.tracks, frame, ankle);
  const FitResult fit = FitWithUncertainty(take);
  const auto stated = [&](int frame) { return std::sqrt(CovarianceAt(fit.motion, frame, ankle).trace()); };
  for (const auto& [before, after] : {std::pair(29, 32), std::pair(59, 61), std::pair(89, 92), std::pair(119, 121)}) {
    for (int f = before + 1; f < after; ++f) {
      EXPECT_GT(stated(f), 0.98 * std::min(stated(before), stated(after))) << "frame " << f;
    }
  }
}

TEST(TrackUncertainty, GrowsWithTheGapOfEachJointAndItsChildren) {
  PlayedTake take = SmoothTake(120);
  const Skeleton& body = *take.truth.skeleton;
  const int elbow = *body.FindJoint("left_elbow");
  const int wrist = *body.FindJoint("left_wrist");
  const int head = *body.FindJoint("head");
  const int top = *body.FindJoint("head_top");
  for (int f = 0; f < 120; ++f) {
    if (f >= 40 && f < 75) Hide(take.tracks, f, wrist);  // 1.2 s between observations
    if (f >= 40 && f < 56) Hide(take.tracks, f, elbow);  // 0.57 s
    if (f >= 40 && f < 75) Hide(take.tracks, f, head);
    Hide(take.tracks, f, top);
  }
  const GapInflation growth = FindGapInflation(take.tracks);
  const auto at = [&](int frame, int joint) { return static_cast<std::size_t>(frame * body.joint_count() + joint); };
  EXPECT_NEAR(growth.position[at(50, wrist)], 4.0, 1e-9);
  EXPECT_NEAR(growth.position[at(50, top)], 4.0, 1e-9);  // never observed, a child of the head
  EXPECT_EQ(growth.position[at(50, elbow)], 1.0);
  EXPECT_EQ(growth.position[at(80, wrist)], 1.0);
  EXPECT_EQ(growth.position[at(80, top)], 1.0);
  EXPECT_NEAR(growth.rotation[at(50, elbow)], 4.0, 1e-9);  // only the wrist observes it
  EXPECT_EQ(growth.rotation[at(50, *body.FindJoint("left_shoulder"))], 1.0);
}

}  // namespace
}  // namespace mocurate
