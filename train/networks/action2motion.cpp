#include "train/networks/action2motion.h"

#include <torch/torch.h>

#include <map>
#include <string>

#include "train/recognisers/gru_layer.h"
#include "train/recognisers/tensors.h"

namespace mocurate {
namespace {

using torch::Tensor;

// A cell whose input passes through a linear layer first. No activation lies between them (B.5), so the two products
// are one: W_ih (E x + e) + b_ih = (W_ih E) x + (W_ih e + b_ih).
struct Cell {
  Tensor input_weight, hidden_weight, input_bias, hidden_bias;

  Cell(const Weights& weights, const std::string& gru, const std::string& embed) {
    input_weight = weights.at(gru + "weight_ih");
    hidden_weight = weights.at(gru + "weight_hh");
    input_bias = weights.at(gru + "bias_ih");
    hidden_bias = weights.at(gru + "bias_hh");
    if (embed.empty()) return;
    input_bias = torch::addmv(input_bias, input_weight, weights.at(embed + ".bias"));
    input_weight = torch::mm(input_weight, weights.at(embed + ".weight"));
  }
  Tensor Step(const Tensor& input, const Tensor& hidden) const {
    return GruLayer(input.unsqueeze(0), hidden, input_weight, hidden_weight, input_bias, hidden_bias).squeeze(0);
  }
};

struct Gaussian {
  Tensor mean, log_variance;

  Gaussian(const Weights& weights, const std::string& net, const Tensor& hidden) {
    mean = torch::linear(hidden, weights.at(net + "/mu_net.weight"), weights.at(net + "/mu_net.bias"));
    log_variance = torch::linear(hidden, weights.at(net + "/logvar_net.weight"), weights.at(net + "/logvar_net.bias"));
  }
};

struct Decoder {
  const Weights& weights;
  bool lie;
  Cell first, second;
  Tensor hidden0, hidden1;

  Decoder(const Weights& all, const Action2MotionConfig& config, int batch)
      : weights(all),
        lie(config.lie.has_value()),
        first(all, "decoder/gru.0.", "decoder/embed"),
        second(all, "decoder/gru.1.", ""),
        hidden0(torch::zeros({batch, config.hidden})),
        hidden1(hidden0) {}

  Tensor Step(const Tensor& input) {
    hidden0 = first.Step(input, hidden0);
    hidden1 = second.Step(hidden0, hidden1);
    const Tensor y = torch::linear(hidden1, weights.at("decoder/output.weight"), weights.at("decoder/output.bias"));
    if (!lie) return y;
    const Tensor bent = torch::linear(torch::tanh(y.slice(1, 3)), weights.at("decoder/output_lie.weight"),
                                      weights.at("decoder/output_lie.bias"));
    return torch::cat({y.slice(1, 0, 3), torch::tanh(bent) * 3.1415926}, 1);
  }
};

// Forward kinematics with its analytic derivative, on (N,3J) rows.
struct Kinematics : torch::autograd::Function<Kinematics> {
  static Tensor forward(torch::autograd::AutogradContext* context, const Tensor& parameters, const Tensor& bone_length,
                        std::int64_t layer) {
    const Tensor dense = parameters.contiguous();
    context->save_for_backward({dense, bone_length});
    context->saved_data["layer"] = layer;
    Tensor joints = torch::empty_like(dense);
    reinterpret_cast<const LieLayer*>(layer)->Forward(dense.data_ptr<float>(), bone_length.data_ptr<float>(),
                                                      static_cast<int>(dense.size(0)), joints.data_ptr<float>());
    return joints;
  }
  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 torch::autograd::variable_list gradient) {
    const auto saved = context->get_saved_variables();
    const auto* layer = reinterpret_cast<const LieLayer*>(context->saved_data["layer"].toInt());
    const Tensor by_joints = gradient[0].contiguous();
    Tensor by_parameters = torch::empty_like(saved[0]);
    layer->Backward(saved[0].data_ptr<float>(), saved[1].data_ptr<float>(), by_joints.data_ptr<float>(),
                    static_cast<int>(by_joints.size(0)), by_parameters.data_ptr<float>());
    return {by_parameters, Tensor(), Tensor()};
  }
};

Tensor ApplyKinematics(const LieLayer& layer, const Tensor& parameters, const Tensor& bone_length) {
  return Kinematics::apply(parameters, bone_length, static_cast<std::int64_t>(reinterpret_cast<std::intptr_t>(&layer)));
}

// (T,B,C [+1]): one-hot label and time counter.
Tensor Conditions(const Action2MotionConfig& config, const std::vector<int>& label, int frames) {
  const int width = config.input() - config.pose();
  const int batch = static_cast<int>(label.size());
  Tensor condition = torch::zeros({frames, batch, width});
  float* row = condition.data_ptr<float>();
  for (int t = 0; t < frames; ++t) {
    const double time = config.time_counter == TimeCounter::kPaper ? (t + 1.0) / frames
                        : frames > 1                               ? static_cast<double>(t) / (frames - 1)
                                                                   : 0.0;
    for (int b = 0; b < batch; ++b, row += width) {
      row[label[b]] = 1.0f;
      if (config.time_counter != TimeCounter::kNone) row[config.classes] = static_cast<float>(time);
    }
  }
  return condition;
}

// Per number, before any sum: log(s_p/s_q) + (exp(lv_q) + (m_q-m_p)^2) / (2 exp(lv_p)) - 1/2.
Tensor KlTerms(const Tensor& mean_q, const Tensor& lv_q, const Tensor& mean_p, const Tensor& lv_p) {
  return 0.5 * (lv_p - lv_q) + (torch::exp(lv_q) + (mean_q - mean_p).square()) * (0.5 * torch::exp(-lv_p)) - 0.5;
}

struct Rollout {
  Tensor output;        // (T,B,3J)
  Tensor joints;        // (T,B,3J); undefined unless joints are fed back
  Tensor prior_hidden;  // (T,B,hidden)
};

Rollout RunDecoder(const Action2MotionConfig& config, const Weights& weights, const LieLayer& layer,
                   const Action2MotionBatch& batch, const Tensor& motion, const Tensor& condition, const Tensor& z,
                   const Tensor& bone_length) {
  const bool feed_joints = config.feedback == Feedback::kJoints && config.lie.has_value();
  const Cell prior(weights, "prior/gru.0.", "prior/embed");
  Decoder decoder(weights, config, batch.batch);
  Tensor hidden = torch::zeros({batch.batch, config.hidden});
  Tensor previous = torch::zeros({batch.batch, config.pose()});
  std::vector<Tensor> outputs, joints, hiddens;
  for (int t = 0; t < batch.frames; ++t) {
    const Tensor input = torch::cat({previous, condition[t]}, 1);
    hidden = prior.Step(input, hidden);
    hiddens.push_back(hidden);
    const Tensor y = decoder.Step(torch::cat({input, z[t]}, 1));
    outputs.push_back(y);
    if (feed_joints) joints.push_back(ApplyKinematics(layer, y, bone_length[t]));
    previous = !batch.self_feed ? motion[t] : feed_joints ? joints.back() : y;
  }
  Rollout rollout{torch::stack(outputs), Tensor(), torch::stack(hiddens)};
  if (feed_joints) rollout.joints = torch::stack(joints);
  return rollout;
}

void KeepTrace(const Gaussian& posterior, const Gaussian& prior, const Tensor& z, const Rollout& rollout,
               const Tensor& joints, const Tensor& reconstruction, const Tensor& kl, Action2MotionTrace& trace) {
  trace.output = Numbers(rollout.output);
  trace.joints = Numbers(joints);
  trace.z = Numbers(z);
  trace.mean = Numbers(posterior.mean);
  trace.log_variance = Numbers(posterior.log_variance);
  trace.prior_mean = Numbers(prior.mean);
  trace.prior_log_variance = Numbers(prior.log_variance);
  for (const float value : Numbers(reconstruction)) trace.reconstruction.push_back(value);
  for (const float value : Numbers(kl)) trace.kl.push_back(value);
}

}  // namespace

ParameterList Action2MotionParameters(const Action2MotionConfig& config) {
  ParameterList parameters;
  for (const std::string net : {"prior", "posterior"}) {
    AddLinear(net + "/embed", config.input(), config.hidden, parameters);
    AddGru(net + "/gru.0.", "", config.hidden, config.hidden, parameters);
    AddLinear(net + "/mu_net", config.hidden, config.latent, parameters);
    AddLinear(net + "/logvar_net", config.hidden, config.latent, parameters);
  }
  AddLinear("decoder/embed", config.input() + config.latent, config.hidden, parameters);
  AddGru("decoder/gru.0.", "", config.hidden, config.hidden, parameters);
  AddGru("decoder/gru.1.", "", config.hidden, config.hidden, parameters);
  AddLinear("decoder/output", config.hidden, config.pose(), parameters);
  if (config.lie) AddLinear("decoder/output_lie", config.pose() - 3, config.pose() - 3, parameters);
  return parameters;
}

Action2MotionLoss Action2MotionStep(const Action2MotionConfig& config, const Action2MotionBatch& batch,
                                    ParameterList& parameters, Action2MotionTrace* trace) {
  torch::set_num_threads(1);
  const int T = batch.frames, B = batch.batch;
  const LieLayer layer = config.lie ? LieLayer(*config.lie, config.exp) : LieLayer();
  const Weights weights = MakeWeights(parameters, true);
  const Tensor motion = View(batch.motion, {T, B, config.pose()});
  const Tensor noise = View(batch.noise, {T, B, config.latent});
  const Tensor condition = Conditions(config, batch.label, T);
  Tensor bone_length;
  if (config.lie) {
    bone_length = torch::empty({T, B, config.joints});
    layer.BoneLengths(batch.motion.data(), T * B, bone_length.data_ptr<float>());
  }

  const Cell encoder(weights, "posterior/gru.0.", "posterior/embed");
  const Tensor encoded = GruLayer(torch::cat({motion, condition}, 2), torch::zeros({B, config.hidden}),
                                  encoder.input_weight, encoder.hidden_weight, encoder.input_bias, encoder.hidden_bias);
  const Gaussian posterior(weights, "posterior", encoded);
  const Tensor z = posterior.mean + noise * torch::exp(0.5 * posterior.log_variance);
  const Rollout rollout = RunDecoder(config, weights, layer, batch, motion, condition, z, bone_length);
  const Gaussian prior(weights, "prior", rollout.prior_hidden);
  Tensor joints = rollout.output;
  if (config.lie) {
    joints = rollout.joints.defined() ? rollout.joints
                                      : ApplyKinematics(layer, rollout.output.view({T * B, config.pose()}),
                                                        bone_length.view({T * B, config.joints}))
                                            .view({T, B, config.pose()});
  }
  const double rows = config.reconstruction == Reconstruction::kMean ? B * config.pose() : B;
  const Tensor reconstruction = (joints - motion).square().sum({1, 2}) / rows;
  const Tensor kl =
      KlTerms(posterior.mean, posterior.log_variance, prior.mean, prior.log_variance).sum({1, 2}) / double(B);
  const Tensor total = reconstruction.sum() + config.kl_weight * kl.sum();

  std::vector<Tensor> inputs;
  for (const Parameter& parameter : parameters) inputs.push_back(weights.at(parameter.name));
  const std::vector<Tensor> gradients = torch::autograd::grad({total}, inputs);
  for (std::size_t i = 0; i < parameters.size(); ++i) parameters[i].gradient = Numbers(gradients[i]);
  if (trace != nullptr) KeepTrace(posterior, prior, z, rollout, joints, reconstruction, kl, *trace);
  return {total.item<double>(), reconstruction.sum().item<double>(), kl.sum().item<double>()};
}

Action2MotionAnswers Action2MotionForward(const Action2MotionConfig& config, const ParameterList& parameters,
                                          const Action2MotionRows& rows) {
  torch::set_num_threads(1);
  torch::NoGradGuard no_gradient;
  const Weights weights = MakeWeights(parameters, false);
  const Tensor prior_rows = View(rows.prior, {rows.frames, rows.batch, config.input()});
  const Tensor decoder_rows = View(rows.decoder, {rows.frames, rows.batch, config.input() + config.latent});
  const Cell prior(weights, "prior/gru.0.", "prior/embed");
  Decoder decoder(weights, config, rows.batch);
  Tensor hidden = torch::zeros({rows.batch, config.hidden});
  std::vector<Tensor> hiddens, outputs;
  for (int t = 0; t < rows.frames; ++t) {
    hidden = prior.Step(prior_rows[t], hidden);
    hiddens.push_back(hidden);
    outputs.push_back(decoder.Step(decoder_rows[t]));
  }
  const Gaussian gaussian(weights, "prior", torch::stack(hiddens));
  return {Numbers(torch::stack(hiddens)), Numbers(gaussian.mean), Numbers(gaussian.log_variance),
          Numbers(torch::stack(outputs))};
}

double GaussianKl(const std::vector<float>& mean_q, const std::vector<float>& log_variance_q,
                  const std::vector<float>& mean_p, const std::vector<float>& log_variance_p, int batch) {
  const std::int64_t size = static_cast<std::int64_t>(mean_q.size());
  return KlTerms(View(mean_q, {size}), View(log_variance_q, {size}), View(mean_p, {size}), View(log_variance_p, {size}))
             .sum()
             .item<double>() /
         batch;
}

std::vector<float> Action2MotionGenerate(const Action2MotionConfig& config, const ParameterList& parameters,
                                         const std::vector<int>& label, int frames, const std::vector<float>& noise,
                                         const std::vector<float>& bone_length) {
  torch::set_num_threads(1);
  torch::NoGradGuard no_gradient;
  const int B = static_cast<int>(label.size());
  const LieLayer layer = config.lie ? LieLayer(*config.lie, config.exp) : LieLayer();
  const bool feed_joints = config.feedback == Feedback::kJoints && config.lie.has_value();
  const Weights weights = MakeWeights(parameters, false);
  const Tensor condition = Conditions(config, label, frames);
  const Cell prior_cell(weights, "prior/gru.0.", "prior/embed");
  Decoder decoder(weights, config, B);
  Tensor hidden = torch::zeros({B, config.hidden});
  Tensor previous = torch::zeros({B, config.pose()});
  const std::size_t width = static_cast<std::size_t>(B) * config.pose();
  std::vector<float> output(width * frames), joints(feed_joints ? width : 0);
  for (int t = 0; t < frames; ++t) {
    const Tensor input = torch::cat({previous, condition[t]}, 1);
    hidden = prior_cell.Step(input, hidden);
    const Gaussian prior(weights, "prior", hidden);
    const Tensor eps =
        torch::from_blob(const_cast<float*>(noise.data()) + static_cast<std::size_t>(t) * B * config.latent,
                         {B, config.latent}, torch::kFloat32);
    const Tensor z = torch::addcmul(prior.mean, eps, torch::exp(0.5 * prior.log_variance));
    previous = decoder.Step(torch::cat({input, z}, 1)).contiguous();
    std::copy(previous.data_ptr<float>(), previous.data_ptr<float>() + width, output.data() + t * width);
    if (feed_joints) {
      layer.Forward(output.data() + t * width, bone_length.data(), B, joints.data());
      previous = View(joints, {B, config.pose()}).clone();
    }
  }
  return output;
}

}  // namespace mocurate
