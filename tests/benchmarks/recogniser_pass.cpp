// Logits and features of 3,000 motions of 60 x 72 numbers in one pass: one JSON line.

#include <cstdlib>
#include <filesystem>

#include "core/base/random.h"
#include "tests/benchmarks/json_line.h"
#include "tests/benchmarks/made_networks.h"
#include "tests/train/recogniser_runs.h"
#include "train/checkpoint/checkpoint.h"

int main(int argc, char** argv) {
  using namespace mocurate;
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "mocurate_recogniser_pass.h5";
  Checkpoint checkpoint;
  checkpoint.kind = kGruRecogniserKind;
  checkpoint.options = OptionsToJson(NetworkOptions(NetworkKind::kGruRecogniser));
  checkpoint.labels.assign(12, "label");
  checkpoint.parameters = GruRecogniserParameters({});
  benchmarks::FillRandomly(checkpoint.parameters);
  Random random(0, "benchmark");
  if (!WriteCheckpoint(checkpoint, path)) return 1;
  const auto recogniser = Recogniser::Load(path);
  std::filesystem::remove(path);
  if (!recogniser) return 1;
  std::vector<float> motions(static_cast<std::size_t>(3000) * 60 * 72);
  for (float& value : motions) value = static_cast<float>(random.Uniform(-0.5, 0.5));
  RecogniserHidden hidden;
  hidden.kind = InitialHidden::kNormal;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 1;
  benchmarks::Report(
      "recogniser_pass", 3000, "motions", argc > 1 ? std::atoi(argv[1]) : 3,
      [&] { (void)RunOn(**recogniser, motions, 3000, 60, 72, hidden, {}, threads); }, threads);
  return 0;
}
