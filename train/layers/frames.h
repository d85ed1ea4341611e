#pragma once

#include <torch/torch.h>

namespace mocurate {

/// (L,B,W) -> (count,B,W): row at(t,b) of motion b. `at` (count,B) int64.
torch::Tensor RowsAt(const torch::Tensor& rows, const torch::Tensor& at);

/// Of motions [previous action, transition, action] with `parts` (B,3) frames: the part 0, 1, 2 in which each of the
/// first `frames` frames lies, 3 behind them. (frames,B) int64
torch::Tensor PartOf(const torch::Tensor& parts, std::int64_t frames);

/// A convolution over frames without padding: `x` (T+K-1,B,I), `weight` (O,K I) tap by tap, `bias` (O). (T,B,O)
/// libtorch 1.13's convolutions give wrong gradients of some narrow weights; this one is a linear layer.
torch::Tensor ConvolveTaps(const torch::Tensor& x, const torch::Tensor& weight, const torch::Tensor& bias);

}  // namespace mocurate
