#include "train/trainer/values.h"

namespace mocurate {

using torch::Tensor;

Parameter ParameterOf(const std::string& name, const Tensor& tensor) {
  const Tensor dense = tensor.detach().to(torch::kCPU, torch::kFloat32).contiguous();
  Parameter parameter;
  parameter.name = name;
  parameter.shape.assign(dense.sizes().begin(), dense.sizes().end());
  parameter.value.assign(dense.data_ptr<float>(), dense.data_ptr<float>() + dense.numel());
  return parameter;
}

Tensor TensorOf(const Parameter& parameter) {
  return torch::from_blob(const_cast<float*>(parameter.value.data()), parameter.shape, torch::kFloat32).clone();
}

Expected<const Parameter*> FindOfShape(const ParameterList& list, const std::string& name, at::IntArrayRef shape,
                                       const std::string& where) {
  const int found = FindParameter(list, name);
  if (found < 0) return Fail(ErrorCode::kInconsistent, "parameter '" + name + "' is missing", where);
  const Parameter& parameter = list[static_cast<std::size_t>(found)];
  if (at::IntArrayRef(parameter.shape) == shape) return &parameter;
  return Fail(
      ErrorCode::kInconsistent,
      "parameter '" + name + "' is " + ShapeText(parameter.shape) + ", the network has " + ShapeText(shape.vec()),
      where);
}

ParameterList ValuesOf(const torch::nn::Module& network) {
  ParameterList values;
  for (const auto& named : network.named_parameters()) values.push_back(ParameterOf(named.key(), named.value()));
  for (const auto& named : network.named_buffers()) values.push_back(ParameterOf(named.key(), named.value()));
  return values;
}

Status SetValues(const ParameterList& values, const std::string& where, torch::nn::Module& network) {
  const torch::NoGradGuard no_gradient;
  for (const auto& list : {network.named_parameters(), network.named_buffers()}) {
    for (const auto& named : list) {
      Tensor target = named.value();
      const auto stored = FindOfShape(values, named.key(), target.sizes(), where);
      if (!stored) return Forward(stored);
      target.copy_(TensorOf(**stored));
    }
  }
  return {};
}

}  // namespace mocurate
