#include "train/layers/body.h"

#include <algorithm>

namespace mocurate {
namespace {

using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

constexpr std::int64_t kFramesAtOnce = 32;  // whose vertices are in memory

Tensor PointsOf(const std::vector<Vector3d>& points) {
  Tensor tensor = torch::empty({static_cast<std::int64_t>(points.size()), 3}, torch::kFloat64);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int k = 0; k < 3; ++k) tensor.data_ptr<double>()[3 * i + static_cast<std::size_t>(k)] = points[i][k];
  }
  return tensor;
}

std::vector<Vector3d> OffsetsOf(const std::vector<Vector3d>& joints, const std::vector<int>& parents) {
  std::vector<Vector3d> offsets(joints.size(), Vector3d::Zero());
  for (std::size_t j = 1; j < joints.size(); ++j) offsets[j] = joints[j] - joints[static_cast<std::size_t>(parents[j])];
  return offsets;
}

/// c += a b of 3 x 3 matrices, row by row.
inline void AddProduct(const float* a, const float* b, float* c) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      c[3 * i + k] += a[3 * i] * b[k] + a[3 * i + 1] * b[3 + k] + a[3 * i + 2] * b[6 + k];
    }
  }
}

/// c += a b^T.
inline void AddProductByTransposed(const float* a, const float* b, float* c) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      c[3 * i + k] += a[3 * i] * b[3 * k] + a[3 * i + 1] * b[3 * k + 1] + a[3 * i + 2] * b[3 * k + 2];
    }
  }
}

/// c += a^T b.
inline void AddTransposedProduct(const float* a, const float* b, float* c) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) c[3 * i + k] += a[i] * b[k] + a[3 + i] * b[3 + k] + a[6 + i] * b[6 + k];
  }
}

/// The numbers of frame `n` of a tensor (N,J,width) or of one for all frames (J,width).
const float* FrameOf(const Tensor& tensor, std::int64_t n, std::int64_t width) {
  return tensor.data_ptr<float>() + (tensor.dim() == 3 ? n * tensor.size(1) * width : 0);
}

struct KinematicsOfTree : torch::autograd::Function<KinematicsOfTree> {
  static variable_list forward(AutogradContext* context, const Tensor& rotation, const Tensor& offsets,
                               const std::vector<std::int64_t>& parents) {
    const std::int64_t N = rotation.size(0), J = rotation.size(1);
    const Tensor own = rotation.contiguous(), along = offsets.contiguous();
    Tensor global = torch::zeros({N, J, 3, 3}), joints = torch::empty({N, J, 3});
    for (std::int64_t n = 0; n < N; ++n) {
      const float* r = own.data_ptr<float>() + 9 * n * J;
      const float* o = FrameOf(along, n, 3);
      float* g = global.data_ptr<float>() + 9 * n * J;
      float* p = joints.data_ptr<float>() + 3 * n * J;
      std::copy_n(r, 9, g);
      std::fill_n(p, 3, 0.0f);
      for (std::int64_t j = 1; j < J; ++j) {
        const std::int64_t parent = parents[static_cast<std::size_t>(j)];
        const float *of_parent = g + 9 * parent, *offset = o + 3 * j;
        AddProduct(of_parent, r + 9 * j, g + 9 * j);
        for (int i = 0; i < 3; ++i) {
          p[3 * j + i] = p[3 * parent + i] + of_parent[3 * i] * offset[0] + of_parent[3 * i + 1] * offset[1] +
                         of_parent[3 * i + 2] * offset[2];
        }
      }
    }
    context->save_for_backward({own, along, global});
    context->saved_data["parents"] = parents;
    context->set_materialize_grads(false);
    return {global, joints};
  }

  static variable_list backward(AutogradContext* context, variable_list gradient) {
    const auto saved = context->get_saved_variables();
    const std::vector<std::int64_t> parents = context->saved_data["parents"].toIntVector();
    const Tensor &own = saved[0], &along = saved[1], &global = saved[2];
    const std::int64_t N = own.size(0), J = own.size(1);
    const bool of_offsets = context->needs_input_grad(1);
    const Tensor given_global = gradient[0].defined() ? gradient[0].contiguous() : Tensor();
    const Tensor given_joints = gradient[1].defined() ? gradient[1].contiguous() : Tensor();
    Tensor by_rotation = torch::zeros_like(own);
    Tensor by_offsets = of_offsets ? torch::zeros_like(along) : Tensor();
    std::vector<float> by_global(static_cast<std::size_t>(9 * J)), by_joint(static_cast<std::size_t>(3 * J));
    for (std::int64_t n = 0; n < N; ++n) {
      const float* r = own.data_ptr<float>() + 9 * n * J;
      const float* g = global.data_ptr<float>() + 9 * n * J;
      const float* o = FrameOf(along, n, 3);
      float* result = by_rotation.data_ptr<float>() + 9 * n * J;
      float *dg = by_global.data(), *dp = by_joint.data();
      const auto take = [n](const Tensor& given, std::int64_t count, float* to) {
        if (given.defined()) {
          std::copy_n(given.data_ptr<float>() + n * count, count, to);
        } else {
          std::fill_n(to, count, 0.0f);
        }
      };
      take(given_global, 9 * J, dg);
      take(given_joints, 3 * J, dp);
      for (std::int64_t j = J - 1; j > 0; --j) {
        const std::int64_t parent = parents[static_cast<std::size_t>(j)];
        const float *offset = o + 3 * j, *of_parent = g + 9 * parent;
        float *up = dg + 9 * parent, *place = dp + 3 * j;
        AddProductByTransposed(dg + 9 * j, r + 9 * j, up);
        AddTransposedProduct(of_parent, dg + 9 * j, result + 9 * j);
        for (int i = 0; i < 3; ++i) {
          dp[3 * parent + i] += place[i];
          for (int k = 0; k < 3; ++k) up[3 * i + k] += place[i] * offset[k];
        }
        if (!of_offsets) continue;
        float* by_offset = by_offsets.data_ptr<float>() + (along.dim() == 3 ? 3 * n * J : 0) + 3 * j;
        for (int k = 0; k < 3; ++k) {
          by_offset[k] += of_parent[k] * place[0] + of_parent[3 + k] * place[1] + of_parent[6 + k] * place[2];
        }
      }
      std::copy_n(dg, 9, result);
    }
    return {by_rotation, by_offsets, Tensor()};
  }
};

/// A scalar whose gradient by its inputs is known already.
struct PrecomputedGradient : torch::autograd::Function<PrecomputedGradient> {
  static Tensor forward(AutogradContext* context, const Tensor& rotation, const Tensor& translation,
                        const Tensor& value, const Tensor& by_rotation, const Tensor& by_translation) {
    (void)rotation, (void)translation;
    context->save_for_backward({by_rotation, by_translation});
    return value.clone();
  }
  static variable_list backward(AutogradContext* context, variable_list gradient) {
    const auto saved = context->get_saved_variables();
    const Tensor by_translation = saved[1].defined() ? saved[1] * gradient[0] : Tensor();
    return {saved[0] * gradient[0], by_translation, Tensor(), Tensor(), Tensor()};
  }
};

}  // namespace

variable_list TreeKinematics(const std::vector<int>& parents, const Tensor& rotation, const Tensor& offsets) {
  if (!rotation.device().is_cpu() || rotation.scalar_type() != torch::kFloat32) {
    return PlainTreeKinematics(parents, rotation, offsets);
  }
  return KinematicsOfTree::apply(rotation, offsets, std::vector<std::int64_t>(parents.begin(), parents.end()));
}

variable_list PlainTreeKinematics(const std::vector<int>& parents, const Tensor& rotation, const Tensor& offsets) {
  const std::size_t J = parents.size();
  std::vector<Tensor> global(J), place(J);
  global[0] = rotation.select(1, 0);
  place[0] = torch::zeros({rotation.size(0), 3}, rotation.options());
  for (std::size_t j = 1; j < J; ++j) {
    const auto parent = static_cast<std::size_t>(parents[j]);
    const auto joint = static_cast<std::int64_t>(j);
    global[j] = torch::bmm(global[parent], rotation.select(1, joint));
    place[j] = place[parent] + torch::matmul(global[parent], offsets.select(-2, joint).unsqueeze(-1)).squeeze(-1);
  }
  return {torch::stack(global, 1), torch::stack(place, 1)};
}

BodyTree::BodyTree(std::vector<int> parents, const std::vector<Vector3d>& rest_offset)
    : parents_(std::move(parents)), rest_offset_(PointsOf(rest_offset).to(torch::kFloat32)) {}

BodyTree::Posed BodyTree::Pose(const Tensor& rotation, const Tensor& offsets) const {
  const Tensor along = offsets.defined() ? offsets : rest_offset_.to(rotation.device());
  const auto posed = TreeKinematics(parents_, rotation, along);
  return {posed[0], posed[1]};
}

Tensor BodyTree::JointsOfBones(const Tensor& rotation, const Tensor& place, const Tensor& bone_length) const {
  const std::int64_t T = rotation.size(0), B = rotation.size(1), J = joint_count();
  const Tensor rest = rest_offset_.to(rotation.device());                           // (J,3)
  const Tensor scale = bone_length / rest.norm(2, 1).clamp_min(1e-9).unsqueeze(0);  // (B,J)
  const Tensor offsets = (scale.unsqueeze(2) * rest.unsqueeze(0)).unsqueeze(0).expand({T, B, J, 3});
  const Tensor joints =
      Pose(rotation.reshape({T * B, J, 3, 3}), offsets.reshape({T * B, J, 3})).joints.view({T, B, J, 3});
  return (place.defined() ? joints + place.unsqueeze(2) : joints).reshape({T, B, 3 * J});
}

SkinnedBody::SkinnedBody(const Skin& skin, const std::vector<int>& parents)
    : tree_(parents, OffsetsOf(skin.joints, parents)), vertex_count_(static_cast<std::int64_t>(skin.vertices.size())) {
  const std::int64_t V = vertex_count_, J = tree_.joint_count();
  const Tensor vertices = PointsOf(skin.vertices), joints = PointsOf(skin.joints);
  const Tensor weights = torch::from_blob(const_cast<double*>(skin.weights.data()), {V, J}, torch::kFloat64).clone();
  root_ = joints[0].to(torch::kFloat32);
  vertices_ = vertices.to(torch::kFloat32);
  joints_ = joints.to(torch::kFloat32);
  weights_ = weights.to(torch::kFloat32);
  if (!skin.pose_blending.empty()) {
    blending_ = torch::from_blob(const_cast<double*>(skin.pose_blending.data()), {3 * V, 9 * (J - 1)}, torch::kFloat64)
                    .to(torch::kFloat32);
    return;
  }
  // Row v: for each joint w_j (v - J_j) and w_j, by which its transform's columns count.
  const Tensor from_joint = vertices.unsqueeze(1) - joints.unsqueeze(0);  // (V,J,3)
  const Tensor rows =
      (torch::cat({from_joint, torch::ones({V, J, 1}, torch::kFloat64)}, 2) * weights.unsqueeze(2)).view({V, 4 * J});
  gram_ = torch::mm(rows.t(), rows).to(torch::kFloat32);
}

Tensor SkinnedBody::Vertices(const Tensor& rotation) const {
  const std::int64_t N = rotation.size(0), V = vertex_count_, J = tree_.joint_count();
  const BodyTree::Posed posed = tree_.Pose(rotation);
  const torch::Device device = rotation.device();
  const Tensor weights = weights_.to(device);
  Tensor rest = vertices_.to(device).unsqueeze(0).expand({N, V, 3});
  if (blending_.defined()) {
    const Tensor away = (rotation.slice(1, 1) - torch::eye(3, rotation.options())).reshape({N, 9 * (J - 1)});
    rest = rest + torch::mm(away, blending_.to(device).t()).view({N, V, 3});
  }
  // v' = (sum of w_j G_j) v + sum of w_j (p_j - G_j J_j)
  const Tensor shift =
      posed.joints - torch::matmul(posed.rotation, joints_.to(device).unsqueeze(2)).squeeze(3);  // (N,J,3)
  const Tensor turning = torch::matmul(weights, posed.rotation.reshape({N, J, 9})).view({N, V, 3, 3});
  return torch::matmul(turning, rest.unsqueeze(3)).squeeze(3) + torch::matmul(weights, shift) + root_.to(device);
}

Tensor SkinnedBody::SquaredDistance(const Tensor& rotation, const Tensor& other, const Tensor& translation) const {
  if (blending_.defined()) return ByVertices(rotation, other, translation);
  const std::int64_t N = rotation.size(0), J = tree_.joint_count();
  const BodyTree::Posed a = tree_.Pose(rotation), b = tree_.Pose(other);
  Tensor apart = a.joints - b.joints;  // (N,J,3)
  if (translation.defined()) apart = apart + translation.unsqueeze(1);
  const Tensor columns = torch::cat({a.rotation - b.rotation, apart.unsqueeze(3)}, 3);  // (N,J,3,4)
  const Tensor rows = columns.permute({0, 2, 1, 3}).reshape({3 * N, 4 * J});            // of x, y, z
  return (torch::mm(rows, gram_.to(rows.device())) * rows).sum();
}

Tensor SkinnedBody::ByVertices(const Tensor& rotation, const Tensor& other, const Tensor& translation) const {
  const bool differentiable = torch::GradMode::is_enabled() && rotation.requires_grad();
  const std::int64_t N = rotation.size(0);
  Tensor value = torch::zeros({}, rotation.options()), by_rotation = torch::zeros_like(rotation);
  Tensor by_translation = translation.defined() ? torch::zeros_like(translation) : Tensor();
  for (std::int64_t begin = 0; begin < N; begin += kFramesAtOnce) {
    const std::int64_t end = std::min(N, begin + kFramesAtOnce);
    const auto part = [&](const Tensor& x) { return x.detach().slice(0, begin, end); };
    const Tensor own = part(rotation).clone().requires_grad_(differentiable);
    const Tensor moved = translation.defined() ? part(translation).clone().requires_grad_(differentiable) : Tensor();
    Tensor apart = Vertices(own) - Vertices(part(other));
    if (moved.defined()) apart = apart + moved.unsqueeze(1);
    const Tensor sum = apart.square().sum();
    value += sum.detach();
    if (!differentiable) continue;
    const auto gradient =
        torch::autograd::grad({sum}, moved.defined() ? variable_list{own, moved} : variable_list{own});
    by_rotation.slice(0, begin, end).copy_(gradient[0]);
    if (moved.defined()) by_translation.slice(0, begin, end).copy_(gradient[1]);
  }
  return differentiable ? PrecomputedGradient::apply(rotation, translation, value, by_rotation, by_translation) : value;
}

}  // namespace mocurate
