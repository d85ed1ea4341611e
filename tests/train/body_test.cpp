// The skinned body of losses: equal to core/body, exact as a quadratic form, its slopes those of finite differences.

#include "train/layers/body.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/formats/smpl_model.h"
#include "core/motion/kinematics.h"
#include "core/store/body_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/smpl_model_writer.h"
#include "train/layers/dropout.h"
#include "train/layers/rotations.h"

namespace mocurate {
namespace {

constexpr int kJoints = 6;

std::vector<int> TreeOfSix() { return {-1, 0, 1, 0, 3, 3}; }

Skeleton SkeletonOfSix() {
  Skeleton skeleton;
  Random random(3, "body.skeleton");
  for (int j = 0; j < kJoints; ++j) {
    Joint joint;
    joint.name = "j" + std::to_string(j);
    joint.parent = TreeOfSix()[static_cast<std::size_t>(j)];
    joint.mirror = j;
    if (j > 0) joint.rest_offset = Vector3d(random.Normal(), random.Normal(), random.Normal()) * 0.3;
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

/// A body of 40 vertices; with pose-dependent offsets where asked for.
Skin SkinOfSix(bool blends) {
  Skin skin;
  Random random(4, "body.skin");
  const Skeleton skeleton = SkeletonOfSix();
  for (int j = 0; j < kJoints; ++j) {
    const int parent = skeleton.joints[static_cast<std::size_t>(j)].parent;
    skin.joints.push_back(skeleton.joints[static_cast<std::size_t>(j)].rest_offset +
                          (parent < 0 ? Vector3d(0.1, 1.0, 0.0) : skin.joints[static_cast<std::size_t>(parent)]));
  }
  for (int v = 0; v < 40; ++v) {
    skin.vertices.emplace_back(random.Normal(), random.Normal() + 1.0, random.Normal());
    double sum = 0.0;
    for (int j = 0; j < kJoints; ++j) {
      skin.weights.push_back(random.Uniform() < 0.5 ? 0.0 : random.Uniform());
      sum += skin.weights.back();
    }
    skin.weights[skin.weights.size() - kJoints] += 0.1;
    for (int j = 0; j < kJoints; ++j)
      skin.weights[skin.weights.size() - kJoints + static_cast<std::size_t>(j)] /= sum + 0.1;
  }
  for (int i = 0; blends && i < 3 * 40 * 9 * (kJoints - 1); ++i) skin.pose_blending.push_back(0.01 * random.Normal());
  return skin;
}

torch::Tensor RandomRotations(int frames, int joints, double angle, int seed) {
  torch::manual_seed(static_cast<std::uint64_t>(seed));
  return MatricesOf(torch::randn({frames, joints, 3}) * angle, PoseChoice::kAxisAngle);
}

Quaterniond QuaternionOf(const torch::Tensor& matrix) {
  const torch::Tensor dense = matrix.contiguous();
  const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> map(dense.data_ptr<float>());
  return Quaterniond(Matrix3d(map.cast<double>()));
}

TEST(BodyLayer, KinematicsEqualThoseInDouble) {
  const Skeleton skeleton = SkeletonOfSix();
  std::vector<Vector3d> offsets;
  for (const Joint& joint : skeleton.joints) offsets.push_back(joint.rest_offset);
  const torch::Tensor rotation = RandomRotations(7, kJoints, 1.0, 1);
  const torch::Tensor joints = BodyTree(TreeOfSix(), offsets).Pose(rotation).joints;
  for (int f = 0; f < 7; ++f) {
    std::vector<Quaterniond> local;
    for (int j = 0; j < kJoints; ++j) local.push_back(QuaternionOf(rotation[f][j]));
    std::vector<Vector3d> want(kJoints);
    ForwardKinematics(skeleton, Vector3d::Zero(), local.data(), {}, want.data());
    for (int j = 0; j < kJoints; ++j) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(joints[f][j][k].item<float>(), want[static_cast<std::size_t>(j)][k], 1e-5);
      }
    }
  }
}

class SkinnedLoss : public testing::TestWithParam<bool> {};

TEST_P(SkinnedLoss, IsTheSumOverVertices) {
  const SkinnedBody body(SkinOfSix(GetParam()), TreeOfSix());
  const torch::Tensor a = RandomRotations(70, kJoints, 0.5, 2), b = RandomRotations(70, kJoints, 0.5, 3);
  const torch::Tensor moved = torch::randn({70, 3}) * 0.1;
  const torch::Tensor apart = body.Vertices(a) - body.Vertices(b);
  const double still = apart.square().sum().item<double>();
  const double want = (apart + moved.unsqueeze(1)).square().sum().item<double>();
  EXPECT_NEAR(body.SquaredDistance(a, b, moved).item<double>(), want, 1e-4 * want);
  EXPECT_NEAR(body.SquaredDistance(a, b, {}).item<double>(), still, 1e-4 * still);
}

TEST_P(SkinnedLoss, HasTheSlopesOfFiniteDifferences) {
  const SkinnedBody body(SkinOfSix(GetParam()), TreeOfSix());
  torch::manual_seed(11);
  const torch::Tensor numbers = (torch::randn({3, kJoints, 6}) + 0.2).requires_grad_();
  const torch::Tensor other = RandomRotations(3, kJoints, 0.5, 5);
  const torch::Tensor moved = (torch::randn({3, 3}) * 0.1).requires_grad_();
  const auto loss = [&](const torch::Tensor& x, const torch::Tensor& place) {
    return body.SquaredDistance(MatricesOf(x, PoseChoice::kRotation6D), other, place);
  };
  const auto gradient = torch::autograd::grad({loss(numbers, moved)}, {numbers, moved});
  const torch::Tensor direction = torch::randn_like(numbers), beside = torch::randn_like(moved);
  constexpr double kStep = 3e-3;
  const torch::NoGradGuard no_gradient;
  const double slope = (loss(numbers + kStep * direction, moved + kStep * beside) -
                        loss(numbers - kStep * direction, moved - kStep * beside))
                           .item<double>() /
                       (2.0 * kStep);
  const double want = ((gradient[0] * direction).sum() + (gradient[1] * beside).sum()).item<double>();
  EXPECT_NEAR(slope, want, 1e-2 * std::fabs(want));
}

INSTANTIATE_TEST_SUITE_P(Bodies, SkinnedLoss, testing::Bool());

TEST(BodyLayer, TheRecordedBodyIsThatOfCoreBody) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const std::filesystem::path file = std::filesystem::path(data) / "body_cc0/body_cc0.h5";
  const auto skeleton = LoadSkeleton("smpl24");
  ASSERT_TRUE(skeleton) << skeleton.error().Message();
  const auto skin = ReadSkin(file, **skeleton);
  ASSERT_TRUE(skin) << skin.error().Message();
  const auto body = ReadBodyTemplate(file);
  ASSERT_TRUE(body);
  std::vector<int> parents;
  for (const Joint& joint : (*skeleton)->joints) parents.push_back(joint.parent);
  const torch::Tensor rotation = RandomRotations(1, 24, 0.6, 7);
  std::vector<Quaterniond> local;
  for (int j = 0; j < 24; ++j) local.push_back(QuaternionOf(rotation[0][j]));
  const RestBody posed = Posed(*body, body->rest, local, Vector3d::Zero());
  const torch::Tensor vertices = SkinnedBody(*skin, parents).Vertices(rotation)[0];
  double worst = 0.0;
  for (std::size_t v = 0; v < posed.vertices.size(); ++v) {
    for (int k = 0; k < 3; ++k) {
      worst = std::max(worst, std::fabs(vertices.data_ptr<float>()[3 * v + static_cast<std::size_t>(k)] -
                                        (posed.vertices[v][k] - posed.joints[0][k] + body->rest.joints[0][k])));
    }
  }
  EXPECT_LT(worst, 1e-5);
  const Vector3d root(0.3, 1.1, -2.0);
  const std::vector<Vector3d> skinned = PosedVertices(*skin, **skeleton, local.data(), root);
  for (std::size_t v = 0; v < skinned.size(); v += 97) {
    EXPECT_LT((skinned[v] - (posed.vertices[v] - posed.joints[0] + root)).norm(), 1e-6) << "weights are float32";
  }
  const auto other = LoadSkeleton("openni16");
  ASSERT_TRUE(other);
  EXPECT_EQ(ReadSkin(file, **other).error().code, ErrorCode::kInconsistent);
}

/// A body in SMPL's layout over smpl24: two vertices beside each joint, shapes and pose-dependent offsets drawn.
SmplModel ToySmpl(const Skeleton& skeleton) {
  SmplModel model;
  Random random(5, "toy smpl");
  model.joints = skeleton.joints.size();
  model.vertices = 2 * model.joints;
  model.shapes = 3;
  model.pose_columns = 9 * (model.joints - 1);
  std::vector<Vector3d> place(model.joints, Vector3d::Zero());
  model.joint_regressor.assign(model.joints * model.vertices, 0.0);
  model.weights.assign(model.vertices * model.joints, 0.0);
  for (std::size_t j = 0; j < model.joints; ++j) {
    const int parent = skeleton.joints[j].parent;
    model.parents.push_back(parent);
    if (parent >= 0) place[j] = place[static_cast<std::size_t>(parent)] + skeleton.joints[j].rest_offset;
    for (std::size_t side = 0; side < 2; ++side) {
      const Vector3d vertex = place[j] + Vector3d(side == 0 ? 0.05 : -0.05, 0.0, 0.0);
      model.v_template.insert(model.v_template.end(), vertex.data(), vertex.data() + 3);
      model.joint_regressor[j * model.vertices + 2 * j + side] = 0.5;
      const double own = random.Uniform();
      model.weights[(2 * j + side) * model.joints + j] += own;
      model.weights[(2 * j + side) * model.joints + static_cast<std::size_t>(std::max(parent, 0))] += 1.0 - own;
    }
  }
  for (std::size_t i = 0; i < model.vertices * 3 * model.shapes; ++i) model.shapedirs.push_back(0.02 * random.Normal());
  for (std::size_t i = 0; i < model.vertices * 3 * model.pose_columns; ++i) {
    model.posedirs.push_back(0.01 * random.Normal());
  }
  for (std::uint32_t f = 0; f + 2 < model.vertices; ++f) model.faces.insert(model.faces.end(), {f, f + 1, f + 2});
  return model;
}

TEST(BodyLayer, AnSmplFileIsPosedAlikeByBothAndVariesInShape) {
  const auto skeleton = LoadSkeleton("smpl24");
  ASSERT_TRUE(skeleton);
  const SmplModel model = ToySmpl(**skeleton);
  const auto bytes = EncodeSmplModelNpz(model, "toy");
  ASSERT_TRUE(bytes) << bytes.error().Message();
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "SMPL_NEUTRAL.npz", *bytes));
  const auto skin = ReadSkin(folder / "SMPL_NEUTRAL.npz", **skeleton);
  ASSERT_TRUE(skin) << skin.error().Message();
  EXPECT_EQ(skin->name, "SMPL");
  EXPECT_EQ(skin->faces.size(), model.faces.size() / 3);
  ASSERT_EQ(skin->shapes.size(), 3u);
  const std::vector<double> shape = DrawShape(*skin, 1, 1);
  EXPECT_NE(shape, DrawShape(*skin, 1, 2));
  const Skin other = Shaped(*skin, shape);
  for (std::size_t v = 0; v < model.vertices; ++v) {  // v = v_template + sum of b_k shapedirs[:, :, k]
    for (std::size_t k = 0; k < 3; ++k) {
      double want = model.v_template[3 * v + k];
      for (std::size_t s = 0; s < 3; ++s) want += shape[s] * model.shapedirs[(3 * v + k) * 3 + s];
      EXPECT_NEAR(other.vertices[v][static_cast<Eigen::Index>(k)], want, 1e-12);
    }
    const Vector3d middle = 0.5 * (other.vertices[v - v % 2] + other.vertices[v - v % 2 + 1]);
    EXPECT_LT((other.joints[v / 2] - middle).norm(), 1e-12) << "joints are regressed from the shaped vertices";
  }
  std::vector<int> parents;
  for (const Joint& joint : (*skeleton)->joints) parents.push_back(joint.parent);
  const torch::Tensor rotation = RandomRotations(1, 24, 0.6, 7);
  std::vector<Quaterniond> local;
  for (int j = 0; j < 24; ++j) local.push_back(QuaternionOf(rotation[0][j]));
  for (const Skin& body : {*skin, other}) {
    const std::vector<Vector3d> posed = PosedVertices(body, **skeleton, local.data(), body.joints[0]);
    const torch::Tensor vertices = SkinnedBody(body, parents).Vertices(rotation)[0].contiguous();
    for (std::size_t v = 0; v < posed.size(); ++v) {
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(posed[v][static_cast<Eigen::Index>(k)], vertices.data_ptr<float>()[3 * v + k], 1e-5);
      }
    }
  }
  EXPECT_TRUE(IsOfOneGender("SMPL_FEMALE.npz"));
  EXPECT_FALSE(IsOfOneGender(folder / "SMPL_NEUTRAL.npz"));
}

TEST(RotationNumbers, EveryRepresentationComesBack) {
  const torch::Tensor rotation = RandomRotations(20, 4, 2.0, 9);
  for (const PoseChoice pose :
       {PoseChoice::kRotation6D, PoseChoice::kMatrix, PoseChoice::kQuaternion, PoseChoice::kAxisAngle}) {
    EXPECT_LT((MatricesOf(NumbersOf(rotation, pose), pose) - rotation).abs().max().item<double>(), 1e-5);
  }
  const torch::Tensor none = torch::zeros({1, 3}).requires_grad_();
  const auto gradient = torch::autograd::grad({MatricesOf(none, PoseChoice::kAxisAngle).sum()}, {none});
  EXPECT_TRUE(gradient[0].isfinite().all().item<bool>());
}

TEST(DropoutMask, KeepsTheRightPartAndDependsOnStepAndShard) {
  const torch::Tensor ones = torch::ones({1000, 101});
  const auto dropped = [&](std::int64_t step, int shard) {
    const Draws draws(1, step, 0, shard);
    return Dropout(draws, 0.1)(ones);
  };
  const torch::Tensor first = dropped(3, 0);
  EXPECT_NEAR(first.mean().item<double>(), 1.0, 5e-3);
  EXPECT_NEAR((first == 0).to(torch::kFloat64).mean().item<double>(), 0.1, 3e-3);
  EXPECT_TRUE(first.equal(dropped(3, 0)));
  EXPECT_FALSE(first.equal(dropped(4, 0)));
  EXPECT_FALSE(first.equal(dropped(3, 1)));
  // Neighbouring columns are independent: both are dropped in one of a hundred.
  const torch::Tensor zero = (first == 0).to(torch::kFloat64);
  EXPECT_NEAR((zero.slice(1, 1) * zero.slice(1, 0, 100)).mean().item<double>(), 0.01, 1.5e-3);
}

}  // namespace
}  // namespace mocurate
