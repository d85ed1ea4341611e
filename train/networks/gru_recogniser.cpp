#include "train/networks/gru_recogniser.h"

#include "train/layers/gru_layer.h"

namespace mocurate {

using torch::Tensor;

GruClassifierImpl::GruClassifierImpl(std::int64_t input, std::int64_t hidden, std::int64_t layers,
                                     std::int64_t outputs) {
  constexpr std::int64_t kFeatures = 30;
  recurrent = register_module("recurrent", torch::nn::GRU(torch::nn::GRUOptions(input, hidden).num_layers(layers)));
  linear1 = register_module("linear1", torch::nn::Linear(hidden, kFeatures));
  linear2 = register_module("linear2", torch::nn::Linear(kFeatures, outputs));
}

GruClassifierImpl::Heads GruClassifierImpl::forward(const Tensor& motion, const Tensor& hidden, const Tensor& last) {
  const Tensor outputs = GruStack(motion, hidden, recurrent);  // (T,B,H)
  const Tensor read = last.defined() ? outputs.index({last, torch::arange(last.size(0), last.options())})
                                     : outputs[motion.size(0) - 1];  // (B,H)
  const Tensor features = torch::tanh(linear1->forward(read));
  return {features, linear2->forward(features)};
}

GruRecogniser::GruRecogniser(const GruRecogniserOptions& options, const LearningOptions& learning,
                             const NetworkSizes& sizes)
    : options_(options), learning_rate_(learning.learning_rate), weight_decay_(learning.weight_decay) {
  classifier_ = GruClassifier(sizes.pose(), options.hidden, options.layers, sizes.classes);
  // The released file names its parts without a prefix.
  register_module("recurrent", classifier_->recurrent);
  register_module("linear1", classifier_->linear1);
  register_module("linear2", classifier_->linear2);
}

std::vector<OptimiserGroup> GruRecogniser::Groups() { return {AdamGroup(*this, learning_rate_, weight_decay_)}; }

Tensor GruRecogniser::Input(const Tensor& motion) const {
  return mean_.defined() ? (motion - mean_) / deviation_ : motion;
}

/// Undefined where the last frame counts.
Tensor GruRecogniser::LastOf(const Batch& batch) const {
  if (options_.read_out == ReadOutChoice::kLastFrame || !batch.valid.defined()) return {};
  return batch.valid.to(torch::kInt64).sum(0) - 1;
}

Losses GruRecogniser::Loss(const Batch& batch, Draws& draws, int /*phase*/) {
  const std::int64_t B = batch.size(), H = options_.hidden, layers = options_.layers;
  const Tensor hidden = options_.initial_hidden == InitialHidden::kNormal
                            ? draws.Normal("hidden", layers, B, H).to(batch.motion.device())
                            : torch::zeros({layers, B, H}, batch.motion.options());
  const GruClassifierImpl::Heads heads = classifier_->forward(Input(batch.motion), hidden, LastOf(batch));
  const Tensor log_probability = torch::log_softmax(heads.logits, 1);  // (B,C)
  const Tensor of_label = log_probability.gather(1, batch.label.unsqueeze(1)).sum();
  const double smoothing = options_.label_smoothing, whole = static_cast<double>(batch.whole);
  const Tensor of_all = log_probability.mean(1).sum();
  Losses losses;
  losses.total = (-(1.0 - smoothing) * of_label - smoothing * of_all) / whole;
  const Tensor right = (heads.logits.argmax(1) == batch.label).to(torch::kFloat32).sum() / whole;
  losses.terms = {{"loss", losses.total}, {"accuracy", right}};
  losses.outputs = {{"logits", heads.logits}};
  return losses;
}

ValidationScore GruRecogniser::Validate(const Batch& batch) {
  const Tensor hidden = torch::zeros({options_.layers, batch.size(), options_.hidden}, batch.motion.options());
  return ScoreOf(classifier_->forward(Input(batch.motion), hidden, LastOf(batch)).logits, batch.label);
}

void GruRecogniser::Standardise(const Tensor& mean, const Tensor& deviation) {
  if (!options_.standardise) return;
  mean_ = mean.clone();
  deviation_ = deviation.clone();
}

void GruRecogniser::Finish() {
  if (!mean_.defined()) return;
  torch::NoGradGuard no_gradient;
  const auto first = classifier_->recurrent->named_parameters(false);
  Tensor weight = first["weight_ih_l0"], bias = first["bias_ih_l0"];
  weight.div_(deviation_);
  bias.sub_(torch::mv(weight.to(torch::kFloat64), mean_.to(torch::kFloat64)).to(torch::kFloat32));
  mean_ = deviation_ = Tensor();
}

}  // namespace mocurate
