#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/cloud_uncertainty.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/clouds/joint_cloud_fit.h"
#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "tests/fitting/cloud_takes.h"
#include "tests/fitting/fit_score.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

constexpr double kHalfTurn = 3.141592653589793;
constexpr std::size_t kSitting = 8;  ///< clip of the ninth class

/// One of the studio's people in the first frames of all actions up to sitting, seen by PHSPD's depth cameras.
class StudioClouds : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    CloudTakeOptions options;
    options.seed = 811;
    options.subjects = 1;
    options.clips = 9;
    options.frames = 8;
    const std::filesystem::path folder = SharedScratch("cloud_takes");
    takes_ = new std::vector<CloudTake>(CloudTakes(options, folder));
    clips_.clear();
    for (const CloudTake& take : *takes_) {
      clips_.emplace_back();
      clips_.back().evidence = take.evidence;
      clips_.back().rate = take.clip.truth.rate;
    }
    skeleton_ = *LoadSkeleton("smpl24");
    options_.solver = PoseSolver::kBanded;
    if (clips_.empty()) return;
    const BodyFromClouds body = *MeasureBodyInClouds(clips_, skeleton_, options_);
    person_ = body.skeleton;
    bones_ = body.bone_length;
  }

  void SetUp() override {
    if (takes_->empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }

  static FitScore Score(const FitResult& fit, const CloudTake& take) {
    FitScore score;
    score.Add(fit, take.clip);
    return score;
  }

  static Expected<BodyFromClouds> BodyOfBothModalities(const JointTrackOptions& options) {
    std::vector<SkeletonTracks> tracks;
    for (const CloudTake& of_person : *takes_) tracks.push_back(of_person.clip.tracks);
    const auto person = EstimateProportions(tracks, skeleton_, ProportionsOptions{});
    std::vector<Motion> motions;
    for (const CloudTake& of_person : *takes_) {
      motions.push_back(RepairAndFit(OnBody(of_person.clip.tracks, person.skeleton), of_person.clip.truth.rate,
                                     person.bone_length, RepairOptions{}, options)
                            ->motion);
    }
    return MeasurePosedBody(clips_, motions, person.scale, skeleton_, options_);
  }

  /// A take fitted to its tracks; made once.
  static const Expected<FitResult>& FitOfTracks(std::size_t take) {
    static std::map<std::size_t, Expected<FitResult>> fits;
    const auto known = fits.find(take);
    if (known != fits.end()) return known->second;
    JointTrackOptions options;
    options.solver = PoseSolver::kBanded;
    options.poses = true;
    static const Expected<BodyFromClouds> body = BodyOfBothModalities(options);
    if (!body) return fits.emplace(take, Forward(body)).first->second;
    const StudioClip& clip = (*takes_)[take].clip;
    return fits
        .emplace(take, RepairAndFit(OnBody(clip.tracks, body->skeleton), clip.truth.rate, body->bone_length,
                                    RepairOptions{}, options))
        .first->second;
  }

  static PointCloudOptions WithReportedFacing(std::size_t take) {
    PointCloudOptions options = options_;
    options.start.facing = (*takes_)[take].reported_heading;
    return options;
  }

  /// A take fitted to its clouds from the reported facing; made once.
  static const Expected<FitResult>& FitOfClouds(std::size_t take) {
    static std::map<std::size_t, Expected<FitResult>> fits;
    const auto known = fits.find(take);
    if (known != fits.end()) return known->second;
    return fits.emplace(take, FitClouds(clips_[take], person_, bones_, WithReportedFacing(take))).first->second;
  }

  static std::vector<CloudTake>* takes_;
  static std::vector<Clip> clips_;
  static SkeletonPtr skeleton_;
  static SkeletonPtr person_;  ///< with their own bones and body shape
  static std::vector<double> bones_;
  static PointCloudOptions options_;
};

std::vector<CloudTake>* StudioClouds::takes_ = nullptr;
std::vector<Clip> StudioClouds::clips_;
SkeletonPtr StudioClouds::skeleton_;
SkeletonPtr StudioClouds::person_;
std::vector<double> StudioClouds::bones_;
PointCloudOptions StudioClouds::options_;

TEST_F(StudioClouds, FindsASeatedPersonFromTheFacingAlone) {
  const CloudTake& take = (*takes_)[kSitting];
  ASSERT_TRUE(take.seated);
  const auto& fit = FitOfClouds(kSitting);
  ASSERT_TRUE(fit) << fit.error().Message();
  EXPECT_LT(Score(*fit, take).joint_mm(), 20.0);
}

/// Arms before the chest of a seated person make neither the chest nor the body larger: the search fits limbs first.
TEST_F(StudioClouds, MeasuresTheSizeOfAPersonWhoIsAlwaysSeated) {
  ASSERT_TRUE((*takes_)[kSitting].seated);
  const auto body = MeasureBodyInClouds({clips_[kSitting]}, skeleton_, options_);
  ASSERT_TRUE(body) << body.error().Message();
  const std::vector<double>& truth = (*takes_)[kSitting].clip.truth.bone_length;
  EXPECT_NEAR(BodyScale(*skeleton_, body->bone_length) / BodyScale(*skeleton_, truth), 1.0, 0.03);
}

TEST_F(StudioClouds, SearchesAgainForALostPerson) {
  // The person sits; from one frame to the next the person stands and faces another way.
  constexpr int kStanding = 0;
  std::vector<FusedCloud> clouds = *FuseClip(clips_[kSitting], options_);
  std::vector<FusedCloud> after = *FuseClip(clips_[kStanding], options_);
  const Matrix3d turn = Eigen::AngleAxisd(2.0, Vector3d::UnitY()).toRotationMatrix();
  const Vector3d middle = after[0].points.rowwise().mean();
  constexpr int kStood = 3;
  constexpr int kLeftWrist = 20;
  for (int f = 0; f < kStood; ++f) {
    FusedCloud& cloud = after[static_cast<std::size_t>(f)];
    cloud.points = ((turn * (cloud.points.colwise() - middle)).colwise() + middle).eval();
    cloud.normals = (turn * cloud.normals).eval();
    clouds.push_back(cloud);
  }
  clouds.push_back(FusedCloud{Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xd(3, 0), 0});
  CloudClock clock{clips_[kSitting].rate, {}};
  for (std::size_t f = 0; f < clouds.size(); ++f) clock.time_s.push_back(clock.rate.FrameTime(static_cast<int>(f)));
  PointCloudOptions options = options_;
  options.start.facing = (*takes_)[kSitting].reported_heading;
  const auto fit = FitFusedClouds(clouds, clock, person_, bones_, options);
  ASSERT_TRUE(fit) << fit.error().Message();
  const Motion& truth = (*takes_)[kStanding].clip.truth;
  double error = 0.0;
  for (int f = 0; f < kStood; ++f) {
    const int at = fit->motion.frame_count() - 1 - kStood + f;
    for (int j = 0; j < truth.joint_count(); ++j) {
      error += (turn * (truth.joints.at(f, j) - middle) + middle - fit->motion.joints.at(at, j)).norm();
    }
  }
  EXPECT_LT(error / (kStood * truth.joint_count()), 0.04);
  // The last frame has no points: it keeps the pose before it and that pose's uncertainty.
  const Motion& motion = fit->motion;
  const int last = motion.frame_count() - 1;
  EXPECT_EQ(motion.joints.at(last, kLeftWrist), motion.joints.at(last - 1, kLeftWrist));
  const auto variance = [&](int frame) {
    return motion.position_cov[6 * static_cast<std::size_t>(frame * motion.joint_count() + kLeftWrist)];
  };
  EXPECT_LT(variance(last - 1), 4.0F * variance(0));
}

TEST_F(StudioClouds, UsesTheReportedFacing) {
  const CloudTake& take = (*takes_)[0];
  PointCloudOptions options = options_;
  options.start.facing = take.heading + kHalfTurn;
  const auto wrong = FitClouds(clips_[0], person_, bones_, options);
  ASSERT_TRUE(wrong) << wrong.error().Message();
  EXPECT_GT(std::abs(std::remainder(HeadingOf(wrong->motion, 0) - take.heading, 2.0 * kHalfTurn)), 1.5);
  const auto& right = FitOfClouds(0);
  ASSERT_TRUE(right) << right.error().Message();
  EXPECT_LT(Score(*right, take).joint_mm(), 14.0);
}

/// One camera from near; then its surface flattened, as noise does from afar.
TEST_F(StudioClouds, OneSideIsLessCertainAndAFlatOneHasLowCoverage) {
  Clip clip = clips_[0];
  const auto sigma = [](const Motion& motion) {  // m, per axis
    double variance = 0.0;
    for (std::size_t i = 0; i < motion.position_cov.size(); i += 6)
      variance += (motion.position_cov[i] + motion.position_cov[i + 3] + motion.position_cov[i + 5]) / 3.0;
    return std::sqrt(6.0 * variance / static_cast<double>(motion.position_cov.size()));
  };
  const auto fit_of = [&](std::vector<FusedCloud> clouds) {
    return FitFusedClouds(std::move(clouds), {clip.rate, clip.evidence.depth_views[0].time_s}, person_, bones_,
                          WithReportedFacing(0));
  };
  const auto is_low_coverage = [](const FitResult& fit) {
    return std::any_of(fit.findings.begin(), fit.findings.end(),
                       [](const Finding& finding) { return finding.code == kLowCoverage; });
  };
  const std::vector<FusedCloud> all = *FuseClip(clip, options_);
  clip.evidence.depth_views.resize(1);
  std::vector<FusedCloud> one = *FuseClip(clip, options_);
  EXPECT_LT(LowCoverageSigma(all[0], options_, 1.0), 0.001);
  EXPECT_GT(LowCoverageSigma(one[0], options_, 1.0), 0.002);
  EXPECT_EQ(LowCoverageSigma(FusedCloud{}, options_, 1.0), 0.0);
  FusedCloud part = all[0];
  part.points = part.points.leftCols(200).eval();
  part.normals = part.normals.leftCols(200).eval();
  EXPECT_GT(LowCoverageSigma(part, options_, 1.0), kUnobservedError);
  const auto of_all = fit_of(all), of_one = fit_of(one);
  ASSERT_TRUE(of_all && of_one);
  EXPECT_FALSE(is_low_coverage(*of_all) || is_low_coverage(*of_one));
  EXPECT_GT(sigma(of_one->motion), 1.2 * sigma(of_all->motion));
  for (FusedCloud& cloud : one) {
    const Vector3d mean = cloud.normals.rowwise().mean().normalized();
    for (int i = 0; i < cloud.size(); ++i)
      cloud.normals.col(i) = (0.5 * cloud.normals.col(i) + 0.5 * mean).normalized();
  }
  const auto flat = fit_of(one);
  ASSERT_TRUE(flat) << flat.error().Message();
  EXPECT_TRUE(is_low_coverage(*flat));
  EXPECT_GT(sigma(flat->motion), 0.04);
  ASSERT_EQ(flat->motion.state.size(), 24 * one.size());
  for (const JointState state : flat->motion.state) EXPECT_EQ(state, JointState::kInferred);
  for (const Finding& finding : flat->findings) EXPECT_NE(finding.code, "limb_never_seen") << "limbs are observed";
  for (const float observed : flat->motion.rotation_observed) EXPECT_LT(observed, 1.0F);
}

/// Kinect pixels are 8 mm apart at three metres: smaller voxels are mostly empty. Filled from voxels of 5 and 10 mm,
/// cells of 3 cm are 28 % more than from voxels of 3 cm.
TEST_F(StudioClouds, TheSeenAreaHardlyDependsOnTheVoxelSize) {
  double usual = 0.0;
  for (const double voxel_size : {0.03, 0.02, 0.01, 0.005}) {
    PointCloudOptions options = options_;
    options.voxel_size = voxel_size;
    const FusedCloud cloud = FuseClip(clips_[0], options)->front();
    const std::vector<bool> sample = CoverageSample(cloud, voxel_size);
    const double area =
        static_cast<double>(std::count(sample.begin(), sample.end(), true)) * CoverageOfPoint(voxel_size);
    if (usual == 0.0) usual = area;
    EXPECT_NEAR(area, usual, 0.35 * usual) << voxel_size;
    const double of_voxels = cloud.size() * voxel_size * voxel_size;
    if (voxel_size < 0.01) {
      EXPECT_LT(of_voxels, 0.5 * usual);
    }
  }
}

/// From the fifth frame on, two of three views show another person.
TEST_F(StudioClouds, ReportsAnotherPersonFromHalfwayOnAndRaisesUncertainty) {
  constexpr int kFrom = 4;
  Clip clip = clips_[0];
  for (const std::size_t v : {std::size_t{0}, std::size_t{1}}) {
    for (std::size_t f = kFrom; f < clip.evidence.depth_views[v].files.size(); ++f)
      clip.evidence.depth_views[v].files[f] = clips_[kSitting].evidence.depth_views[v].files[f];
  }
  PointCloudOptions options = options_;
  options.start.facing = (*takes_)[0].reported_heading;
  options.audit.moved = AuditAction::kReport;  // else the view of the first person is excluded, and the two agree
  const auto fit = FitClouds(clip, person_, bones_, options);
  ASSERT_TRUE(fit) << fit.error().Message();
  const auto reported = std::find_if(fit->findings.begin(), fit->findings.end(),
                                     [](const Finding& finding) { return finding.code == kPoorlyExplained; });
  ASSERT_NE(reported, fit->findings.end());
  EXPECT_EQ(reported->value, static_cast<double>(fit->motion.frame_count() - kFrom));
  const auto variance = [&](int frame) {
    double sum = 0.0;
    for (int j = 0; j < 24; ++j) sum += fit->motion.position_cov[6 * (24 * static_cast<std::size_t>(frame) + j)];
    return sum;
  };
  EXPECT_GT(variance(kFrom + 1), 4.0 * variance(kFrom - 1));
}

/// A single stray point is not a fitted frame of low coverage.
TEST_F(StudioClouds, FramesThatAreNotFittedHaveNoLowCoverage) {
  std::vector<FusedCloud> clouds = *FuseClip(clips_[0], options_);
  FusedCloud& stray = clouds[3];
  stray.points = stray.points.leftCols(1).eval();
  stray.normals = stray.normals.leftCols(1).eval();
  PointCloudOptions options = options_;
  options.start.facing = (*takes_)[0].reported_heading;
  const auto fit = FitFusedClouds(std::move(clouds), {clips_[0].rate, clips_[0].evidence.depth_views[0].time_s},
                                  person_, bones_, options);
  ASSERT_TRUE(fit) << fit.error().Message();
  ASSERT_EQ(fit->findings.size(), 1u);
  EXPECT_EQ(fit->findings[0].code, "frames_without_evidence");
}

TEST_F(StudioClouds, StatedUncertaintyCoversTheErrors) {
  FitScore score;
  for (std::size_t i = 0; i < takes_->size(); ++i) {
    const auto& fit = FitOfClouds(i);
    ASSERT_TRUE(fit) << fit.error().Message();
    score.Add(*fit, (*takes_)[i].clip);
  }
  EXPECT_GT(score.within_one(), 0.5);
  EXPECT_LT(score.within_one(), 0.85);
  EXPECT_GT(score.within_two(), 0.85);
}

/// Rotations improve by a tenth in 60 clips of 15 frames (bench_fit_clouds with mix=1). They do not in nine clips of 8
/// frames of this person: clouds alone already orient the trunk better than tracks with 30 mm of noise.
TEST_F(StudioClouds, WithTracksAreATenthBetterThanTheBetterOneAlone) {
  FitScore of_tracks, of_clouds, of_both;
  for (std::size_t i = 0; i < takes_->size(); ++i) {
    const CloudTake& take = (*takes_)[i];
    const auto& tracks = FitOfTracks(i);
    ASSERT_TRUE(tracks) << tracks.error().Message();
    const auto& clouds = FitOfClouds(i);
    ASSERT_TRUE(clouds) << clouds.error().Message();
    const PointCloudOptions options = WithReportedFacing(i);
    const auto both = FitTracksAndClouds(*tracks, *FuseClip(clips_[i], options), options);
    ASSERT_TRUE(both) << both.error().Message();
    of_tracks.Add(*tracks, take.clip);
    of_clouds.Add(*clouds, take.clip);
    of_both.Add(*both, take.clip);
  }
  RecordProperty("tracks_mm", std::to_string(of_tracks.joint_mm()));
  RecordProperty("clouds_mm", std::to_string(of_clouds.joint_mm()));
  RecordProperty("both_mm", std::to_string(of_both.joint_mm()));
  EXPECT_LT(of_both.joint_mm(), 0.9 * std::min(of_tracks.joint_mm(), of_clouds.joint_mm()));
  // Of twelve clips of a second (bench_fit_clouds 12 30 907 FOLDER mix=1) 2.1 degrees with both, 2.8 and 3.5 alone.
  EXPECT_LT(of_both.rotation_deg(), 1.02 * std::min(of_tracks.rotation_deg(), of_clouds.rotation_deg()));
  EXPECT_GT(of_both.within_one(), 0.55);
  EXPECT_LT(of_both.within_one(), 0.80);
  EXPECT_GT(of_both.within_two(), 0.84);
}

TEST_F(StudioClouds, WithTracksBothSolversFindTheSamePose) {
  const auto& tracks = FitOfTracks(2);
  ASSERT_TRUE(tracks);
  const auto clouds = FuseClip(clips_[2], options_);
  const auto banded = FitTracksAndClouds(*tracks, *clouds, options_);
  PointCloudOptions options = options_;
  options.solver = PoseSolver::kCeres;
  const auto ceres = FitTracksAndClouds(*tracks, *clouds, options);
  ASSERT_TRUE(banded && ceres);
  double furthest = 0.0;
  for (int f = 0; f < banded->motion.frame_count(); ++f) {
    for (int j = 0; j < banded->motion.joint_count(); ++j) {
      furthest = std::max(furthest, (banded->motion.joints.at(f, j) - ceres->motion.joints.at(f, j)).norm());
    }
  }
  EXPECT_LT(furthest, 0.005);
}

TEST_F(StudioClouds, WithTracksRefuseACloudOfAnotherPerson) {
  const auto& tracks = FitOfTracks(0);
  ASSERT_TRUE(tracks);
  auto clouds = FuseClip(clips_[0], options_);
  for (FusedCloud& cloud : *clouds) cloud.points.row(0).array() += 2.0;
  const auto both = FitTracksAndClouds(*tracks, *clouds, options_);
  ASSERT_FALSE(both);
  EXPECT_THAT(both.error().Message(), HasSubstr("of one person"));
  clouds->pop_back();
  EXPECT_THAT(FitTracksAndClouds(*tracks, *clouds, options_).error().Message(), HasSubstr("7 frames of depth images"));
}

TEST_F(StudioClouds, WithTracksFramesWithoutPointsKeepTheTracks) {
  const auto& tracks = FitOfTracks(0);
  ASSERT_TRUE(tracks);
  auto clouds = FuseClip(clips_[0], options_);
  (*clouds)[3] = {Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xd(3, 0), 0};
  const auto both = FitTracksAndClouds(*tracks, *clouds, options_);
  ASSERT_TRUE(both) << both.error().Message();
  EXPECT_LT((both->motion.joints.at(3, 20) - tracks->motion.joints.at(3, 20)).norm(), 1e-6);
  EXPECT_GT((both->motion.joints.at(4, 20) - tracks->motion.joints.at(4, 20)).norm(), 1e-6);
  const auto reported = std::find_if(both->findings.begin(), both->findings.end(),
                                     [](const Finding& finding) { return finding.code == "frames_without_depth"; });
  ASSERT_NE(reported, both->findings.end());
  EXPECT_EQ(reported->value, 1.0);
  EXPECT_EQ(reported->severity, Severity::kInfo) << "the tracks are evidence there";
  EXPECT_EQ(reported->action, FindingAction::kKept);
}

TEST_F(StudioClouds, WithTracksRefuseCloudsWithoutAnyPoints) {
  const auto& tracks = FitOfTracks(0);
  ASSERT_TRUE(tracks);
  const FusedCloud empty{Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xd(3, 0), 0};
  const std::vector<FusedCloud> clouds(static_cast<std::size_t>(tracks->motion.frame_count()), empty);
  const auto both = FitTracksAndClouds(*tracks, clouds, options_);
  ASSERT_FALSE(both);
  EXPECT_EQ(both.error().code, ErrorCode::kInconsistent);
  EXPECT_THAT(both.error().Message(), HasSubstr("no frame has 100 points of the person"));
}

TEST_F(StudioClouds, WithTracksEndJointsKeepTheRotationsOfTheTracks) {
  auto tracks = FitOfTracks(0);
  ASSERT_TRUE(tracks);
  const std::vector<bool> moving = CapsuleBody::Make(tracks->motion.skeleton, 1.0).MovingJoints();
  const auto end_joint = std::find(moving.begin(), moving.end(), false);
  ASSERT_NE(end_joint, moving.end());
  const auto end = static_cast<int>(end_joint - moving.begin());
  const int joints = tracks->motion.joint_count();
  const Quaterniond turned(Eigen::AngleAxisd(0.5, Vector3d::UnitX()));
  for (int f = 0; f < tracks->motion.frame_count(); ++f) tracks->motion.rotation[f * joints + end] = turned;
  const auto both = FitTracksAndClouds(*tracks, *FuseClip(clips_[0], options_), options_);
  ASSERT_TRUE(both) << both.error().Message();
  EXPECT_LT(both->motion.rotation_at(4, end).angularDistance(turned), 1e-6);
  EXPECT_EQ(both->motion.rotation_sigma[3 * (4 * joints + end)], tracks->motion.rotation_sigma[3 * (4 * joints + end)]);
}

TEST(TracksAndDepth, RefuseTimesHalfAStepApart) {
  const std::vector<double> tracks = {0.0, 0.1, 0.2, 0.3};
  EXPECT_TRUE(CheckOneClock(tracks, {0.04, 0.14, 0.24, 0.34}, 0.1, "clip"));
  const Status apart = CheckOneClock(tracks, {0.0, 0.1, 0.262, 0.3}, 0.1, "clip");
  ASSERT_FALSE(apart);
  EXPECT_EQ(apart.error().code, ErrorCode::kInconsistent);
  EXPECT_THAT(apart.error().Message(), HasSubstr("62 ms apart (frame 2)"));
}

}  // namespace
}  // namespace mocurate
