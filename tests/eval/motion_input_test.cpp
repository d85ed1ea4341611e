// Conversion of motions to an extractor's input: frames, units, roots, windows, padding.

#include "eval/features/motion_input.h"

#include <gtest/gtest.h>

#include "core/motion/preparation.h"
#include "eval/features/feature_extractor.h"
#include "tests/train/toy_dataset.h"
#include "train/recognisers/recogniser_input.h"

namespace mocurate {
namespace {

Motion Counting(int frames) {
  Motion motion;
  motion.skeleton = SmallSkeleton();
  motion.joints = JointPositions(frames, motion.skeleton->joint_count());
  for (std::size_t i = 0; i < motion.joints.xyz.size(); ++i)
    motion.joints.xyz[i] = 0.01 * static_cast<double>(i * i % 97);
  return motion;
}

InputRules Rules(int frames) {
  InputRules rules;
  rules.skeleton = SmallSkeleton();
  rules.options.frames = frames;
  return rules;
}

struct Input {
  std::vector<float> values;
  int read_out = 0;

  Vector3d at(int frame, int joint, int joints = 5) const {
    const float* p = values.data() + 3 * (frame * joints + joint);
    return {p[0], p[1], p[2]};
  }
};

Input InputOf(const InputRules& rules, const Motion& motion, RootRule root, CropStart start = CropStart::kFirst) {
  Input input;
  Random random(3, "crop", "0");
  const auto joints = JointsFor(*rules.skeleton, *motion.skeleton);
  EXPECT_TRUE(joints) << joints.error().Message();
  input.values.resize(static_cast<std::size_t>(rules.frames() * rules.size()));
  input.read_out = WriteMotionInput(rules, *joints, motion, root, start, random, input.values.data());
  return input;
}

std::vector<float> AsFloats(const std::vector<double>& values) { return {values.begin(), values.end()}; }

TEST(MotionInput, WindowsAndPaddingAreThoseOfTheReleasedPreparation) {
  for (const int frames : {7, 12, 19}) {
    const Motion motion = Counting(frames);
    Random random(3, "crop", "0");
    const Window window = DrawWindow(frames, 12, LastStart::kExcluded, random);
    EXPECT_EQ(InputOf(Rules(12), motion, RootRule::kFirstFrame, CropStart::kReleased).values,
              AsFloats(PrepareWindow(motion.joints, window, 12, true)))
        << frames;
  }
}

/// Two frames of smpl24 with a root rotation in camera axes (y down), converted to canonical axes.
Motion CameraMotion(const Quaterniond& in_camera, const Quaterniond& knee) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const Quaterniond half_turn(0.0, 1.0, 0.0, 0.0);  // diag(1, -1, -1)
  std::vector<Quaterniond> rotation(48, Quaterniond::Identity());
  rotation[0] = rotation[24] = half_turn * in_camera;
  rotation[4] = rotation[28] = knee;
  return MakeMotion(skeleton, {}, {Vector3d::Zero(), Vector3d::Zero()}, rotation, skeleton->RestBoneLengths());
}

TEST(MotionInput, RotationsAreThoseOfTheNetworksCamera) {
  ExtractorOptions options;
  options.skeleton = "smpl24";
  options.axes = "+x -y -z";
  options.network = ExtractorNetwork::kStGcn;
  options.values = ExtractorValues::kRotation6DRows;
  options.frames = 3;
  const auto rules = RulesOf(options);
  ASSERT_TRUE(rules) << rules.error().Message();
  const Quaterniond root = ExpQuaternion(Vector3d(0.3, -0.8, 0.5)), knee = ExpQuaternion(Vector3d(1.1, 0.0, 0.2));
  const Motion motion = CameraMotion(root, knee);
  ASSERT_TRUE(CheckRotations(*rules->skeleton, motion));
  const Input input = InputOf(*rules, motion, RootRule::kAsGiven, CropStart::kFirst);
  const auto want_root = Matrix6D(root.toRotationMatrix(), Rotation6D::kRows);
  const auto want_knee = Matrix6D(knee.toRotationMatrix(), Rotation6D::kRows);
  for (std::size_t f = 0; f < 3; ++f) {  // the last one repeats
    for (std::size_t k = 0; k < 6; ++k) {
      EXPECT_NEAR(input.values[f * 144 + k], want_root[k], 1e-6);
      EXPECT_NEAR(input.values[f * 144 + 24 + k], want_knee[k], 1e-6);
    }
  }
}

TEST(MotionInput, RotationsOfAnotherRestPoseOrOfNoneAreRefused) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  Motion motion = CameraMotion(Quaterniond::Identity(), Quaterniond::Identity());
  auto arms_down = std::make_shared<Skeleton>(*skeleton);
  const int elbow = *arms_down->FindJoint("left_elbow");
  arms_down->joints[static_cast<std::size_t>(elbow)].rest_offset = Vector3d(0.0, -0.24, 0.0);
  motion.skeleton = arms_down;
  EXPECT_EQ(CheckRotations(*skeleton, motion).error().code, ErrorCode::kInconsistent);
  EXPECT_EQ(CheckRotations(*skeleton, MakeJointsOnly(skeleton, {}, motion.joints)).error().code,
            ErrorCode::kInconsistent);
}

TEST(MotionInput, IsWhatARecogniserOfOursWasTrainedOn) {
  for (const int frames : {1, 7, 12, 19}) {
    const Motion motion = Counting(frames);
    for (const auto kind : {RecogniserInputKind::kCrop, RecogniserInputKind::kResample}) {
      InputRules rules = Rules(12);
      rules.options.length = kind == RecogniserInputKind::kResample ? LengthRule::kResample : LengthRule::kCrop;
      Random random(3, "crop", "0");
      EXPECT_EQ(InputOf(rules, motion, RootRule::kFirstFrame, CropStart::kReleased).values,
                RecogniserInput(motion, kind, 12, random))
          << frames;
    }
  }
}

TEST(MotionInput, AxesAndUnitAreTheNetworks) {
  ExtractorOptions options;
  options.skeleton = "humanact12";
  options.axes = "+x -y -z";
  options.metres_per_unit = 2.0;
  const auto rules = RulesOf(options);
  ASSERT_TRUE(rules) << rules.error().Message();
  Motion motion;
  motion.skeleton = rules->skeleton;
  motion.joints = JointPositions(2, 24);
  motion.joints.at(1, 7) = Vector3d(1.0, 2.0, 3.0);
  const Input input = InputOf(*rules, motion, RootRule::kAsGiven);
  EXPECT_EQ(input.at(1, 7, 24), Vector3d(0.5, -1.0, -1.5));
  EXPECT_EQ(static_cast<int>(input.values.size()), 60 * 72);
}

TEST(MotionInput, TheRootIsCountedFromWhereTheRuleSays) {
  const Motion motion = Counting(12);
  const Input given = InputOf(Rules(12), motion, RootRule::kAsGiven);
  const Input first = InputOf(Rules(12), motion, RootRule::kFirstFrame);
  const Input every = InputOf(Rules(12), motion, RootRule::kEveryFrame);
  for (int f = 0; f < 12; ++f) {
    EXPECT_LT((given.at(f, 3) - given.at(0, 0) - first.at(f, 3)).norm(), 1e-6);
    EXPECT_LT((given.at(f, 3) - given.at(f, 0) - every.at(f, 3)).norm(), 1e-6);
  }
}

TEST(MotionInput, PaddingFollowsTheRuleAndTheReadOutTheLastFrameOrTheLastOfTheMotion) {
  const Motion motion = Counting(5);
  InputRules rules = Rules(8);
  EXPECT_EQ(InputOf(rules, motion, RootRule::kFirstFrame).read_out, 8);
  rules.options.read_out = ReadOut::kLastValid;
  const Input repeated = InputOf(rules, motion, RootRule::kFirstFrame);
  EXPECT_EQ(repeated.read_out, 5);
  EXPECT_EQ(repeated.at(7, 2), repeated.at(4, 2));
  rules.options.padding = PaddingRule::kZeros;
  EXPECT_EQ(InputOf(rules, motion, RootRule::kFirstFrame).at(6, 2), Vector3d::Zero());
  rules.options.padding = PaddingRule::kZerosMinusRoot;
  const Vector3d root = motion.joints.at(0, 0);
  EXPECT_LT((InputOf(rules, motion, RootRule::kFirstFrame).at(6, 2) + root).norm(), 1e-6);
}

TEST(MotionInput, JointsAreFoundByNameInAnyOrder) {
  const SkeletonPtr own = SmallSkeleton();
  auto turned = std::make_shared<Skeleton>(*own);
  std::swap(turned->joints[3].name, turned->joints[4].name);
  const auto joints = JointsFor(*own, *turned);
  ASSERT_TRUE(joints);
  EXPECT_EQ((*joints)[3], 4);
  EXPECT_EQ((*joints)[4], 3);
  turned->joints[2].name = "tail";
  EXPECT_EQ(JointsFor(*own, *turned).error().code, ErrorCode::kInconsistent);
}

TEST(ClassOf, GoesByNameWhateverItsSpellingElseByIndex) {
  const std::vector<std::string> classes = {"warm_up", "walk", "turn_steering_wheel"};
  EXPECT_EQ(ClassOf(classes, "Warm up"), 0);
  EXPECT_EQ(ClassOf(classes, "turn steering-wheel"), 2);
  EXPECT_EQ(ClassOf(classes, "1"), 1);
  EXPECT_EQ(ClassOf(classes, "01"), 1);
  EXPECT_EQ(ClassOf(classes, "3"), std::nullopt);
  EXPECT_EQ(ClassOf(classes, "run"), std::nullopt);
  EXPECT_EQ(ClassOf(classes, ""), std::nullopt);
}

/// A set of the canonical rest pose of humanact12, its values changed.
std::vector<Motion> RestPoses(double y_sign, double scale) {
  const auto skeleton = LoadSkeleton("humanact12");
  Motion motion;
  motion.skeleton = *skeleton;
  motion.joints = JointPositions(3, 24);
  for (int f = 0; f < 3; ++f) {
    for (int j = 1; j < 24; ++j) {
      const Joint& joint = (*skeleton)->joints[j];
      Vector3d offset = joint.rest_offset * scale;
      offset.y() *= y_sign;
      motion.joints.at(f, j) = motion.joints.at(f, joint.parent) + offset;
    }
  }
  return {motion, motion, motion};
}

Status CheckedFrame(const std::vector<Motion>& set) {
  std::vector<const Motion*> motions;
  for (const Motion& motion : set) motions.push_back(&motion);
  return CheckFrameOfSet(motions);
}

TEST(FrameOfSet, AHeadBelowTheFeetOrBonesOfAnotherUnitAreRefused) {
  EXPECT_TRUE(CheckedFrame(RestPoses(1.0, 1.0)));
  EXPECT_TRUE(CheckedFrame(RestPoses(1.0, 1.4)));
  EXPECT_EQ(CheckedFrame(RestPoses(-1.0, 1.0)).error().code, ErrorCode::kInconsistent);
  EXPECT_EQ(CheckedFrame(RestPoses(1.0, 1.6)).error().code, ErrorCode::kInconsistent);
  EXPECT_EQ(CheckedFrame(RestPoses(1.0, 0.6)).error().code, ErrorCode::kInconsistent);
  std::vector<Motion> one_lies = RestPoses(1.0, 1.0);
  one_lies[0] = RestPoses(-1.0, 1.0)[0];
  EXPECT_TRUE(CheckedFrame(one_lies)) << "half of the set decides, not one motion";
}

}  // namespace
}  // namespace mocurate
