#include "train/networks/action2motion.h"

#include "train/layers/lie_function.h"

namespace mocurate {
namespace {

using torch::Tensor;

TimeChoice TimeOf(const Action2MotionOptions& options) {
  if (options.time_counter != TimeChoice::kProtocol) return options.time_counter;
  if (options.protocol == Protocol::kPaper) return TimeChoice::kPaper;
  return options.lie ? TimeChoice::kReleased : TimeChoice::kNone;
}

double KlWeightOf(const Action2MotionOptions& options) {
  if (options.kl_weight) return *options.kl_weight;
  if (options.protocol == Protocol::kPaper) return 0.01;
  return options.lie ? 1e-3 : 1e-4;
}

}  // namespace

Action2Motion::GaussianNetImpl::GaussianNetImpl(std::int64_t input, std::int64_t hidden, std::int64_t latent) {
  embed = register_module("embed", torch::nn::Linear(input, hidden));
  gru = torch::nn::GRUCell(hidden, hidden);
  register_module("gru", torch::nn::ModuleList(gru));
  mu_net = register_module("mu_net", torch::nn::Linear(hidden, latent));
  logvar_net = register_module("logvar_net", torch::nn::Linear(hidden, latent));
}

Action2Motion::DecoderImpl::DecoderImpl(std::int64_t input, std::int64_t hidden, std::int64_t pose, bool lie) {
  embed = register_module("embed", torch::nn::Linear(input, hidden));
  first = torch::nn::GRUCell(hidden, hidden);
  second = torch::nn::GRUCell(hidden, hidden);
  register_module("gru", torch::nn::ModuleList(first, second));
  output = register_module("output", torch::nn::Linear(hidden, pose));
  if (lie) output_lie = register_module("output_lie", torch::nn::Linear(pose - 3, pose - 3));
}

Action2Motion::Action2Motion(const Action2MotionOptions& options, const LearningOptions& learning,
                             const NetworkSizes& sizes)
    : classes_(sizes.classes),
      pose_(sizes.pose()),
      hidden_(options.hidden),
      latent_(options.latent),
      time_(TimeOf(options)),
      lie_(options.lie),
      learning_rate_(learning.learning_rate),
      weight_decay_(learning.weight_decay) {
  const bool paper = options.protocol == Protocol::kPaper;
  feed_joints_ =
      lie_ && (options.feedback == FeedbackChoice::kJoints || (options.feedback == FeedbackChoice::kProtocol && paper));
  mean_loss_ =
      options.reconstruction == LossChoice::kMean || (options.reconstruction == LossChoice::kProtocol && !paper);
  self_feed_ = options.self_feed_probability.value_or(paper ? 0.4 : 0.6);
  kl_weight_ = KlWeightOf(options);
  if (lie_) {
    kinematics_ =
        LieLayer(sizes.chains, options.lie_exp == LieExpChoice::kReleased ? LieExp::kReleased : LieExp::kExact);
  }
  const std::int64_t input = pose_ + classes_ + (time_ == TimeChoice::kNone ? 0 : 1);
  prior_ = register_module("prior", GaussianNet(input, hidden_, latent_));
  posterior_ = register_module("posterior", GaussianNet(input, hidden_, latent_));
  decoder_ = register_module("decoder", Decoder(input + latent_, hidden_, pose_, lie_));
}

// The released code has one Adam a network; they step alike.
std::vector<OptimiserGroup> Action2Motion::Groups() { return {AdamGroup(*this, learning_rate_, weight_decay_)}; }

Tensor Action2Motion::Conditions(const Tensor& label, std::int64_t frames) const {
  Tensor one_hot = OneHot(label, classes_).unsqueeze(0).expand({frames, -1, -1});  // (T,B,C)
  if (time_ == TimeChoice::kNone) return one_hot;
  Tensor time = torch::arange(frames, one_hot.options());
  time = time_ == TimeChoice::kPaper ? (time + 1.0) / frames : time / std::max<std::int64_t>(1, frames - 1);
  return torch::cat({one_hot, time.view({-1, 1, 1}).expand({-1, label.size(0), 1})}, 2);
}

Tensor Action2Motion::KlTerms(const Tensor& mean_q, const Tensor& lv_q, const Tensor& mean_p, const Tensor& lv_p) {
  return 0.5 * (lv_p - lv_q) + (torch::exp(lv_q) + (mean_q - mean_p).square()) * (0.5 * torch::exp(-lv_p)) - 0.5;
}

Tensor Action2Motion::Decode(const Tensor& state) {
  Tensor y = decoder_->output->forward(state);  // (...,D)
  if (!lie_) return y;
  const Tensor rotations = decoder_->output_lie->forward(torch::tanh(y.slice(-1, 3)));  // (...,D-3)
  return torch::cat({y.slice(-1, 0, 3), torch::tanh(rotations) * kReleasedPi}, -1);
}

Tensor Action2Motion::Joints(const Tensor& output, const Tensor& bone_length) const {
  if (!lie_) return output;
  return LieJoints(kinematics_, output.view({-1, pose_}), bone_length.reshape({-1, pose_ / 3})).view(output.sizes());
}

struct Action2Motion::Rollout {
  Tensor output;  // (T,B,D)
  Tensor joints;  // (T,B,D); undefined unless joints are fed back
  Tensor before;  // (T,B,D) the pose that each frame reads
};

// The decoder with the posterior's z. Where the truth is fed, all frames are known and each layer runs over all of
// them.
Action2Motion::Rollout Action2Motion::Unroll(const Batch& batch, const Tensor& condition, const Tensor& z,
                                             const Tensor& bone_length, bool self_feed) {
  const GruWeights first(decoder_->first, decoder_->embed), second(decoder_->second);
  const Tensor zero = torch::zeros({batch.size(), hidden_}, batch.motion.options());
  const Tensor start = torch::zeros({1, batch.size(), pose_}, batch.motion.options());
  if (!self_feed) {
    const Tensor before = torch::cat({start, batch.motion.slice(0, 0, -1)});             // (T,B,D)
    const Tensor states = GruLayer(torch::cat({before, condition, z}, 2), zero, first);  // (T,B,H)
    const Tensor output = Decode(GruLayer(states, zero, second));                        // (T,B,D)
    return {output, feed_joints_ ? Joints(output, bone_length) : Tensor(), before};
  }
  const Tensor known = torch::cat({condition, z}, 2);  // (T,B,C + 1 + Z)
  GruFrames first_frames(first, batch.frames(), batch.size()), second_frames(second, batch.frames(), batch.size());
  Tensor state0 = zero, state1 = zero;
  std::vector<Tensor> outputs, joints, before = {start[0]};
  for (std::int64_t t = 0; t < batch.frames(); ++t) {
    state0 = first_frames.Step(torch::cat({before.back(), known[t]}, 1), state0);  // (B,H)
    state1 = second_frames.Step(state0, state1);
    outputs.push_back(Decode(state1));  // (B,D)
    if (feed_joints_) joints.push_back(Joints(outputs.back(), bone_length[t]));
    before.push_back(feed_joints_ ? joints.back() : outputs.back());
  }
  before.pop_back();
  return {torch::stack(outputs), feed_joints_ ? torch::stack(joints) : Tensor(), torch::stack(before)};
}

Losses Action2Motion::Loss(const Batch& batch, Draws& draws, int /*phase*/) {
  const std::int64_t T = batch.frames(), B = batch.size();
  const bool self_feed = draws.Coin("self_feed", self_feed_);
  const Tensor noise = draws.Normal("noise", T, B, latent_).to(batch.motion.device());
  const Tensor condition = Conditions(batch.label, T);
  const Tensor bone_length = lie_ ? LieBoneLengths(kinematics_, batch.motion) : Tensor();  // (T,B,J)

  const Tensor zero = torch::zeros({B, hidden_}, batch.motion.options());
  const Tensor encoded = GruLayer(torch::cat({batch.motion, condition}, 2), zero,
                                  GruWeights(posterior_->gru, posterior_->embed));  // (T,B,H)
  const Tensor mean_q = posterior_->mu_net->forward(encoded), lv_q = posterior_->logvar_net->forward(encoded);
  const Tensor z = mean_q + noise * torch::exp(0.5 * lv_q);  // (T,B,Z)

  const Rollout rollout = Unroll(batch, condition, z, bone_length, self_feed);
  const Tensor expected =
      GruLayer(torch::cat({rollout.before, condition}, 2), zero, GruWeights(prior_->gru, prior_->embed));  // (T,B,H)
  const Tensor mean_p = prior_->mu_net->forward(expected), lv_p = prior_->logvar_net->forward(expected);
  const Tensor joints = feed_joints_ ? rollout.joints : Joints(rollout.output, bone_length);

  const double rows = static_cast<double>(mean_loss_ ? batch.whole * pose_ : batch.whole);
  const Tensor reconstruction = (joints - batch.motion).square().sum({1, 2}) / rows;                     // (T)
  const Tensor kl = KlTerms(mean_q, lv_q, mean_p, lv_p).sum({1, 2}) / static_cast<double>(batch.whole);  // (T)
  Losses losses;
  losses.total = reconstruction.sum() + kl_weight_ * kl.sum();
  losses.terms = {{"loss", losses.total / T}, {"reconstruction", reconstruction.sum() / T}, {"kl", kl.sum() / T}};
  losses.outputs = {{"reconstruction", reconstruction},
                    {"kl", kl},
                    {"output", rollout.output},
                    {"joints", joints},
                    {"z", z},
                    {"mean", mean_q},
                    {"log_variance", lv_q},
                    {"prior_mean", mean_p},
                    {"prior_log_variance", lv_p}};
  return losses;
}

Motions Action2Motion::Answer(const RequestBatch& requests, Draws& draws) {
  const std::int64_t B = requests.label.size(0), T = requests.frames;
  const Tensor noise = draws.Normal("generator.motion", T, B, latent_);
  const Tensor condition = Conditions(requests.label, T);
  const GruWeights prior(prior_->gru, prior_->embed), first(decoder_->first, decoder_->embed), second(decoder_->second);
  Tensor state = torch::zeros({B, hidden_}), state0 = state, state1 = state;
  Tensor before = torch::zeros({B, pose_});
  const Tensor output = torch::empty({T, B, pose_});
  for (std::int64_t t = 0; t < T; ++t) {
    const Tensor input = torch::cat({before, condition[t]}, 1);
    state = GruStep(input, state, prior);
    const Tensor deviation = torch::exp(0.5 * prior_->logvar_net->forward(state));
    const Tensor z = torch::addcmul(prior_->mu_net->forward(state), noise[t], deviation);  // (B,Z)
    state0 = GruStep(torch::cat({input, z}, 1), state0, first);
    state1 = GruStep(state0, state1, second);
    const Tensor y = Decode(state1);
    output[t].copy_(y);
    before = feed_joints_ ? Joints(y, requests.bone_length) : y;
  }
  if (!lie_) return {output, output};
  const Tensor lengths = requests.bone_length.unsqueeze(0).expand({T, -1, -1});
  return {Joints(output, lengths), output};
}

}  // namespace mocurate
