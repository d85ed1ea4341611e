// A table of Real and one generator, in full: 20 repetitions of 3,000 motions, features and four metrics, from the
// dataset file (1,200 clips of HumanAct12 sizes) to the written result; the answers of the generator are given. Prints
// one JSON line. Arguments: default | released [repeats]. default: whole clips, zero hidden state: real clips pass the
// recogniser once, generated ones in each repetition. released: windows, random hidden states: all three sets of a
// repetition pass it, and all three are counted as items.

#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "core/store/store.h"
#include "eval/options.h"
#include "eval/stages.h"
#include "tests/benchmarks/json_line.h"
#include "tests/train/chains.h"
#include "train/checkpoint/checkpoint.h"
#include "train/options.h"
#include "train/recognisers/gru_recogniser.h"

namespace mocurate {
namespace {

constexpr int kClasses = 12;
constexpr int kFrames = 60;

SkeletonPtr HumanAct12Skeleton() {
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = "humanact12";
  skeleton->lie = HumanAct12Chains();
  for (int j = 0; j < 24; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.rest_offset = 0.2 * skeleton->lie->raw_offsets[static_cast<std::size_t>(j)];
    joint.mirror = j;
    skeleton->joints.push_back(joint);
  }
  const std::vector<int> parents = skeleton->LieParents();
  for (int j = 0; j < 24; ++j)
    skeleton->joints[static_cast<std::size_t>(j)].parent = parents[static_cast<std::size_t>(j)];
  return skeleton;
}

Motion RandomMotion(const SkeletonPtr& skeleton, Random& random) {
  Motion motion;
  motion.skeleton = skeleton;
  motion.joints = JointPositions(kFrames, skeleton->joint_count());
  for (double& value : motion.joints.xyz) value = random.Uniform(-0.5, 0.5);
  return motion;
}

Dataset RandomDataset(const SkeletonPtr& skeleton, int clips) {
  Dataset dataset;
  dataset.skeleton = skeleton;
  dataset.joints_only = true;
  for (int c = 0; c < kClasses; ++c) dataset.labels.push_back("label" + std::to_string(10 + c));
  Random random(0, "dataset");
  for (int i = 0; i < clips; ++i) {
    Clip clip;
    clip.identity.source = "benchmark";
    clip.identity.recording = std::to_string(100000 + i);
    clip.identity.end_frame = kFrames;
    clip.label = dataset.labels[static_cast<std::size_t>(i % kClasses)];
    clip.motion = RandomMotion(skeleton, random);
    dataset.clips.push_back(std::move(clip));
  }
  return dataset;
}

Status WriteRecogniser(RecogniserInputKind input, const std::filesystem::path& path) {
  RecogniserOptions options;
  options.input = input;
  Checkpoint checkpoint;
  checkpoint.kind = kGruRecogniserKind;
  checkpoint.options = OptionsToJson(options);
  checkpoint.labels.assign(kClasses, "label");
  checkpoint.parameters = GruRecogniserParameters({});
  Random random(0, "benchmark");
  Initialise(checkpoint.parameters, random);
  return WriteCheckpoint(checkpoint, path);
}

int Run(bool released, int repeats, const std::filesystem::path& folder) {
  const SkeletonPtr skeleton = HumanAct12Skeleton();
  const auto input = released ? RecogniserInputKind::kCrop : RecogniserInputKind::kResample;
  if (!WriteDataset(RandomDataset(skeleton, 1200), folder / "dataset.h5")) return 1;
  if (!WriteRecogniser(input, folder / "recogniser.h5")) return 1;
  EvaluateOptions options;
  options.random_hidden = released;
  std::vector<Motion> answers;
  Random random(1, "answers");
  for (int i = 0; i < options.motions; ++i) answers.push_back(RandomMotion(skeleton, random));
  const StageFunction evaluate = MakeEvaluateStage([&](const std::filesystem::path&) -> Expected<AnswerRequests> {
    return AnswerRequests([&](const std::vector<MotionRequest>&) { return answers; });
  });
  StageRequest request;
  request.options = OptionsToJson(options);
  request.inputs = {{"dataset", "dataset", folder / "dataset.h5", ""},
                    {"recogniser", "recogniser/1", folder / "recogniser.h5", ""},
                    {"generator", "generator", folder / "generator.h5", ""}};
  request.output = folder / "metrics.json";
  int exit_code = 0;
  benchmarks::Report(released ? "evaluation_released" : "evaluation",
                     static_cast<int>(options.repetitions * options.motions * (released ? 3 : 1)), "motions", repeats,
                     [&] {
                       const auto outcome = evaluate(request);
                       if (outcome) return;
                       std::fprintf(stderr, "%s\n", outcome.error().Message().c_str());
                       exit_code = 1;
                     });
  return exit_code;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  const bool released = argc > 1 && std::string(argv[1]) == "released";
  std::string pattern = (std::filesystem::temp_directory_path() / "mocurate_evaluation_XXXXXX").string();
  const std::filesystem::path folder = ::mkdtemp(pattern.data());
  const int exit_code = mocurate::Run(released, argc > 2 ? std::atoi(argv[2]) : 1, folder);
  std::filesystem::remove_all(folder);
  return exit_code;
}
