#pragma once

#include "train/layers/body.h"
#include "train/networks/actor_coders.h"
#include "train/networks/network.h"

namespace mocurate {

/// ACTOR (Petrovich et al. 2021; a2m_actor.md C): a VAE over whole motions whose coders are transformers. A frame is
/// the rotation of each joint (J rows of 6 numbers) and a row of the root's place since the first frame (x, y, z, 0, 0,
/// 0); F = 6 (J + 1), E = 256, C classes. MakeActorCoders lists the layers.
///
///   mean, log-variance (B,E) = encoder(frames (T,B,F), class);  z = mean + exp(log-variance / 2) noise
///   frames' (T,B,F) = decoder(z, class, T)
///   loss = pose_weight mean|frames' - frames|^2 + joint_weight mean|joints' - joints|^2
///        + vertex_weight mean|vertices' - vertices|^2 + kl_weight sum KL
///
/// Means are over valid frames and all numbers of a frame; KL is a sum over the batch as released (F11).
class Actor : public Network {
 public:
  Actor(const ActorOptions& options, const LearningOptions& learning, const TrainingDataOptions& data,
        const NetworkSizes& sizes);

  std::vector<OptimiserGroup> Groups() override;
  Losses Loss(const Batch& batch, Draws& draws, int phase) override;
  Motions Answer(const RequestBatch& requests, Draws& draws) override;
  std::int64_t latent_size() const override { return options_.latent; }
  torch::Tensor Encode(const Batch& batch, Draws& draws) override;

 private:
  friend struct NetworkParts;  // of the tests

  torch::Tensor FramesOf(const Batch& batch) const;
  /// (N,J,3,3) and (N,3) of rows (N,F).
  torch::Tensor RotationsOf(const torch::Tensor& rows) const;
  torch::Tensor PlacesOf(const torch::Tensor& rows) const;
  void AddBodyLosses(const torch::Tensor& decoded, const torch::Tensor& truth, const torch::Tensor& valid,
                     double whole_frames, Losses& losses) const;

  ActorOptions options_;
  double learning_rate_, weight_decay_;
  std::int64_t joints_, rows_, width_;
  BodyTree tree_;
  std::optional<SkinnedBody> skin_;
  std::shared_ptr<ActorEncoder> encoder_;
  std::shared_ptr<ActorDecoder> decoder_;
};

}  // namespace mocurate
