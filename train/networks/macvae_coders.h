#pragma once

#include <torch/torch.h>

#include "train/layers/transformer.h"
#include "train/networks/network.h"

namespace mocurate {

/// Sizes of MACVAE: J joints, F = 3 J + 3 numbers of a frame as it is read (6 J + 3 by the paper), G = 6 J + 3 as it is
/// written, E the width, L the frames to which a motion is padded, V words.
struct MacvaeSizes {
  std::int64_t joints = 24;
  std::int64_t input = 75;  ///< F
  std::int64_t words = 0;   ///< V
  std::int64_t frames = 120;

  std::int64_t output() const { return 6 * joints + 3; }  ///< G
};

/// Mean and logarithm of the variance of the K latents, (B,K,E) each: K = 2, of the transition and of the action; or 1.
struct LatentMoments {
  torch::Tensor mean, log_variance;
};

/// Positions as released, where time and channel changed places (multiact.md C.2): channel c at frame t is sin(c w) for
/// even t, cos(c w) for odd t, w = 10000^(-2 floor(t/2) / L). (L,E); or the usual sines and cosines of the paper.
torch::Tensor EncoderPositions(std::int64_t frames, std::int64_t width, bool released);
/// The decoder's first `count`, of the rows of the encoder's `table` (L,1,E), for motions whose transition has
/// `transition` (B) frames: the second half of the channels counts from the first frame of the action again.
/// (count,B,E)
torch::Tensor DecoderPositions(const torch::Tensor& transition, const torch::Tensor& table, std::int64_t count);

/// PrevNet and CurrNet: the prior of both latents from the last frames of the previous motion and two words.
struct MacvaePriorImpl : torch::nn::Module {
  MacvaePriorImpl(const MacvaeOptions& options, const MacvaeSizes& sizes);
  /// `frames` (L,B,F) from the previous motion's first frame on; `parts` (B,3) frames, `word` (B,3).
  LatentMoments forward(const torch::Tensor& frames, const torch::Tensor& parts, const torch::Tensor& word);
  /// (B, frames F): what PrevNet reads.
  torch::Tensor PreviousOf(const torch::Tensor& frames, const torch::Tensor& parts) const;

  MacvaeOptions options;
  std::int64_t previous_frames;
  torch::nn::Embedding mean_actions{nullptr}, logvar_actions{nullptr};
  torch::nn::Linear pre_coder1{nullptr}, pre_coder2{nullptr};
  torch::nn::BatchNorm1d bn{nullptr};  ///< of the released file; nothing reads it
};
TORCH_MODULE(MacvaePrior);

/// Frames after each other: a transformer, or what takes its place in Table B.
struct FrameCoder : torch::nn::Module {
  /// `x` (T,B,E); `padded` (B,T) bool. Decoders see `memory` (2,B,E), each entry `count` (B,2) times, and at each frame
  /// the one of `phase` (T,B,2), one-hot.
  struct Memory {
    torch::Tensor entries, count, phase;
  };
  virtual torch::Tensor Run(const torch::Tensor& x, const torch::Tensor& padded, const Memory& memory,
                            Dropout& dropout) = 0;
};

/// Posterior of both latents from all frames.
struct MacvaeEncoderImpl : torch::nn::Module {
  MacvaeEncoderImpl(const MacvaeOptions& options, const MacvaeSizes& sizes);
  LatentMoments forward(const torch::Tensor& frames, const torch::Tensor& parts, const torch::Tensor& word,
                        Dropout& dropout);

  MacvaeOptions options;
  torch::Tensor positions;  ///< (L,1,E)
  torch::nn::Linear pre_coding{nullptr}, pose_coding{nullptr};
  torch::nn::Embedding action_embed{nullptr};
  std::shared_ptr<FrameCoder> encoder;
  torch::nn::Conv2d mean_conv{nullptr}, logvar_conv{nullptr};
  torch::nn::BatchNorm2d bn{nullptr};  ///< one for both branches, as released
  torch::nn::Linear mean_fc{nullptr}, logvar_fc{nullptr};
};
TORCH_MODULE(MacvaeEncoder);

/// Frames of transition and action from the latents.
struct MacvaeDecoderImpl : torch::nn::Module {
  MacvaeDecoderImpl(const MacvaeOptions& options, const MacvaeSizes& sizes);
  /// `z` (B,K,E), `count` frames that are wanted -> (count,B,G); those after the action are of no meaning.
  torch::Tensor forward(const torch::Tensor& z, const torch::Tensor& parts, std::int64_t count, Dropout& dropout);

  MacvaeOptions options;
  std::int64_t frames;
  torch::Tensor table;  ///< (L,1,E) positions
  std::shared_ptr<FrameCoder> decoder;
  torch::nn::Conv2d post_conv{nullptr};
};
TORCH_MODULE(MacvaeDecoder);

/// A convolution over five frames of (T,B,I) with a Conv2d's weights (O,1,5,I): `before` frames repeat the first,
/// 4 - before the last. (T,B,O)
torch::Tensor ConvolveFrames(const torch::Tensor& x, const torch::Tensor& weight, const torch::Tensor& bias,
                             std::int64_t before);

}  // namespace mocurate
