#pragma once

#include <torch/torch.h>

#include <map>
#include <string>
#include <vector>

#include "train/checkpoint/parameters.h"

namespace mocurate {

/// Parameters of a network by their names.
using Weights = std::map<std::string, torch::Tensor>;

/// The values themselves, not a copy: they must outlive the tensor.
torch::Tensor View(const std::vector<float>& values, std::vector<std::int64_t> shape);

std::vector<float> Numbers(const torch::Tensor& tensor);

/// Views of the parameters; `learn`: gradients are wanted.
Weights MakeWeights(const ParameterList& parameters, bool learn);

}  // namespace mocurate
