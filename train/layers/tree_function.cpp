#include "train/layers/tree_function.h"

#include <algorithm>

namespace mocurate {
namespace {

using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

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

}  // namespace mocurate
