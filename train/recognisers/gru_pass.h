#pragma once

#include <vector>

#include "train/checkpoint/parameters.h"

namespace mocurate {

/// Sizes of Action2Motion's recogniser (a2m_actor.md D.1): GRU(input, hidden, layers) - output of the last frame -
/// Linear(hidden, features) - tanh (the features) - Linear(features, classes) (the logits). MultiAct's has 4 layers of
/// 256 (multiact.md E).
struct GruRecogniserConfig {
  int input = 72;
  int classes = 12;
  int hidden = 128;
  int layers = 2;
  int features = 30;
};

/// Names and shapes of its parameters, without values.
ParameterList GruRecogniserParameters(const GruRecogniserConfig& config);

/// The recogniser without gradients: the layers of a chunk of motions advance frame by frame, so that what a frame
/// needs stays in the second-level cache; matrix products by BLAS, gates by GruGates. The network that is trained
/// (GruRecogniser, libtorch) is its reference.
class GruPass {
 public:
  GruPass() = default;
  /// `parameters` as GruRecogniserParameters lists them.
  GruPass(const GruRecogniserConfig& config, const ParameterList& parameters);

  /// `motions` (count, frames, input). `read_out` (count): frames after which a motion's state counts, or empty: all.
  /// `hidden` (layers, count, H): initial states, or null: zero. Writes `features` (count, features) and `logits`
  /// (count, classes). Safe to call from several threads at once.
  void Run(const float* motions, int count, int frames, const std::vector<int>& read_out, const float* hidden,
           float* features, float* logits) const;

 private:
  struct Layer {
    int input = 0;
    std::vector<float> reset_update;     ///< (2H, input + H): [W_i | W_h] of r and z
    std::vector<float> candidate_input;  ///< (H, input)
    std::vector<float> candidate_state;  ///< (H, H)
    std::vector<float> bias;             ///< (4H) as GruGateInput
  };
  GruRecogniserConfig config_;
  std::vector<Layer> layers_;
  std::vector<float> linear1_, bias1_, linear2_, bias2_;
};

}  // namespace mocurate
