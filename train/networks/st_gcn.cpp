#include "train/networks/st_gcn.h"

#include "train/layers/rotations.h"
#include "train/recognisers/st_gcn_pass.h"

namespace mocurate {

using torch::Tensor;

StGcnBlockImpl::StGcnBlockImpl(std::int64_t input, std::int64_t output, std::int64_t stride, bool adds)
    : output_(output), adds_input_(adds && input == output && stride == 1) {
  constexpr std::int64_t kFrames = 9;
  conv = torch::nn::Conv2d(torch::nn::Conv2dOptions(input, 3 * output, 1));
  auto gcn = std::make_shared<torch::nn::Module>();
  gcn->register_module("conv", conv);
  register_module("gcn", gcn);
  tcn = torch::nn::Sequential(
      torch::nn::BatchNorm2d(output), torch::nn::ReLU(),
      torch::nn::Conv2d(
          torch::nn::Conv2dOptions(output, output, {kFrames, 1}).stride({stride, 1}).padding({kFrames / 2, 0})),
      torch::nn::BatchNorm2d(output));
  register_module("tcn", tcn);
  if (!adds || adds_input_) return;
  residual = torch::nn::Sequential(torch::nn::Conv2d(torch::nn::Conv2dOptions(input, output, 1).stride({stride, 1})),
                                   torch::nn::BatchNorm2d(output));
  register_module("residual", residual);
}

Tensor StGcnBlockImpl::forward(const Tensor& x, const Tensor& adjacency) {
  const std::int64_t B = x.size(0), T = x.size(2), V = x.size(3);
  const Tensor parts = conv->forward(x).view({B, 3, output_, T, V}).permute({0, 2, 3, 1, 4});           // (B,C',T,3,V)
  const Tensor sum = torch::matmul(parts.reshape({B, output_, T, 3 * V}), adjacency.view({3 * V, V}));  // (B,C',T,V)
  Tensor y = tcn->forward(sum);
  if (adds_input_) y = y + x;
  if (residual) y = y + residual->forward(x);
  return torch::relu(y);
}

StGcn::StGcn(const StGcnOptions& options, const LearningOptions& learning, const NetworkSizes& sizes)
    : learning_rate_(learning.learning_rate),
      weight_decay_(learning.weight_decay),
      global_orientation_(options.global_orientation) {
  constexpr std::int64_t kChannels[] = {64, 64, 64, 64, 128, 128, 128, 256, 256, 256};
  const std::vector<int> parents = global_orientation_ ? sizes.parents : WithoutRoot(sizes.parents);
  joints_ = static_cast<std::int64_t>(parents.size());
  std::vector<float> partitions = SpatialPartitions(parents);
  partitions_ = torch::from_blob(partitions.data(), {3, joints_, joints_}).clone();
  data_bn = register_module("data_bn", torch::nn::BatchNorm1d(6 * joints_));
  torch::nn::ModuleList list;
  std::int64_t input = 6;
  for (const std::int64_t channels : kChannels) {
    blocks_.emplace_back(input, channels, input != channels && input != 6 ? 2 : 1, !blocks_.empty());
    list->push_back(blocks_.back());
    input = channels;
  }
  register_module("st_gcn_networks", list);
  auto importance = std::make_shared<torch::nn::Module>();
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    edge_importance_.push_back(importance->register_parameter(std::to_string(i), torch::ones({3, joints_, joints_})));
  }
  register_module("edge_importance", importance);
  fcn = register_module("fcn", torch::nn::Conv2d(torch::nn::Conv2dOptions(input, sizes.classes, 1)));
}

std::vector<OptimiserGroup> StGcn::Groups() { return {AdamWGroup(*this, learning_rate_, weight_decay_)}; }

Tensor StGcn::InputOf(const Batch& batch) const {
  if (batch.features.defined()) return batch.features;
  const Tensor rotation = global_orientation_ ? batch.rotation : batch.rotation.slice(2, 1);
  return NumbersOf(rotation, PoseChoice::kRotation6D).reshape({batch.frames(), batch.size(), 6 * joints_});
}

StGcn::Heads StGcn::Run(const Tensor& frames) {
  const std::int64_t T = frames.size(0), B = frames.size(1), V = joints_;
  const Tensor channels = data_bn->forward(frames.permute({1, 2, 0}).contiguous());  // (B,6V,T), joint-major
  Tensor x = channels.view({B, V, 6, T}).permute({0, 2, 3, 1}).contiguous();         // (B,6,T,V)
  const Tensor adjacency = partitions_.to(frames.device());
  for (std::size_t i = 0; i < blocks_.size(); ++i) x = blocks_[i]->forward(x, adjacency * edge_importance_[i]);
  const Tensor features = x.mean({2, 3});  // (B,256)
  return {features, fcn->forward(features.view({B, features.size(1), 1, 1})).view({B, -1})};
}

Losses StGcn::Loss(const Batch& batch, Draws& /*draws*/, int /*phase*/) {
  train();
  const Heads heads = Run(InputOf(batch));
  const Tensor log_probability = torch::log_softmax(heads.logits, 1);
  const double whole = static_cast<double>(batch.whole);
  Losses losses;
  losses.total = -log_probability.gather(1, batch.label.unsqueeze(1)).sum() / whole;
  const Tensor right = (heads.logits.argmax(1) == batch.label).to(torch::kFloat32).sum() / whole;
  losses.terms = {{"loss", losses.total}, {"accuracy", right}};
  losses.outputs = {{"logits", heads.logits}, {"features", heads.features}};
  return losses;
}

ValidationScore StGcn::Validate(const Batch& batch) {
  eval();
  return ScoreOf(Run(InputOf(batch)).logits, batch.label);
}

}  // namespace mocurate
