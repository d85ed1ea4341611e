#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>

#include "tests/fitting/cloud_takes.h"

namespace mocurate {

/// Reads [CLIPS [FRAMES [SEED [FOLDER]]]] from a program's arguments; returns the folder of the images.
inline std::filesystem::path GivenTakes(int argc, char** argv, const char* folder, CloudTakeOptions& wanted) {
  if (argc > 1) wanted.clips = std::atoi(argv[1]);
  if (argc > 2) wanted.frames = std::atoi(argv[2]);
  if (argc > 3) wanted.seed = static_cast<std::uint64_t>(std::atoll(argv[3]));
  return argc > 4 ? argv[4] : folder;
}

}  // namespace mocurate
