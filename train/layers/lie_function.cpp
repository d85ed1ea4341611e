#include "train/layers/lie_function.h"

namespace mocurate {
namespace {

using torch::Tensor;

struct Kinematics : torch::autograd::Function<Kinematics> {
  static Tensor forward(torch::autograd::AutogradContext* context, const Tensor& parameters, const Tensor& bone_length,
                        std::int64_t layer) {
    const Tensor dense = parameters.contiguous(), lengths = bone_length.contiguous();
    context->save_for_backward({dense, lengths});
    context->saved_data["layer"] = layer;
    Tensor joints = torch::empty_like(dense);
    reinterpret_cast<const LieLayer*>(layer)->Forward(dense.data_ptr<float>(), lengths.data_ptr<float>(),
                                                      static_cast<int>(dense.size(0)), joints.data_ptr<float>());
    return joints;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 torch::autograd::variable_list gradient) {
    const auto saved = context->get_saved_variables();
    const auto* layer = reinterpret_cast<const LieLayer*>(context->saved_data["layer"].toInt());
    const Tensor by_joints = gradient[0].contiguous();
    Tensor by_parameters = torch::empty_like(saved[0]);
    layer->Backward(saved[0].data_ptr<float>(), saved[1].data_ptr<float>(), by_joints.data_ptr<float>(),
                    static_cast<int>(by_joints.size(0)), by_parameters.data_ptr<float>());
    return {by_parameters, Tensor(), Tensor()};
  }
};

/// Rotation vectors (N,3) -> (N,3,3) by Rodrigues' formula, the squared angle at least `floor`.
Tensor Rotations(const Tensor& w, double floor) {
  const Tensor square = w.square().sum(1, true).clamp_min(floor).unsqueeze(2);  // (N,1,1)
  const Tensor angle = square.sqrt();
  const Tensor zero = torch::zeros_like(w.select(1, 0));
  const Tensor x = w.select(1, 0), y = w.select(1, 1), z = w.select(1, 2);
  const Tensor skew = torch::stack({zero, -z, y, z, zero, -x, -y, x, zero}, 1).view({-1, 3, 3});
  return torch::eye(3, w.options()) + angle.sin() / angle * skew +
         (1.0 - angle.cos()) / square * torch::bmm(skew, skew);
}

}  // namespace

Tensor LieJoints(const LieLayer& layer, const Tensor& parameters, const Tensor& bone_length) {
  if (!parameters.device().is_cpu()) return PlainLieJoints(layer, parameters, bone_length);
  return Kinematics::apply(parameters, bone_length, static_cast<std::int64_t>(reinterpret_cast<std::intptr_t>(&layer)));
}

Tensor PlainLieJoints(const LieLayer& layer, const Tensor& parameters, const Tensor& bone_length) {
  const std::int64_t J = layer.joint_count();
  const Tensor w = parameters.view({-1, J, 3});
  std::vector<Tensor> joints(static_cast<std::size_t>(J));
  joints[0] = w.select(1, 0);
  Tensor rotation;  // (N,3,3)
  for (const LieLayer::Bone& bone : layer.bones()) {
    const Tensor own = Rotations(w.select(1, bone.joint), layer.floor());
    rotation = bone.starts_chain ? own : torch::bmm(rotation, own);
    const Tensor offset = torch::tensor({bone.offset[0], bone.offset[1], bone.offset[2]}, w.options());
    const Tensor along = torch::matmul(rotation, offset);  // (N,3)
    joints[static_cast<std::size_t>(bone.joint)] =
        bone_length.select(1, bone.joint).unsqueeze(1) * along + joints[static_cast<std::size_t>(bone.parent)];
  }
  return torch::stack(joints, 1).view({-1, 3 * J});
}

Tensor LieBoneLengths(const LieLayer& layer, const Tensor& joints) {
  const std::int64_t J = layer.joint_count();
  const Tensor positions = joints.view({-1, J, 3});
  const std::vector<std::int64_t> parents(layer.parents().begin(), layer.parents().end());
  const Tensor parent = torch::tensor(parents, torch::TensorOptions().dtype(torch::kInt64).device(joints.device()));
  const Tensor lengths = (positions - positions.index_select(1, parent)).square().sum(2).sqrt();
  std::vector<std::int64_t> shape(joints.sizes().begin(), joints.sizes().end());
  shape.back() = J;
  return lengths.view(shape);
}

}  // namespace mocurate
