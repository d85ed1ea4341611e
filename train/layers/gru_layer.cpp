#include "train/layers/gru_layer.h"

#include <algorithm>

#include "train/recognisers/gru_gates.h"

namespace mocurate {
namespace {

using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

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
      Tensor state_part = from_state[t];
      torch::addmm_out(state_part, hidden_bias, states[t], weight);
      float* state = states.data_ptr<float>() + t * B * H;
      GruForwardGates(from_input.data_ptr<float>() + t * B * 3 * H, state_part.data_ptr<float>(), state,
                      static_cast<int>(B), static_cast<int>(H), rz.data_ptr<float>() + t * B * 2 * H,
                      n.data_ptr<float>() + t * B * H, state + B * H);
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
      GruBackwardGates(rz.data_ptr<float>() + t * B * 2 * H, n.data_ptr<float>() + t * B * H,
                       from_state.data_ptr<float>() + t * B * 3 * H, states.data_ptr<float>() + t * B * H,
                       static_cast<int>(B), static_cast<int>(H), by_state.data_ptr<float>(),
                       by_input_sum.data_ptr<float>() + t * B * 3 * H, by_state_sum.data_ptr<float>() + t * B * 3 * H);
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

/// The weights as an input of every frame: its backward runs when those of all frames have written their rows.
struct Gather : torch::autograd::Function<Gather> {
  static Tensor forward(AutogradContext* context, const Tensor& input_weight, const Tensor& /*hidden_weight*/,
                        const Tensor& /*input_bias*/, const Tensor& /*hidden_bias*/, const Tensor& input,
                        const Tensor& before, const Tensor& by_from_input, const Tensor& by_from_state) {
    context->save_for_backward({input, before, by_from_input, by_from_state});
    return torch::zeros({1}, input_weight.options());
  }

  static variable_list backward(AutogradContext* context, variable_list /*gradients*/) {
    const variable_list saved = context->get_saved_variables();
    const Tensor &by_input = saved[2], &by_state = saved[3];
    return {torch::mm(by_input.t(), saved[0]),
            torch::mm(by_state.t(), saved[1]),
            by_input.sum(0),
            by_state.sum(0),
            Tensor(),
            Tensor(),
            Tensor(),
            Tensor()};
  }
};

/// One frame whose rows begin at `row`. Rows are written through pointers: autograd must not take them for changed.
struct Frame : torch::autograd::Function<Frame> {
  static Tensor forward(AutogradContext* context, const Tensor& input, const Tensor& hidden, const Tensor& ticket,
                        const Tensor& input_weight, const Tensor& hidden_weight, const Tensor& input_bias,
                        const Tensor& hidden_bias, const Tensor& inputs, const Tensor& befores,
                        const Tensor& by_from_input, const Tensor& by_from_state, std::int64_t row) {
    const std::int64_t B = hidden.size(0), H = hidden.size(1), I = input.size(1);
    const Tensor dense = input.contiguous(), state = hidden.contiguous();
    std::copy_n(dense.data_ptr<float>(), B * I, inputs.data_ptr<float>() + row * I);
    std::copy_n(state.data_ptr<float>(), B * H, befores.data_ptr<float>() + row * H);
    const Tensor from_input = torch::addmm(input_bias, dense, input_weight.t());
    const Tensor from_state = torch::addmm(hidden_bias, state, hidden_weight.t());
    const Tensor rz = torch::empty({B, 2 * H}), n = torch::empty({B, H}), after = torch::empty({B, H});
    GruForwardGates(from_input.data_ptr<float>(), from_state.data_ptr<float>(), state.data_ptr<float>(),
                    static_cast<int>(B), static_cast<int>(H), rz.data_ptr<float>(), n.data_ptr<float>(),
                    after.data_ptr<float>());
    context->save_for_backward(
        {input_weight, hidden_weight, from_state, rz, n, befores, by_from_input, by_from_state, ticket});
    context->saved_data["row"] = row;
    return after;
  }

  static variable_list backward(AutogradContext* context, variable_list gradients) {
    const variable_list saved = context->get_saved_variables();
    const Tensor &from_state = saved[2], &rz = saved[3], &n = saved[4];
    const std::int64_t row = context->saved_data["row"].toInt(), B = n.size(0), H = n.size(1);
    Tensor by_state = gradients[0].clone(at::MemoryFormat::Contiguous);
    const Tensor by_from_input = saved[6].slice(0, row, row + B), by_from_state = saved[7].slice(0, row, row + B);
    GruBackwardGates(rz.data_ptr<float>(), n.data_ptr<float>(), from_state.data_ptr<float>(),
                     saved[5].data_ptr<float>() + row * H, static_cast<int>(B), static_cast<int>(H),
                     by_state.data_ptr<float>(), by_from_input.data_ptr<float>(), by_from_state.data_ptr<float>());
    by_state.addmm_(by_from_state, saved[1]);
    variable_list result(12);
    result[0] = torch::mm(by_from_input, saved[0]);
    result[1] = by_state;
    result[2] = torch::zeros_like(saved[8]);
    return result;
  }
};

/// Keeps nothing for a backward pass.
Tensor StepWithoutGradients(const Tensor& input, const Tensor& hidden, const GruWeights& weights) {
  const Tensor from_input = torch::addmm(weights.input_bias, input, weights.input.t());
  const Tensor from_state = torch::addmm(weights.hidden_bias, hidden, weights.hidden.t());
  const auto B = static_cast<int>(hidden.size(0)), H = static_cast<int>(hidden.size(1));
  const Tensor rz = torch::empty({B, 2 * H}), n = torch::empty({B, H}), after = torch::empty({B, H});
  GruForwardGates(from_input.data_ptr<float>(), from_state.data_ptr<float>(), hidden.contiguous().data_ptr<float>(), B,
                  H, rz.data_ptr<float>(), n.data_ptr<float>(), after.data_ptr<float>());
  return after;
}

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

GruFrames::GruFrames(const GruWeights& weights, std::int64_t frames, std::int64_t batch) : weights_(weights) {
  if (!weights.input.device().is_cpu() || !torch::GradMode::is_enabled()) return;
  const std::int64_t I = weights.input.size(1), H = weights.hidden.size(1);
  input_ = torch::empty({frames * batch, I});
  before_ = torch::empty({frames * batch, H});
  by_from_input_ = torch::empty({frames * batch, 3 * H});
  by_from_state_ = torch::empty({frames * batch, 3 * H});
  ticket_ = Gather::apply(weights.input, weights.hidden, weights.input_bias, weights.hidden_bias, input_, before_,
                          by_from_input_, by_from_state_);
}

Tensor GruFrames::Step(const Tensor& input, const Tensor& hidden) {
  if (!ticket_.defined()) return GruStep(input, hidden, weights_);
  const std::int64_t row = row_;
  row_ += input.size(0);
  return Frame::apply(input, hidden, ticket_, weights_.input.detach(), weights_.hidden.detach(),
                      weights_.input_bias.detach(), weights_.hidden_bias.detach(), input_, before_, by_from_input_,
                      by_from_state_, row);
}

Tensor GruStep(const Tensor& input, const Tensor& hidden, const GruWeights& weights) {
  if (!torch::GradMode::is_enabled() && input.device().is_cpu()) return StepWithoutGradients(input, hidden, weights);
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
