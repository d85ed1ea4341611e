#include "train/networks/macvae_coders.h"

#include <cmath>

#include "train/layers/frames.h"
#include "train/layers/gru_layer.h"

namespace mocurate {

using torch::Tensor;

namespace {

constexpr std::int64_t kTaps = 5;  // frames of every convolution

TransformerSizes LayerSizes(const MacvaeOptions& options) {
  return {options.width, options.heads, options.feed_forward, options.layers};
}

/// Channel c at frame t, both (any shape that broadcasts): the released code's exchange of time and channel.
Tensor ReleasedWave(const Tensor& time, const Tensor& channel, std::int64_t frames) {
  const Tensor pair = torch::floor(time / 2.0);
  const Tensor angle = torch::exp(pair * (-2.0 * std::log(10000.0) / static_cast<double>(frames))) * channel;
  return torch::where(time - 2.0 * pair == 0.0, torch::sin(angle), torch::cos(angle));
}

struct TransformerFrames : FrameCoder {
  TransformerFrames(const MacvaeOptions& options, bool decodes_) : decodes(decodes_) {
    torch::nn::ModuleList list;
    for (std::int64_t i = 0; i < options.layers; ++i) {
      layers.emplace_back(LayerSizes(options), decodes);
      list->push_back(layers.back());
    }
    register_module("layers", list);
    StartAsCopies(layers);
    norm = register_module("norm", torch::nn::LayerNorm(torch::nn::LayerNormOptions({options.width})));
  }

  Tensor Run(const Tensor& given, const Tensor& padded, const Memory& memory, Dropout& dropout) override {
    Tensor x = given;
    const RepeatedMemory repeated{memory.entries, memory.count};
    for (TransformerLayer& layer : layers) {
      x = decodes ? layer->Causal(x, padded, repeated, dropout) : layer->forward(x, padded, Tensor(), dropout);
    }
    return norm->forward(x);
  }

  bool decodes;
  std::vector<TransformerLayer> layers;
  torch::nn::LayerNorm norm{nullptr};
};

/// Table B: LSTM, GRU or MLP of the same width and depth (their sizes are not published; multiact.md C.4). A decoder
/// reads the latent of the frame's phase beside its position.
struct OtherFrames : FrameCoder {
  OtherFrames(const MacvaeOptions& options, bool decodes) : backbone(options.backbone), layers(options.layers) {
    const std::int64_t E = options.width;
    if (decodes) input = register_module("input", torch::nn::Linear(2 * E, E));
    if (backbone == MacvaeBackbone::kLstm) {
      lstm = register_module("lstm", torch::nn::LSTM(torch::nn::LSTMOptions(E, E).num_layers(layers)));
    } else if (backbone == MacvaeBackbone::kGru) {
      gru = register_module("gru", torch::nn::GRU(torch::nn::GRUOptions(E, E).num_layers(layers)));
    } else {
      mlp = register_module("mlp", torch::nn::Sequential());
      for (std::int64_t i = 0; i < layers; ++i) {
        mlp->push_back(torch::nn::Linear(E, E));
        mlp->push_back(torch::nn::GELU());
      }
    }
  }

  Tensor Run(const Tensor& given, const Tensor& /*padded*/, const Memory& memory, Dropout& dropout) override {
    Tensor x = given;
    if (input) {
      const Tensor latent = torch::einsum("tbk,kbe->tbe", {memory.phase, memory.entries});
      x = input->forward(torch::cat({x, latent}, 2));
    }
    x = dropout(x);
    if (backbone == MacvaeBackbone::kLstm) return std::get<0>(lstm->forward(x));
    if (backbone == MacvaeBackbone::kMlp) return mlp->forward(x);
    return GruStack(x, torch::zeros({layers, x.size(1), x.size(2)}, x.options()), gru);
  }

  MacvaeBackbone backbone;
  std::int64_t layers;
  torch::nn::Linear input{nullptr};
  torch::nn::LSTM lstm{nullptr};
  torch::nn::GRU gru{nullptr};
  torch::nn::Sequential mlp{nullptr};
};

std::shared_ptr<FrameCoder> MakeFrameCoder(const MacvaeOptions& options, bool decodes) {
  if (options.backbone == MacvaeBackbone::kTransformer) return std::make_shared<TransformerFrames>(options, decodes);
  return std::make_shared<OtherFrames>(options, decodes);
}

torch::nn::Conv2d FrameConvolution(std::int64_t input, std::int64_t output) {
  return torch::nn::Conv2d(torch::nn::Conv2dOptions(1, output, {kTaps, input}));
}

}  // namespace

Tensor ConvolveFrames(const Tensor& x, const Tensor& weight, const Tensor& bias, std::int64_t before) {
  const std::int64_t T = x.size(0), after = kTaps - 1 - before;
  std::vector<Tensor> padded(static_cast<std::size_t>(before), x.slice(0, 0, 1));
  padded.push_back(x);
  padded.insert(padded.end(), static_cast<std::size_t>(after), x.slice(0, T - 1, T));
  return ConvolveTaps(torch::cat(padded), weight.reshape({weight.size(0), -1}), bias);
}

Tensor EncoderPositions(std::int64_t frames, std::int64_t width, bool released) {
  if (!released) return PositionalTable(frames, width);
  const Tensor time = torch::arange(frames, torch::kFloat64).view({frames, 1, 1});
  return ReleasedWave(time, torch::arange(width, torch::kFloat64), frames).to(torch::kFloat32);  // (L,1,E)
}

Tensor DecoderPositions(const Tensor& transition, const Tensor& table, std::int64_t count) {
  const std::int64_t width = table.size(2);
  const Tensor rows = table.squeeze(1);                                  // (L,E)
  const Tensor time = torch::arange(count, torch::kInt64).unsqueeze(1);  // (count,1)
  const Tensor of_batch = transition.to(torch::kCPU).unsqueeze(0);       // (1,B)
  const Tensor since = torch::where(time < of_batch, time, time - of_batch);
  const Tensor first = rows.slice(0, 0, count).slice(1, 0, width / 2).unsqueeze(1);
  const Tensor second = rows.slice(1, width / 2).index_select(0, since.reshape({-1}));
  return torch::cat(
      {first.expand({count, since.size(1), width / 2}), second.view({count, since.size(1), width - width / 2})}, 2);
}

MacvaePriorImpl::MacvaePriorImpl(const MacvaeOptions& given, const MacvaeSizes& sizes)
    : options(given), previous_frames(given.whole_previous ? sizes.frames - 5 : given.previous_frames) {
  const std::int64_t E = options.width;
  mean_actions = register_module("mean_actions", torch::nn::Embedding(sizes.words, E));
  logvar_actions = register_module("logvar_actions", torch::nn::Embedding(sizes.words, E));
  pre_coder1 = register_module("pre_coder1", torch::nn::Linear(previous_frames * sizes.input, E));
  pre_coder2 = register_module("pre_coder2", torch::nn::Linear(previous_frames * sizes.input, E));
  bn = register_module("bn", torch::nn::BatchNorm1d(4 * E));
}

Tensor MacvaePriorImpl::PreviousOf(const Tensor& frames, const Tensor& parts) const {
  const Tensor back = torch::arange(-previous_frames, 0, parts.options()).unsqueeze(1);  // (P,1)
  const Tensor at = back + parts.select(1, 0).unsqueeze(0);                              // (P,B), before 0: none
  const Tensor chosen = RowsAt(frames, at.clamp_min(0)) * (at >= 0).unsqueeze(2);        // (P,B,F)
  return chosen.transpose(0, 1).reshape({frames.size(1), -1});
}

LatentMoments MacvaePriorImpl::forward(const Tensor& frames, const Tensor& parts, const Tensor& word) {
  const Tensor previous = PreviousOf(frames, parts);
  const auto moment = [&](torch::nn::Embedding& table, torch::nn::Linear& coder) {
    const Tensor of_previous = coder->forward(previous);  // (B,E)
    const auto row = [&](int part) { return table->forward(word.select(1, part)); };
    if (!options.separate_latents) return (of_previous + row(2)).unsqueeze(1);  // (B,1,E)
    Tensor of_transition = of_previous + row(1);
    if (options.action_to_previous) of_transition = of_transition + row(2);
    return torch::stack({of_transition, row(2)}, 1);  // (B,2,E)
  };
  return {moment(mean_actions, pre_coder1), moment(logvar_actions, pre_coder2)};
}

MacvaeEncoderImpl::MacvaeEncoderImpl(const MacvaeOptions& given, const MacvaeSizes& sizes)
    : options(given), positions(EncoderPositions(sizes.frames, given.width, given.released())) {
  const std::int64_t E = options.width;
  if (options.released()) {
    pre_coding = register_module("pre_coding", torch::nn::Linear(sizes.input + E, E));
    action_embed = register_module("action_embed", torch::nn::Embedding(sizes.words, E));
  } else {
    pose_coding = register_module("pose_coding", torch::nn::Linear(sizes.input, E - E / 2));
    action_embed = register_module("action_embed", torch::nn::Embedding(sizes.words, E / 2));
  }
  encoder = register_module("encoder", MakeFrameCoder(options, false));
  mean_conv = register_module("mean_conv", FrameConvolution(E, E));
  if (options.released()) logvar_conv = register_module("logvar_conv", FrameConvolution(E, E));
  bn = register_module("bn", torch::nn::BatchNorm2d(E));
  const std::int64_t heads = options.released() ? E : E * (options.separate_latents ? 2 : 1);
  mean_fc = register_module("mean_fc", torch::nn::Linear(E, heads));
  logvar_fc = register_module("logvar_fc", torch::nn::Linear(E, heads));
}

LatentMoments MacvaeEncoderImpl::forward(const Tensor& frames, const Tensor& parts, const Tensor& word,
                                         Dropout& dropout) {
  const std::int64_t L = frames.size(0), B = frames.size(1), E = options.width;
  const Tensor part = PartOf(parts, L);  // (L,B)
  const Tensor words = torch::cat({word, torch::zeros({B, 1}, word.options())}, 1);
  const Tensor of_frame = words.gather(1, part.t()).t();  // (L,B); padding has word 0
  const Tensor embedded = action_embed->forward(of_frame);
  const Tensor joined = options.released() ? pre_coding->forward(torch::cat({frames, embedded}, 2))
                                           : torch::cat({pose_coding->forward(frames), embedded}, 2);
  Tensor h = joined + positions.slice(0, 0, L).to(frames.device());  // (L,B,E)
  h = encoder->Run(h, (part == 3).t(), {}, dropout);                 // (L,B,E)
  const auto branch = [&](torch::nn::Conv2d& conv) {
    const Tensor convolved = ConvolveFrames(h, conv->weight, conv->bias, 2);  // (L,B,E)
    return torch::relu(bn->forward(convolved.reshape({L * B, E, 1, 1}))).view({L, B, E});
  };
  // Means over the frames of a part; a linear layer of the mean is the mean of the linear layer.
  std::vector<Tensor> members;
  if (!options.released()) {
    members = {(part < 3).to(torch::kFloat32)};
  } else if (options.separate_latents) {
    members = {(part == 1).to(torch::kFloat32), (part == 2).to(torch::kFloat32)};
  } else {
    members = {((part == 1) + (part == 2)).to(torch::kFloat32)};
  }
  const Tensor member = torch::stack(members);                       // (K,L,B)
  const Tensor weights = member / member.sum(1, true).clamp_min(1);  // (K,L,B)
  const auto pooled = [&](const Tensor& x) { return torch::einsum("lbe,klb->bke", {x, weights}); };
  const Tensor of_mean = branch(mean_conv);
  const Tensor of_variance = options.released() ? branch(logvar_conv) : of_mean;
  const auto heads = [&](torch::nn::Linear& fc, const Tensor& x) {
    return fc->forward(pooled(x)).reshape({B, -1, E});  // (B,K,E)
  };
  return {heads(mean_fc, of_mean), heads(logvar_fc, of_variance)};
}

MacvaeDecoderImpl::MacvaeDecoderImpl(const MacvaeOptions& given, const MacvaeSizes& sizes)
    : options(given), frames(sizes.frames), table(EncoderPositions(sizes.frames, given.width, given.released())) {
  decoder = register_module("decoder", MakeFrameCoder(options, true));
  post_conv = register_module("post_conv", FrameConvolution(options.width, sizes.output()));
}

Tensor MacvaeDecoderImpl::forward(const Tensor& z, const Tensor& parts, std::int64_t count, Dropout& dropout) {
  const std::int64_t T = std::min(count, frames);
  const Tensor positions = DecoderPositions(parts.select(1, 1), table, T);
  const Tensor time = torch::arange(T, parts.options()).unsqueeze(1);                 // (T,1)
  const Tensor begin = parts.select(1, 1), end = begin + parts.select(1, 2);          // (B)
  const Tensor transition = (time < begin), action = (time >= begin) * (time < end);  // (T,B)
  FrameCoder::Memory memory;
  memory.count = parts.slice(1, 1).to(torch::kFloat32);                      // (B,2)
  memory.phase = torch::stack({transition, action}, 2).to(torch::kFloat32);  // (T,B,2)
  memory.entries = z.expand({z.size(0), 2, z.size(2)}).transpose(0, 1);      // (2,B,E)
  const Tensor h = decoder->Run(positions.to(z.device()), (time >= end).t(), memory, dropout);
  return ConvolveFrames(h, post_conv->weight, post_conv->bias, kTaps - 1);
}

}  // namespace mocurate
