#include "fitting/evidence/implausible_body.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/fitting/takes.h"

namespace mocurate {
namespace {

constexpr int kElbow = 4, kWrist = 5;

/// The arm from joint `shoulder` on bends and stretches.
void BendArm(int shoulder, PlayedTake& take) {
  for (int f = 0; f < 120; ++f) {
    const Vector3d elbow = take.truth.joints.at(f, shoulder + 1);
    const Vector3d upper = (elbow - Vector3d(take.truth.joints.at(f, shoulder))).normalized();
    const double bend = 1.0 + 0.9 * std::sin(f / 9.0);
    take.tracks.positions.at(f, shoulder + 2) =
        elbow + 0.25 * (std::cos(bend) * upper + std::sin(bend) * upper.unitOrthogonal());
  }
}

/// The left arm bends and stretches.
PlayedTake BendingTake(double sigma = 0.005) {
  PlayedTake take = SmoothTake(120);
  BendArm(kElbow - 1, take);
  AddNoise(take.tracks, sigma, 7);
  return take;
}

std::vector<std::string> Codes(const SkeletonTracks& tracks) {
  std::vector<std::string> codes;
  for (const Finding& finding : FindImplausibleBody(tracks)) codes.push_back(finding.code + " " + finding.joint);
  return codes;
}

TEST(ImplausibleBody, ASoundTakeHasNoFindingsHoweverManyJointsAreHidden) {
  PlayedTake take = BendingTake();
  EXPECT_TRUE(FindImplausibleBody(take.tracks).empty());
  for (int f = 0; f < 120; ++f) {
    Hide(take.tracks, f, kElbow);
    if (f % 3 == 0) Hide(take.tracks, f, 1);
  }
  EXPECT_TRUE(FindImplausibleBody(take.tracks).empty());
}

TEST(SuspectStature, IsAnErrorWhenImplausibleAndAWarningForAChild) {
  for (const double scale : {0.9, 1.0, 1.2}) EXPECT_FALSE(CheckStature(1.5 * scale, scale)) << scale;
  const auto child = CheckStature(1.05, 0.7);
  ASSERT_TRUE(child.has_value());
  EXPECT_EQ(child->severity, Severity::kWarning);
  EXPECT_THAT(child->message, testing::HasSubstr("fitting.point_clouds.height"));
  for (const double scale : {0.2, 2.0}) {
    const auto suspect = CheckStature(1.5 * scale, scale);
    ASSERT_TRUE(suspect.has_value()) << scale;
    EXPECT_EQ(suspect->code, "size_suspect");
    EXPECT_EQ(suspect->severity, Severity::kError);
  }
}

TEST(UnexplainedJoints, LieFarFromTheirTracksInMostFrames) {
  const PlayedTake take = BendingTake();
  JointPositions fitted = take.tracks.positions;
  EXPECT_TRUE(FindUnexplainedJoints(take.tracks, fitted).empty());
  for (int f = 0; f < 50; ++f) fitted.at(f, kElbow).y() += 0.4;
  EXPECT_TRUE(FindUnexplainedJoints(take.tracks, fitted).empty()) << "in less than half of the frames";
  for (int f = 50; f < 100; ++f) fitted.at(f, kElbow).y() += 0.4;
  const std::vector<Finding> findings = FindUnexplainedJoints(take.tracks, fitted);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "joint_unexplained");
  EXPECT_EQ(findings[0].joint, "left_elbow");
  EXPECT_NEAR(findings[0].value, 0.4, 1e-9);
}

TEST(UnexplainedJoints, ExcludeDistanceAlongNearlyParallelRays) {
  PlayedTake take = BendingTake();
  JointPositions fitted = take.tracks.positions;
  for (int f = 0; f < take.tracks.frames(); ++f) fitted.at(f, kElbow).y() += 0.4;
  const Matrix3d along_y = Vector3d(1.0, 0.01, 1.0).asDiagonal();
  take.tracks.precision.assign(take.tracks.confidence.size(), along_y);
  EXPECT_TRUE(FindUnexplainedJoints(take.tracks, fitted).empty());
}

TEST(JointsBeyondLimits, ExceedTheHumanRangeInMostFrames) {
  Motion motion = SmoothTake(100).truth;
  const SkeletonPtr smpl24 = *LoadSkeleton("smpl24");
  const std::vector<Quaterniond> rest(std::size_t{100} * 24, Quaterniond::Identity());
  motion =
      MakeMotion(smpl24, motion.rate, std::vector<Vector3d>(100, Vector3d::Zero()), rest, smpl24->RestBoneLengths());
  const auto collar = static_cast<std::size_t>(*smpl24->FindJoint("left_collar"));
  const double most = smpl24->joints[collar].limits->max.z();
  const auto turn = [&](std::size_t begin, std::size_t end, double angle) {
    for (std::size_t f = begin; f < end; ++f)
      motion.rotation[f * 24 + collar] = ExpQuaternion(Vector3d(0.0, 0.0, angle));
  };
  turn(0, 100, most);
  EXPECT_TRUE(FindJointsBeyondLimits(motion).empty()) << "within the range of people";
  turn(0, 40, most + 0.5);
  EXPECT_TRUE(FindJointsBeyondLimits(motion).empty()) << "in less than half of the frames";
  turn(40, 80, most + 0.5);
  const std::vector<Finding> findings = FindJointsBeyondLimits(motion);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "joint_beyond_limits");
  EXPECT_EQ(findings[0].joint, "left_collar");
  EXPECT_EQ(findings[0].severity, Severity::kWarning);
  EXPECT_NEAR(findings[0].value, 0.5 * 180.0 / M_PI, 0.1);

  motion.state.assign(motion.rotation.size(), JointState::kObserved);
  for (std::size_t f = 0; f < 80; ++f) motion.state[f * 24 + collar] = JointState::kInferred;
  EXPECT_TRUE(FindJointsBeyondLimits(motion).empty()) << "in less than half of the frames that observe it";
}

TEST(ImplausibleBody, DetectsExchangedElbowAndWrist) {
  PlayedTake take = BendingTake();
  for (int f = 0; f < 120; ++f) {
    const Vector3d elbow = take.tracks.positions.at(f, kElbow);
    take.tracks.positions.at(f, kElbow) = Vector3d(take.tracks.positions.at(f, kWrist));
    take.tracks.positions.at(f, kWrist) = elbow;
  }
  const std::vector<Finding> findings = FindImplausibleBody(take.tracks);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "joints_exchanged");
  EXPECT_EQ(findings[0].joint, "left_elbow");
  EXPECT_GT(findings[0].value, 0.1);
}

TEST(ImplausibleBody, DetectsExchangedElbowAndWristOnBothSides) {
  constexpr int kRightElbow = 7, kRightWrist = 8;
  PlayedTake take = BendingTake();
  BendArm(kRightElbow - 1, take);
  for (int f = 0; f < 120; ++f) {
    for (const auto& [from, to] : {std::pair(kElbow, kWrist), std::pair(kRightElbow, kRightWrist)}) {
      const Vector3d place = take.tracks.positions.at(f, from);
      take.tracks.positions.at(f, from) = Vector3d(take.tracks.positions.at(f, to));
      take.tracks.positions.at(f, to) = place;
    }
  }
  EXPECT_EQ(Codes(take.tracks), std::vector<std::string>{"joints_exchanged left_elbow"});
}

TEST(ImplausibleBody, DetectsAMisplacedJoint) {
  for (const int joint : {2, kElbow, kWrist}) {
    PlayedTake take = BendingTake();
    for (int f = 0; f < 120; ++f) take.tracks.positions.at(f, joint) += Vector3d(0.3, 0.0, 0.4);
    const std::vector<Finding> findings = FindImplausibleBody(take.tracks);
    ASSERT_EQ(findings.size(), 1u) << joint;
    EXPECT_EQ(findings[0].code, "joint_misplaced");
    EXPECT_EQ(findings[0].joint, take.tracks.skeleton->joints[static_cast<std::size_t>(joint)].name);
    EXPECT_GT(findings[0].value, 0.15);
  }
}

TEST(ImplausibleBody, DetectsTheWristThatIsTooNearTheElbow) {
  constexpr int kRightElbow = 7, kRightWrist = 8;
  for (const auto& [elbow, wrist] : {std::pair(kElbow, kWrist), std::pair(kRightElbow, kRightWrist)}) {
    PlayedTake take = BendingTake();
    for (int f = 0; f < 120; ++f) {
      const Vector3d from = take.tracks.positions.at(f, elbow);
      const Vector3d forearm = Vector3d(take.tracks.positions.at(f, wrist)) - from;
      take.tracks.positions.at(f, wrist) = from + 0.15 * forearm;
    }
    const std::string name = take.tracks.skeleton->joints[static_cast<std::size_t>(wrist)].name;
    EXPECT_EQ(Codes(take.tracks), std::vector<std::string>{"joint_misplaced " + name});
  }
}

TEST(ImplausibleBody, DetectsABodyThatGrows) {
  for (const double growth : {0.1, -0.1}) {
    PlayedTake take = BendingTake(0.003);
    for (int f = 0; f < 120; ++f) {
      for (int j = 0; j < 14; ++j) take.tracks.positions.at(f, j) *= 1.0 + growth * f / 119.0;
    }
    const std::vector<Finding> findings = FindImplausibleBody(take.tracks);
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].code, "body_grows");
    EXPECT_NEAR(findings[0].value, 80.0 * growth, 2.0);
  }
}

TEST(ImplausibleBody, DetectsAnImplausibleSize) {
  for (const double scale : {1.7, 0.2}) {
    PlayedTake take = BendingTake();
    for (double& value : take.tracks.positions.xyz) value *= scale;
    EXPECT_EQ(Codes(take.tracks), std::vector<std::string>{"size_suspect "}) << scale;
  }
}

}  // namespace
}  // namespace mocurate
