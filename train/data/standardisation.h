#pragma once

#include <vector>

#include "train/data/training_clips.h"

namespace mocurate {

/// Mean and spread of every input number over the training clips. A recogniser trains on (x - mean) / spread, which it
/// learns from several times faster; folded into the first layer afterwards, the stored network takes plain joints.
struct Standardisation {
  std::vector<float> mean;
  std::vector<float> spread;  ///< at least 0.02 m

  /// Over all frames of the unchanged clips.
  static Standardisation Of(const RecogniserOptions& options, const std::vector<TrainingClip>& clips);
  void Apply(std::vector<float>& motion) const;
  /// From a network of standardised input to one of plain input.
  void Fold(ParameterList& parameters) const;
};

}  // namespace mocurate
