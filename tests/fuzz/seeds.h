#pragma once

#include <string>
#include <vector>

namespace mocurate {

/// A first input of a fuzz target, made by a writer of ours where there is one.
struct FuzzSeed {
  std::string target;
  std::string bytes;
};

using FuzzSeeds = std::vector<FuzzSeed>;

void AddMotionSeeds(FuzzSeeds& seeds);  ///< text that holds motion
void AddNotedSeeds(FuzzSeeds& seeds);   ///< JSON, labels, calibrations, configurations
void AddBinarySeeds(FuzzSeeds& seeds);  ///< arrays, pickles, clouds
void AddStoredSeeds(FuzzSeeds& seeds);  ///< files of the store

/// All of them. Aborts where a writer fails.
FuzzSeeds AllFuzzSeeds();

}  // namespace mocurate
