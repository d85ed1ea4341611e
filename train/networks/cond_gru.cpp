#include "train/networks/cond_gru.h"

#include "train/layers/gru_layer.h"

namespace mocurate {

using torch::Tensor;

CondGru::CondGru(const CondGruOptions& options, const LearningOptions& learning, const NetworkSizes& sizes)
    : classes_(sizes.classes),
      pose_(sizes.pose()),
      hidden_(options.hidden),
      teacher_forcing_(options.teacher_forcing),
      learning_rate_(learning.learning_rate),
      weight_decay_(learning.weight_decay),
      zeros_(options.evaluation == CondGruEvaluation::kReleasedZeros) {
  linear_c2e_ = register_module("linear_c2e", torch::nn::Linear(classes_, pose_));
  gru_ = register_module("gru", torch::nn::GRU(2 * pose_, hidden_));
  linear_output_ = register_module("linear_output", torch::nn::Linear(hidden_, pose_));
}

std::vector<OptimiserGroup> CondGru::Groups() { return {AdamGroup(*this, learning_rate_, weight_decay_)}; }

Losses CondGru::Loss(const Batch& batch, Draws& draws, int /*phase*/) {
  const std::int64_t T = batch.frames(), B = batch.size();
  const Tensor forced = (draws.Uniform("teacher_forcing", 1, B, 1)[0] < teacher_forcing_).to(batch.motion.device());
  const Tensor category = linear_c2e_->forward(OneHot(batch.label, classes_));  // (B,D)
  GruFrames frames(GruWeights(gru_, 0), T - 1, B);
  Tensor state = torch::zeros({B, hidden_}, batch.motion.options());
  Tensor pose = batch.motion[0];
  std::vector<Tensor> outputs;
  for (std::int64_t t = 0; t + 1 < T; ++t) {
    state = frames.Step(torch::cat({pose, category}, 1), state);
    outputs.push_back(linear_output_->forward(state));  // (B,D): the pose of frame t + 1
    pose = torch::where(forced, batch.motion[t + 1], outputs.back());
  }
  const Tensor output = torch::stack(outputs);  // (T-1,B,D)
  const Tensor squares = (output - batch.motion.slice(0, 1)).square();
  Losses losses;
  losses.total = squares.sum() / static_cast<double>(batch.whole * pose_);
  losses.terms = {{"loss", losses.total / (T - 1)}};
  losses.outputs = {{"output", output}};
  return losses;
}

Motions CondGru::Answer(const RequestBatch& requests, Draws& /*draws*/) {
  const std::int64_t B = requests.label.size(0), T = requests.frames;
  const Tensor output = torch::zeros({T, B, pose_});
  Tensor pose = requests.first_pose.defined() ? requests.first_pose : torch::zeros({B, pose_});
  output[0].copy_(pose);
  if (zeros_) return {output, output};
  const Tensor category = linear_c2e_->forward(OneHot(requests.label, classes_));
  const GruWeights weights(gru_, 0);
  Tensor state = torch::zeros({B, hidden_});
  for (std::int64_t t = 1; t < T; ++t) {
    state = GruStep(torch::cat({pose, category}, 1), state, weights);
    pose = linear_output_->forward(state);
    output[t].copy_(pose);
  }
  return {output, output};
}

}  // namespace mocurate
