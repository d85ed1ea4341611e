#pragma once

#include <torch/torch.h>

#include "train/layers/dropout.h"

namespace mocurate {

/// Inputs of attention: `query` (T,B,E), `key` and `value` (S,B,E) lie beside each other in rows of one or two tensors
/// float32 on the CPU.
struct AttentionRows {
  torch::Tensor queries;  ///< (T,B,3E) query, key, value of frames that attend to themselves; or (T,B,E) the query
  torch::Tensor memory;   ///< (S,B,2E) key and value; undefined where `queries` holds them
};

/// Modifications of the weights.
struct AttentionRules {
  std::int64_t heads = 1;
  bool causal = false;   ///< frame t attends to entries 0..t
  torch::Tensor hidden;  ///< (B,S) bool of entries without weight; or undefined
  torch::Tensor bias;    ///< (B,S) added to the scores, no gradient; or undefined
  torch::Tensor kept;    ///< (B H T S) uint8 of weights that dropout keeps, which become `scale` times as large
  double scale = 1.0;
  torch::Tensor share;  ///< (B,H,T,S) factors of the weights, no gradient; or undefined
};

/// Multi-head attention between the projections, (T,B,E), as one differentiable function: each product reads and writes
/// the rows of its head where they lie.
torch::Tensor Attend(const AttentionRows& rows, const AttentionRules& rules);

/// The same in plain tensor operations: the reference of Attend, and what other devices run.
torch::Tensor PlainAttend(const AttentionRows& rows, const AttentionRules& rules);

/// Entries (S,B,E) with multiplicity `count` (B,S) in attention, 0 included.
struct RepeatedMemory {
  torch::Tensor entries, count;
};

/// Multi-head attention (Vaswani et al. 2017) with PyTorch's parameter names: in_proj_weight (3E,E), in_proj_bias (3E),
/// out_proj. Sequences come first: (T,B,E).
struct AttentionImpl : torch::nn::Module {
  AttentionImpl(std::int64_t width, std::int64_t heads);

  /// `x` (T,B,E) attends to itself. `padded` (B,T) bool, or undefined; `causal`: to itself and what is before it.
  torch::Tensor ToItself(const torch::Tensor& x, const torch::Tensor& padded, bool causal, Dropout& dropout);

  /// Keys and values of entries, (S,B,E) each.
  struct Seen {
    torch::Tensor key, value;
  };

  /// `x` (T,B,E) attends to `memory` (S,B,E), but for entries that are `padded` (B,S). With one entry its weight is 1:
  /// no query and no key is needed, and dropout zeroes a head at a frame (a2m_actor.md C.2).
  torch::Tensor To(const torch::Tensor& memory, const torch::Tensor& x, const torch::Tensor& padded, Dropout& dropout);

  /// `x` (T,B,E) attends to repeated entries: one key and value each, their scores higher by log(count). Dropout leaves
  /// out single copies, as of a memory that holds them all.
  torch::Tensor ToRepeated(const RepeatedMemory& memory, const torch::Tensor& x, Dropout& dropout);

  /// The memory's keys and values, and the attention of `x` to them, without dropout.
  Seen Remember(const torch::Tensor& memory) const;
  torch::Tensor Read(const torch::Tensor& x, const Seen& seen);
  /// One more frame, (1,B,E), that attends to itself and all before it, stored in `seen`.
  torch::Tensor Next(const torch::Tensor& x, Seen& seen);

  torch::Tensor in_proj_weight, in_proj_bias;
  torch::nn::Linear out_proj{nullptr};

 private:
  /// Rows [part E, (part + count) E) of the input projection.
  torch::Tensor Project(const torch::Tensor& x, std::int64_t part, std::int64_t count) const;
  torch::Tensor Weighted(const torch::Tensor& query, const torch::Tensor& key, const torch::Tensor& value);
  torch::Tensor ShareOfCopies(const torch::Tensor& count, std::int64_t frames, Dropout& dropout) const;
  torch::Tensor OfHeads(const torch::Tensor& x) const;
  std::int64_t width_, heads_;
};
TORCH_MODULE(Attention);

}  // namespace mocurate
