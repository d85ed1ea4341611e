#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "core/base/file.h"
#include "tests/fuzz/seeds.h"
#include "tests/store/builders.h"
#include "tests/support/scratch_folder.h"
#include "train/checkpoint/checkpoint.h"

namespace mocurate {
namespace {

/// The bytes that `write` stores at a path.
template <typename Write>
void AddStored(FuzzSeeds& seeds, const std::string& target, const Write& write) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "seed";
  const Status written = write(path);
  const Expected<std::string> bytes = ReadFile(path);
  if (!written || !bytes) {
    std::fprintf(stderr, "seed of %s cannot be written to %s\n", target.c_str(), path.c_str());
    std::abort();
  }
  seeds.push_back({target, *bytes});
}

Checkpoint SmallCheckpoint() {
  Checkpoint checkpoint;
  checkpoint.kind = kGruRecogniserKind;
  checkpoint.labels = {"a", "b"};
  checkpoint.skeleton = test::Walker();
  checkpoint.history["loss"] = {3.0, 2.0};
  checkpoint.parameters = {{"classifier.weight", {2, 3}, {1, 2, 3, 4, 5, 6}}, {"classifier.bias", {2}, {0.5, -0.5}}};
  checkpoint.optimisers = {{"adam", 3, checkpoint.parameters, checkpoint.parameters}};
  return checkpoint;
}

}  // namespace

void AddStoredSeeds(FuzzSeeds& seeds) {
  AddStored(seeds, "store", [](const auto& path) { return WriteDataset(test::MakeDataset(), path); });
  AddStored(seeds, "store", [](const auto& path) { return WriteEvidence(test::MakeEvidenceClip(true), path); });
  AddStored(seeds, "store", [](const auto& path) { return WriteTruth(test::MakeTruth(), path); });
  AddStored(seeds, "checkpoint", [](const auto& path) { return WriteCheckpoint(SmallCheckpoint(), path); });
}

FuzzSeeds AllFuzzSeeds() {
  FuzzSeeds seeds;
  AddMotionSeeds(seeds);
  AddNotedSeeds(seeds);
  AddBinarySeeds(seeds);
  AddStoredSeeds(seeds);
  return seeds;
}

}  // namespace mocurate
