#pragma once

namespace at {
class Tensor;
}

namespace mocurate {

/// One GRU layer over T frames with PyTorch's gates (r, z, n), forward and hand-written backward: the input products of
/// all frames are one product, elementwise work is fused, weight gradients are one product at the end. `input` (T,B,I),
/// `hidden` (B,H), weights (3H,I) and (3H,H), biases (3H), all float32. -> outputs (T,B,H).
at::Tensor GruLayer(const at::Tensor& input, const at::Tensor& hidden, const at::Tensor& input_weight,
                    const at::Tensor& hidden_weight, const at::Tensor& input_bias, const at::Tensor& hidden_bias);

}  // namespace mocurate
