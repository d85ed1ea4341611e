#pragma once

#include "train/layers/body.h"
#include "train/layers/transformer.h"
#include "train/networks/network.h"

namespace mocurate {

/// A motion whose transition is filled: (L,B,J,3,3) and (L,B,3).
struct FilledMotion {
  torch::Tensor rotation, place;
};

/// Replaces the frames of the transition: frame j of l has the pose between the last frame of the previous action and
/// the first of the action, weight (j + 1) / (l + 1), each joint's rotation along the shortest turn, the root's place
/// on a line. `rotation` (L,B,J,3,3), `place` (L,B,3), `parts` (B,3) frames, of which the first and last are not 0.
FilledMotion SlerpFill(const torch::Tensor& rotation, const torch::Tensor& place, const torch::Tensor& parts);

/// A stand-in of SSMCT (Duan et al. 2021), of which no code is published (multiact.md F.2). It predicts the whole
/// transition between a previous action and an action in one pass. A frame has G = 6 J + 3 numbers: two columns of each
/// joint's rotation as 3 x 2 numbers row by row, and the root's place. E the width, L the longest motion.
///
///   x (T,B,G)                    frames of both actions; SlerpFill's between them; 0 behind them
///   h (T,B,E)  = input           Conv1d(G,E,3), zeros before the first frame and behind the last
///              + positions[t]    learned (L,E)
///              + tags[tag]       learned (3,E): 0 known, 1 missing, 2 padding
///   h (T,B,E)  = encoder         TransformerEncoderLayer times `layers` (norm after the sum, GELU), padding masked
///   y (T,B,G)  = output          Conv1d(E,G,3), zeros around the motion
///   frames     = y in the transition, x elsewhere; rotations by Gram-Schmidt of the two columns
///   loss = pose_weight mean|y - true numbers| + joint_weight mean|joints - true joints|
///
/// Means are over the frames of all transitions of the batch, so a batch must be one shard. The sizes are those of
/// MACVAE's encoder. `tags[2]` changes no frame that is read.
class Ssmct : public Network {
 public:
  Ssmct(const SsmctOptions& options, const LearningOptions& learning, const TrainingDataOptions& data,
        const NetworkSizes& sizes);

  std::vector<OptimiserGroup> Groups() override;
  Losses Loss(const Batch& batch, Draws& draws, int phase) override;
  /// Frames of the transition; motion b has parts(b,1) of them, the others mean nothing. A transition has at most L - 2
  /// frames. Where all three parts have more than L, the first frames of the previous action are not read, then the
  /// last of the action. Nothing is drawn.
  Motions Answer(const RequestBatch& requests, Draws& draws) override;

 private:
  friend struct NetworkParts;  // of the tests

  FilledMotion FramesOf(const Batch& batch) const;
  torch::Tensor RowsOf(const torch::Tensor& rotation, const torch::Tensor& place) const;
  torch::Tensor Fill(const FilledMotion& known, const torch::Tensor& parts, Dropout& dropout);
  torch::Tensor RotationsOf(const torch::Tensor& rows) const;
  torch::Tensor JointsOf(const torch::Tensor& rows) const;

  SsmctOptions options_;
  double learning_rate_, weight_decay_;
  std::int64_t joints_, frames_;
  BodyTree tree_;
  torch::nn::Conv1d input_{nullptr}, output_{nullptr};
  torch::Tensor positions_, tags_;
  TransformerStack encoder_{nullptr};
};

}  // namespace mocurate
