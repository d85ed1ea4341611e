#pragma once

#include <torch/torch.h>

#include "train/layers/lie_kinematics.h"

namespace mocurate {

/// Largest component of a decoded rotation vector, as the released code writes pi.
inline constexpr double kReleasedPi = 3.1415926;

/// Joints of Lie parameters by `layer`, which must outlive the backward pass: (N,3J) and bone lengths (N,J) -> (N,3J).
/// On the CPU with the derivative of LieLayer.
torch::Tensor LieJoints(const LieLayer& layer, const torch::Tensor& parameters, const torch::Tensor& bone_length);

/// The same in plain tensor operations: the reference of LieJoints, and what other devices run.
torch::Tensor PlainLieJoints(const LieLayer& layer, const torch::Tensor& parameters, const torch::Tensor& bone_length);

/// Lengths of the bones along the chains: joints (...,3J) -> (...,J), 0 for the root.
torch::Tensor LieBoneLengths(const LieLayer& layer, const torch::Tensor& joints);

}  // namespace mocurate
