#include "train/networks/two_stage_gan.h"

#include "train/layers/gru_layer.h"

namespace mocurate {
namespace {

using torch::Tensor;

torch::nn::Sequential Perceptron(std::int64_t input, std::int64_t hidden, std::int64_t output) {
  const auto leaky = [] { return torch::nn::LeakyReLU(torch::nn::LeakyReLUOptions().negative_slope(0.2)); };
  return torch::nn::Sequential(torch::nn::Linear(input, hidden), leaky(), torch::nn::Linear(hidden, hidden), leaky(),
                               torch::nn::Linear(hidden, output));
}

}  // namespace

TwoStageGan::TwoStageGan(const TwoStageGanOptions& options, const LearningOptions& learning, const NetworkSizes& sizes)
    : options_(options), classes_(sizes.classes), pose_(sizes.pose()), learning_rate_(learning.learning_rate) {
  const std::int64_t P = options.pose_hidden, H = options.motion_hidden, Z = options.latent;
  pose_generator_ = register_module("pose_generator", Perceptron(classes_ + Z, P, pose_));
  pose_critic_ = register_module("pose_critic", Perceptron(pose_ + classes_, P, 1));
  start_ = register_module("motion_generator_start", torch::nn::Linear(classes_ + Z, H));
  motion_ = register_module("motion_generator_gru", torch::nn::GRU(classes_ + Z, H));
  latent_ = register_module("motion_generator_latent", torch::nn::Linear(H, Z));
  judge_motion_ = register_module("motion_critic_gru", torch::nn::GRU(pose_ + classes_, H));
  judge_ = register_module("motion_critic_output", torch::nn::Linear(H, 1));
}

std::vector<OptimiserGroup> TwoStageGan::Groups() {
  std::vector<OptimiserGroup> groups;
  const auto add = [&](const char* name, const std::vector<const torch::nn::Module*>& modules) {
    OptimiserGroup group;
    group.name = name;
    group.rule = OptimiserGroup::Rule::kRmsProp;
    group.learning_rate = learning_rate_;
    for (const torch::nn::Module* module : modules) {
      for (const Tensor& parameter : module->parameters()) group.parameters.push_back(parameter);
    }
    groups.push_back(std::move(group));
  };
  add("pose_critic", {pose_critic_.get()});
  add("pose_generator", {pose_generator_.get()});
  add("motion_critic", {judge_motion_.get(), judge_.get()});
  add("motion_generator", {start_.get(), motion_.get(), latent_.get()});
  return groups;
}

std::vector<int> TwoStageGan::Phases(std::int64_t step, std::int64_t steps) const {
  const bool poses = static_cast<double>(step) < options_.pose_share * static_cast<double>(steps);
  const int critic = poses ? kPoseCritic : kMotionCritic, generator = poses ? kPoseGenerator : kMotionGenerator;
  if ((step + 1) % options_.critic_steps == 0) return {critic, generator};
  return {critic};
}

// z_0 (B,Z), noise (T-1,B,Z), one_hot (B,C) -> (T,B,D)
Tensor TwoStageGan::Motion(const Tensor& z_0, const Tensor& noise, const Tensor& one_hot) {
  const Tensor category = one_hot.unsqueeze(0).expand({noise.size(0), -1, -1});                     // (T-1,B,C)
  const Tensor state = torch::tanh(start_->forward(torch::cat({one_hot, z_0}, 1)));                 // (B,H)
  const Tensor states = GruLayer(torch::cat({category, noise}, 2), state, GruWeights(motion_, 0));  // (T-1,B,H)
  const Tensor latents = torch::cat({z_0.unsqueeze(0), torch::sigmoid(latent_->forward(states))});  // (T,B,Z)
  const Tensor classes = one_hot.unsqueeze(0).expand({latents.size(0), -1, -1});                    // (T,B,C)
  return pose_generator_->forward(torch::cat({classes, latents}, 2));                               // (T,B,D)
}

Tensor TwoStageGan::JudgePoses(const Tensor& poses, const Tensor& one_hot) {
  return pose_critic_->forward(torch::cat({poses, one_hot}, 1)).flatten();  // (B)
}

// `twice`: its gradient is differentiated again, which only plain tensor operations allow.
Tensor TwoStageGan::JudgeMotion(const Tensor& motion, const Tensor& one_hot, bool twice) {
  const Tensor category = one_hot.unsqueeze(0).expand({motion.size(0), -1, -1});
  const Tensor zero = torch::zeros({motion.size(1), options_.motion_hidden}, motion.options());
  const Tensor input = torch::cat({motion, category}, 2);
  const GruWeights weights(judge_motion_, 0);
  const Tensor states = twice ? PlainGruLayer(input, zero, weights) : GruLayer(input, zero, weights);
  return judge_->forward(states[motion.size(0) - 1]).flatten();  // (B)
}

// Of poses (B,D), or of motions (T,B,D): the sum over B.
Tensor TwoStageGan::Penalty(const Tensor& real, const Tensor& made, const Tensor& one_hot, Draws& draws) {
  const bool poses = real.dim() == 2;
  const Tensor share = draws.Uniform("between", 1, one_hot.size(0), 1)[0].to(real.device());  // (B,1)
  const Tensor between = (made.detach() + share * (real - made.detach())).requires_grad_();
  const Tensor judged = poses ? JudgePoses(between, one_hot) : JudgeMotion(between, one_hot, true);
  const Tensor gradient = torch::autograd::grad({judged.sum()}, {between}, {}, true, true)[0];
  const Tensor squares = gradient.square().sum(-1);  // (B) or (T,B)
  return ((poses ? squares : squares.sum(0)) + 1e-12).sqrt().sub(1.0).square().sum();
}

void TwoStageGan::AddPenalty(const Tensor& real, const Tensor& made, const Tensor& one_hot, Draws& draws, double whole,
                             Losses& losses) {
  if (options_.gradient_penalty == 0.0) return;
  const Tensor penalty = options_.gradient_penalty * Penalty(real, made, one_hot, draws) / whole;
  losses.total = losses.total + penalty;
  losses.terms.emplace_back("penalty", penalty);
}

Losses TwoStageGan::PoseLoss(const Batch& batch, Draws& draws, const Tensor& made_of, int phase) {
  const std::int64_t B = batch.size();
  const double whole = static_cast<double>(batch.whole);
  const Tensor z = draws.Uniform("z", 1, B, options_.latent)[0].to(made_of.device());
  const Tensor made = pose_generator_->forward(torch::cat({made_of, z}, 1));
  Losses losses;
  if (phase == kPoseGenerator) {
    losses.total = -JudgePoses(made, made_of).sum() / whole;
    losses.terms = {{"pose_generator", losses.total}};
    return losses;
  }
  const Tensor frame = draws.Classes("real_frame", B, batch.frames()).to(made_of.device());
  const Tensor real = batch.motion.gather(0, frame.view({1, -1, 1}).expand({1, -1, pose_})).squeeze(0);  // (B,D)
  losses.total =
      (JudgePoses(made.detach(), made_of).sum() - JudgePoses(real, OneHot(batch.label, classes_)).sum()) / whole;
  losses.terms = {{"pose_critic", losses.total}};
  AddPenalty(real, made, made_of, draws, whole, losses);
  return losses;
}

Losses TwoStageGan::Loss(const Batch& batch, Draws& draws, int phase) {
  const std::int64_t B = batch.size(), T = batch.frames();
  const double whole = static_cast<double>(batch.whole);
  // A penalty is at points between motions of one class.
  const bool of_real = options_.gradient_penalty > 0.0 && (phase == kPoseCritic || phase == kMotionCritic);
  const Tensor drawn = draws.Classes("label", B, classes_).to(batch.label.device());
  const Tensor made_of = OneHot(of_real ? batch.label : drawn, classes_);
  if (phase == kPoseCritic || phase == kPoseGenerator) return PoseLoss(batch, draws, made_of, phase);
  const Tensor z_0 = draws.Uniform("z_0", 1, B, options_.latent)[0].to(made_of.device());
  const Tensor noise = draws.Normal("noise", T - 1, B, options_.latent).to(made_of.device());
  Losses losses;
  if (phase == kMotionGenerator) {
    losses.total = -JudgeMotion(Motion(z_0, noise, made_of), made_of).sum() / whole;
    losses.terms = {{"motion_generator", losses.total}};
    return losses;
  }
  Tensor made;
  {
    const torch::NoGradGuard no_gradient;
    made = Motion(z_0, noise, made_of);
  }
  const Tensor real = JudgeMotion(batch.motion, OneHot(batch.label, classes_));
  losses.total = (JudgeMotion(made, made_of).sum() - real.sum()) / whole;
  losses.terms = {{"motion_critic", losses.total}};
  AddPenalty(batch.motion, made, made_of, draws, whole, losses);
  return losses;
}

void TwoStageGan::AfterStep(int phase) {
  if (options_.gradient_penalty > 0.0) return;
  if (phase != kPoseCritic && phase != kMotionCritic) return;
  const torch::NoGradGuard no_gradient;
  const std::vector<OptimiserGroup> groups = Groups();
  for (Tensor parameter : groups[static_cast<std::size_t>(phase)].parameters) {
    parameter.clamp_(-options_.weight_clip, options_.weight_clip);
  }
}

Motions TwoStageGan::Answer(const RequestBatch& requests, Draws& draws) {
  const std::int64_t B = requests.label.size(0);
  const Tensor z_0 = draws.Uniform("z_0", 1, B, options_.latent)[0];
  const Tensor noise = draws.Normal("noise", requests.frames - 1, B, options_.latent);
  const Tensor joints = Motion(z_0, noise, OneHot(requests.label, classes_));
  return {joints, joints};
}

}  // namespace mocurate
