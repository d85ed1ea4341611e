#include "train/recognisers/gru_pass.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "train/recognisers/gru_gates.h"

namespace mocurate {
namespace {

const std::vector<float>& Named(const ParameterList& parameters, const std::string& name) {
  return parameters[static_cast<std::size_t>(FindParameter(parameters, name))].value;
}

/// C (rows, columns) = A (rows, depth) B^T, B (columns, depth); leading dimensions of A and C given.
void MultiplyTransposed(const float* a, int lda, const std::vector<float>& b, int rows, int columns, int depth,
                        float* c, int ldc) {
  cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, rows, columns, depth, 1.0f, a, lda, b.data(), depth, 0.0f, c,
              ldc);
}

}  // namespace

ParameterList GruRecogniserParameters(const GruRecogniserConfig& config) {
  ParameterList parameters;
  for (int layer = 0; layer < config.layers; ++layer) {
    const std::string end = "_l" + std::to_string(layer);
    parameters.push_back(
        {"recurrent.weight_ih" + end, {3 * config.hidden, layer == 0 ? config.input : config.hidden}, {}});
    parameters.push_back({"recurrent.weight_hh" + end, {3 * config.hidden, config.hidden}, {}});
    parameters.push_back({"recurrent.bias_ih" + end, {3 * config.hidden}, {}});
    parameters.push_back({"recurrent.bias_hh" + end, {3 * config.hidden}, {}});
  }
  parameters.push_back({"linear1.weight", {config.features, config.hidden}, {}});
  parameters.push_back({"linear1.bias", {config.features}, {}});
  parameters.push_back({"linear2.weight", {config.classes, config.features}, {}});
  parameters.push_back({"linear2.bias", {config.classes}, {}});
  return parameters;
}

GruPass::GruPass(const GruRecogniserConfig& config, const ParameterList& parameters) : config_(config) {
  const int H = config.hidden;
  for (int l = 0; l < config.layers; ++l) {
    const std::string end = "_l" + std::to_string(l);
    const std::vector<float>& input_weight = Named(parameters, "recurrent.weight_ih" + end);
    const std::vector<float>& state_weight = Named(parameters, "recurrent.weight_hh" + end);
    const std::vector<float>& input_bias = Named(parameters, "recurrent.bias_ih" + end);
    const std::vector<float>& state_bias = Named(parameters, "recurrent.bias_hh" + end);
    Layer layer;
    layer.input = l == 0 ? config.input : H;
    for (int row = 0; row < 2 * H; ++row) {
      const auto of_input = input_weight.begin() + static_cast<std::ptrdiff_t>(row) * layer.input;
      const auto of_state = state_weight.begin() + static_cast<std::ptrdiff_t>(row) * H;
      layer.reset_update.insert(layer.reset_update.end(), of_input, of_input + layer.input);
      layer.reset_update.insert(layer.reset_update.end(), of_state, of_state + H);
    }
    layer.candidate_input.assign(input_weight.begin() + static_cast<std::ptrdiff_t>(2) * H * layer.input,
                                 input_weight.end());
    layer.candidate_state.assign(state_weight.begin() + static_cast<std::ptrdiff_t>(2) * H * H, state_weight.end());
    for (int k = 0; k < 2 * H; ++k) layer.bias.push_back(input_bias[k] + state_bias[k]);
    layer.bias.insert(layer.bias.end(), input_bias.begin() + 2 * H, input_bias.end());
    layer.bias.insert(layer.bias.end(), state_bias.begin() + 2 * H, state_bias.end());
    layers_.push_back(std::move(layer));
  }
  linear1_ = Named(parameters, "linear1.weight");
  bias1_ = Named(parameters, "linear1.bias");
  linear2_ = Named(parameters, "linear2.weight");
  bias2_ = Named(parameters, "linear2.bias");
}

void GruPass::Run(const float* motions, int count, int frames, const std::vector<int>& read_out, const float* hidden,
                  float* features, float* logits) const {
  const int B = count, H = config_.hidden, D = config_.input, F = config_.features, C = config_.classes;
  const std::size_t cells = static_cast<std::size_t>(B) * H;
  // Per layer (B, input + H): what the layer reads, then its state. The top layer's state lies in `top`, too.
  std::vector<std::vector<float>> rows;
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const int width = layers_[l].input + H;
    rows.emplace_back(static_cast<std::size_t>(B) * width, 0.0f);
    for (int b = 0; hidden != nullptr && b < B; ++b) {
      const float* state = hidden + (l * static_cast<std::size_t>(B) + b) * H;
      std::copy(state, state + H, rows[l].data() + static_cast<std::size_t>(b) * width + layers_[l].input);
    }
  }
  std::vector<float> top(cells), read(cells), reset_update(2 * cells), candidate_input(cells), candidate_state(cells);
  for (int t = 0; t < frames; ++t) {
    for (int b = 0; b < B; ++b) {
      const float* frame = motions + (static_cast<std::ptrdiff_t>(b) * frames + t) * D;
      std::copy(frame, frame + D, rows[0].data() + static_cast<std::size_t>(b) * (D + H));
    }
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      const Layer& layer = layers_[l];
      const int I = layer.input, width = I + H;
      float* state = rows[l].data() + I;
      MultiplyTransposed(rows[l].data(), width, layer.reset_update, B, 2 * H, width, reset_update.data(), 2 * H);
      MultiplyTransposed(rows[l].data(), width, layer.candidate_input, B, H, I, candidate_input.data(), H);
      MultiplyTransposed(state, width, layer.candidate_state, B, H, H, candidate_state.data(), H);
      const bool is_top = l + 1 == layers_.size();
      GruGates({reset_update.data(), candidate_input.data(), candidate_state.data(), layer.bias.data()}, B, H, state,
               width, is_top ? top.data() : rows[l + 1].data(), is_top ? H : layers_[l + 1].input + H);
    }
    for (int b = 0; b < B; ++b) {
      if ((read_out.empty() ? frames : read_out[static_cast<std::size_t>(b)]) != t + 1) continue;
      std::copy_n(top.data() + static_cast<std::size_t>(b) * H, H, read.data() + static_cast<std::size_t>(b) * H);
    }
  }
  MultiplyTransposed(read.data(), H, linear1_, B, F, H, features, F);
  for (int b = 0; b < B; ++b) {
    for (int k = 0; k < F; ++k) features[b * F + k] = std::tanh(features[b * F + k] + bias1_[k]);
  }
  MultiplyTransposed(features, F, linear2_, B, C, F, logits, C);
  for (int b = 0; b < B; ++b) {
    for (int k = 0; k < C; ++k) logits[b * C + k] += bias2_[k];
  }
}

}  // namespace mocurate
