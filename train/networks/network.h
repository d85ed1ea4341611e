#pragma once

#include <torch/torch.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/motion/skeleton.h"
#include "core/skin/skin.h"
#include "train/layers/draws.h"
#include "train/options.h"

namespace mocurate {

/// Sizes and skeleton of a network.
struct NetworkSizes {
  int joints = 24;
  int classes = 12;
  LieChains chains;                   ///< of the skeleton; read where a network decodes rotations
  std::vector<int> parents;           ///< (J) of the tree; -1 for the root
  std::vector<Vector3d> rest_offset;  ///< (J) metres, median of the training set
  std::shared_ptr<const Skin> skin;   ///< null: only the tree
  std::int64_t words = 0;             ///< labels of segments, for networks trained on them

  std::int64_t pose() const { return 3 * static_cast<std::int64_t>(joints); }
};

/// Motions of one shard of a training batch.
struct Batch {
  torch::Tensor motion;         ///< (T,B,D) float32 joints, metres, first root at the origin
  torch::Tensor label;          ///< (B) int64
  std::int64_t whole = 0;       ///< motions of the whole batch: means divide by it, so that gradients of shards add up
  std::int64_t first = 0;       ///< place of a shard's first motion in the whole batch
  torch::Tensor rotation = {};  ///< (T,B,J,3,3) parent_from_joint; undefined where the network does not need it
  torch::Tensor valid = {};     ///< (T,B) bool: frames that are no padding; undefined: all
  std::int64_t whole_frames = 0;  ///< valid frames of the whole batch
  torch::Tensor features = {};  ///< (T,B,F) frames as the network reads them, in the place of the others; or undefined
  torch::Tensor parts = {};     ///< (B,3) int64 frames of previous action, transition and action; or undefined
  torch::Tensor word = {};      ///< (B,3) int64 their labels, in the vocabulary of the set

  std::int64_t frames() const { return features.defined() ? features.size(0) : motion.size(0); }
  std::int64_t size() const { return label.size(0); }
};

/// Loss of a shard. `terms` are scalars for the history, `outputs` what other implementations can be compared in.
struct Losses {
  torch::Tensor total;
  std::vector<std::pair<std::string, torch::Tensor>> terms;
  std::vector<std::pair<std::string, torch::Tensor>> outputs;
};

/// Parameters that one optimiser steps.
struct OptimiserGroup {
  enum class Rule { kAdam, kAdamW, kRmsProp };
  std::string name;
  std::vector<torch::Tensor> parameters;
  Rule rule = Rule::kAdam;
  double learning_rate = 2e-4;
  double weight_decay = 0.0;
  double beta1 = 0.9;
};

/// Requested motions: B of them, of the same number of frames.
struct RequestBatch {
  torch::Tensor label;  ///< (B) int64
  int frames = 60;
  torch::Tensor bone_length;  ///< (B,J) metres, 0 for the root
  torch::Tensor first_pose;   ///< (B,D) metres, root at the origin; undefined where requests have none
  /// Of networks that continue a motion: frames and words of its three parts as in Batch, and the previous motion in
  /// the frame in which the network learned, (P,B,J,3,3) and (P,B,3), padded.
  torch::Tensor parts = {}, word = {}, previous_rotation = {}, previous_place = {};
  /// Of networks that fill a transition: the action that follows, in the same frame, (N,B,J,3,3) and (N,B,3), padded.
  torch::Tensor next_rotation = {}, next_place = {};
};

/// Output of a network for requests.
struct Motions {
  torch::Tensor joints;         ///< (T,B,D) metres
  torch::Tensor output;         ///< (T,B,F) output of the last layer: Lie parameters, rotations, or joints
  torch::Tensor rotation = {};  ///< (T,B,J,3,3) parent_from_joint; undefined where the network outputs joints only
};

/// Accuracy and loss of a classifier on held-out motions, sums over the batch.
struct ValidationScore {
  double right = 0.0;
  double loss = 0.0;
};

/// Purpose of the draw of a whole motion's latent (Draws::Give).
constexpr const char* kMotionLatent = "generator.latent";

/// A network that a trainer can train. Parameters bear the released names (`register_module`).
class Network : public torch::nn::Module {
 public:
  /// Optimisers, one a phase of a training step, in their order.
  virtual std::vector<OptimiserGroup> Groups() = 0;
  /// The phases that step `step` of `steps` runs, in order: positions in Groups().
  virtual std::vector<int> Phases(std::int64_t step, std::int64_t steps) const;
  /// Loss of one shard by the parameters of that phase.
  virtual Losses Loss(const Batch& batch, Draws& draws, int phase) = 0;
  /// After the optimiser of that phase has stepped.
  virtual void AfterStep(int /*phase*/) {}

  /// Motions for requests; no gradients are kept.
  virtual Motions Answer(const RequestBatch& requests, Draws& draws) = 0;

  /// Numbers of the latent of a whole motion, drawn as kMotionLatent (1,B,E); 0: the network has none.
  virtual std::int64_t latent_size() const { return 0; }
  /// Such latents of motions, for networks that encode them: (1,B,E).
  virtual torch::Tensor Encode(const Batch& /*batch*/, Draws& /*draws*/) { return {}; }

  /// Of recognisers only.
  virtual ValidationScore Validate(const Batch& batch);
  /// Before training: mean and standard deviation of every number of a frame, (D) each.
  virtual void Standardise(const torch::Tensor& /*mean*/, const torch::Tensor& /*deviation*/) {}
  /// After training: folds all learned values into its parameters.
  virtual void Finish() {}
};

/// All parameters of a module under Adam, under AdamW.
OptimiserGroup AdamGroup(const torch::nn::Module& module, double learning_rate, double weight_decay);
OptimiserGroup AdamWGroup(const torch::nn::Module& module, double learning_rate, double weight_decay);

/// Of the logits (B,C) for classes (B).
ValidationScore ScoreOf(const torch::Tensor& logits, const torch::Tensor& label);

/// The network that `options` ask for, its initial values drawn from their seed.
std::shared_ptr<Network> MakeNetwork(const NetworkOptions& options, const NetworkSizes& sizes);

/// Sizes for a dataset or a checkpoint. `rest_offset` (J): of a usual person; empty: those of the skeleton.
NetworkSizes SizesOf(const Skeleton& skeleton, std::size_t classes, const std::vector<Vector3d>& rest_offset = {});

/// (B) classes -> (B,classes) float32.
torch::Tensor OneHot(const torch::Tensor& label, std::int64_t classes);

}  // namespace mocurate
