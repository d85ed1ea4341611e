#include "train/layers/gru_layer.h"

namespace mocurate {
namespace {

using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

// r and z before their sigmoid: sum of the parts from input and state.
void AddGates(const float* from_input, const float* from_state, std::int64_t batch, std::int64_t hidden, float* rz) {
  for (std::int64_t b = 0; b < batch; ++b) {
    for (std::int64_t k = 0; k < 2 * hidden; ++k) rz[k] = from_input[k] + from_state[k];
    from_input += 3 * hidden;
    from_state += 3 * hidden;
    rz += 2 * hidden;
  }
}

// n before its tanh: from_input + r * from_state.
void AddCandidate(const float* from_input, const float* from_state, const float* rz, std::int64_t batch,
                  std::int64_t hidden, float* n) {
  for (std::int64_t b = 0; b < batch; ++b) {
    for (std::int64_t k = 0; k < hidden; ++k) n[k] = from_input[2 * hidden + k] + rz[k] * from_state[2 * hidden + k];
    from_input += 3 * hidden;
    from_state += 3 * hidden;
    rz += 2 * hidden;
    n += hidden;
  }
}

void Mix(const float* rz, const float* n, const float* before, std::int64_t batch, std::int64_t hidden, float* after) {
  for (std::int64_t b = 0; b < batch; ++b) {
    for (std::int64_t k = 0; k < hidden; ++k) after[k] = n[k] + rz[hidden + k] * (before[k] - n[k]);
    rz += 2 * hidden;
    n += hidden;
    before += hidden;
    after += hidden;
  }
}

// From the gradient `by_output` of one frame: gradients of the gate sums from input and state, and the direct part of
// the gradient of the state before (in place of `by_output`).
void GateGradients(const float* rz, const float* n, const float* from_state, const float* before, std::int64_t batch,
                   std::int64_t hidden, float* by_output, float* by_input_sum, float* by_state_sum) {
  for (std::int64_t b = 0; b < batch; ++b) {
    for (std::int64_t k = 0; k < hidden; ++k) {
      const float r = rz[k], z = rz[hidden + k], g = by_output[k];
      const float by_n = g * (1.0f - z) * (1.0f - n[k] * n[k]);
      const float by_r = by_n * from_state[2 * hidden + k] * r * (1.0f - r);
      const float by_z = g * (before[k] - n[k]) * z * (1.0f - z);
      by_input_sum[k] = by_r;
      by_input_sum[hidden + k] = by_z;
      by_input_sum[2 * hidden + k] = by_n;
      by_state_sum[k] = by_r;
      by_state_sum[hidden + k] = by_z;
      by_state_sum[2 * hidden + k] = by_n * r;
      by_output[k] = g * z;
    }
    rz += 2 * hidden;
    n += hidden;
    from_state += 3 * hidden;
    before += hidden;
    by_output += hidden;
    by_input_sum += 3 * hidden;
    by_state_sum += 3 * hidden;
  }
}

struct Layer : torch::autograd::Function<Layer> {
  static Tensor forward(AutogradContext* context, const Tensor& input, const Tensor& hidden, const Tensor& input_weight,
                        const Tensor& hidden_weight, const Tensor& input_bias, const Tensor& hidden_bias) {
    const std::int64_t T = input.size(0), B = input.size(1), H = hidden_weight.size(1);
    const Tensor rows = input.reshape({T * B, input.size(2)});
    const Tensor from_input = torch::addmm(input_bias, rows, input_weight.t());
    const Tensor from_state = torch::empty({T, B, 3 * H}), rz = torch::empty({T, B, 2 * H});
    const Tensor n = torch::empty({T, B, H}), states = torch::empty({T + 1, B, H});
    states[0].copy_(hidden);
    const Tensor weight = hidden_weight.t();
    for (std::int64_t t = 0; t < T; ++t) {
      Tensor state_part = from_state[t], gates = rz[t], candidate = n[t];
      torch::addmm_out(state_part, hidden_bias, states[t], weight);
      const float* input_part = from_input.data_ptr<float>() + t * B * 3 * H;
      AddGates(input_part, state_part.data_ptr<float>(), B, H, gates.data_ptr<float>());
      gates.sigmoid_();
      AddCandidate(input_part, state_part.data_ptr<float>(), gates.data_ptr<float>(), B, H,
                   candidate.data_ptr<float>());
      candidate.tanh_();
      float* state = states.data_ptr<float>() + t * B * H;
      Mix(gates.data_ptr<float>(), candidate.data_ptr<float>(), state, B, H, state + B * H);
    }
    context->save_for_backward({rows, input_weight, hidden_weight, from_state, rz, n, states});
    return states.slice(0, 1).clone();
  }

  static variable_list backward(AutogradContext* context, variable_list gradients) {
    const variable_list saved = context->get_saved_variables();
    const Tensor &rows = saved[0], &input_weight = saved[1], &hidden_weight = saved[2], &from_state = saved[3];
    const Tensor &rz = saved[4], &n = saved[5], &states = saved[6];
    const Tensor by_output = gradients[0].contiguous();
    const std::int64_t T = by_output.size(0), B = by_output.size(1), H = by_output.size(2);
    const Tensor by_input_sum = torch::empty({T * B, 3 * H}), by_state_sum = torch::empty({T * B, 3 * H});
    const Tensor by_state = torch::zeros({B, H});
    for (std::int64_t t = T - 1; t >= 0; --t) {
      by_state.add_(by_output[t]);
      float* by_state_part = by_state_sum.data_ptr<float>() + t * B * 3 * H;
      GateGradients(rz.data_ptr<float>() + t * B * 2 * H, n.data_ptr<float>() + t * B * H,
                    from_state.data_ptr<float>() + t * B * 3 * H, states.data_ptr<float>() + t * B * H, B, H,
                    by_state.data_ptr<float>(), by_input_sum.data_ptr<float>() + t * B * 3 * H, by_state_part);
      by_state.addmm_(by_state_sum.slice(0, t * B, (t + 1) * B), hidden_weight);
    }
    Tensor by_input;
    if (context->needs_input_grad(0)) by_input = torch::mm(by_input_sum, input_weight).view({T, B, rows.size(1)});
    const Tensor before = states.slice(0, 0, T).reshape({T * B, H});
    return {by_input,
            by_state,
            torch::mm(by_input_sum.t(), rows),
            torch::mm(by_state_sum.t(), before),
            by_input_sum.sum(0),
            by_state_sum.sum(0)};
  }
};

}  // namespace

GruWeights::GruWeights(const torch::nn::GRUCell& cell)
    : input(cell->weight_ih), hidden(cell->weight_hh), input_bias(cell->bias_ih), hidden_bias(cell->bias_hh) {}

GruWeights::GruWeights(const torch::nn::GRU& gru, int layer) {
  const auto parameters = gru->named_parameters(false);
  const std::string end = "_l" + std::to_string(layer);
  input = parameters["weight_ih" + end];
  hidden = parameters["weight_hh" + end];
  input_bias = parameters["bias_ih" + end];
  hidden_bias = parameters["bias_hh" + end];
}

GruWeights::GruWeights(const torch::nn::GRUCell& cell, const torch::nn::Linear& embedding) : GruWeights(cell) {
  input_bias = torch::addmv(input_bias, input, embedding->bias);
  input = torch::mm(input, embedding->weight);
}

Tensor GruLayer(const Tensor& input, const Tensor& hidden, const GruWeights& weights) {
  if (!input.device().is_cpu()) return PlainGruLayer(input, hidden, weights);
  return Layer::apply(input, hidden, weights.input, weights.hidden, weights.input_bias, weights.hidden_bias);
}

Tensor PlainGruLayer(const Tensor& input, const Tensor& hidden, const GruWeights& weights) {
  Tensor state = hidden;
  std::vector<Tensor> states;
  for (const Tensor& frame : input.unbind(0)) {
    const auto from_input = torch::linear(frame, weights.input, weights.input_bias).chunk(3, 1);    // 3 x (B,H)
    const auto from_state = torch::linear(state, weights.hidden, weights.hidden_bias).chunk(3, 1);  // 3 x (B,H)
    const Tensor r = torch::sigmoid(from_input[0] + from_state[0]);
    const Tensor z = torch::sigmoid(from_input[1] + from_state[1]);
    const Tensor n = torch::tanh(from_input[2] + r * from_state[2]);
    state = n + z * (state - n);
    states.push_back(state);
  }
  return torch::stack(states);
}

Tensor GruStep(const Tensor& input, const Tensor& hidden, const GruWeights& weights) {
  return GruLayer(input.unsqueeze(0), hidden, weights).squeeze(0);
}

Tensor GruStack(const Tensor& input, const Tensor& hidden, const torch::nn::GRU& gru) {
  Tensor outputs = input;
  for (int layer = 0; layer < static_cast<int>(gru->options.num_layers()); ++layer) {
    outputs = GruLayer(outputs, hidden[layer], GruWeights(gru, layer));
  }
  return outputs;
}

}  // namespace mocurate
