// Markers on the skin of a person whose bones and marker places are unknown.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "fitting/evidence/motion_tracks.h"
#include "fitting/fit_outcome.h"
#include "fitting/solver/marker_body.h"
#include "tests/fitting/studio_clips.h"

namespace mocurate {
namespace {

/// Where a set says that markers are, for a person of the skeleton's size.
const std::vector<PointPlace>& Markers() {
  static const std::vector<PointPlace> markers = [] {
    std::vector<PointPlace> both = {
        {"ASI", "pelvis", {0.12, 0.066, 0.055}, 0.015},     {"PSI", "pelvis", {0.045, 0.07, -0.115}, 0.015},
        {"THI", "left_hip", {0.085, -0.2, 0.01}, 0.03},     {"KNE", "left_knee", {0.055, 0.0, 0.0}, 0.012},
        {"TIB", "left_knee", {0.06, -0.18, 0.01}, 0.03},    {"ANK", "left_ankle", {0.042, 0.0, 0.0}, 0.012},
        {"HEE", "left_ankle", {0.0, -0.045, -0.06}, 0.015}, {"TOE", "left_ankle", {0.005, -0.03, 0.125}, 0.015},
        {"SHO", "left_collar", {0.135, 0.04, 0.0}, 0.02},   {"ELB", "left_elbow", {0.0, 0.042, 0.0}, 0.012},
        {"WRA", "left_wrist", {0.0, 0.01, 0.035}, 0.012},   {"WRB", "left_wrist", {0.0, 0.01, -0.035}, 0.012},
        {"FHD", "head", {0.075, 0.09, 0.09}, 0.02}};
    std::vector<PointPlace> all = {{"C7", "spine3", {0.0, 0.29, -0.055}, 0.02},
                                   {"T10", "spine3", {0.0, 0.05, -0.115}, 0.02},
                                   {"STRN", "spine3", {0.0, 0.09, 0.115}, 0.02}};
    for (const PointPlace& left : both) {
      PointPlace one = left;
      one.point = "L" + left.point;
      all.push_back(one);
      one.point = "R" + left.point;
      one.offset.x() *= -1.0;
      if (const std::size_t side = one.joint.find("left"); side == 0) one.joint = "right" + one.joint.substr(4);
      all.push_back(one);
    }
    return all;
  }();
  return markers;
}

class WornMarkers : public ::testing::Test {
 protected:
  void SetUp() override {
    body_ = *LoadSkeleton("smpl24");
    const std::vector<StudioClip> clips = StudioClips(5, 1, false, StudioClipErrors());
    ASSERT_FALSE(clips.empty());
    const Motion& motion = clips.front().truth;
    Random random(81, "worn markers", "person");
    std::vector<double> lengths = body_->RestBoneLengths();
    for (int j = 1; j < body_->joint_count(); ++j) {
      const int mirror = body_->joints[static_cast<std::size_t>(j)].mirror;
      lengths[static_cast<std::size_t>(j)] =
          mirror < j ? lengths[static_cast<std::size_t>(mirror)]
                     : lengths[static_cast<std::size_t>(j)] * 1.07 * (1.0 + 0.03 * random.Normal());
    }
    std::vector<Vector3d> translation;
    for (int f = 0; f < motion.frame_count(); ++f) translation.emplace_back(motion.joints.at(f, 0));
    truth_ = MakeMotion(body_, motion.rate, translation, motion.rotation, lengths);
    nlohmann::json json = nlohmann::json::array();
    for (const PointPlace& marker : Markers()) {
      places_.push_back(1.07 * marker.offset +
                        marker.spread * Vector3d(random.Normal(), random.Normal(), random.Normal()));
      json.push_back({{"point", marker.point},
                      {"joint", marker.joint},
                      {"offset", {marker.offset.x(), marker.offset.y(), marker.offset.z()}},
                      {"spread", marker.spread}});
    }
    JointTracks tracks;
    const int markers = static_cast<int>(Markers().size());
    tracks.positions = JointPositions(truth_.frame_count(), markers);
    tracks.confidence.assign(tracks.positions.xyz.size() / 3, 1.0);
    std::vector<Vector3d> joints(body_->joints.size());
    std::vector<Quaterniond> turns(body_->joints.size());
    for (const PointPlace& marker : Markers()) tracks.names.push_back(marker.point);
    for (int f = 0; f < truth_.frame_count(); ++f) {
      tracks.time_s.push_back(truth_.rate.FrameTime(f));
      ForwardKinematics(*body_, truth_.root_translation[static_cast<std::size_t>(f)], &truth_.rotation_at(f, 0),
                        lengths, joints.data(), turns.data());
      for (int m = 0; m < markers; ++m) {
        const auto joint = static_cast<std::size_t>(*body_->FindJoint(Markers()[static_cast<std::size_t>(m)].joint));
        const Vector3d noise(random.Normal(), random.Normal(), random.Normal());
        tracks.positions.at(f, m) = joints[joint] + turns[joint] * places_[static_cast<std::size_t>(m)] + 1e-3 * noise;
      }
    }
    clip_.rate = truth_.rate;
    clip_.evidence.tracks = std::move(tracks);
    clip_.provenance[kMarkers] = json.dump();
  }

  /// Mean distance of the joints from the truth, metres.
  double ErrorOf(const Motion& motion) const {
    double error = 0.0;
    for (int f = 0; f < truth_.frame_count(); ++f) {
      for (int j = 0; j < body_->joint_count(); ++j) error += (motion.joints.at(f, j) - truth_.joints.at(f, j)).norm();
    }
    return error / truth_.frame_count() / body_->joint_count();
  }

  SkeletonPtr body_;
  Motion truth_;
  std::vector<Vector3d> places_;  ///< of this person's markers
  Clip clip_;
};

TEST_F(WornMarkers, BonesPlacesAndPosesAreLearntTogether) {
  const SkeletonPtr marked = WithTrackerPoints(body_, clip_);
  ASSERT_EQ(marked->joint_count(), body_->joint_count() + static_cast<int>(Markers().size()));
  const auto tracks = TracksOfClip(clip_, marked, OtherJoints::kRefuse);
  ASSERT_TRUE(tracks) << tracks.error().Message();
  const auto learnt = LearnMarkerBody({*tracks}, JointTrackOptions());
  ASSERT_TRUE(learnt) << learnt.error().Message();
  EXPECT_NEAR(learnt->scale, 1.07, 0.05);
  double chi_square = 0.0;
  for (std::size_t m = 0; m < places_.size(); ++m) {
    const auto joint = static_cast<std::size_t>(*marked->FindJoint(TrackedName(Markers()[m].point)));
    const double sigma = learnt->place_sigma[joint];
    EXPECT_LT(sigma, Markers()[m].spread) << "motion tells something of " << Markers()[m].point;
    chi_square += (learnt->skeleton->joints[joint].rest_offset - places_[m]).squaredNorm() / (3.0 * sigma * sigma);
  }
  chi_square /= static_cast<double>(places_.size());
  EXPECT_GT(chi_square, 0.2);
  EXPECT_LT(chi_square, 2.5) << "places are as uncertain as stated";
  const auto fit = FitTracksOfClip(clip_, learnt->skeleton, learnt->bone_length, FittingOptions(), learnt->place_sigma);
  ASSERT_TRUE(fit) << fit.error().Message();
  EXPECT_EQ(fit->motion.joint_count(), body_->joint_count());
  EXPECT_LT(fit->residual_rms, 0.004);
  const auto nominal = FitTracksOfClip(clip_, marked, {}, FittingOptions());
  ASSERT_TRUE(nominal) << nominal.error().Message();
  EXPECT_LT(ErrorOf(fit->motion), 0.03);
  EXPECT_LT(ErrorOf(fit->motion), 0.6 * ErrorOf(nominal->motion)) << "of places and bones of the set";
  for (const char* name : {"left_knee", "spine2", "right_wrist"}) {  // a marker moves with it, or above and below it
    EXPECT_EQ(fit->motion.state[static_cast<std::size_t>(*body_->FindJoint(name))], JointState::kObserved) << name;
  }
}

TEST_F(WornMarkers, AJointThatTheSkeletonLacksIsNamed) {
  nlohmann::json json = nlohmann::json::parse(clip_.provenance[kMarkers]);
  json[0]["joint"] = "spine9";
  clip_.provenance[kMarkers] = json.dump();
  const auto tracks = TracksOfClip(clip_, WithTrackerPoints(body_, clip_), OtherJoints::kRefuse);
  ASSERT_FALSE(tracks);
  EXPECT_EQ(tracks.error().code, ErrorCode::kInconsistent);
  EXPECT_NE(tracks.error().what.find("C7 (spine9)"), std::string::npos);
}

}  // namespace
}  // namespace mocurate
