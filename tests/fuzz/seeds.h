#pragma once

#include <string>
#include <vector>

namespace mocurate {

/// A seed input of a fuzz target, made by our writer where one exists.
struct FuzzSeed {
  std::string target;
  std::string bytes;
};

using FuzzSeeds = std::vector<FuzzSeed>;

void AddMotionSeeds(FuzzSeeds& seeds);  ///< motion as text
void AddNotedSeeds(FuzzSeeds& seeds);   ///< JSON, labels, calibrations, configurations
void AddBinarySeeds(FuzzSeeds& seeds);  ///< arrays, pickles, clouds
void AddStoredSeeds(FuzzSeeds& seeds);  ///< files of the store

/// All seeds. Aborts when a writer fails.
FuzzSeeds AllFuzzSeeds();

}  // namespace mocurate
