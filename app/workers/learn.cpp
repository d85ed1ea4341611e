// Worker program for everything that needs libtorch: training and evaluating.

#include <cstdio>
#include <cstring>

#include "core/base/version.h"
#include "core/pipeline/worker.h"
#include "eval/options.h"
#include "eval/stages.h"
#include "train/generators/motion_generator.h"
#include "train/options.h"
#include "train/stages.h"

namespace {

/// The generator of a checkpoint, as the evaluation asks it.
mocurate::Expected<mocurate::AnswerRequests> OpenGeneratorCheckpoint(const std::filesystem::path& checkpoint,
                                                                     int threads) {
  using namespace mocurate;
  auto loaded = MotionGenerator::Load(checkpoint);
  if (!loaded) return Forward(loaded);
  const std::shared_ptr<const MotionGenerator> generator = std::move(*loaded);
  return [generator, threads](const std::vector<MotionRequest>& requests) -> Expected<std::vector<Motion>> {
    auto answered = generator->Generate(requests, threads);
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
    std::printf("%s\n", std::string(CreatedBy()).c_str());
    return 0;
  }
  return RunWorker({{TrainDeclaration().name, TrainStage},
                    {TrainCostDeclaration().name, TrainCostStage},
                    {GenerateDeclaration().name, GenerateStage},
                    {FeaturesDeclaration().name, MakeFeaturesStage(OpenGeneratorCheckpoint)},
                    {ScoreDeclaration().name, ScoreStage},
                    {CompareDeclaration().name, CompareStage}});
}
