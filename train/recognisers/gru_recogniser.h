#pragma once

#include <cstdint>
#include <vector>

#include "train/checkpoint/parameters.h"

namespace mocurate {

/// Action2Motion's recogniser (a2m_actor.md D.1): GRU(input, hidden, layers) -> last valid output -> Linear(hidden, 30)
/// -> tanh (the features) -> Linear(30, classes) (the logits). MultiAct's has 4 layers of 256 (multiact.md E).
struct GruRecogniserConfig {
  int input = 72;
  int classes = 12;
  int hidden = 128;
  int layers = 2;
  int features = 30;
};

/// Parameters with the released names ("recurrent.weight_ih_l0", "linear1.weight", ...), values zero.
ParameterList GruRecogniserParameters(const GruRecogniserConfig& config);

/// B motions of T frames, frame-major.
struct GruRecogniserBatch {
  int batch = 0;
  int frames = 0;
  std::vector<float> motion;          ///< (T,B,input)
  std::vector<int> length;            ///< (B) frames that count, or empty: all
  std::vector<float> initial_hidden;  ///< (layers,B,hidden), or empty: zero
};

struct GruRecogniserOutput {
  std::vector<float> features;  ///< (B,30)
  std::vector<float> logits;    ///< (B,classes)
};

/// Features and logits in one pass.
GruRecogniserOutput RunGruRecogniser(const GruRecogniserConfig& config, const ParameterList& parameters,
                                     const GruRecogniserBatch& batch);

/// Mean cross entropy of `label` (B), smoothed by `smoothing`; gradients of all parameters are overwritten. `logits`,
/// if not null, receives (B,classes).
double GruRecogniserStep(const GruRecogniserConfig& config, const GruRecogniserBatch& batch,
                         const std::vector<int>& label, double smoothing, ParameterList& parameters,
                         std::vector<float>* logits = nullptr);

}  // namespace mocurate
