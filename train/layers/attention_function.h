#pragma once

#include <torch/torch.h>

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

}  // namespace mocurate
