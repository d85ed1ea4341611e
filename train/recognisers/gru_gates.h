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

}  // namespace mocurate
