#include "train/networks/actor_coders.h"

#include "train/layers/gru_layer.h"
#include "train/networks/network.h"

namespace mocurate {
namespace {

using torch::Tensor;

TransformerSizes SizesOfLayers(const ActorOptions& options) {
  return {options.latent, options.heads, options.feed_forward, options.layers};
}

Tensor PaddedOf(const CodedMotion& motion) {
  return motion.valid.defined() ? motion.valid.t().logical_not() : Tensor();  // (B,T)
}

Tensor WithoutPadding(const Tensor& frames, const Tensor& valid) {
  return valid.defined() ? frames * valid.unsqueeze(2) : frames;
}

/// Frames of each motion (B), float32.
Tensor LengthsOf(const CodedMotion& motion) {
  if (motion.valid.defined()) return motion.valid.sum(0).to(torch::kFloat32);
  return torch::full({motion.frames.size(1)}, static_cast<double>(motion.frames.size(0)), motion.frames.options());
}

/// t / (length - 1) at each frame, 0 on padding: (T,B,1).
Tensor TimeColumn(const CodedMotion& motion) {
  const Tensor t = torch::arange(motion.frames.size(0), motion.frames.options()).unsqueeze(1);  // (T,1)
  const Tensor time = t / (LengthsOf(motion) - 1.0).clamp_min(1.0).unsqueeze(0);                // (T,B)
  return WithoutPadding(time.unsqueeze(2), motion.valid);
}

/// [x | y | time] of each frame: (T,B,X+C+1). `x` (T,B,X), or (B,X) for the same at all frames.
Tensor WithClassAndTime(const Tensor& x, const CodedMotion& motion, std::int64_t classes) {
  const std::int64_t T = motion.frames.size(0);
  const Tensor of_frames = x.dim() == 3 ? x : x.unsqueeze(0).expand({T, -1, -1});
  const Tensor one_hot = OneHot(motion.label, classes).unsqueeze(0).expand({T, -1, -1});
  return torch::cat({of_frames, one_hot, TimeColumn(motion)}, 2);
}

struct TransformerCoder : ActorEncoder {
  TransformerCoder(const ActorOptions& options, const CoderSizes& sizes)
      : tokens(options.distribution == DistributionChoice::kTokens) {
    const std::int64_t E = options.latent;
    if (tokens) {
      mu_query = register_parameter("muQuery", torch::randn({sizes.classes, E}));
      sigma_query = register_parameter("sigmaQuery", torch::randn({sizes.classes, E}));
    } else {
      mu_layer = register_module("mu_layer", torch::nn::Linear(E, E));
      sigma_layer = register_module("sigma_layer", torch::nn::Linear(E, E));
    }
    embedding = register_module("skelEmbedding", torch::nn::Linear(sizes.features, E));
    stack = register_module("seqTransEncoder", TransformerStack(SizesOfLayers(options), false));
  }

  std::pair<Tensor, Tensor> Encode(const CodedMotion& motion, Dropout& dropout) override {
    Tensor x = embedding->forward(motion.frames);  // (T,B,E)
    Tensor padded = PaddedOf(motion);              // (B,T)
    if (tokens) {
      x = torch::cat({mu_query.index_select(0, motion.label).unsqueeze(0),
                      sigma_query.index_select(0, motion.label).unsqueeze(0), x});  // (T+2,B,E)
      if (padded.defined()) padded = torch::cat({torch::zeros({padded.size(0), 2}, padded.options()), padded}, 1);
    }
    x = dropout(x + PositionalTable(x.size(0), x.size(2)).to(x.device()));
    x = stack->forward(x, padded, Tensor(), dropout);
    if (tokens) return {x[0], x[1]};
    const Tensor mean = x.mean(0);  // over padding, too, as released
    return {mu_layer->forward(mean), sigma_layer->forward(mean)};
  }

  bool tokens;
  Tensor mu_query, sigma_query;
  torch::nn::Linear mu_layer{nullptr}, sigma_layer{nullptr}, embedding{nullptr};
  TransformerStack stack{nullptr};
};

struct TransformerDecoder : ActorDecoder {
  TransformerDecoder(const ActorOptions& options, const CoderSizes& sizes)
      : condition(options.condition), classes(sizes.classes), latent(options.latent) {
    if (condition == ConditionChoice::kOneHot) {
      with_class = register_module("ztimelinear", torch::nn::Linear(latent + classes, latent));
    } else {
      bias = register_parameter("actionBiases", torch::randn({classes, latent}));
    }
    stack = register_module("seqTransDecoder", TransformerStack(SizesOfLayers(options), true));
    output = register_module("finallayer", torch::nn::Linear(latent, sizes.features));
  }

  Tensor Memory(const Tensor& z, const Tensor& label) {
    if (condition == ConditionChoice::kOneHot) {
      return with_class->forward(torch::cat({z, OneHot(label, classes)}, 1)).unsqueeze(0);
    }
    const Tensor of_class = bias.index_select(0, label);
    return condition == ConditionChoice::kBias ? (z + of_class).unsqueeze(0) : torch::stack({z, of_class});
  }

  Tensor Decode(const Tensor& z, const CodedMotion& motion, Dropout& dropout) override {
    const std::int64_t T = motion.frames.size(0), B = z.size(0);
    const Tensor queries = dropout(PositionalTable(T, latent).to(z.device()).expand({T, B, latent}));
    const Tensor x = stack->forward(queries, PaddedOf(motion), Memory(z, motion.label), dropout);  // (T,B,E)
    return WithoutPadding(output->forward(x), motion.valid);
  }

  ConditionChoice condition;
  std::int64_t classes, latent;
  Tensor bias;
  torch::nn::Linear with_class{nullptr}, output{nullptr};
  TransformerStack stack{nullptr};
};

struct GruCoder : ActorEncoder {
  GruCoder(const ActorOptions& options, const CoderSizes& sizes) : classes(sizes.classes), latent(options.latent) {
    embedding = register_module("feats_embedding", torch::nn::Linear(sizes.features + classes + 1, latent));
    gru = register_module("gru", torch::nn::GRU(torch::nn::GRUOptions(latent, latent).num_layers(options.layers)));
    mu = register_module("mu", torch::nn::Linear(latent, latent));
    var = register_module("var", torch::nn::Linear(latent, latent));
  }

  std::pair<Tensor, Tensor> Encode(const CodedMotion& motion, Dropout& /*dropout*/) override {
    const std::int64_t B = motion.label.size(0);
    const Tensor zero = torch::zeros({gru->options.num_layers(), B, latent}, motion.frames.options());
    const Tensor x = embedding->forward(WithClassAndTime(motion.frames, motion, classes));  // (T,B,E)
    const Tensor last = (LengthsOf(motion) - 1.0).to(torch::kInt64).view({1, B, 1}).expand({1, B, latent});
    const Tensor state = GruStack(x, zero, gru).gather(0, last).squeeze(0);  // (B,E)
    return {mu->forward(state), var->forward(state)};
  }

  std::int64_t classes, latent;
  torch::nn::Linear embedding{nullptr}, mu{nullptr}, var{nullptr};
  torch::nn::GRU gru{nullptr};
};

struct GruDecoder : ActorDecoder {
  GruDecoder(const ActorOptions& options, const CoderSizes& sizes) : classes(sizes.classes), latent(options.latent) {
    embedding = register_module("feats_embedding", torch::nn::Linear(latent + classes + 1, latent));
    gru = register_module("gru", torch::nn::GRU(torch::nn::GRUOptions(latent, latent).num_layers(options.layers)));
    output = register_module("final_layer", torch::nn::Linear(latent, sizes.features));
  }

  Tensor Decode(const Tensor& z, const CodedMotion& motion, Dropout& /*dropout*/) override {
    const Tensor zero = torch::zeros({gru->options.num_layers(), z.size(0), latent}, z.options());
    const Tensor x = embedding->forward(WithClassAndTime(z, motion, classes));  // (T,B,E)
    return WithoutPadding(output->forward(GruStack(x, zero, gru)), motion.valid);
  }

  std::int64_t classes, latent;
  torch::nn::Linear embedding{nullptr}, output{nullptr};
  torch::nn::GRU gru{nullptr};
};

torch::nn::Sequential GeluLayers(const std::vector<std::int64_t>& widths) {
  torch::nn::Sequential layers;
  for (std::size_t i = 0; i + 1 < widths.size(); ++i) {
    layers->push_back(torch::nn::Linear(widths[i], widths[i + 1]));
    layers->push_back(torch::nn::GELU());
  }
  return layers;
}

struct FullyConnectedCoder : ActorEncoder {
  FullyConnectedCoder(const ActorOptions& options, const CoderSizes& sizes) : classes(sizes.classes) {
    layers = register_module("fully_connected", GeluLayers({sizes.features * sizes.frames + classes, 512, 256}));
    mu = register_module("mu", torch::nn::Linear(256, options.latent));
    var = register_module("var", torch::nn::Linear(256, options.latent));
  }

  std::pair<Tensor, Tensor> Encode(const CodedMotion& motion, Dropout& /*dropout*/) override {
    const Tensor numbers = motion.frames.permute({1, 2, 0}).reshape({motion.label.size(0), -1});  // frames run fastest
    const Tensor x = layers->forward(torch::cat({numbers, OneHot(motion.label, classes)}, 1));
    return {mu->forward(x), var->forward(x)};
  }

  std::int64_t classes;
  torch::nn::Sequential layers{nullptr};
  torch::nn::Linear mu{nullptr}, var{nullptr};
};

struct FullyConnectedDecoder : ActorDecoder {
  FullyConnectedDecoder(const ActorOptions& options, const CoderSizes& sizes) : sizes_(sizes) {
    layers = register_module("fully_connected",
                             GeluLayers({options.latent + sizes.classes, 256, 512, sizes.features * sizes.frames}));
  }

  Tensor Decode(const Tensor& z, const CodedMotion& motion, Dropout& /*dropout*/) override {
    const Tensor x = layers->forward(torch::cat({z, OneHot(motion.label, sizes_.classes)}, 1));
    const Tensor frames = x.view({z.size(0), sizes_.features, sizes_.frames}).permute({2, 0, 1});  // (T,B,F)
    return WithoutPadding(frames, motion.valid);
  }

  CoderSizes sizes_;
  torch::nn::Sequential layers{nullptr};
};

struct AutoregressiveDecoder : ActorDecoder {
  AutoregressiveDecoder(const ActorOptions& options, const CoderSizes& sizes) : sizes_(sizes), latent(options.latent) {
    const std::int64_t more = sizes.classes + 1;
    source = register_module("source_embedding", torch::nn::Linear(latent + more, latent));
    target = register_module("target_embedding", torch::nn::Linear(sizes.features + more, latent));
    torch::nn::ModuleList list;
    for (std::int64_t i = 0; i < options.layers; ++i) {
      layers.emplace_back(SizesOfLayers(options));
      list->push_back(layers.back());
    }
    register_module("layers", list);
    norm = register_module("layer_norm", torch::nn::LayerNorm(torch::nn::LayerNormOptions({latent}).eps(1e-6)));
    output = register_module("output_layer",
                             torch::nn::Linear(torch::nn::LinearOptions(latent, sizes.features).bias(false)));
  }

  Tensor Decode(const Tensor& z, const CodedMotion& motion, Dropout& dropout) override {
    const std::int64_t T = motion.frames.size(0);
    const Tensor memory = source->forward(WithClassAndTime(z, motion, sizes_.classes));  // (T,B,E)
    const Tensor before =
        torch::cat({torch::zeros({1, z.size(0), sizes_.features}, z.options()), motion.frames.slice(0, 0, -1)});
    Tensor x = target->forward(WithClassAndTime(before, motion, sizes_.classes));
    x = dropout(x + PositionalTable(T, latent).to(z.device()));  // (T,B,E)
    for (CausalLayer& layer : layers) x = layer->forward(x, memory, PaddedOf(motion), dropout);
    return WithoutPadding(output->forward(norm->forward(x)), motion.valid);
  }

  Tensor Generate(const Tensor& z, const Tensor& label, std::int64_t frames) override {
    const std::int64_t B = z.size(0);
    CodedMotion motion{torch::zeros({frames, B, sizes_.features}, z.options()), label, Tensor()};
    const Tensor memory = source->forward(WithClassAndTime(z, motion, sizes_.classes));
    const Tensor known = WithClassAndTime(motion.frames, motion, sizes_.classes).slice(2, sizes_.features);
    const Tensor table = PositionalTable(frames, latent).to(z.device());
    std::vector<AttentionImpl::Seen> seen(layers.size()), of_memory;
    for (const CausalLayer& layer : layers) of_memory.push_back(layer->multihead_attn->Remember(memory));
    Tensor before = torch::zeros({1, B, sizes_.features}, z.options());
    std::vector<Tensor> outputs;
    for (std::int64_t t = 0; t < frames; ++t) {
      Tensor x = target->forward(torch::cat({before, known.slice(0, t, t + 1)}, 2)) + table[t];  // (1,B,E)
      for (std::size_t i = 0; i < layers.size(); ++i) x = layers[i]->Next(x, of_memory[i], seen[i]);
      before = output->forward(norm->forward(x));
      outputs.push_back(before);
    }
    return torch::cat(outputs);
  }

  CoderSizes sizes_;
  std::int64_t latent;
  torch::nn::Linear source{nullptr}, target{nullptr}, output{nullptr};
  std::vector<CausalLayer> layers;
  torch::nn::LayerNorm norm{nullptr};
};

}  // namespace

Tensor ActorDecoder::Generate(const Tensor& z, const Tensor& label, std::int64_t frames) {
  Dropout none;
  return Decode(z, {torch::zeros({frames, z.size(0), 1}, z.options()), label, Tensor()}, none);
}

std::pair<std::shared_ptr<ActorEncoder>, std::shared_ptr<ActorDecoder>> MakeActorCoders(const ActorOptions& options,
                                                                                        const CoderSizes& sizes) {
  switch (options.coders) {
    case ActorCoders::kGru:
      return {std::make_shared<GruCoder>(options, sizes), std::make_shared<GruDecoder>(options, sizes)};
    case ActorCoders::kFullyConnected:
      return {std::make_shared<FullyConnectedCoder>(options, sizes),
              std::make_shared<FullyConnectedDecoder>(options, sizes)};
    case ActorCoders::kAutoregressive:
      return {std::make_shared<TransformerCoder>(options, sizes),
              std::make_shared<AutoregressiveDecoder>(options, sizes)};
    case ActorCoders::kTransformer:
      break;
  }
  return {std::make_shared<TransformerCoder>(options, sizes), std::make_shared<TransformerDecoder>(options, sizes)};
}

}  // namespace mocurate
