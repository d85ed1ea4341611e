// Worker program for everything that needs libtorch: training and evaluating.

#include <cstring>

#include "core/base/terminal.h"
#include "core/base/version.h"
#include "core/pipeline/worker.h"
#include "eval/options.h"
#include "eval/stages.h"
#include "train/generators/long_motion.h"
#include "train/options.h"
#include "train/stages.h"

namespace {

/// Opens networks that answer the evaluation's requests.
mocurate::Expected<mocurate::AnswerRequests> OpenGenerators(const mocurate::GeneratorFiles& files, int threads) {
  using namespace mocurate;
  LongMotionNetworks networks;
  networks.align = files.align;
  for (const auto& [file, network] : {std::pair(&files.main, &networks.main), std::pair(&files.first, &networks.first),
                                      std::pair(&files.fill, &networks.fill)}) {
    if (file->empty()) continue;
    auto loaded = MotionGenerator::Load(*file);
    if (!loaded) return Forward(loaded);
    *network = std::move(*loaded);
  }
  return [networks, threads](const std::vector<MotionRequest>& requests) -> Expected<std::vector<Motion>> {
    auto answered = GenerateLongMotions(networks, requests, threads, [](double) { return !StopRequested(); });
    if (!answered) return Forward(answered);
    std::vector<Motion> motions;
    motions.reserve(answered->clips.size());
    for (Clip& clip : answered->clips) motions.push_back(std::move(*clip.motion));
    return motions;
  };
}

}  // namespace

int main(int argc, char** argv) {
  using namespace mocurate;
  if (argc == 2 && std::strcmp(argv[1], "--version") == 0) {
    Print("%s\n", std::string(CreatedBy()).c_str());
    return 0;
  }
  return RunWorker({{TrainDeclaration().name, TrainStage},
                    {TrainCostDeclaration().name, TrainCostStage},
                    {GenerateDeclaration().name, GenerateStage},
                    {FeaturesDeclaration().name, MakeFeaturesStage(OpenGenerators)},
                    {ScoreDeclaration().name, ScoreStage},
                    {CompareDeclaration().name, CompareStage}});
}
