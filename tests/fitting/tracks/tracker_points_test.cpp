
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/motion/kinematics.h"
#include "fitting/evidence/motion_tracks.h"
#include "fitting/fit_outcome.h"
#include "ingest/synthetic/body_points.h"
#include "tests/fitting/studio_clips.h"

namespace mocurate {
namespace {

/// A person of smpl24's size, as OpenNI's tracker writes it.
class TrackerPointsTest : public testing::Test {
 protected:
  void SetUp() override {
    body_ = *LoadSkeleton("smpl24");
    StudioClipErrors none;
    none.tracker = TrackerOptions{};
    none.tracker.noise = none.tracker.dropout_share = none.tracker.outlier_share = 0.0;
    none.swapped_frames = 0.0;
    const std::vector<StudioClip> clips = StudioClips(5, 1, false, none);
    ASSERT_FALSE(clips.empty());
    const Motion& motion = clips.front().truth;
    std::vector<Vector3d> translation;
    for (int f = 0; f < motion.frame_count(); ++f) translation.emplace_back(motion.joints.at(f, 0));
    truth_ = MakeMotion(body_, motion.rate, translation, motion.rotation, body_->RestBoneLengths());
    JointTracks tracks;
    tracks.names = NamesOf(KardPlaces());
    tracks.positions = PlacesOf(truth_, KardPlaces());
    tracks.confidence.assign(tracks.positions.xyz.size() / 3, 1.0);
    for (int f = 0; f < truth_.frame_count(); ++f) tracks.time_s.push_back(truth_.rate.FrameTime(f));
    clip_.rate = truth_.rate;
    clip_.evidence.tracks = std::move(tracks);
    clip_.provenance[kSourceSkeleton] = "openni15";
  }

  FitResult Fit() const {
    FittingOptions options;
    options.other_joints = OtherJoints::kLeaveOut;
    options.joint_tracks.solver = PoseSolver::kBanded;
    const auto fit = FitTracksOfClip(clip_, WithTrackerPoints(body_, clip_), {}, options);
    EXPECT_TRUE(fit.has_value()) << fit.error().Message();
    return fit ? *fit : FitResult{};
  }

  /// Mean error and mean stated standard deviation of all joints of that name, metres.
  std::pair<double, double> ErrorAndSigma(const FitResult& fit, const std::string& name) const {
    const int joint = *body_->FindJoint(name);
    double error = 0.0, sigma = 0.0;
    for (int f = 0; f < truth_.frame_count(); ++f) {
      const float* c =
          fit.motion.position_cov.data() + 6 * (static_cast<std::size_t>(f) * 24 + static_cast<std::size_t>(joint));
      error += (fit.motion.joints.at(f, joint) - truth_.joints.at(f, joint)).norm();
      sigma += std::sqrt(c[0] + c[3] + c[5]);
    }
    return {error / truth_.frame_count(), sigma / truth_.frame_count()};
  }

  SkeletonPtr body_;
  Motion truth_;
  Clip clip_;
};

TEST_F(TrackerPointsTest, AreLandmarksOfTheBodyNotItsJoints) {
  const SkeletonPtr with = WithTrackerPoints(body_, clip_);
  EXPECT_EQ(with->joint_count(), 24 + 5);
  EXPECT_EQ(with->joints[*with->FindJoint("tracked_left_wrist")].mirror, *with->FindJoint("tracked_right_wrist"));
  EXPECT_EQ(WithoutTrackerPoints(with)->joint_count(), 24);
  EXPECT_TRUE(WithoutTrackerPoints(with)->Check().has_value());
  const auto tracks = TracksOfClip(clip_, with, OtherJoints::kRefuse);
  ASSERT_TRUE(tracks.has_value()) << tracks.error().Message();
  for (const char* unobserved : {"neck", "head", "left_wrist", "left_hand", "left_foot", "spine3"})
    EXPECT_FALSE(tracks->seen(0, *with->FindJoint(unobserved))) << unobserved;
  for (const char* observed :
       {"tracked_neck", "tracked_torso", "tracked_head", "left_ankle", "left_elbow", "right_hip"})
    EXPECT_TRUE(tracks->seen(0, *with->FindJoint(observed))) << observed;
  EXPECT_EQ(tracks->place_sigma[static_cast<std::size_t>(*with->FindJoint("tracked_neck"))], 0.03);
}

TEST_F(TrackerPointsTest, AreJointsOnATrackersSkeleton) {
  const SkeletonPtr own = *LoadSkeleton("openni16");
  EXPECT_EQ(WithTrackerPoints(own, clip_), own);
  const auto tracks = TracksOfClip(clip_, own, OtherJoints::kRefuse);
  ASSERT_TRUE(tracks.has_value()) << tracks.error().Message();
  EXPECT_TRUE(tracks->seen(0, *own->FindJoint("neck")));
  EXPECT_TRUE(tracks->place_sigma.empty());
}

TEST_F(TrackerPointsTest, PlaceJointsCorrectlyAndStateTheUncertainty) {
  const FitResult fit = Fit();
  ASSERT_EQ(fit.motion.joint_count(), 24);
  for (const char* name : {"neck", "head", "left_wrist", "right_wrist", "left_ankle", "spine3", "left_foot"}) {
    const auto [error, sigma] = ErrorAndSigma(fit, name);
    EXPECT_LT(error, std::string(name) == "left_foot" ? 0.1 : 0.04)
        << name;  // no point of the tracker observes the toes
    EXPECT_LT(error, 2.0 * sigma + 0.002) << name;
  }
  for (const char* name : {"neck", "head", "left_wrist"}) EXPECT_GT(ErrorAndSigma(fit, name).second, 0.01) << name;
  EXPECT_LT(ErrorAndSigma(fit, "left_knee").second, 0.02);
}

}  // namespace
}  // namespace mocurate
