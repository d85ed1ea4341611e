#include "fitting/solver/joint_track_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "fitting/clouds/joint_cloud_fit.h"
#include "fitting/evidence/noise.h"
#include "fitting/solver/bone_lengths.h"
#include "tests/fitting/takes.h"
#include "tests/fitting/track_problems.h"

namespace mocurate {
namespace {

FitResult FitTake(const PlayedTake& take, const JointTrackOptions& options = {}) {
  const auto fit = FitJointTracks(take.tracks, take.truth.rate, take.truth.bone_length, options);
  EXPECT_TRUE(fit.has_value()) << fit.error().Message();
  return *fit;
}

/// m; what the rest pose moves joints by where the noise that is assumed is 1 mm.
constexpr double kBesideNoise = 3e-4;

JointTrackOptions Tight() {
  JointTrackOptions options;
  options.steps = {{FreeParts::kPose, StepEvidence::kAll, 1e-10, 200}};  // one problem, as the options state it
  return options;
}

TEST(JointTrackFit, RecoversNoiseFreeTracks) {
  const PlayedTake take = SmoothTake(60);
  EXPECT_LT(LargestError(FitTake(take).motion.joints, take.truth.joints), 5e-4);  // half of the assumed noise
  const FitResult fit = FitTake(take, Tight());
  EXPECT_LT(LargestError(fit.motion.joints, take.truth.joints), kBesideNoise);
  EXPECT_TRUE(fit.converged);
  EXPECT_TRUE(fit.motion.Check().has_value()) << fit.motion.Check().error().Message();
  EXPECT_EQ(fit.motion.bone_length, take.truth.bone_length);
  for (int f = 0; f < 60; ++f) {
    EXPECT_LT(AngleBetween(fit.motion.rotation_at(f, 0), take.truth.rotation_at(f, 0)), 2e-3) << "frame " << f;
  }
}

class AnyPosture : public testing::TestWithParam<Vector3d> {};

INSTANTIATE_TEST_SUITE_P(JointTrackFit, AnyPosture,
                         testing::Values(Vector3d(EIGEN_PI, 0, 0), Vector3d(0, 0, EIGEN_PI), Vector3d(0, EIGEN_PI, 0),
                                         Vector3d(EIGEN_PI / 2, 0, 0), Vector3d(-EIGEN_PI / 2, 0, 0),
                                         Vector3d(1.2, -2.0, 1.7)));

TEST_P(AnyPosture, ConvergesUpsideDownAndLying) {
  PlayedTake take = SmoothTake(40, ExpQuaternion(GetParam()));
  const FitResult clean = FitTake(take, Tight());
  EXPECT_LT(LargestError(clean.motion.joints, take.truth.joints), kBesideNoise);
  AddNoise(take.tracks, 0.01, 5);
  EXPECT_LT(RmsError(FitTake(take).motion.joints, take.truth.joints), 0.012);
}

TEST(JointTrackFit, FollowsAPersonWhoSpinsSeveralTimes) {
  const PlayedTake take = SmoothTake(150, Quaterniond::Identity(), 30.0, 6.0);  // five rotations about the vertical
  EXPECT_LT(LargestError(FitTake(take, Tight()).motion.joints, take.truth.joints), 5e-4);
}

// As in mocap bodies, neck and collars begin at one point: only their descendants determine the chest's orientation.
TEST(JointTrackFit, ShouldersOrientAChestWhoseCollarsBeginAtItsTop) {
  auto body = std::make_shared<Skeleton>(**LoadSkeleton("smpl24"));
  const int chest = *body->FindJoint("spine3");
  body->joints[*body->FindJoint("neck")].rest_offset = {0.0, 0.2, 0.001};
  body->joints[*body->FindJoint("left_collar")].rest_offset = {0.001, 0.2, 0.0};
  body->joints[*body->FindJoint("right_collar")].rest_offset = {-0.001, 0.2, 0.0};
  PlayedTake take = SmoothTake(60, Quaterniond::Identity(), 30.0, 0.4, body);
  AddNoise(take.tracks, 0.01, 5);
  JointTrackOptions closed_form;
  closed_form.steps.clear();
  const FitResult start = FitTake(take, closed_form);
  const std::vector<int> above{0, *body->FindJoint("spine1"), *body->FindJoint("spine2"), chest};
  const auto turn = [&](const Motion& motion, int f) {
    Quaterniond world = Quaterniond::Identity();
    for (const int joint : above) world = world * motion.rotation_at(f, joint);
    return world;
  };
  for (int f = 0; f < 60; ++f) EXPECT_LT(AngleBetween(turn(start.motion, f), turn(take.truth, f)), 0.7) << f;
  const FitResult fit = FitTake(take);
  EXPECT_LT(RmsError(fit.motion.joints, take.truth.joints), 8e-3);
}

// The frame with the most joints has none of the trunk: the fit starts among the joints that are observed.
TEST(JointTrackFit, StartsAmongTheObservedJointsWithoutATrunk) {
  PlayedTake take = SmoothTake(90);
  const auto is_end = [&](int j) {
    const std::string& name = take.tracks.skeleton->joints[static_cast<std::size_t>(j)].name;
    return name.find("elbow") != std::string::npos || name.find("wrist") != std::string::npos ||
           name.find("ankle") != std::string::npos;
  };
  const auto is_trunk = [&](int j) {
    const std::string& name = take.tracks.skeleton->joints[static_cast<std::size_t>(j)].name;
    return name.find("hip") != std::string::npos || name.find("shoulder") != std::string::npos;
  };
  for (int f = 0; f < 90; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) {
      const bool observed = f < 30 ? is_end(j) : f >= 60 && is_trunk(j);
      if (!observed) Hide(take.tracks, f, j);
    }
  }
  JointTrackOptions closed_form;
  closed_form.steps.clear();
  const FitResult start = FitTake(take, closed_form);
  EXPECT_LT((start.motion.root_translation[0] - take.truth.root_translation[0]).norm(), 0.7);
  EXPECT_LT(FitTake(take).residual_rms, 0.01);
}

TEST(JointTrackFit, FillsHiddenJointsWithoutReadingThem) {
  PlayedTake take = SmoothTake(90);
  Random random(1, "half");
  for (int f = 0; f < 90; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) {
      if (random.Uniform() < 0.5) Hide(take.tracks, f, j);
    }
  }
  const FitResult fit = FitTake(take);
  EXPECT_LT(RmsError(fit.motion.joints, take.truth.joints), 0.01);
  EXPECT_LT(fit.residual_rms, 0.005);
  PlayedTake other = take;
  for (std::size_t i = 0; i < other.tracks.confidence.size(); ++i) {
    if (other.tracks.confidence[i] > 0.0) continue;
    for (int k = 0; k < 3; ++k) other.tracks.positions.xyz[3 * i + k] = std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_EQ(FitTake(other).motion.joints.xyz, fit.motion.joints.xyz);
}

// A straight line between the last and the next observation does not predict where the right side is.
TEST(JointTrackFit, StartsWithTheRightOrientationWhileOneSideIsHidden) {
  PlayedTake take = SmoothTake(120, Quaterniond::Identity(), 30.0, 0.0);
  std::vector<Vector3d> translation;
  std::vector<Quaterniond> rotation;
  const int joints = take.truth.joint_count();
  for (int f = 0; f < 120; ++f) {
    const double way = std::sin(EIGEN_PI * std::clamp((f - 20) / 80.0, 0.0, 1.0));  // from 0 to 1 and back
    translation.emplace_back(take.truth.joints.at(f, 0));
    for (int j = 0; j < joints; ++j) {
      const Quaterniond own = take.truth.rotation_at(f, j);
      rotation.push_back(j == 0 ? ExpQuaternion(Vector3d(0, 2.0 * way, 0)) * own : own);
      const bool right = take.truth.skeleton->joints[j].name.rfind("right_", 0) == 0;
      if (right && f >= 20 && f < 100) Hide(take.tracks, f, j);
    }
  }
  take.truth = MakeMotion(take.truth.skeleton, take.truth.rate, translation, rotation, take.truth.bone_length);
  for (int f = 0; f < 120; ++f) {
    for (int j = 0; j < joints; ++j) {
      if (take.tracks.seen(f, j)) take.tracks.positions.at(f, j) = take.truth.joints.at(f, j);
    }
  }
  JointTrackOptions closed_form;
  closed_form.steps.clear();
  const FitResult start = FitTake(take, closed_form);
  for (int f = 0; f < 120; ++f) {
    EXPECT_LT(AngleBetween(start.motion.rotation_at(f, 0), take.truth.rotation_at(f, 0)), 0.5) << "frame " << f;
  }
}

TEST(JointTrackFit, MarksTheStateOfEachJoint) {
  PlayedTake take = SmoothTake(30);
  for (int f = 0; f < 30; ++f) Hide(take.tracks, f, 5);
  Hide(take.tracks, 10, 2);
  const FitResult fit = FitTake(take);
  const int joints = take.tracks.joints();
  EXPECT_EQ(fit.motion.state[10 * joints + 2], JointState::kInterpolated);
  EXPECT_EQ(fit.motion.state[11 * joints + 2], JointState::kObserved);
  EXPECT_EQ(fit.motion.state[10 * joints + 5], JointState::kInferred);
}

TEST(JointTrackFit, InterpolatesFramesWithoutAnyEvidence) {
  PlayedTake take = SmoothTake(60);
  for (int f = 25; f < 31; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) Hide(take.tracks, f, j);
  }
  const FitResult fit = FitTake(take);
  EXPECT_LT(RmsError(fit.motion.joints, take.truth.joints), 0.02);
  ASSERT_EQ(fit.findings.size(), 1u);
  EXPECT_EQ(fit.findings[0].code, "frames_without_evidence");
  EXPECT_EQ(fit.findings[0].frame_begin, 25);
  EXPECT_EQ(fit.findings[0].frame_end, 31);
  EXPECT_EQ(fit.motion.state[27 * take.tracks.joints()], JointState::kInterpolated);
}

TEST(JointTrackFit, FitsEvidenceInTheFirstFrameOnlyAndASingleFrame) {
  const PlayedTake single = SmoothTake(1);
  EXPECT_LT(LargestError(FitTake(single, Tight()).motion.joints, single.truth.joints), 1e-3);
  PlayedTake take = SmoothTake(20);
  for (int f = 1; f < 20; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) Hide(take.tracks, f, j);
  }
  const FitResult fit = FitTake(take);
  EXPECT_TRUE(fit.motion.Check().has_value());
  EXPECT_LT((fit.motion.joints.at(19, 0) - take.truth.joints.at(0, 0)).norm(), 0.1);
}

TEST(JointTrackFit, ResistsGrossOutliers) {
  PlayedTake take = SmoothTake(60);
  AddNoise(take.tracks, 0.005, 2);
  const double undisturbed = RmsError(FitTake(take).motion.joints, take.truth.joints);
  Random random(4, "outliers");
  for (int f = 0; f < 60; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) {
      if (random.Uniform() < 0.03) take.tracks.positions.at(f, j) += Vector3d(1.0, -2.0, 0.7);
    }
  }
  const FitResult fit = FitTake(take);
  EXPECT_LT(RmsError(fit.motion.joints, take.truth.joints), 2.0 * undisturbed);
  ASSERT_FALSE(fit.findings.empty());
  EXPECT_EQ(fit.findings[0].code, "outliers_rejected");
}

/// A tracker moves an ankle halfway up to the hip: a bone of constant length does not reach it.
TEST(JointTrackFit, CountsSamplesThatContradictTheBodyAsNotObserved) {
  const int hip = *TestSkeleton()->FindJoint("left_hip");
  const int ankle = *TestSkeleton()->FindJoint("left_ankle");
  const std::pair<int, JointState> cases[] = {{10, JointState::kInterpolated}, {25, JointState::kInferred}};
  for (const auto& [length, state] : cases) {
    PlayedTake take = SmoothTake(90);
    AddNoise(take.tracks, 0.01, 13);
    for (int f = 30; f < 30 + length; ++f) {
      const Vector3d middle = 0.5 * (take.tracks.positions.at(f, hip) + take.tracks.positions.at(f, ankle));
      take.tracks.positions.at(f, ankle) = middle;
    }
    const FitResult fit = FitTake(take);
    for (int f = 0; f < 90; ++f) {
      for (int j = 0; j < take.tracks.joints(); ++j) {
        const bool collapsed = j == ankle && f >= 30 && f < 30 + length;
        EXPECT_EQ(StateAt(fit.motion, f, j), collapsed ? state : JointState::kObserved)
            << "frame " << f << " joint " << j;
      }
    }
    ASSERT_EQ(fit.findings.size(), 1u);
    const Finding& finding = fit.findings[0];
    EXPECT_EQ(finding.code, kSamplesContradicted);
    EXPECT_EQ(finding.severity, Severity::kInfo);
    EXPECT_EQ(finding.action, FindingAction::kFlagged);
    EXPECT_EQ(finding.joint, "left_ankle");
    EXPECT_EQ(finding.frame_begin, 30);
    EXPECT_EQ(finding.frame_end, 30 + length);
    EXPECT_EQ(finding.value, length);
    EXPECT_EQ(KnownJoints(fit.motion), std::vector<bool>(fit.motion.state.size() / 90, true))
        << "the ankle is observed in other frames";
  }
}

/// Far along a direction in which the sample is uncertain, as along the ray of a keypoint, is no contradiction.
TEST(JointTrackFit, KeepsObservedWhatItsOwnDeviationExplains) {
  const int wrist = *TestSkeleton()->FindJoint("left_wrist");
  for (const bool uncertain : {false, true}) {
    PlayedTake take = SmoothTake(60);
    AddNoise(take.tracks, 0.01, 3);
    take.tracks.precision.assign(take.tracks.confidence.size(), Matrix3d::Identity());
    for (int f = 20; f < 30; ++f) {
      const std::size_t at = static_cast<std::size_t>(f) * take.tracks.joints() + static_cast<std::size_t>(wrist);
      take.tracks.positions.at(f, wrist).z() += 0.6;
      if (uncertain) take.tracks.precision[at] = Vector3d(1.0, 1.0, 1e-4).asDiagonal();
    }
    const FitResult fit = FitTake(take);
    EXPECT_GT((fit.motion.joints.at(25, wrist) - take.tracks.positions.at(25, wrist)).norm(), 0.15);
    EXPECT_EQ(StateAt(fit.motion, 25, wrist), uncertain ? JointState::kObserved : JointState::kInterpolated);
  }
}

TEST(JointTrackFit, WeightsEachDirectionByItsPrecision) {
  PlayedTake take = SmoothTake(60);
  AddUnevenNoise(take.tracks, 0.02, 12);
  const FitResult weighted = FitTake(take);
  EXPECT_NEAR(weighted.noise_sigma, 0.02, 0.002);  // of a sample whose precision is the identity
  EXPECT_NEAR(weighted.variance_factor, 1.0, 0.15);
  take.tracks.precision.clear();
  const FitResult defaults = FitTake(take);
  EXPECT_LT(RmsError(weighted.motion.joints, take.truth.joints),
            0.8 * RmsError(defaults.motion.joints, take.truth.joints));
}

TEST(JointTrackFit, KeepsASampleThatIsOffInAnUncertainDirection) {
  PlayedTake take = SmoothTake(40);
  AddNoise(take.tracks, 0.01, 3);
  take.tracks.precision.assign(take.tracks.confidence.size(), Matrix3d::Identity());
  take.tracks.positions.at(20, 5).z() += 0.4;
  const auto rejected = [&] {
    SkeletonTracks tracks = take.tracks;
    return RejectOutliers(tracks, 0.01);
  };
  const std::size_t at = std::size_t{20} * take.tracks.joints() + 5;
  EXPECT_TRUE(rejected()[at]);
  take.tracks.precision[at] = Vector3d(1.0, 1.0, 0.01).asDiagonal();
  EXPECT_FALSE(rejected()[at]);
}

TEST(JointTrackFit, WeightsConfidence) {
  PlayedTake take = SmoothTake(40);
  AddNoise(take.tracks, 0.01, 9);
  for (int f = 0; f < 40; ++f) {  // one joint has wrong samples of low confidence
    take.tracks.positions.at(f, 1) += Vector3d(0.03, 0, 0);
    take.tracks.confidence[static_cast<std::size_t>(f) * take.tracks.joints() + 1] = 0.05;
  }
  const FitResult quiet = FitTake(take);
  for (double& confidence : take.tracks.confidence) confidence = 1.0;
  const FitResult loud = FitTake(take);
  const auto pull = [&](const FitResult& fit) {
    Vector3d sum = Vector3d::Zero();
    for (int f = 0; f < 40; ++f) sum += (fit.motion.joints.at(f, 1) - take.truth.joints.at(f, 1)) / 40.0;
    return sum.norm();
  };
  EXPECT_LT(pull(quiet), 0.6 * pull(loud));
}

TEST(JointTrackFit, DoesNotSmoothAcrossAGapInTime) {
  PlayedTake take = SmoothTake(40);
  const double jump = 3.0;
  for (int f = 20; f < 40; ++f) {
    take.tracks.time_s[f] += 5.0;
    for (int j = 0; j < take.tracks.joints(); ++j) take.tracks.positions.at(f, j).x() += jump;
  }
  AddNoise(take.tracks, 0.01, 11);
  const FitResult fit = FitTake(take);
  const double before = fit.motion.joints.at(19, 0).x() - take.truth.joints.at(19, 0).x();
  const double after = fit.motion.joints.at(20, 0).x() - take.truth.joints.at(20, 0).x() - jump;
  EXPECT_LT(std::abs(before), 0.02);
  EXPECT_LT(std::abs(after), 0.02);
}

TEST(JointTrackFit, SmoothnessIsIndependentOfTheRate) {
  PlayedTake slow = SmoothTake(45, Quaterniond::Identity(), 15.0);
  PlayedTake fast = SmoothTake(180, Quaterniond::Identity(), 60.0);
  AddNoise(slow.tracks, 0.02, 21);
  AddNoise(fast.tracks, 0.02, 21);
  // Four times the samples per second must not reduce accuracy, as smoothness per frame would.
  EXPECT_LT(RmsError(FitTake(fast).motion.joints, fast.truth.joints),
            RmsError(FitTake(slow).motion.joints, slow.truth.joints));
}

TEST(JointTrackFit, WindowsAgreeWithTheWholeClip) {
  PlayedTake take = SmoothTake(200);
  AddNoise(take.tracks, 0.01, 31);
  JointTrackOptions windows = Tight();
  windows.window_frames = 60;
  windows.window_overlap = 20;
  const FitResult whole = FitTake(take, Tight());
  const FitResult parts = FitTake(take, windows);
  EXPECT_LT(RmsError(whole.motion.joints, parts.motion.joints), 5e-4);
}

TEST(JointTrackFit, IsReproducibleToTheByte) {
  PlayedTake take = SmoothTake(50);
  AddNoise(take.tracks, 0.02, 41);
  const FitResult first = FitTake(take);
  const FitResult second = FitTake(take);
  EXPECT_EQ(first.motion.joints.xyz, second.motion.joints.xyz);
  EXPECT_EQ(first.final_cost, second.final_cost);
}

TEST(JointTrackFit, ReportsThatItDidNotConverge) {
  PlayedTake take = SmoothTake(30);
  AddNoise(take.tracks, 0.02, 51);
  JointTrackOptions options = Tight();
  options.steps.back().max_iterations = 1;
  const FitResult fit = FitTake(take, options);
  EXPECT_FALSE(fit.converged);
  EXPECT_EQ(fit.termination.rfind("iteration limit in frames 0 to 29", 0), 0u) << fit.termination;
}

TEST(JointTrackFit, WithoutStepsReturnsTheClosedForm) {
  PlayedTake take = SmoothTake(30);
  JointTrackOptions options;
  options.steps.clear();
  const FitResult fit = FitTake(take, options);
  EXPECT_EQ(fit.termination, "closed form");
  EXPECT_EQ(fit.iterations, 0);
  EXPECT_TRUE(fit.motion.position_cov.empty()) << "nothing was solved, so no covariance exists";
  EXPECT_LT(RmsError(fit.motion.joints, take.truth.joints), 0.05);
}

TEST(JointTrackFit, StepWithAFreeRootMovesThePersonAsAWhole) {
  PlayedTake take = SmoothTake(30);
  AddNoise(take.tracks, 0.02, 51);
  JointTrackOptions options;
  options.steps.clear();
  const FitResult start = FitTake(take, options);
  options.steps = {{FreeParts::kRoot, StepEvidence::kAll, 1e-8, 100}};
  for (const PoseSolver solver : {PoseSolver::kCeres, PoseSolver::kBanded}) {
    options.solver = solver;
    const FitResult moved = FitTake(take, options);
    EXPECT_GT((moved.motion.root_translation[15] - start.motion.root_translation[15]).norm(), 1e-4);
    for (int f = 0; f < 30; ++f) {
      for (int j = 1; j < take.tracks.joints(); ++j) {
        EXPECT_LT(moved.motion.rotation_at(f, j).angularDistance(start.motion.rotation_at(f, j)), 1e-9);
      }
    }
  }
  options.steps.push_back({FreeParts::kPose, StepEvidence::kAll, 1e-8, 100});
  const FitResult all = FitTake(take, options);
  EXPECT_LT(LargestError(all.motion.joints, FitTake(take, Tight()).motion.joints), 1e-4)
      << "the last step determines the result";
}

TEST(JointTrackFit, EstimatesTheNoiseOfTheTracks) {
  PlayedTake take = SmoothTake(100);
  AddNoise(take.tracks, 0.02, 61);
  EXPECT_NEAR(FitTake(take).noise_sigma, 0.02, 0.002);
}

/// A runner moves far between two frames; that is not noise, because her bones keep their lengths.
TEST(JointTrackFit, DoesNotMistakeFastMotionForNoise) {
  PlayedTake take = SmoothTake(150, Quaterniond::Identity(), 8.0, 4.0);
  EXPECT_LT(EstimateNoise(take.tracks, {}).sigma, 2e-3);
  const BoneEstimate bones = EstimateBoneLengths({take.tracks}, *take.tracks.skeleton, true);
  for (int j = 1; j < take.tracks.joints(); ++j) {
    EXPECT_NEAR(bones.length[j], take.truth.bone_length[j], 1e-3) << take.tracks.skeleton->joints[j].name;
  }
  AddNoise(take.tracks, 0.01, 5);
  EXPECT_NEAR(EstimateNoise(take.tracks, {}).sigma, 0.01, 0.002);
}

TEST(JointTrackFit, PlacesARootWithoutATrack) {
  PlayedTake take = SmoothTake(40, ExpQuaternion(Vector3d(0, 2.5, 0)));
  for (int f = 0; f < 40; ++f) Hide(take.tracks, f, 0);
  const FitResult fit = FitTake(take, Tight());
  EXPECT_LT(LargestError(fit.motion.joints, take.truth.joints), kBesideNoise);
}

JointTrackOptions Refits(int count) {
  JointTrackOptions options;
  options.steps = StepsWithRefits(count);
  return options;
}

TEST(JointTrackFit, AdaptsSmoothingToTheMotion) {
  for (const double noise : {0.005, 0.02}) {
    PlayedTake calm = SmoothTake(120);
    AddNoise(calm.tracks, noise, 6);
    const double as_given = RmsError(FitTake(calm, Refits(0)).motion.joints, calm.truth.joints);
    const double fitted = RmsError(FitTake(calm, Refits(2)).motion.joints, calm.truth.joints);
    EXPECT_LT(fitted, 0.95 * as_given) << "noise " << noise;

    PlayedTake spinning = SmoothTake(120, Quaterniond::Identity(), 30.0, 9.0);
    AddNoise(spinning.tracks, noise, 6);
    const double spin_as_given = RmsError(FitTake(spinning, Refits(0)).motion.joints, spinning.truth.joints);
    const double spin_fitted = RmsError(FitTake(spinning, Refits(2)).motion.joints, spinning.truth.joints);
    EXPECT_LT(spin_fitted, 1.02 * spin_as_given) << "noise " << noise;
  }
}

}  // namespace
}  // namespace mocurate
