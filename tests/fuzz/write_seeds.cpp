// Writes the seed inputs of every fuzz target, one folder per target: fuzz_seeds FOLDER.

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/seeds.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
    return 2;
  }
  int count = 0;
  for (const mocurate::FuzzSeed& seed : mocurate::AllFuzzSeeds()) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / seed.target;
    std::filesystem::create_directories(folder);
    std::ofstream file(folder / ("seed" + std::to_string(count++)), std::ios::binary);
    if (!(file << seed.bytes).flush()) {
      std::fprintf(stderr, "fuzz_seeds: cannot write to %s\n", folder.c_str());
      return 74;
    }
  }
  return 0;
}
