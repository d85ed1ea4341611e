#pragma once

#include <torch/torch.h>

#include <vector>

namespace mocurate {

/// Forward kinematics of N poses of a tree as one differentiable function of float32 numbers on the CPU, with its own
/// backward pass. `parents` (J), -1 for the root, each below its child; `rotation` (N,J,3,3) parent_from_joint;
/// `offsets` (J,3) or (N,J,3) in the parent's frame. Returns world_from_joint (N,J,3,3) and joints (N,J,3), the root
/// at the origin.
torch::autograd::variable_list TreeKinematics(const std::vector<int>& parents, const torch::Tensor& rotation,
                                              const torch::Tensor& offsets);

/// The same in plain tensor operations: the reference of TreeKinematics, and what other devices run.
torch::autograd::variable_list PlainTreeKinematics(const std::vector<int>& parents, const torch::Tensor& rotation,
                                                   const torch::Tensor& offsets);

}  // namespace mocurate
