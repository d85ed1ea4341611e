#include "fitting/contacts/foot_contacts.h"

#include <gtest/gtest.h>

#include "core/geometry/rotation.h"
#include "core/motion/kinematics.h"
#include "core/motion/skeleton.h"

namespace mocurate {
namespace {

SkeletonPtr WalkingSkeleton() {
  auto skeleton = LoadSkeleton("smpl24");
  EXPECT_TRUE(skeleton.has_value());
  return *skeleton;
}

/// Two seconds of a person who sways by `sway` metres with bent knees; the feet slide with the pelvis.
Motion Swaying(double sway, int frames = 60) {
  const SkeletonPtr skeleton = WalkingSkeleton();
  std::vector<Vector3d> translation;
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) {
    translation.emplace_back(sway * std::sin(0.2 * f), 0.9, 0.0);
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      const std::string& name = skeleton->joints[j].name;
      const bool hip = name == "left_hip" || name == "right_hip", knee = name == "left_knee" || name == "right_knee";
      rotation.push_back(ExpQuaternion(Vector3d(hip ? -0.5 : knee ? 1.0 : 0.0, 0.0, 0.0)));
    }
  }
  return MakeMotion(skeleton, FrameRate{30, 1}, translation, rotation, skeleton->RestBoneLengths());
}

TEST(FootContacts, StanceFootStopsSliding) {
  Motion motion = Swaying(0.06);
  const Motion before = motion;
  const auto removed = RemoveFootSliding(ContactOptions(), motion);
  ASSERT_TRUE(removed.has_value()) << removed.error().Message();
  EXPECT_GT(removed->sliding_before, 0.15);
  EXPECT_LT(removed->sliding_after, 1e-6);
  EXPECT_EQ(removed->contact_share, 1.0);
  EXPECT_EQ(removed->unreachable, 0);
  ASSERT_TRUE(motion.Check().has_value()) << motion.Check().error().Message();
  EXPECT_EQ(motion.contact, std::vector<std::uint8_t>(120, 1));
  const int ankle = *motion.skeleton->FindJoint("left_ankle");
  const int head = *motion.skeleton->FindJoint("head");
  for (int f = 0; f < motion.frame_count(); ++f) {
    EXPECT_LT((motion.joints.at(f, ankle) - motion.joints.at(0, ankle)).norm(), 1e-6);
    EXPECT_LT((motion.joints.at(f, head) - before.joints.at(f, head)).norm(), 1e-9);
  }
  EXPECT_NEAR(removed->largest_shift, 0.06, 0.01);
  EXPECT_GT(removed->largest_rotation, 0.02);
}

TEST(FootContacts, KeepsTheFootsOrientationAndTheKneesPlane) {
  Motion motion = Swaying(0.06);
  const Motion before = motion;
  ASSERT_TRUE(RemoveFootSliding(ContactOptions(), motion).has_value());
  const int ankle = *motion.skeleton->FindJoint("right_ankle"), toe = *motion.skeleton->FindJoint("right_foot");
  const int hip = *motion.skeleton->FindJoint("right_hip"), knee = *motion.skeleton->FindJoint("right_knee");
  for (int f = 0; f < motion.frame_count(); ++f) {
    const Vector3d foot = motion.joints.at(f, toe) - motion.joints.at(f, ankle);
    EXPECT_LT((foot - (before.joints.at(f, toe) - before.joints.at(f, ankle))).norm(), 1e-9);
    const Vector3d middle = 0.5 * (motion.joints.at(f, hip) + motion.joints.at(f, ankle));
    EXPECT_GT((motion.joints.at(f, knee) - middle).z(), 0.1) << "the knee stays in front";
  }
}

/// Sways and lifts the heels midway: the pelvis rises, and the ankles rotate so that the toes keep their height.
Motion RisingOntoTheToes() {
  Motion motion = Swaying(0.03, 80);
  const int ankles[] = {7, 8}, toes[] = {10, 11};
  for (int f = 0; f < motion.frame_count(); ++f) {  // flat feet
    for (const int ankle : ankles) motion.rotation_at(f, ankle) = ExpQuaternion(Vector3d(-0.5, 0.0, 0.0));
  }
  ComputeJoints(motion);
  const double low = motion.joints.at(0, toes[0]).y();
  for (int f = 0; f < motion.frame_count(); ++f) {
    motion.root_translation[f].x() += 0.005 * f;  // the whole person slides
    motion.root_translation[f].y() += std::clamp(0.007 * (f - 40), 0.0, 0.07);
  }
  ComputeJoints(motion);
  const Motion risen = motion;
  for (int f = 41; f < motion.frame_count(); ++f) {
    for (int side = 0; side < 2; ++side) {
      const Vector3d foot = risen.joints.at(f, toes[side]) - risen.joints.at(f, ankles[side]);
      const double drop = low - risen.joints.at(f, ankles[side]).y();
      const double length = std::hypot(foot.y(), foot.z());
      const double turn = std::atan2(foot.y(), foot.z()) - std::asin(std::max(-1.0, drop / length));
      Quaterniond& ankle = motion.rotation_at(f, ankles[side]);
      ankle = ankle * ExpQuaternion(Vector3d(turn, 0.0, 0.0));
    }
  }
  ComputeJoints(motion);
  return motion;
}

TEST(FootContacts, RollingOntoTheToesMakesNoJump) {
  Motion motion = RisingOntoTheToes();
  const auto removed = RemoveFootSliding(ContactOptions(), motion);
  ASSERT_TRUE(removed.has_value()) << removed.error().Message();
  EXPECT_LE(removed->fastest_after, removed->fastest_before + 1e-4);
  EXPECT_LT(removed->sliding_after, 0.3 * removed->sliding_before);
  const auto fastest = [&](const Motion& of, int joint) {
    double most = 0.0;
    for (int f = 1; f < of.frame_count(); ++f) {
      if (motion.contact[2 * f] == 0 || motion.contact[2 * f - 2] == 0) continue;
      most = std::max(most, 30.0 * (of.joints.at(f, joint) - of.joints.at(f - 1, joint)).norm());
    }
    return most;
  };
  EXPECT_GT(removed->contact_share, 0.6) << "contact of ankle or toes";
  for (const int joint : {7, 10}) EXPECT_LT(fastest(motion, joint), 1.0);
}

TEST(FootContacts, StandingPersonIsNotChanged) {
  Motion motion = Swaying(0.0);
  const Motion before = motion;
  const auto removed = RemoveFootSliding(ContactOptions(), motion);
  ASSERT_TRUE(removed.has_value());
  EXPECT_LT(removed->largest_shift, 1e-9);
  EXPECT_EQ(motion.joints.xyz, before.joints.xyz);
}

TEST(FootContacts, MovedJointsAreLessCertainAndMarkedRepaired) {
  Motion motion = Swaying(0.06);
  const auto samples = static_cast<std::size_t>(motion.frame_count()) * motion.joint_count();
  motion.state.assign(samples, JointState::kObserved);
  motion.position_cov.assign(6 * samples, 0.0F);
  motion.rotation_sigma.assign(3 * samples, 0.01F);
  const Motion before = motion;
  ASSERT_TRUE(RemoveFootSliding(ContactOptions(), motion).has_value());
  const int ankle = *motion.skeleton->FindJoint("left_ankle"), head = *motion.skeleton->FindJoint("head");
  const int knee = *motion.skeleton->FindJoint("left_knee"), frame = 8;  // swayed farthest
  const auto at = [&](int joint) { return static_cast<std::size_t>(frame) * motion.joint_count() + joint; };
  const double shift = (motion.joints.at(frame, ankle) - before.joints.at(frame, ankle)).norm();
  ASSERT_GT(shift, 0.03);
  EXPECT_NEAR(std::sqrt(motion.position_cov[6 * at(ankle)]), shift, 1e-3);  // along x, as it swayed
  EXPECT_EQ(motion.state[at(ankle)], JointState::kRepaired);
  EXPECT_GT(motion.rotation_sigma[3 * at(knee)], 0.01F);
  EXPECT_EQ(motion.position_cov[6 * at(head)], 0.0F);
  EXPECT_EQ(motion.state[at(head)], JointState::kObserved);
}

TEST(FootContacts, FootInTheAirIsNotFixed) {
  Motion motion = Swaying(0.06);
  for (int f = 0; f < motion.frame_count(); ++f) motion.root_translation[f].y() += f < 30 ? 0.0 : 0.5;
  ComputeJoints(motion);
  const Motion before = motion;
  ASSERT_TRUE(RemoveFootSliding(ContactOptions(), motion).has_value());
  for (int f = 40; f < 60; ++f) {  // after the blend
    EXPECT_EQ(motion.contact[2 * f], 0);
    EXPECT_LT((motion.joints.at(f, 7) - before.joints.at(f, 7)).norm(), 1e-9);
  }
  for (int f = 1; f < 60; ++f) {  // the foot leaves the contact without a jump
    const Vector3d shift = motion.joints.at(f, 7) - before.joints.at(f, 7);
    const Vector3d last = motion.joints.at(f - 1, 7) - before.joints.at(f - 1, 7);
    EXPECT_LT((shift - last).norm(), 0.035) << f;
  }
}

TEST(FootContacts, ReportsAnUnreachableContactWithoutStretchingTheLeg) {
  Motion motion = Swaying(0.5, 200);
  ContactOptions options;
  options.speed = 10.0;
  const auto removed = RemoveFootSliding(options, motion);
  ASSERT_TRUE(removed.has_value());
  EXPECT_GT(removed->unreachable, 0);
  EXPECT_TRUE(motion.Check().has_value());
}

TEST(FootContacts, StraightLegBendsForwards) {
  Motion motion = Swaying(0.0, 40);
  const int hip = 1, knee = 4, ankle = 7;
  for (int f = 0; f < 40; ++f) {
    for (const int j : {hip, knee}) motion.rotation_at(f, j) = Quaterniond::Identity();
    motion.root_translation[f].y() += f < 20 ? 0.0 : -0.04;  // sinks: the feet stay
  }
  ComputeJoints(motion);
  ASSERT_TRUE(RemoveFootSliding(ContactOptions(), motion).has_value());
  EXPECT_LT((motion.joints.at(30, ankle) - motion.joints.at(5, ankle)).norm(), 0.025);
  EXPECT_GT(motion.joints.at(30, knee).z(), 0.0);
}

TEST(FootContacts, RefusesASkeletonWithoutLegs) {
  Skeleton skeleton = *WalkingSkeleton();
  skeleton.joints[4].parent = 0;
  EXPECT_EQ(LegsOf(skeleton).error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace mocurate
