#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/clouds/person_points.h"
#include "tests/fitting/back_project.h"
#include "tests/fitting/cloud_scene.h"
#include "tests/support/depth_files.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

std::filesystem::path CloudsFolder(const std::string& name) { return SharedScratch("clouds_" + name); }

/// A person who stands, lowers the arms and bends the knees a little from frame to frame.
Motion Standing(const SkeletonPtr& skeleton, int frames, double heading = 0.0) {
  const int joints = skeleton->joint_count();
  std::vector<Vector3d> translation;
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(frames) * joints, Quaterniond::Identity());
  for (int f = 0; f < frames; ++f) {
    translation.emplace_back(0.1 + 0.01 * f, 0.05, -0.05);
    const auto turn = [&](const char* name, const Vector3d& by) {
      rotation[static_cast<std::size_t>(f) * joints + *skeleton->FindJoint(name)] = ExpQuaternion(by);
    };
    rotation[static_cast<std::size_t>(f) * joints] = ExpQuaternion({0.0, heading, 0.0});
    turn("plain_left_shoulder", {0.0, 0.0, -0.9 + 0.05 * f});
    turn("plain_right_shoulder", {0.0, 0.0, 0.7 - 0.1 * f});
    turn("plain_right_elbow", {0.0, 0.4, 0.0});
    turn("plain_left_knee", {0.3 + 0.05 * f, 0.0, 0.0});
  }
  return MakeMotion(skeleton, FrameRate{12, 1}, translation, rotation, skeleton->RestBoneLengths());
}

TEST(CloudFit, RecoversACapsulePersonInThreeViews) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  const Motion truth = Standing(skeleton, 3);
  const auto clip = RenderClip(truth, CloudsFolder("person"));
  ASSERT_TRUE(clip) << clip.error().Message();
  const auto fit = FitClouds(*clip, skeleton, {}, PointCloudOptions());
  ASSERT_TRUE(fit) << fit.error().Message();
  const Status whole = fit->motion.Check();
  EXPECT_TRUE(whole) << whole.error().Message();
  const double error = MeanJointError(fit->motion.joints, truth.joints);
  RecordProperty("mean_joint_error_mm", std::to_string(1000.0 * error));
  EXPECT_LT(error, 0.015);
  EXPECT_LT(fit->residual_rms, 0.01);
  EXPECT_GT(fit->iterations, 0);
  ASSERT_EQ(fit->motion.state.size(), 3u * skeleton->joints.size());
  EXPECT_EQ(fit->motion.state[*skeleton->FindJoint("plain_left_knee")], JointState::kObserved);
}

/// Below a camera's pixels, smaller voxels are empty: they are no more evidence.
TEST(CloudFit, StatesTheSameForSmallerVoxels) {
  const SkeletonPtr skeleton = PlainSkeleton();
  const auto clip = RenderClip(Standing(skeleton, 1), CloudsFolder("voxels"));
  ASSERT_TRUE(clip) << clip.error().Message();
  std::vector<double> sigma;
  for (const double voxel : {0.03, 0.015, 0.005, 0.002}) {
    PointCloudOptions options;
    options.voxel_size = voxel;
    options.rules.SwitchOff(FittingRule::kBodyErrors);  // they do not depend on the points' number
    options.rules.SwitchOff(FittingRule::kLowCoverage);
    const auto fit = FitClouds(*clip, skeleton, skeleton->RestBoneLengths(), options);
    ASSERT_TRUE(fit) << fit.error().Message();
    double sum = 0.0;
    for (std::size_t at = 0; at < skeleton->joints.size(); ++at)
      sum += FromSixNumbers(fit->motion.position_cov.data() + 6 * at).trace();
    sigma.push_back(std::sqrt(sum));
  }
  for (const double of_voxel : sigma) EXPECT_NEAR(of_voxel, sigma[0], 0.25 * sigma[0]);
}

TEST(CloudFit, NamesTheSigmaThatItSolvedWith) {
  const SkeletonPtr skeleton = PlainSkeleton();
  const Motion truth = Standing(skeleton, 1);
  const auto clip = RenderClip(truth, CloudsFolder("solved_sigma"));
  ASSERT_TRUE(clip) << clip.error().Message();
  const auto clouds = FuseClip(*clip, {});
  ASSERT_TRUE(clouds) << clouds.error().Message();
  const CapsuleBody body = CapsuleBody::Make(skeleton, 1.0);
  PoseState state(*skeleton, 1, skeleton->RestBoneLengths(), body.MovingJoints());
  Eigen::Map<Vector3d>(state.translation(0)) = truth.joints.at(0, 0);
  FrameFit fit = ComparedFit(0, 20);
  fit.sigma = 0.02;
  const auto fitted = FitCloudFrame(body, clouds->front(), fit, state, {});
  ASSERT_TRUE(fitted) << fitted.error().Message();
  EXPECT_EQ(fitted->sigma, 0.02);
  EXPECT_LT(fitted->residual, 0.015);
}

TEST(CloudFit, FindsAPersonWhoFacesAwayFromTheFirstCamera) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  const Motion truth = Standing(skeleton, 1, 2.5);
  const auto clip = RenderClip(truth, CloudsFolder("away"));
  ASSERT_TRUE(clip) << clip.error().Message();
  const auto fit = FitClouds(*clip, skeleton, {}, PointCloudOptions());
  ASSERT_TRUE(fit) << fit.error().Message();
  EXPECT_TRUE(fit->converged);
  EXPECT_LT(MeanJointError(fit->motion.joints, truth.joints), 0.02);
}

/// The solver of the same costs that is several times faster than Ceres.
PointCloudOptions QuickOptions() {
  PointCloudOptions options;
  options.solver = PoseSolver::kBanded;
  return options;
}

/// Error of the second of two frames; an arm moved far between them, `seconds` apart.
double ErrorAfter(double seconds, const SkeletonPtr& skeleton) {
  Motion truth = Standing(skeleton, 2);
  const int arm = *skeleton->FindJoint("plain_left_shoulder");
  truth.rotation_at(1, arm) = ExpQuaternion({0.0, 0.0, 0.2});
  truth = MakeMotion(skeleton, truth.rate, truth.root_translation, truth.rotation, truth.bone_length);
  auto clip = RenderClip(truth, CloudsFolder("later"));
  if (!clip) return -1.0;
  for (DepthView& view : clip->evidence.depth_views) view.time_s = {0.0, seconds};
  const auto fit = FitClouds(*clip, skeleton, {}, QuickOptions());
  const int hand = *skeleton->FindJoint("plain_left_hand");
  return fit ? (fit->motion.joints.at(1, hand) - truth.joints.at(1, hand)).norm() : -1.0;
}

TEST(CloudFit, AnOlderPreviousFrameConstrainsLess) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  const double at_once = ErrorAfter(1e-4, skeleton);
  const double later = ErrorAfter(1.0, skeleton);
  EXPECT_GT(later, 0.0);
  EXPECT_GT(at_once, 2.0 * later);
}

/// Arms that hung and are overhead a second later are closer to other body parts than to their old position.
TEST(CloudFit, FindsArmsAnywhereAfterAGap) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  Motion truth = Standing(skeleton, 2);
  truth.rotation_at(0, *skeleton->FindJoint("plain_left_shoulder")) = ExpQuaternion({0.0, 0.0, -1.4});
  truth.rotation_at(0, *skeleton->FindJoint("plain_right_shoulder")) = ExpQuaternion({0.0, 0.0, 1.4});
  truth.rotation_at(1, *skeleton->FindJoint("plain_left_shoulder")) = ExpQuaternion({0.0, 0.0, 1.3});
  truth.rotation_at(1, *skeleton->FindJoint("plain_right_shoulder")) = ExpQuaternion({0.0, 0.0, -1.3});
  truth = MakeMotion(skeleton, truth.rate, truth.root_translation, truth.rotation, truth.bone_length);
  auto clip = RenderClip(truth, CloudsFolder("overhead"));
  ASSERT_TRUE(clip) << clip.error().Message();
  for (DepthView& view : clip->evidence.depth_views) view.time_s = {0.0, 1.0};
  const auto fit = FitClouds(*clip, skeleton, {}, QuickOptions());
  ASSERT_TRUE(fit) << fit.error().Message();
  for (const char* hand : {"plain_left_hand", "plain_right_hand"}) {
    const int joint = *skeleton->FindJoint(hand);
    EXPECT_LT((fit->motion.joints.at(1, joint) - truth.joints.at(1, joint)).norm(), 0.06) << hand;
  }
}

/// Points every `step` metres of an upright box or a level square, normals up.
FusedCloud CloudOf(const std::vector<Vector3d>& points) {
  FusedCloud cloud{Eigen::Matrix3Xd(3, points.size()), Eigen::Matrix3Xd(3, points.size()), 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    cloud.points.col(static_cast<Eigen::Index>(i)) = points[i];
    cloud.normals.col(static_cast<Eigen::Index>(i)) = Vector3d::UnitY();
  }
  return cloud;
}

std::vector<Vector3d> Column(const Vector3d& foot, double height) {
  std::vector<Vector3d> points;
  for (double y = 0.0; y < height; y += 0.015) {
    for (double x = 0.0; x < 0.3; x += 0.015) points.push_back(foot + Vector3d(x, y, 0.0));
  }
  return points;
}

TEST(PersonPoints, KeepsThePersonAndDropsFloorAndSeparateObjects) {
  std::vector<Vector3d> points = Column({0.0, 0.05, 0.0}, 1.7);
  const int person = static_cast<int>(points.size());
  for (double x = -1.0; x < 1.0; x += 0.015) {
    for (double z = -1.0; z < 1.0; z += 0.015) points.emplace_back(x, 0.0, z);
  }
  const std::vector<Vector3d> chair = Column({0.8, 0.05, 0.3}, 0.5);
  points.insert(points.end(), chair.begin(), chair.end());
  const FusedCloud kept = PersonPoints(CloudOf(points), 0.015);
  EXPECT_EQ(kept.size(), person);
  EXPECT_EQ(kept.excluded, static_cast<int>(points.size()) - person);
  EXPECT_LT(kept.points.row(0).maxCoeff(), 0.31);
}

TEST(PersonPoints, KeepsAPartThatOcclusionCutsOff) {
  std::vector<Vector3d> points = Column({0.0, 0.0, 0.0}, 1.0);
  const std::vector<Vector3d> head = Column({0.0, 1.12, 0.0}, 0.3);
  points.insert(points.end(), head.begin(), head.end());
  EXPECT_EQ(PersonPoints(CloudOf(points), 0.015).size(), static_cast<int>(points.size()));
}

TEST(CloudFit, FramesWithoutPointsKeepTheirNeighboursPoseAndAreReported) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  const auto clip = RenderClip(Standing(skeleton, 3), CloudsFolder("gap"));
  ASSERT_TRUE(clip) << clip.error().Message();
  for (const DepthView& view : clip->evidence.depth_views) {
    DepthImage nothing{view.camera.width, view.camera.height, {}};
    nothing.values.resize(static_cast<std::size_t>(nothing.width) * nothing.height, 0);
    ASSERT_TRUE(WriteDepthImage(nothing, view.files[2]));
  }
  const auto fit = FitClouds(*clip, skeleton, {}, PointCloudOptions());
  ASSERT_TRUE(fit) << fit.error().Message();
  ASSERT_EQ(fit->findings.size(), 2u);
  EXPECT_EQ(fit->findings[0].code, "rig_not_audited");
  EXPECT_EQ(fit->findings[0].severity, Severity::kWarning) << "a frame without evidence is a warning, not an info";
  EXPECT_EQ(fit->findings[1].code, "frames_without_evidence");
  EXPECT_EQ(fit->findings[1].frame_begin, 2);
  EXPECT_EQ(fit->findings[1].frame_end, 3);
  EXPECT_EQ(fit->motion.joints.at(2, 5), fit->motion.joints.at(1, 5));
  EXPECT_EQ(fit->motion.state.back(), JointState::kInferred);
}

TEST(CloudFit, AnkleThatNoViewShowsIsInferredAndLessCertain) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  const Motion truth = Standing(skeleton, 1);
  const auto clip = RenderClip(truth, CloudsFolder("ankle"));
  ASSERT_TRUE(clip) << clip.error().Message();
  PointCloudOptions options;
  auto clouds = FuseClip(*clip, options);
  ASSERT_TRUE(clouds) << clouds.error().Message();
  const int ankle = *skeleton->FindJoint("plain_left_ankle");
  const int other = *skeleton->FindJoint("plain_right_ankle");
  const FusedCloud whole = (*clouds)[0];
  FusedCloud& cloud = (*clouds)[0];
  int kept = 0;
  for (int i = 0; i < whole.size(); ++i) {
    if ((whole.points.col(i) - truth.joints.at(0, ankle)).norm() < 0.2) continue;
    cloud.points.col(kept) = whole.points.col(i);
    cloud.normals.col(kept++) = whole.normals.col(i);
  }
  cloud.points.conservativeResize(3, kept);
  cloud.normals.conservativeResize(3, kept);
  const auto fit = FitFusedClouds(*clouds, {truth.rate, {0.0}}, skeleton, {}, options);
  ASSERT_TRUE(fit) << fit.error().Message();
  EXPECT_EQ(fit->motion.state[ankle], JointState::kInferred)
      << "points at the knee's end of the shin do not observe the ankle";
  EXPECT_EQ(fit->motion.state[other], JointState::kObserved);
  EXPECT_EQ(fit->motion.state[*skeleton->FindJoint("plain_left_knee")], JointState::kObserved);
  const auto variance = [&](int joint) {
    const float* c = fit->motion.position_cov.data() + 6 * joint;
    return c[0] + c[3] + c[5];
  };
  EXPECT_GT(variance(ankle), 1.6 * variance(other));
}

TEST(CloudFit, IgnoresPointsFarBehindThePerson) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  const auto clip = RenderClip(Standing(skeleton, 1), CloudsFolder("junk"));
  ASSERT_TRUE(clip) << clip.error().Message();
  const auto clean = FitClouds(*clip, skeleton, {}, QuickOptions());
  int measured = 0, junk = 0;
  for (const DepthView& view : clip->evidence.depth_views) {
    auto image = ReadDepthImage(view.files[0]);
    ASSERT_TRUE(image);
    for (std::size_t i = 0; i < image->values.size(); ++i) {
      if (image->values[i] == 0 || ++measured % 50 != 0) continue;
      image->values[i] = 60000;
      ++junk;
    }
    ASSERT_TRUE(WriteDepthImage(*image, view.files[0]));
  }
  ASSERT_GT(junk, 100);
  const auto fit = FitClouds(*clip, skeleton, {}, QuickOptions());
  ASSERT_TRUE(clean && fit);
  EXPECT_LT(MeanJointError(fit->motion.joints, clean->motion.joints), 0.003);
}

TEST(CloudFit, BodyOfAnotherSizeIsSuspectWithAValue) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  const auto clip = RenderClip(Standing(skeleton, 1), CloudsFolder("other_size"));
  ASSERT_TRUE(clip) << clip.error().Message();
  std::vector<double> bones = skeleton->RestBoneLengths();
  for (double& bone : bones) bone *= 0.5;
  const auto fit = FitClouds(*clip, skeleton, bones, PointCloudOptions());
  ASSERT_TRUE(fit) << fit.error().Message();
  const auto far = std::find_if(fit->findings.begin(), fit->findings.end(),
                                [](const Finding& finding) { return finding.code == "points_off_the_body"; });
  ASSERT_NE(far, fit->findings.end());
  EXPECT_GT(far->value, 0.1);
}

TEST(CloudFit, RefusesImagesWithoutAPerson) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  const auto clip = RenderClip(Standing(skeleton, 2), CloudsFolder("no_person"));
  ASSERT_TRUE(clip) << clip.error().Message();
  for (const DepthView& view : clip->evidence.depth_views) {
    DepthImage nothing{view.camera.width, view.camera.height, {}};
    nothing.values.resize(static_cast<std::size_t>(nothing.width) * nothing.height, 0);
    for (const auto& file : view.files) ASSERT_TRUE(WriteDepthImage(nothing, file));
  }
  const auto fit = FitClouds(*clip, skeleton, {}, PointCloudOptions());
  ASSERT_FALSE(fit);
  EXPECT_THAT(fit.error().Message(), HasSubstr("no frame has 100 points"));
}

class Fusion : public ::testing::Test {
 protected:
  void SetUp() override {
    const SkeletonPtr skeleton = PlainSkeleton();
    ASSERT_NE(skeleton, nullptr);
    truth_ = Standing(skeleton, 1);
    auto clip = RenderClip(truth_, CloudsFolder("fusion"));
    ASSERT_TRUE(clip) << clip.error().Message();
    views_ = clip->evidence.depth_views;
  }

  Motion truth_;
  std::vector<DepthView> views_;
};

TEST_F(Fusion, PlacesPointsOnTheSurfaceWithOutwardNormals) {
  const auto cloud = FuseViews(views_, 0, PointCloudOptions().voxel_size);
  ASSERT_TRUE(cloud) << cloud.error().Message();
  ASSERT_GT(cloud->size(), 1000);
  const BoneCapsules body = BoneCapsules::Make(truth_.skeleton);
  std::vector<Vector3d> joints;
  for (int j = 0; j < truth_.joint_count(); ++j) joints.emplace_back(truth_.joints.at(0, j));
  double square = 0.0;
  int outward = 0;
  for (int i = 0; i < cloud->size(); ++i) {
    const auto nearest = ClosestOnBody(body, joints.data(), cloud->points.col(i));
    square += nearest->on_capsule.distance * nearest->on_capsule.distance;
    EXPECT_NEAR(cloud->normals.col(i).norm(), 1.0, 1e-6);
    if (nearest->on_capsule.normal.dot(cloud->normals.col(i)) > 0.5) ++outward;
  }
  EXPECT_LT(std::sqrt(square / cloud->size()), 0.002);
  EXPECT_GT(outward, 0.95 * cloud->size());
}

TEST_F(Fusion, ReturnsTheSamePointsInTheSameOrderEveryTime) {
  const auto once = FuseViews(views_, 0, PointCloudOptions().voxel_size);
  const auto again = FuseViews(views_, 0, PointCloudOptions().voxel_size);
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->points, again->points);
  EXPECT_EQ(once->normals, again->normals);
  for (int i = 1; i < once->size(); ++i) EXPECT_LE(once->points(0, i - 1), once->points(0, i));
}

TEST_F(Fusion, NamesAMissingImage) {
  views_[1].files[0] = CloudsFolder("fusion") / "c1_99.png";
  const auto cloud = FuseViews(views_, 0, PointCloudOptions().voxel_size);
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(cloud.error().Message(), HasSubstr("c1_99.png"));
}

TEST_F(Fusion, NamesAnImageOfAnotherSizeWithBothSizes) {
  views_[2].camera.width = 640;
  const auto cloud = FuseViews(views_, 0, PointCloudOptions().voxel_size);
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().code, ErrorCode::kInconsistent);
  EXPECT_THAT(cloud.error().Message(), HasSubstr("c2_0.png"));
  EXPECT_THAT(cloud.error().Message(), HasSubstr("320 x 300 pixels, camera 'c2' has 640 x 300"));
}

TEST_F(Fusion, NamesADamagedImageAndPrintsNothing) {
  views_[0].files[0] = CloudsFolder("fusion") / "damaged.png";
  std::ofstream(views_[0].files[0]) << "not an image";
  ::testing::internal::CaptureStdout();
  const auto cloud = FuseViews(views_, 0, PointCloudOptions().voxel_size);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().code, ErrorCode::kMalformed);
  EXPECT_THAT(cloud.error().Message(), HasSubstr("damaged.png"));
}

TEST_F(Fusion, RefusesAnImageThatChangedSinceIngest) {
  views_[0].sha256 = {std::string(64, '0')};
  const auto cloud = FuseViews(views_, 0, PointCloudOptions().voxel_size);
  ASSERT_FALSE(cloud);
  EXPECT_THAT(cloud.error().Message(), HasSubstr("has changed since it was ingested"));
}

TEST(CloudFit, RefusesAClipWithoutOrWithUnequalViews) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  Clip clip;
  EXPECT_EQ(FitClouds(clip, skeleton, {}, PointCloudOptions()).error().code, ErrorCode::kInconsistent);
  clip.evidence.depth_views.resize(2);
  clip.evidence.depth_views[0].files = {"a.png", "b.png"};
  clip.evidence.depth_views[0].time_s = {0.0, 0.1};
  clip.evidence.depth_views[1].files = {"c.png"};
  const auto fit = FitClouds(clip, skeleton, {}, PointCloudOptions());
  EXPECT_THAT(fit.error().Message(), HasSubstr("has 1 depth images"));
}

TEST(CloudFit, RefusesTimesThatDoNotIncreaseNamingTheFrame) {
  const SkeletonPtr skeleton = PlainSkeleton();
  ASSERT_NE(skeleton, nullptr);
  Clip clip;
  clip.evidence.depth_views.resize(1);
  clip.evidence.depth_views[0].files = {"a.png", "b.png", "c.png"};
  clip.evidence.depth_views[0].time_s = {0.0, 0.1, 0.1};
  const auto fit = FitClouds(clip, skeleton, {}, PointCloudOptions());
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().code, ErrorCode::kInconsistent);
  EXPECT_THAT(fit.error().Message(), HasSubstr("frame 2 of view"));
}

class RenderedSequenceFit : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("MOCURATE_DATA");
    if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
    auto read = ReadRenderedSequence(std::filesystem::path(data) / "clouds" / "rendered_seq", 10);
    ASSERT_TRUE(read) << read.error().Message();
    sequence_ = std::move(*read);
    auto skeleton = LoadSkeleton("smpl24");
    ASSERT_TRUE(skeleton) << skeleton.error().Message();
    skeleton_ = *skeleton;
  }

  RenderedSequence sequence_;
  SkeletonPtr skeleton_;
};

TEST_F(RenderedSequenceFit, ViewsOfOnePersonAgreeWhereTheyOverlap) {
  const auto first = BackProject(sequence_.clip.evidence.depth_views[0], 0);
  const auto second = BackProject(sequence_.clip.evidence.depth_views[1], 0);
  ASSERT_TRUE(first && second);
  std::vector<double> nearest;
  for (Eigen::Index i = 0; i < first->cols(); i += 50) {
    nearest.push_back(std::sqrt((second->colwise() - first->col(i)).colwise().squaredNorm().minCoeff()));
  }
  std::sort(nearest.begin(), nearest.end());
  EXPECT_LT(nearest[nearest.size() / 4], 0.005);
}

TEST_F(RenderedSequenceFit, JointsLieNearTheTruthWithBonesFromTheClouds) {
  PointCloudOptions options;
  options.solver = PoseSolver::kBanded;
  const auto bones = MeasureBodyInClouds({sequence_.clip}, skeleton_, options);
  ASSERT_TRUE(bones) << bones.error().Message();
  const auto fit = FitClouds(sequence_.clip, bones->skeleton, bones->bone_length, options);
  ASSERT_TRUE(fit) << fit.error().Message();
  const double error = MeanJointError(fit->motion.joints, sequence_.truth);
  RecordProperty("mean_joint_error_mm", std::to_string(1000.0 * error));
  EXPECT_LT(error, 0.016);
  EXPECT_LT(fit->residual_rms, 0.012);
}

}  // namespace
}  // namespace mocurate
