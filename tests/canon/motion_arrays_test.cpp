#include "canon/exports/motion_arrays.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/geometry/rotation.h"
#include "core/motion/kinematics.h"
#include "tests/support/rotations.h"

namespace mocurate {
namespace {

/// Random joint rotations, with bone lengths of their own.
Clip Tumbling(const std::string& skeleton_name, int frames = 7) {
  const SkeletonPtr skeleton = *LoadSkeleton(skeleton_name);
  Random random(11, "tumbling");
  std::vector<Vector3d> translation;
  std::vector<Quaterniond> rotation;
  std::vector<double> bones = skeleton->RestBoneLengths();
  for (double& bone : bones) bone *= random.Uniform(0.8, 1.2);
  for (int f = 0; f < frames; ++f) {
    translation.emplace_back(random.Normal(), random.Normal(), random.Normal());
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      rotation.push_back(ExpQuaternion(Vector3d(random.Normal(), random.Normal(), random.Normal())));
    }
  }
  Clip clip;
  clip.identity = {"set", "person", "take", "", "", "", 0, frames};
  clip.label = "tumble";
  clip.motion = MakeMotion(skeleton, FrameRate{30, 1}, translation, rotation, bones);
  return clip;
}

const NpyArray& Get(const Npz& npz, const char* name) {
  const NpyArray* array = npz.Find(name);
  EXPECT_NE(array, nullptr) << name;
  static const NpyArray kNone;
  return array == nullptr ? kNone : *array;
}

Vector3d At(const NpyArray& array, std::size_t index) {
  return {array.values[3 * index], array.values[3 * index + 1], array.values[3 * index + 2]};
}

/// One rotation of `poses` as a matrix.
Matrix3d Decode(const NpyArray& poses, std::size_t index, RotationArrays as) {
  const std::size_t numbers = poses.values.size() / (poses.shape[0] * poses.shape[1]);
  const double* v = poses.values.data() + numbers * index;
  switch (as) {
    case RotationArrays::kQuaternion:
      return Quaterniond(v[0], v[1], v[2], v[3]).toRotationMatrix();
    case RotationArrays::kAxisAngle:
      return ExpMatrix({v[0], v[1], v[2]});
    case RotationArrays::kMatrix:
      return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v);
    default:
      return MatrixFrom6D({v[0], v[1], v[2], v[3], v[4], v[5]},
                          as == RotationArrays::k6dRows ? Rotation6D::kRows : Rotation6D::kColumns);
  }
}

class EveryRepresentation : public testing::TestWithParam<RotationArraysName> {};

INSTANTIATE_TEST_SUITE_P(MotionArrays, EveryRepresentation, testing::ValuesIn(kRotationArraysNames),
                         [](const auto& named) { return "As_" + std::string(named.param.name); });

/// From the arrays alone, through a file: parents, rest offsets and rotations give the joints.
TEST_P(EveryRepresentation, GivesTheJointsBack) {
  for (const char* skeleton : {"smpl24", "humanact12", "ntu18"}) {
    const Clip clip = Tumbling(skeleton);
    const auto made = ArraysOfMotion(clip, GetParam().value);
    ASSERT_TRUE(made.has_value()) << made.error().Message();
    const auto bytes = EncodeNpz(*made, "clip");
    ASSERT_TRUE(bytes.has_value()) << bytes.error().Message();
    const auto arrays = ParseNpz(*bytes, "clip");
    ASSERT_TRUE(arrays.has_value()) << arrays.error().Message();
    EXPECT_EQ(Get(*arrays, "representation").texts.at(0), GetParam().name);
    const NpyArray& joints = Get(*arrays, "joints");
    EXPECT_EQ(joints.values, clip.motion->joints.xyz);
    if (GetParam().value == RotationArrays::kNone) {
      EXPECT_EQ(arrays->Find("poses"), nullptr);
      continue;
    }
    const NpyArray& parents = Get(*arrays, "parents");
    const NpyArray& offsets = Get(*arrays, "rest_offset");
    const bool lie = GetParam().value == RotationArrays::kLie;
    const NpyArray& rotations = Get(*arrays, lie ? "lie" : "poses");
    const std::size_t count = parents.values.size();
    for (std::size_t f = 0; f < 7; ++f) {
      std::vector<Matrix3d> global(count, Matrix3d::Identity());
      std::vector<Vector3d> position(count);
      for (std::size_t j = 0; j < count; ++j) {
        const std::size_t at = f * count + j;
        if (parents.values[j] < 0) {
          position[j] = lie ? At(rotations, at) : At(Get(*arrays, "trans"), f);
          if (!lie) global[j] = Decode(rotations, at, GetParam().value);
        } else if (lie) {
          const auto parent = static_cast<std::size_t>(parents.values[j]);
          const NpyArray& chain = Get(*arrays, "lie_chain");
          const bool begins = chain.values[j] != chain.values[parent];
          global[j] = (begins ? Matrix3d::Identity() : global[parent]) * ExpMatrix(At(rotations, at));
          position[j] = position[parent] + global[j] * At(offsets, j);
        } else {
          const auto parent = static_cast<std::size_t>(parents.values[j]);
          position[j] = position[parent] + global[parent] * At(offsets, j);
          global[j] = global[parent] * Decode(rotations, at, GetParam().value);
        }
        EXPECT_LT((position[j] - At(joints, at)).norm(), 1e-9) << skeleton << ", joint " << j;
      }
    }
  }
}

TEST(MotionArrays, HoldsWhatTheClipStatesOfItsQuality) {
  Clip clip = Tumbling("smpl24");
  const std::size_t samples = clip.motion->joints.xyz.size() / 3;
  clip.motion->state.assign(samples, JointState::kInferred);
  clip.motion->position_cov.assign(6 * samples, 0.25F);
  clip.motion->contact.assign(14, 1);
  const auto arrays = ArraysOfMotion(clip, RotationArrays::kAxisAngle);
  ASSERT_TRUE(arrays.has_value());
  EXPECT_EQ(Get(*arrays, "state").shape, (std::vector<std::size_t>{7, 24}));
  EXPECT_EQ(Get(*arrays, "state").values[5], 3.0);
  EXPECT_EQ(Get(*arrays, "position_cov").shape, (std::vector<std::size_t>{7, 24, 6}));
  EXPECT_EQ(Get(*arrays, "contact").shape, (std::vector<std::size_t>{7, 2}));
  EXPECT_EQ(arrays->Find("rotation_sigma"), nullptr);
  EXPECT_EQ(Get(*arrays, "clip").texts.at(0), "set/person/take#0-7");
  EXPECT_EQ(Get(*arrays, "label").texts.at(0), "tumble");
}

TEST(MotionArrays, RotationsAreNeverInvented) {
  Clip clip = Tumbling("smpl24");
  clip.motion = MakeJointsOnly(clip.motion->skeleton, clip.motion->rate, clip.motion->joints);
  const auto refused = ArraysOfMotion(clip, RotationArrays::kAxisAngle);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kInconsistent);
  EXPECT_TRUE(ArraysOfMotion(clip, RotationArrays::kNone).has_value());
}

TEST(MotionArrays, ASkeletonWithoutLieChainsHasNoLieParameters) {
  const auto refused = ArraysOfMotion(Tumbling("cmu31"), RotationArrays::kLie);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace mocurate
