#include "train/recognisers/gru_gates.h"

#include <cstdint>
#include <cstring>

#include "train/recognisers/vector_clones.h"

namespace mocurate {
namespace {

/// e^x by reduction to [-ln 2 / 2, ln 2 / 2] and a polynomial of degree 6 (coefficients of Cephes' expf).
inline float ExpPolynomial(float x) {
  constexpr float kLargest = 87.0f;         // e^88 is beyond float32
  constexpr float kRounding = 12582912.0f;  // 1.5 * 2^23: adding it rounds to a whole number
  x = x < -kLargest ? -kLargest : x > kLargest ? kLargest : x;
  const float shifted = x * 1.44269504f + kRounding;
  const float whole = shifted - kRounding;
  const float r = (x - whole * 0.693359375f) + whole * 2.12194440e-4f;
  float p = 1.9875691500e-4f;
  p = p * r + 1.3981999507e-3f;
  p = p * r + 8.3334519073e-3f;
  p = p * r + 4.1665795894e-2f;
  p = p * r + 1.6666665459e-1f;
  p = p * r + 5.0000001201e-1f;
  p = p * r * r + r + 1.0f;
  std::uint32_t bits = 0;
  std::memcpy(&bits, &shifted, sizeof(bits));
  bits = (bits << 23) + 0x3f800000u;  // the low bits of `shifted` hold the exponent
  float power = 0.0f;
  std::memcpy(&power, &bits, sizeof(power));
  return p * power;
}

inline float Sigmoid(float x) { return 1.0f / (1.0f + ExpPolynomial(-x)); }

}  // namespace

MOCURATE_VECTOR_CLONES
void GruGates(const GruGateInput& input, int batch, int hidden, float* state, int state_stride, float* output,
              int output_stride) {
  const float* reset_update = input.reset_update;
  const float* candidate_input = input.candidate_input;
  const float* candidate_state = input.candidate_state;
  const float* bias = input.bias;
  for (int b = 0; b < batch; ++b) {
#pragma GCC ivdep
    for (int k = 0; k < hidden; ++k) {
      const float r = Sigmoid(reset_update[k] + bias[k]);
      const float z = Sigmoid(reset_update[hidden + k] + bias[hidden + k]);
      const float sum = candidate_input[k] + bias[2 * hidden + k] + r * (candidate_state[k] + bias[3 * hidden + k]);
      const float n = 1.0f - 2.0f * Sigmoid(-2.0f * sum);
      const float next = n + z * (state[k] - n);
      state[k] = next;
      output[k] = next;
    }
    reset_update += 2 * hidden;
    candidate_input += hidden;
    candidate_state += hidden;
    state += state_stride;
    output += output_stride;
  }
}

MOCURATE_VECTOR_CLONES
void GruForwardGates(const float* from_input, const float* from_state, const float* before, int batch, int hidden,
                     float* reset_update, float* candidate, float* after) {
  for (int b = 0; b < batch; ++b) {
#pragma GCC ivdep
    for (int k = 0; k < hidden; ++k) {
      const float r = Sigmoid(from_input[k] + from_state[k]);
      const float z = Sigmoid(from_input[hidden + k] + from_state[hidden + k]);
      const float sum = from_input[2 * hidden + k] + r * from_state[2 * hidden + k];
      const float n = 1.0f - 2.0f * Sigmoid(-2.0f * sum);
      reset_update[k] = r;
      reset_update[hidden + k] = z;
      candidate[k] = n;
      after[k] = n + z * (before[k] - n);
    }
    from_input += 3 * hidden;
    from_state += 3 * hidden;
    before += hidden;
    reset_update += 2 * hidden;
    candidate += hidden;
    after += hidden;
  }
}

MOCURATE_VECTOR_CLONES
void GruBackwardGates(const float* reset_update, const float* candidate, const float* from_state, const float* before,
                      int batch, int hidden, float* by_state, float* by_from_input, float* by_from_state) {
  for (int b = 0; b < batch; ++b) {
#pragma GCC ivdep
    for (int k = 0; k < hidden; ++k) {
      const float r = reset_update[k], z = reset_update[hidden + k], n = candidate[k], g = by_state[k];
      const float by_n = g * (1.0f - z) * (1.0f - n * n);
      const float by_r = by_n * from_state[2 * hidden + k] * r * (1.0f - r);
      const float by_z = g * (before[k] - n) * z * (1.0f - z);
      by_from_input[k] = by_r;
      by_from_input[hidden + k] = by_z;
      by_from_input[2 * hidden + k] = by_n;
      by_from_state[k] = by_r;
      by_from_state[hidden + k] = by_z;
      by_from_state[2 * hidden + k] = by_n * r;
      by_state[k] = g * z;
    }
    reset_update += 2 * hidden;
    candidate += hidden;
    from_state += 3 * hidden;
    before += hidden;
    by_state += hidden;
    by_from_input += 3 * hidden;
    by_from_state += 3 * hidden;
  }
}

}  // namespace mocurate
