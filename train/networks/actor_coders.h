#pragma once

#include <torch/torch.h>

#include <memory>
#include <utility>

#include "train/layers/dropout.h"
#include "train/layers/transformer.h"
#include "train/options.h"

namespace mocurate {

/// Sizes of a coder: F values a frame, C classes.
struct CoderSizes {
  std::int64_t features = 150;
  std::int64_t classes = 12;
  std::int64_t frames = 60;  ///< of coders of fixed length
};

/// Frames of motions, with their class.
struct CodedMotion {
  torch::Tensor frames;  ///< (T,B,F)
  torch::Tensor label;   ///< (B) int64
  torch::Tensor valid;   ///< (T,B) bool; undefined: all
};

/// Mean and log-variance of the latent, (B,E) each.
struct ActorEncoder : torch::nn::Module {
  virtual std::pair<torch::Tensor, torch::Tensor> Encode(const CodedMotion& motion, Dropout& dropout) = 0;
};

/// Frames (T,B,F) of a latent z (B,E); those that are padding are 0.
struct ActorDecoder : torch::nn::Module {
  /// `motion.frames` are read by an autoregressive decoder alone, which is fed the truth in training.
  virtual torch::Tensor Decode(const torch::Tensor& z, const CodedMotion& motion, Dropout& dropout) = 0;
  /// `frames` frames without the truth: for coders that need none, Decode.
  virtual torch::Tensor Generate(const torch::Tensor& z, const torch::Tensor& label, std::int64_t frames);
};

/// The coders that the options name, with the names of the released code:
///
///   transformer      encoder  frames - Linear(F,E); before them muQuery[y], sigmaQuery[y]; + PE; TransformerEncoder;
///                             outputs 0 and 1 are mean and log-variance. `average`: the mean over all outputs -
///                             mu_layer, sigma_layer
///                    decoder  memory z + actionBiases[y] (`one_hot`: ztimelinear([z | y]); `concatenated`: both as
///                             entries); queries PE(0..T-1); TransformerDecoder; Linear(E,F)
///   gru              encoder  [frame | y | time] - Linear - GRU; output of the last valid frame - mu, var
///                    decoder  [z | y | time] at each frame - Linear - GRU - Linear(E,F)
///   fully_connected  encoder  [all numbers | y] - 512 - GELU - 256 - GELU - mu, var; decoder [z | y] - GELU(256) -
///                             GELU(512) - GELU(all numbers): no output lies below -0.17 (a2m_actor.md F12)
///   autoregressive   encoder  of the transformer; decoder JoeyNMT's: source Linear([z | y | time]), targets the frames
///                             one later, Linear([frame | y | time]) + PE; layers; norm; Linear(E,F) without bias
std::pair<std::shared_ptr<ActorEncoder>, std::shared_ptr<ActorDecoder>> MakeActorCoders(const ActorOptions& options,
                                                                                        const CoderSizes& sizes);

}  // namespace mocurate
