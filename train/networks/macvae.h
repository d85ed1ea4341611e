#pragma once

#include <optional>

#include "train/layers/body.h"
#include "train/networks/macvae_coders.h"

namespace mocurate {

/// MACVAE, the network of MultiAct (Lee et al. 2023; multiact.md C): transition and action that follow a motion, from
/// two latents. A motion is [previous action, transition, action], padded to L frames of F = 3 J + 3 numbers (rotation
/// vectors, place of the root); E = 512, V words.
///
///   posterior (B,2,E) = encoder(frames (L,B,F), words of all frames);  prior (B,2,E) = PrevNet(last 4 frames of the
///   previous action) + row of "transition"; CurrNet = row of the action
///   z = mean + exp(log-variance / 2) noise;  frames' (l_t + l_c,B,G) = decoder(z), G = 6 J + 3
///   frames'' (L,B,G) = convolution of [previous action, frames'] over five frames
///   loss = mean|pose'' - pose| + mean|points'' - points| + mean (second difference of joints'')^2 + kl_weight KL
///
/// With `protocol: paper` frames are 6-D rotations, the posterior is one mean over all frames with a head for each
/// latent, losses are sums over the frames of transition and action, and the acceleration is that of the points less
/// the true ones.
class Macvae : public Network {
 public:
  Macvae(const MacvaeOptions& options, const LearningOptions& learning, const TrainingDataOptions& data,
         const NetworkSizes& sizes);

  std::vector<OptimiserGroup> Groups() override;
  Losses Loss(const Batch& batch, Draws& draws, int phase) override;
  /// Frames of transition and action; motion b has parts(b,1) + parts(b,2) of them, the others mean nothing.
  Motions Answer(const RequestBatch& requests, Draws& draws) override;

 private:
  friend struct NetworkParts;  // of the tests

  /// Frames as they are read (L,B,F), and rotations (L,B,J,3,3) with places (L,B,3).
  struct Frames {
    torch::Tensor read, rotation, place;
  };
  struct Pose {
    torch::Tensor rotation;  ///< (T,B,J,3,3)
    torch::Tensor place;     ///< (T,B,3)
  };
  Frames FramesOf(const Batch& batch) const;
  torch::Tensor ReadFrames(const torch::Tensor& rotation, const torch::Tensor& place) const;
  /// (count,B,G) before and after the convolution, from the first frame of the motion on.
  struct Smoothed {
    torch::Tensor before, after;
  };
  Smoothed Smooth(const Frames& frames, const torch::Tensor& decoded, const torch::Tensor& parts,
                  std::int64_t count) const;
  Pose PoseOf(const torch::Tensor& rows) const;
  torch::Tensor PointsOf(const torch::Tensor& rotation, const torch::Tensor& place, torch::Tensor* joints) const;
  torch::Tensor Sum(const torch::Tensor& x, const torch::Tensor& counted) const;
  torch::Tensor Divergence(const LatentMoments& posterior, const LatentMoments& prior) const;

  MacvaeOptions options_;
  MacvaeSizes sizes_;
  double learning_rate_, weight_decay_;
  BodyTree tree_;
  std::optional<SkinnedBody> skin_;
  MacvaePrior prior_{nullptr};
  MacvaeEncoder encoder_{nullptr};
  MacvaeDecoder decoder_{nullptr};
  torch::nn::Conv2d smoothing_{nullptr};
};

}  // namespace mocurate
