#include "train/recognisers/tensors.h"

namespace mocurate {

torch::Tensor View(const std::vector<float>& values, std::vector<std::int64_t> shape) {
  return torch::from_blob(const_cast<float*>(values.data()), shape, torch::kFloat32);
}

std::vector<float> Numbers(const torch::Tensor& tensor) {
  const torch::Tensor dense = tensor.detach().contiguous();
  return std::vector<float>(dense.data_ptr<float>(), dense.data_ptr<float>() + dense.numel());
}

Weights MakeWeights(const ParameterList& parameters, bool learn) {
  Weights weights;
  for (const Parameter& parameter : parameters) {
    weights[parameter.name] = View(parameter.value, parameter.shape).set_requires_grad(learn);
  }
  return weights;
}

}  // namespace mocurate
