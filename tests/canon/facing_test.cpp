// After canonicalisation the anchor frame stands at the origin and faces +z, and nothing else about the motion changed.

#include <gtest/gtest.h>

#include <cstdlib>

#include "canon/frames/facing.h"
#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "tests/support/golden.h"

namespace mocurate {
namespace {

SkeletonPtr Smpl() {
  auto skeleton = LoadSkeleton("smpl24");
  EXPECT_TRUE(skeleton) << skeleton.error().Message();
  return *skeleton;
}

/// A clip whose root turns and travels; other joints bend a little.
Clip TurningClip(std::uint64_t seed, double tilt) {
  Random random(seed, "clip");
  const SkeletonPtr skeleton = Smpl();
  const int frames = 12;
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) {
    root.emplace_back(0.1 * f + 2.0, 0.9 + 0.01 * f, -1.0 - 0.05 * f);
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      const Vector3d bend(random.Uniform(-0.2, 0.2), random.Uniform(-0.2, 0.2), random.Uniform(-0.2, 0.2));
      rotation.push_back(j == 0 ? ExpQuaternion(Vector3d(0, 1.0 + 0.1 * f, 0)) * ExpQuaternion(Vector3d(tilt, 0, tilt))
                                : ExpQuaternion(bend));
    }
  }
  Clip clip;
  clip.identity.source = "test";
  clip.identity.person = "p1";
  clip.identity.recording = "r1";
  clip.identity.end_frame = frames;
  clip.motion = MakeMotion(skeleton, FrameRate{30, 1}, root, rotation, skeleton->RestBoneLengths());
  return clip;
}

double Largest(const JointPositions& a, const JointPositions& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.xyz.size(); ++i) largest = std::max(largest, std::abs(a.xyz[i] - b.xyz[i]));
  return largest;
}

TEST(FaceFront, ReadsHipsThatHangBelowARootThatNeverTurns) {
  const auto skeleton = LoadSkeleton("bandai22");
  ASSERT_TRUE(skeleton) << skeleton.error().Message();
  const int joints = (*skeleton)->joint_count();
  const auto hips = (*skeleton)->FindJoint("Hips");
  ASSERT_TRUE(hips);
  ASSERT_NE(*hips, 0);
  for (const double turn : {0.5, 2.0, -3.0}) {
    std::vector<Quaterniond> rotation(2 * static_cast<std::size_t>(joints), Quaterniond::Identity());
    // Bones of this skeleton point along local x: stand it up, then turn it.
    const Quaterniond up = ExpQuaternion(Vector3d(0, 0, 0.5 * 3.14159265358979));
    for (int f = 0; f < 2; ++f) {
      rotation[static_cast<std::size_t>(f * joints + *hips)] = ExpQuaternion(Vector3d(0, turn, 0)) * up;
    }
    Clip clip;
    clip.motion = MakeMotion(*skeleton, FrameRate{30, 1}, std::vector<Vector3d>(2, Vector3d(1, 1, 1)), rotation,
                             (*skeleton)->RestBoneLengths());
    const auto heading = FaceFront({}, clip);
    ASSERT_TRUE(heading) << heading.error().Message();
    const auto pair = (*skeleton)->Hips();
    const Vector3d left = clip.motion->joints.at(0, (*pair)[0]) - clip.motion->joints.at(0, (*pair)[1]);
    EXPECT_GT(left.x(), 0.99 * left.norm()) << turn;
  }
}

/// A tree as an exporter names it, facing along x: hips that no skeleton of configs/skeletons calls so.
Clip ExportedClip() {
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = "exported";
  const auto add = [&](const char* name, int parent, const Vector3d& offset, int mirror) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.rest_offset = offset;
    joint.mirror = mirror;
    skeleton->joints.push_back(joint);
  };
  add("mixamorig:Hips", -1, Vector3d::Zero(), 0);
  add("mixamorig:LeftUpLeg", 0, {0.1, -0.05, 0}, 4);
  add("mixamorig:LeftLeg", 1, {0, -0.4, 0}, 5);
  add("mixamorig:LeftFoot", 2, {0, -0.4, 0}, 6);
  add("mixamorig:RightUpLeg", 0, {-0.1, -0.05, 0}, 1);
  add("mixamorig:RightLeg", 4, {0, -0.4, 0}, 2);
  add("mixamorig:RightFoot", 5, {0, -0.4, 0}, 3);
  std::vector<Quaterniond> rotation(7, Quaterniond::Identity());
  rotation[0] = ExpQuaternion(Vector3d(0, 0.5 * 3.14159265358979, 0));
  Clip clip;
  clip.motion = MakeMotion(skeleton, FrameRate{30, 1}, {Vector3d(1, 1, 1)}, rotation, skeleton->RestBoneLengths());
  return clip;
}

TEST(FaceFront, OfATreeWithNamesOfItsOwnIsReadFromItsLegs) {
  Clip clip = ExportedClip();
  EXPECT_LT((clip.motion->joints.at(0, 1) - clip.motion->joints.at(0, 4)).x(), 0.01) << "not facing +z yet";
  const auto heading = FaceFront({}, clip);
  ASSERT_TRUE(heading) << heading.error().Message();
  EXPECT_EQ(heading->source, YawSource::kHipAxis);
  EXPECT_NEAR((clip.motion->joints.at(0, 1) - clip.motion->joints.at(0, 4)).x(), 0.2, 1e-6);
}

TEST(FaceFront, PutsTheAnchorAtTheOriginFacingZ) {
  Clip clip = TurningClip(1, 0.2);
  ASSERT_TRUE(FaceFront({}, clip));
  EXPECT_LT(clip.motion->joints.at(0, 0).norm(), 1e-9);
  const Vector3d left = clip.motion->rotation_at(0, 0) * Vector3d::UnitX();
  EXPECT_NEAR(left.z(), 0.0, 1e-6);
  EXPECT_GT(left.x(), 0.0);
}

TEST(FaceFront, DoesNotDependOnWhereTheCameraStood) {
  Clip clip = TurningClip(2, 0.3);
  Clip moved = clip;
  RigidTransform elsewhere;
  elsewhere.rotation = Quaterniond(Eigen::AngleAxisd(2.1, Vector3d::UnitY()));
  elsewhere.translation = Vector3d(5, 0.4, -3);
  Transform(elsewhere, moved);
  ASSERT_TRUE(FaceFront({}, clip));
  ASSERT_TRUE(FaceFront({}, moved));
  EXPECT_LT(Largest(clip.motion->joints, moved.motion->joints), 1e-6);
}

TEST(FaceFront, TwiceIsOnce) {
  Clip once = TurningClip(3, 0.1);
  ASSERT_TRUE(FaceFront({}, once));
  Clip twice = once;
  ASSERT_TRUE(FaceFront({}, twice));
  EXPECT_LT(Largest(once.motion->joints, twice.motion->joints), 1e-9);
}

TEST(FaceFront, IsUndoneByTheStoredTransform) {
  const Clip original = TurningClip(4, 0.2);
  Clip clip = original;
  ASSERT_TRUE(FaceFront({}, clip));
  const RigidTransform source_from_canonical = Inverse(clip.canonical_from_source);
  for (int f = 0; f < clip.motion->frame_count(); ++f) {
    for (int j = 0; j < clip.motion->joint_count(); ++j) {
      EXPECT_LT(
          (source_from_canonical * Vector3d(clip.motion->joints.at(f, j)) - original.motion->joints.at(f, j)).norm(),
          1e-9);
    }
  }
}

TEST(FaceFront, KeepsDistancesAndTilt) {
  const Clip original = TurningClip(5, 0.4);
  Clip clip = original;
  ASSERT_TRUE(FaceFront({}, clip));
  const auto span = [](const Motion& m) { return (m.joints.at(11, 15) - m.joints.at(0, 4)).norm(); };
  EXPECT_NEAR(span(*clip.motion), span(*original.motion), 1e-9);
  const Vector3d up_before = original.motion->rotation_at(0, 0) * Vector3d::UnitY();
  const Vector3d up_after = clip.motion->rotation_at(0, 0) * Vector3d::UnitY();
  EXPECT_NEAR(up_before.y(), up_after.y(), 1e-9);
}

TEST(FaceFront, JointsOnlyAgreesWithRotationsForAnUprightPerson) {
  Clip full = TurningClip(6, 0.0);
  Clip joints_only = full;
  joints_only.motion = MakeJointsOnly(full.motion->skeleton, full.motion->rate, full.motion->joints);
  const auto of_full = FaceFront({}, full);
  const auto of_joints = FaceFront({}, joints_only);
  ASSERT_TRUE(of_full && of_joints);
  EXPECT_NEAR(of_full->yaw, of_joints->yaw, 0.02);
}

TEST(Heading, OfAPersonLyingOnTheSideComesFromTheForwardAxis) {
  const Heading heading = HeadingOfAxes(Vector3d(0.01, 1, 0), Vector3d(0.6, 0, 0.8), 0.2);
  EXPECT_EQ(heading.source, YawSource::kForwardAxis);
  EXPECT_NEAR(heading.yaw, std::atan2(0.6, 0.8), 1e-12);
}

/// The released code works z-up; C = y-up from z-up on the world side turns its numbers into ours (multiact.md B.3).
TEST(Heading, EqualsTheReleasedAlignmentAfterTheChangeOfAxes) {
  if (golden::Folder() == nullptr) GTEST_SKIP() << "MOCURATE_GOLDENS is unset";
  const golden::File file(golden::PathOf("canonicalization.h5"));
  Matrix3d y_from_z;
  y_from_z << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  int compared = 0;
  for (const char* kind : {"random", "upright", "near_zero_pi"}) {
    const auto orient = file.Doubles(std::string(kind) + "/params_orient");
    const auto place = file.Doubles(std::string(kind) + "/transl");
    for (const std::string& group : file.Children(kind)) {
      if (group.rfind("anchor", 0) != 0) continue;
      const int anchor = std::stoi(group.substr(6));
      const std::string at = std::string(kind) + "/" + group + "/";
      const auto expected_orient = file.Doubles(at + "orient");
      const auto expected_place = file.Doubles(at + "transl");
      const auto rotation_of = [](const golden::Array<double>& a, int f) {
        return ExpMatrix(Vector3d(a.row(f)[0], a.row(f)[1], a.row(f)[2]));
      };
      const Matrix3d root = y_from_z * rotation_of(orient, anchor);
      const Heading heading = HeadingOfAxes(root.col(0), root.col(2), 1e-3);
      if (heading.source != YawSource::kHipAxis) continue;
      const Matrix3d turn = ExpMatrix(Vector3d(0, -heading.yaw, 0));
      const auto place_of = [](const golden::Array<double>& a, int f) {
        return Vector3d(a.row(f)[0], a.row(f)[1], a.row(f)[2]);
      };
      for (int f = 0; f < static_cast<int>(orient.rows()); ++f) {
        const Matrix3d ours = turn * y_from_z * rotation_of(orient, f);
        const Matrix3d theirs = y_from_z * rotation_of(expected_orient, f);
        EXPECT_LT((ours - theirs).cwiseAbs().maxCoeff(), 5e-4) << at << f;
        const Vector3d our_place = turn * (y_from_z * (place_of(place, f) - place_of(place, anchor)));
        EXPECT_LT((our_place - y_from_z * place_of(expected_place, f)).norm(), 2e-4) << at << f;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 100);
}

TEST(Heading, OfTheWrittenExampleIsTheWrittenNumber) {
  Matrix3d y_from_z;
  y_from_z << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Matrix3d root = y_from_z * ExpMatrix(Vector3d(1.157214, 1.291215, 1.900880));
  const Heading heading = HeadingOfAxes(root.col(0), root.col(2), 0.2);
  EXPECT_NEAR(heading.yaw * 180.0 / 3.14159265358979, 120.0, 1e-3);
}

}  // namespace
}  // namespace mocurate
