#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "train/checkpoint/parameters.h"

namespace mocurate {

/// Weights of a network that was trained elsewhere.
struct ReleasedWeights {
  ParameterList parameters;  ///< by the network's own names
  std::int64_t steps = 0;    ///< as stated in the file; 0: not stated
};

/// Weights of a network of kind `kind` from a file of torch.save, in the form of the papers' code, or from a checkpoint
/// (.h5, .safetensors). No code of the file is executed. Other content, such as an optimiser's state, is ignored.
/// Errors: those of ReadTorchPickle and ReadCheckpoint; kInconsistent for a file without such a network.
Expected<ReleasedWeights> ReadReleasedWeights(const std::filesystem::path& path, const std::string& kind);

}  // namespace mocurate
