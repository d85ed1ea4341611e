#include "train/networks/act_mocogan.h"

#include <algorithm>

#include "train/layers/gru_layer.h"
#include "train/layers/lie_function.h"

namespace mocurate {
namespace {

using torch::Tensor;

constexpr std::int64_t kTrajectoryState = 6;  // numbers of the state that give the root
constexpr std::int64_t kDiscriminatorLayers = 2;

/// Binary cross entropy of logits with one target, over the whole batch.
Tensor GanLoss(const Tensor& logits, double target, std::int64_t whole) {
  const Tensor targets = torch::full_like(logits, target);
  return torch::binary_cross_entropy_with_logits(logits, targets, {}, {}, at::Reduction::Sum) /
         static_cast<double>(whole);
}

Tensor ClassLoss(const Tensor& logits, const Tensor& label, std::int64_t whole) {
  return -torch::log_softmax(logits, 1).gather(1, label.unsqueeze(1)).sum() / static_cast<double>(whole);
}

}  // namespace

ActMoCoGan::GeneratorImpl::GeneratorImpl(std::int64_t latent, std::int64_t classes, std::int64_t hidden,
                                         std::int64_t pose, bool lie) {
  recurrent_z = register_module("recurrent_z", torch::nn::GRU(latent, hidden));
  recurrent_h =
      register_module("recurrent_h", torch::nn::GRU(torch::nn::GRUOptions(hidden + classes, hidden).num_layers(2)));
  if (!lie) {
    linear = register_module("linear", torch::nn::Linear(hidden, pose));
    return;
  }
  linear_lie = register_module("linear_lie", torch::nn::Linear(hidden - kTrajectoryState, pose - 3));
  linear_traj = register_module("linear_traj", torch::nn::Linear(kTrajectoryState, 3));
}

ActMoCoGan::PoseDiscriminatorImpl::PoseDiscriminatorImpl(std::int64_t pose, std::int64_t hidden) {
  main = register_module("main",
                         torch::nn::Sequential(torch::nn::Linear(pose, hidden),
                                               torch::nn::LeakyReLU(torch::nn::LeakyReLUOptions().negative_slope(0.2)),
                                               torch::nn::Linear(hidden, 1)));
}

ActMoCoGan::ActMoCoGan(const ActMoCoGanOptions& options, const LearningOptions& learning, const NetworkSizes& sizes)
    : options_(options),
      classes_(sizes.classes),
      pose_(sizes.pose()),
      learning_rate_(learning.learning_rate),
      weight_decay_(learning.weight_decay) {
  if (options.lie) kinematics_ = LieLayer(sizes.chains, LieExp::kReleased);
  generator_ = register_module("generator", Generator(options.latent, classes_, options.hidden, pose_, options.lie));
  motion_discriminator_ =
      register_module("motion_discriminator", GruClassifier(pose_, options.hidden, kDiscriminatorLayers, 1 + classes_));
  pose_discriminator_ = register_module("pose_discriminator", PoseDiscriminator(pose_, options.hidden));
}

std::vector<OptimiserGroup> ActMoCoGan::Groups() {
  std::vector<OptimiserGroup> groups;
  const auto add = [&](const char* name, const torch::nn::Module& module) {
    OptimiserGroup group;
    group.name = name;
    group.parameters = module.parameters();
    group.learning_rate = learning_rate_;
    group.weight_decay = weight_decay_;
    group.beta1 = 0.5;
    groups.push_back(std::move(group));
  };
  add("pose_discriminator", *pose_discriminator_);
  add("motion_discriminator", *motion_discriminator_);
  add("generator", *generator_);
  return groups;
}

std::vector<int> ActMoCoGan::Phases(std::int64_t /*step*/, std::int64_t /*steps*/) const {
  if (options_.pose_weight == 0.0) return {kMotionDiscriminator, kGenerator};
  return {kPoseDiscriminator, kMotionDiscriminator, kGenerator};
}

Tensor ActMoCoGan::Generate(const Tensor& z, const Tensor& h0_z, const Tensor& h0_h, const Tensor& label) {
  const Tensor noise = GruStack(z, h0_z, generator_->recurrent_z);                                  // (T,B,H)
  const Tensor category = OneHot(label, classes_).unsqueeze(0).expand({z.size(0), -1, -1});         // (T,B,C)
  const Tensor states = GruStack(torch::cat({noise, category}, 2), h0_h, generator_->recurrent_h);  // (T,B,H)
  if (!options_.lie) return generator_->linear->forward(states);                                    // (T,B,D)
  const std::int64_t split = states.size(2) - kTrajectoryState;
  const Tensor rotations = torch::tanh(generator_->linear_lie->forward(states.slice(2, 0, split))) * kReleasedPi;
  return torch::cat({rotations, generator_->linear_traj->forward(states.slice(2, split))}, 2);  // root last
}

Tensor ActMoCoGan::GenerateFrom(Draws& draws, const Tensor& label, std::int64_t frames) {
  const std::int64_t B = label.size(0), H = options_.hidden;
  return Generate(draws.Normal("z", frames, B, options_.latent).to(label.device()),
                  draws.Normal("h0_z", 1, B, H).to(label.device()), draws.Normal("h0_h", 2, B, H).to(label.device()),
                  label);
}

Tensor ActMoCoGan::Joints(const Tensor& output, const Tensor& bone_length) const {
  if (!options_.lie) return output;
  const Tensor parameters = torch::cat({output.slice(2, pose_ - 3), output.slice(2, 0, pose_ - 3)}, 2);  // root first
  const Tensor lengths = bone_length.unsqueeze(0).expand({output.size(0), -1, -1});
  return LieJoints(kinematics_, parameters.view({-1, pose_}), lengths.reshape({-1, pose_ / 3})).view(output.sizes());
}

// One frame of each motion, drawn, its root at the origin: (B,D).
Tensor ActMoCoGan::Poses(const Tensor& joints, Draws& draws, const std::string& purpose) const {
  const Tensor frame = draws.Classes(purpose, joints.size(1), joints.size(0)).to(joints.device());
  const Tensor rows = joints.gather(0, frame.view({1, -1, 1}).expand({1, -1, pose_})).squeeze(0);
  return rows - rows.slice(1, 0, 3).repeat({1, pose_ / 3});
}

// (B,1 + C)
Tensor ActMoCoGan::Judge(const Tensor& joints, Draws& draws, const std::string& purpose) {
  if (joints.size(1) == 0)
    return torch::zeros({0, 1 + classes_}, joints.options()).requires_grad_();  // another shard's
  const Tensor hidden = draws.Normal(purpose, kDiscriminatorLayers, joints.size(1), options_.hidden);
  return motion_discriminator_->forward(joints, hidden.to(joints.device())).logits;
}

// Motions that the motion discriminator judges: the first of the whole batch.
std::int64_t ActMoCoGan::Judged(const Batch& batch) const {
  if (options_.motion_batch == 0) return batch.size();
  return std::clamp<std::int64_t>(options_.motion_batch - batch.first, 0, batch.size());
}

Losses ActMoCoGan::Loss(const Batch& batch, Draws& draws, int phase) {
  const std::int64_t whole = batch.whole, judged = Judged(batch);
  const std::int64_t whole_judged = options_.motion_batch == 0 ? whole : std::min(whole, options_.motion_batch);
  const Tensor label = draws.Classes("label", batch.size(), classes_).to(batch.label.device());
  const Tensor bones = options_.lie ? LieBoneLengths(kinematics_, batch.motion[0]) : Tensor();  // (B,J)
  Losses losses;
  Tensor made;  // (T,B,D)
  {
    const torch::AutoGradMode learns(phase == kGenerator);
    made = Joints(GenerateFrom(draws, label, batch.frames()), bones);
  }
  if (phase == kPoseDiscriminator) {
    const Tensor real = pose_discriminator_->forward(Poses(batch.motion, draws, "real_frame"));
    const Tensor fake = pose_discriminator_->forward(Poses(made, draws, "fake_frame"));
    losses.total = GanLoss(real, 1.0, whole) + GanLoss(fake, 0.0, whole);
    losses.terms = {{"pose_discriminator", losses.total}};
    return losses;
  }
  if (phase == kMotionDiscriminator) {
    const Tensor real = Judge(batch.motion.slice(1, 0, judged), draws, "real_hidden");
    const Tensor fake = Judge(made.slice(1, 0, judged), draws, "fake_hidden");
    const Tensor adversarial =
        GanLoss(real.select(1, 0), 1.0, whole_judged) + GanLoss(fake.select(1, 0), 0.0, whole_judged);
    const Tensor category = ClassLoss(real.slice(1, 1), batch.label.slice(0, 0, judged), whole_judged);
    losses.total = adversarial + category;
    losses.terms = {{"motion_discriminator", adversarial}, {"real_class", category}};
    return losses;
  }
  const Tensor logits = Judge(made.slice(1, 0, judged), draws, "fake_hidden");
  const Tensor adversarial = GanLoss(logits.select(1, 0), 1.0, whole_judged);
  const Tensor category = ClassLoss(logits.slice(1, 1), label.slice(0, 0, judged), whole_judged);
  losses.total = adversarial + options_.category_weight * category;
  losses.terms = {{"generator", adversarial}, {"class", category}};
  if (options_.smoothness_weight > 0.0) {
    const double count = static_cast<double>((batch.frames() - 1) * whole * pose_);
    const Tensor smoothness = (made.slice(0, 1) - made.slice(0, 0, -1)).abs().sum() / count;
    losses.total = losses.total + options_.smoothness_weight * smoothness;
    losses.terms.emplace_back("smoothness", smoothness);
  }
  if (options_.pose_weight > 0.0) {
    const Tensor pose = GanLoss(pose_discriminator_->forward(Poses(made, draws, "fake_frame")), 1.0, whole);
    losses.total = losses.total + options_.pose_weight * pose;
    losses.terms.emplace_back("pose", pose);
  }
  return losses;
}

Motions ActMoCoGan::Answer(const RequestBatch& requests, Draws& draws) {
  const Tensor output = GenerateFrom(draws, requests.label, requests.frames);
  return {Joints(output, requests.bone_length), output};
}

}  // namespace mocurate
