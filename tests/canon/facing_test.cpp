// After canonicalisation the anchor frame is at the origin facing +z, and nothing else about the motion changed.

#include <gtest/gtest.h>

#include <cstdlib>

#include "canon/frames/facing.h"
#include "canon/frames/level.h"
#include "core/base/pi.h"
#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "tests/support/golden.h"

namespace mocurate {
namespace {

/// The clip in the world of its source.
void UndoCanonical(Clip& clip) { Transform(Inverse(clip.canonical_from_source), clip); }

SkeletonPtr Smpl() {
  auto skeleton = LoadSkeleton("smpl24");
  EXPECT_TRUE(skeleton) << skeleton.error().Message();
  return *skeleton;
}

/// A clip whose root rotates and travels; other joints bend a little.
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
    // Bones of this skeleton point along local x: set it upright, then rotate it.
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

/// A tree with an exporter's names, facing along x: no skeleton of configs/skeletons has these hip names.
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
  const Vector3d left = Vector3d(0.01, 1, 0).normalized(), forward(0.6, 0, 0.8);
  Matrix3d axes;
  axes << left, forward.cross(left), forward;
  const Heading heading = HeadingOfAxes(axes, HeadingRule::kHips, 0.2);
  EXPECT_EQ(heading.source, YawSource::kForwardAxis);
  EXPECT_NEAR(heading.yaw, std::atan2(0.6, 0.8), 1e-12);
}

TEST(Heading, ByTheTwistIsContinuousWhereTheHipAxisPassesTheVertical) {
  // A person who rolls over sideways, from standing to lying and on towards the head: 0 to 160 degrees.
  FacingOptions twist;
  twist.rule = FacingRule::kTwist;
  double most_by_twist = 0.0, most_by_euler = 0.0;
  Heading last_twist, last_euler;
  for (int degrees = 0; degrees <= 160; ++degrees) {
    const double roll = degrees * kPi / 180.0;
    const Matrix3d axes =
        ExpMatrix(Vector3d(0, 0.7, 0)) * ExpMatrix(Vector3d(0, 0, roll)) * ExpMatrix(Vector3d(0.05, 0, 0));
    const Heading by_twist = HeadingOfAxes(axes, HeadingRule::kTwist, 0.2);
    const Heading by_euler = HeadingOfAxes(axes, HeadingRule::kEuler, 0.2);
    if (degrees > 0) {
      most_by_twist = std::max(most_by_twist, std::abs(std::remainder(by_twist.yaw - last_twist.yaw, 2 * kPi)));
      most_by_euler = std::max(most_by_euler, std::abs(std::remainder(by_euler.yaw - last_euler.yaw, 2 * kPi)));
    }
    last_twist = by_twist;
    last_euler = by_euler;
  }
  EXPECT_LT(most_by_twist, 0.02);
  EXPECT_GT(most_by_euler, 1.0);
}

TEST(Heading, TurnsWithThePersonByEveryRule) {
  Random random(7, "headings");
  for (int trial = 0; trial < 200; ++trial) {
    const Matrix3d axes = ExpMatrix(Vector3d(random.Uniform(-3, 3), random.Uniform(-3, 3), random.Uniform(-3, 3)));
    const double turn = random.Uniform(-3, 3);
    for (const HeadingRule rule : {HeadingRule::kHips, HeadingRule::kEuler, HeadingRule::kTwist}) {
      const Heading before = HeadingOfAxes(axes, rule, 0.2);
      if (before.horizontal < 1e-3) continue;
      const Heading after = HeadingOfAxes(ExpMatrix(Vector3d(0, turn, 0)) * axes, rule, 0.2);
      EXPECT_NEAR(std::remainder(after.yaw - before.yaw - turn, 2 * kPi), 0.0, 1e-9);
    }
  }
}

FacingOptions WithRule(FacingRule rule, Anchor anchor = Anchor::kFirst) {
  FacingOptions options;
  options.rule = rule;
  options.anchor = anchor;
  if (rule == FacingRule::kGiven) options.given = {{{"p1"}, {}, {0, 0, 1, 0, 1, 0, -1, 0, 0}}};
  return options;
}

TEST(FaceFront, EveryRuleAtEveryAnchorIsUndoneByTheStoredTransform) {
  const Clip original = TurningClip(4, 0.9);
  for (const FacingRule rule : {FacingRule::kNone, FacingRule::kOrigin, FacingRule::kHips, FacingRule::kEuler,
                                FacingRule::kTwist, FacingRule::kZero, FacingRule::kGiven}) {
    for (const Anchor anchor :
         {Anchor::kFirst, Anchor::kMiddle, Anchor::kLast, Anchor::kFirstSegment, Anchor::kFrame}) {
      FacingOptions options = WithRule(rule, anchor);
      options.anchor_frame = 5;
      options.height = anchor == Anchor::kMiddle ? HeightOrigin::kFloor : HeightOrigin::kRoot;
      Clip clip = original;
      clip.segments = {{0.1, 0.3, "b", "", ""}, {0.0, 0.1, "a", "", ""}};
      ASSERT_TRUE(FaceFront(options, clip));
      const Clip moved = clip;
      UndoCanonical(clip);
      EXPECT_LT(Largest(original.motion->joints, clip.motion->joints), 1e-9);
      EXPECT_LT(clip.canonical_from_source.translation.norm(), 1e-9);
      if (rule == FacingRule::kNone) {
        EXPECT_EQ(Largest(original.motion->joints, moved.motion->joints), 0.0);
      }
      if (rule == FacingRule::kNone || anchor == Anchor::kMiddle) continue;
      const int frame = anchor == Anchor::kFirst ? 0 : anchor == Anchor::kLast ? 11 : anchor == Anchor::kFrame ? 5 : 2;
      EXPECT_LT(moved.motion->joints.at(frame, 0).norm(), 1e-9);
      if (rule == FacingRule::kZero) {
        EXPECT_LT(AngleBetween(moved.motion->rotation_at(frame, 0), Quaterniond::Identity()), 1e-6);
      }
    }
  }
}

TEST(FaceFront, PutsHeightZeroOnTheFloorWhereItWasMeasured) {
  FloorPlane floor;
  floor.height = -0.7;
  Clip levelled = TurningClip(4, 0.0);
  LevelClip(floor, levelled);
  EXPECT_EQ(levelled.provenance.at(kHeightOrigin), kOriginFloor);
  const double above = levelled.motion->joints.at(0, 0).y();
  EXPECT_NEAR(above, 0.9 + 0.7, 1e-12);

  struct Case {
    FacingRule rule;
    HeightOrigin height;
    bool measured;
    double root_height;  ///< of the anchor afterwards
    const char* origin;
  };
  const HeightOrigin kByDefault = FacingOptions().height;
  const double recorded = TurningClip(4, 0.0).motion->joints.at(0, 0).y();
  const std::vector<Case> cases = {
      {FacingRule::kHips, kByDefault, true, above, kOriginFloor},
      {FacingRule::kOrigin, kByDefault, true, above, kOriginFloor},
      {FacingRule::kGiven, kByDefault, true, above, kOriginFloor},  // about the vertical
      {FacingRule::kNone, kByDefault, true, above, kOriginFloor},
      {FacingRule::kHips, HeightOrigin::kFloor, true, above, kOriginFloor},
      {FacingRule::kHips, HeightOrigin::kRoot, true, 0.0, kOriginRoot},
      {FacingRule::kHips, kByDefault, false, 0.0, kOriginRoot},
      {FacingRule::kHips, HeightOrigin::kFloor, false, recorded, kOriginSourceHeight},
      {FacingRule::kNone, kByDefault, false, recorded, kOriginSource},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    Clip clip = cases[i].measured ? levelled : TurningClip(4, 0.0);
    FacingOptions options = WithRule(cases[i].rule);
    options.height = cases[i].height;
    ASSERT_TRUE(FaceFront(options, clip));
    EXPECT_NEAR(clip.motion->joints.at(0, 0).y(), cases[i].root_height, 1e-9);
    EXPECT_EQ(clip.provenance.at(kHeightOrigin), cases[i].origin);
    // A part of it keeps the origin, and so does the whole when it is faced again.
    const Clip before = clip;
    ASSERT_TRUE(FaceAgain(clip));
    EXPECT_LT(Largest(before.motion->joints, clip.motion->joints), 1e-9);
    EXPECT_EQ(clip.provenance.at(kHeightOrigin), cases[i].origin);
    UndoCanonical(clip);
    EXPECT_LT(Largest(TurningClip(4, 0.0).motion->joints, clip.motion->joints), 1e-9);
  }
}

TEST(FaceFront, DoesNotTakeATiltedFloorForHeightZero) {
  Clip clip = TurningClip(4, 0.3);
  LevelClip(FloorPlane(), clip);
  ASSERT_TRUE(FaceFront(WithRule(FacingRule::kZero), clip));
  EXPECT_LT(clip.motion->joints.at(0, 0).norm(), 1e-9);
  EXPECT_EQ(clip.provenance.at(kHeightOrigin), kOriginRoot);
}

TEST(FaceFront, OfAPartOfAClipIsThatOfTheWhole) {
  for (const FacingRule rule :
       {FacingRule::kOrigin, FacingRule::kHips, FacingRule::kTwist, FacingRule::kZero, FacingRule::kGiven}) {
    for (const Anchor anchor : {Anchor::kFirst, Anchor::kMiddle, Anchor::kLast}) {
      FacingOptions options = WithRule(rule, anchor);
      // A tilt that is undone takes heights over the floor along.
      options.height = rule == FacingRule::kZero ? HeightOrigin::kRoot : HeightOrigin::kFloor;
      Clip whole = TurningClip(4, 0.3);
      Clip part = *Cut(whole, 3, 9);
      ASSERT_TRUE(FaceFront(options, part));  // the part by itself
      ASSERT_TRUE(FaceFront(options, whole));
      Clip cut = *Cut(whole, 3, 9);  // cut from the faced whole, as a review does
      ASSERT_TRUE(FaceAgain(cut));
      EXPECT_LT(Largest(part.motion->joints, cut.motion->joints), 1e-6)
          << static_cast<int>(rule) << static_cast<int>(anchor);
    }
  }
}

TEST(FaceFront, OfAFrameASegmentOrAPersonThatIsNotThereIsRefused) {
  Clip clip = TurningClip(4, 0.2);
  FacingOptions late = WithRule(FacingRule::kHips, Anchor::kFrame);
  late.anchor_frame = 12;
  EXPECT_EQ(FaceFront(late, clip).error().code, ErrorCode::kConfig);
  EXPECT_EQ(FaceFront(WithRule(FacingRule::kHips, Anchor::kFirstSegment), clip).error().code, ErrorCode::kConfig);
  FacingOptions others = WithRule(FacingRule::kGiven);
  others.given[0].persons = {"p2"};
  EXPECT_EQ(FaceFront(others, clip).error().code, ErrorCode::kConfig);
  FacingOptions bent = WithRule(FacingRule::kGiven);
  bent.given[0].rotation[0] = 0.5;
  EXPECT_EQ(FaceFront(bent, clip).error().code, ErrorCode::kConfig);
}

/// The released code is z-up; C = y-up from z-up on the world side converts its values to ours (multiact.md B.3).
Matrix3d YFromZ() {
  Matrix3d y_from_z;
  y_from_z << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return y_from_z;
}

/// One clip of canonicalization.h5 in our axes, as a root without limbs.
Clip GoldenClip(const golden::Array<double>& orient, const golden::Array<double>& place, const Matrix3d& world) {
  const SkeletonPtr skeleton = Smpl();
  const auto joints = static_cast<std::size_t>(skeleton->joint_count());
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  for (std::size_t f = 0; f < orient.rows(); ++f) {
    const double* r = orient.row(f);
    const double* x = place.row(f);
    root.push_back(world * Vector3d(x[0], x[1], x[2]));
    rotation.insert(rotation.end(), joints, Quaterniond::Identity());
    rotation[f * joints] = Quaterniond(world * ExpMatrix(Vector3d(r[0], r[1], r[2])));
  }
  Clip clip;
  clip.motion = MakeMotion(skeleton, FrameRate{30, 1}, root, rotation, skeleton->RestBoneLengths());
  return clip;
}

TEST(FaceFront, EqualsTheReleasedAlignmentAndTheDefinitionOfZero) {
  if (golden::Folder() == nullptr) GTEST_SKIP() << "MOCURATE_GOLDENS is unset";
  const golden::File file(golden::PathOf("canonicalization.h5"));
  int compared = 0;
  for (const char* kind : {"random", "upright", "near_zero_pi", "gimbal"}) {
    const auto orient = file.Doubles(std::string(kind) + "/params_orient");
    const auto place = file.Doubles(std::string(kind) + "/transl");
    for (const std::string& group : file.Children(kind)) {
      if (group.rfind("anchor", 0) != 0) continue;
      const std::string at = std::string(kind) + "/" + group + "/";
      FacingOptions options = WithRule(FacingRule::kEuler, Anchor::kFrame);
      options.anchor_frame = std::stoi(group.substr(6));
      Clip faced = GoldenClip(orient, place, YFromZ());
      ASSERT_TRUE(FaceFront(options, faced));
      // The turn in double is exact; the stored numbers are float32, at the gimbal's anchors off by what they state.
      const auto turn = file.Doubles(at + "f64_check_transform");
      Matrix3d theirs;
      for (int k = 0; k < 9; ++k) theirs(k / 3, k % 3) = turn.values[static_cast<std::size_t>(k)];
      const Matrix3d ours = YFromZ().transpose() * faced.canonical_from_source.rotation.toRotationMatrix() * YFromZ();
      EXPECT_LT((ours - theirs).cwiseAbs().maxCoeff(), 3e-5) << at;
      const auto rotated = file.Doubles(at + "orient");
      const auto placed = file.Doubles(at + "transl");
      const double off = file.Doubles(at + "f64_max_dev_rot").values[0] + 3e-5;
      const double away = file.Doubles(at + "f64_max_dev_transl").values[0] + 3e-5;
      const Clip expected = GoldenClip(rotated, placed, YFromZ());
      options.rule = FacingRule::kZero;
      Clip zero = GoldenClip(orient, place, Matrix3d::Identity());
      ASSERT_TRUE(FaceFront(options, zero));
      const auto zero_turn = file.Doubles(at + "zero_canon_orient_matrix");
      const auto zero_place = file.Doubles(at + "zero_canon_transl");
      for (int f = 0; f < faced.motion->frame_count(); ++f) {
        EXPECT_LT(AngleBetween(faced.motion->rotation_at(f, 0), expected.motion->rotation_at(f, 0)), 2 * off)
            << at << f;
        EXPECT_LT((faced.motion->root_translation[f] - expected.motion->root_translation[f]).norm(), 2 * away)
            << at << f;
        const Matrix3d z = zero.motion->rotation_at(f, 0).toRotationMatrix();
        for (int k = 0; k < 9; ++k)
          EXPECT_NEAR(z(k / 3, k % 3), zero_turn.values[static_cast<std::size_t>(9 * f + k)], 1e-6);
        for (int k = 0; k < 3; ++k) {
          EXPECT_NEAR(zero.motion->root_translation[f][k], zero_place.values[static_cast<std::size_t>(3 * f + k)],
                      1e-6);
        }
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 100);
}

TEST(Heading, OfTheWrittenExampleIsTheWrittenNumber) {
  const Matrix3d root = YFromZ() * ExpMatrix(Vector3d(1.157214, 1.291215, 1.900880));
  EXPECT_NEAR(HeadingOfAxes(root, HeadingRule::kHips, 0.2).yaw * 180.0 / kPi, 120.0, 1e-3);
}

}  // namespace
}  // namespace mocurate
