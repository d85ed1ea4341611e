#pragma once

namespace mocurate {

/// One step of a GRU cell for `batch` rows after its matrix products, PyTorch's gates (r, z, n): h = n + z (h_before -
/// n).
struct GruGateInput {
  const float* reset_update;     ///< (batch, 2H) W_ir x + W_hr h, W_iz x + W_hz h, without biases
  const float* candidate_input;  ///< (batch, H) W_in x
  const float* candidate_state;  ///< (batch, H) W_hn h
  const float* bias;             ///< (4H) b_ir + b_hr, b_iz + b_hz, b_in, b_hn
};

/// Reads and overwrites `state` (rows of H, `state_stride` apart) and writes the new state to `output` as well. The
/// exponential is a polynomial, within 2 units in the last place; compiled for each level of x86-64 vectors.
void GruGates(const GruGateInput& input, int batch, int hidden, float* state, int state_stride, float* output,
              int output_stride);

/// The same where a backward pass follows: `from_input` and `from_state` (batch, 3H) hold W_i x + b_i and W_h h + b_h
/// of r, z and n. Writes r and z (batch, 2H), n (batch, H) and the state after (batch, H) from that before.
void GruForwardGates(const float* from_input, const float* from_state, const float* before, int batch, int hidden,
                     float* reset_update, float* candidate, float* after);

/// The derivative: from the gradient by the state after (batch, H), gradients by `from_input` and `from_state` (batch,
/// 3H), and in place of `by_state` the direct part of the gradient by the state before.
void GruBackwardGates(const float* reset_update, const float* candidate, const float* from_state, const float* before,
                      int batch, int hidden, float* by_state, float* by_from_input, float* by_from_state);

}  // namespace mocurate
