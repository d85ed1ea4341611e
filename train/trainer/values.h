#pragma once

#include <torch/torch.h>

#include <string>

#include "train/checkpoint/parameters.h"

namespace mocurate {

/// Between tensors and the arrays of checkpoints: float32, row-major, copied.
torch::Tensor TensorOf(const Parameter& parameter);
Parameter ParameterOf(const std::string& name, const torch::Tensor& tensor);

/// The parameter of that name. Error kInconsistent where it is missing or has another shape.
Expected<const Parameter*> FindOfShape(const ParameterList& list, const std::string& name, at::IntArrayRef shape,
                                       const std::string& where);

/// Parameters and buffers of a network by name.
ParameterList ValuesOf(const torch::nn::Module& network);
/// Replaces them. Error kInconsistent naming the first that is missing or has another shape.
Status SetValues(const ParameterList& values, const std::string& where, torch::nn::Module& network);

}  // namespace mocurate
