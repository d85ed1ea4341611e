#include "train/recognisers/gru_recogniser.h"

#include <torch/torch.h>

#include <map>
#include <string>

#include "train/recognisers/gru_layer.h"
#include "train/recognisers/gru_pass.h"
#include "train/recognisers/tensors.h"

namespace mocurate {
namespace {

using torch::Tensor;

struct Heads {
  Tensor features, logits;
};

Heads Forward(const GruRecogniserConfig& config, const Weights& weights, const GruRecogniserBatch& batch) {
  const Tensor motion = View(batch.motion, {batch.frames, batch.batch, config.input});
  const Tensor hidden = batch.initial_hidden.empty()
                            ? torch::zeros({config.layers, batch.batch, config.hidden})
                            : View(batch.initial_hidden, {config.layers, batch.batch, config.hidden});
  Tensor outputs = motion;
  for (int layer = 0; layer < config.layers; ++layer) {
    const std::string end = "_l" + std::to_string(layer);
    outputs = GruLayer(outputs, hidden[layer], weights.at("recurrent.weight_ih" + end),
                       weights.at("recurrent.weight_hh" + end), weights.at("recurrent.bias_ih" + end),
                       weights.at("recurrent.bias_hh" + end));
  }
  Tensor last = outputs[batch.frames - 1];
  if (!batch.length.empty()) {
    std::vector<std::int64_t> frame;
    for (const int length : batch.length) frame.push_back(length - 1);
    const Tensor index = torch::tensor(frame, torch::kInt64).view({1, batch.batch, 1});
    last = outputs.gather(0, index.expand({1, batch.batch, config.hidden})).squeeze(0);
  }
  Heads heads;
  heads.features = torch::tanh(torch::linear(last, weights.at("linear1.weight"), weights.at("linear1.bias")));
  heads.logits = torch::linear(heads.features, weights.at("linear2.weight"), weights.at("linear2.bias"));
  return heads;
}

}  // namespace

ParameterList GruRecogniserParameters(const GruRecogniserConfig& config) {
  ParameterList parameters;
  for (int layer = 0; layer < config.layers; ++layer) {
    AddGru("recurrent.", "_l" + std::to_string(layer), layer == 0 ? config.input : config.hidden, config.hidden,
           parameters);
  }
  AddLinear("linear1", config.hidden, config.features, parameters);
  AddLinear("linear2", config.features, config.classes, parameters);
  return parameters;
}

GruRecogniserOutput RunGruRecogniser(const GruRecogniserConfig& config, const ParameterList& parameters,
                                     const GruRecogniserBatch& batch) {
  GruRecogniserOutput output;
  output.features.resize(static_cast<std::size_t>(batch.batch) * config.features);
  output.logits.resize(static_cast<std::size_t>(batch.batch) * config.classes);
  const MotionArray motions{batch.motion.data(), config.input, static_cast<std::ptrdiff_t>(batch.batch) * config.input};
  GruPass(config, parameters)
      .Run(motions, batch.batch, batch.frames, batch.length,
           batch.initial_hidden.empty() ? nullptr : batch.initial_hidden.data(), output.features.data(),
           output.logits.data());
  return output;
}

double GruRecogniserStep(const GruRecogniserConfig& config, const GruRecogniserBatch& batch,
                         const std::vector<int>& label, double smoothing, ParameterList& parameters,
                         std::vector<float>* logits) {
  torch::set_num_threads(1);
  const Weights weights = MakeWeights(parameters, true);
  const Heads heads = Forward(config, weights, batch);
  const Tensor log_probability = torch::log_softmax(heads.logits, 1);
  const std::vector<std::int64_t> target(label.begin(), label.end());
  const Tensor of_label = log_probability.gather(1, torch::tensor(target, torch::kInt64).view({batch.batch, 1})).mean();
  const Tensor loss = -(1.0 - smoothing) * of_label - smoothing * log_probability.mean();
  std::vector<Tensor> inputs;
  for (const Parameter& parameter : parameters) inputs.push_back(weights.at(parameter.name));
  const std::vector<Tensor> gradients = torch::autograd::grad({loss}, inputs);
  for (std::size_t i = 0; i < parameters.size(); ++i) parameters[i].gradient = Numbers(gradients[i]);
  if (logits != nullptr) *logits = Numbers(heads.logits);
  return loss.item<double>();
}

}  // namespace mocurate
