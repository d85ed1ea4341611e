#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "train/checkpoint/parameters.h"

namespace mocurate {

/// Weights of a network that was trained elsewhere.
struct ReleasedWeights {
  ParameterList parameters;  ///< by the network's own names
  std::int64_t steps = 0;    ///< as the file says; 0: it does not say
};

/// Weights of a network of kind `kind` from a file of torch.save, as the papers' code writes them, or from a checkpoint
/// (.h5, .safetensors). No code of the file runs. What else it holds (an optimiser's state) the network
/// does not ask for.
/// Errors: those of ReadTorchPickle and ReadCheckpoint; kInconsistent for a file without such a network.
Expected<ReleasedWeights> ReadReleasedWeights(const std::filesystem::path& path, const std::string& kind);

}  // namespace mocurate
