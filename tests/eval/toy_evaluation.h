#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "eval/options.h"
#include "eval/stages.h"
#include "tests/train/toy_dataset.h"
#include "train/generators/motion_generator.h"
#include "train/items.h"
#include "train/stages.h"

namespace mocurate {

/// A toy dataset with two recognisers and a barely trained generator, made once for all tests of a suite; requests on
/// them.
class ToyEvaluation : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = (std::filesystem::temp_directory_path() / "mocurate_evaluate_XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    dataset_ = ToyDataset(4);
    Save(dataset_, "dataset.h5");
    RecogniserOptions recogniser;
    recogniser.frames = 16;
    recogniser.hidden = 16;
    recogniser.epochs = 40;
    recogniser.learning_rate = 1e-2;
    recogniser.refit = false;
    for (const std::int64_t seed : {1, 2}) {
      recogniser.seed = seed;
      Train("recogniser/" + std::to_string(seed), {NetworkKind::kRecogniser, recogniser, {}});
    }
    GeneratorOptions generator;
    generator.lie = false;
    generator.frames = 16;
    generator.hidden = 8;
    generator.latent = 2;
    generator.iterations = 3;
    Train("Action2Motion", {NetworkKind::kAction2Motion, {}, generator});
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  static void Save(const Dataset& dataset, const std::string& name) {
    const Status written = WriteDataset(dataset, folder_ / name);
    ASSERT_TRUE(written) << written.error().Message();
  }

  /// Where the network of an item lies.
  static std::filesystem::path NetworkPath(std::string item) {
    std::replace(item.begin(), item.end(), '/', '_');
    return folder_ / (item + ".h5");
  }

  static void Train(const std::string& item, const NetworkOptions& options) {
    StageRequest request;
    request.stage = "train";
    request.item = item;
    request.options = OptionsToJson(options);
    request.inputs = {{"dataset", "dataset", folder_ / "dataset.h5", "0"}};
    request.output = NetworkPath(item);
    const auto outcome = TrainStage(request);
    ASSERT_TRUE(outcome) << outcome.error().Message();
  }

  /// Three repetitions of 90 motions on the dataset and both recognisers; generators are input names.
  static StageRequest Request(const std::vector<std::string>& generators) {
    StageRequest request;
    request.stage = "evaluate";
    request.item = "metrics";
    EvaluateOptions options;
    options.repetitions = 3;
    options.motions = 90;
    options.diversity_pairs = 100;
    request.options = OptionsToJson(options);
    request.inputs = {{"dataset", "dataset", folder_ / "dataset.h5", "0"},
                      {"recogniser", "recogniser/1", NetworkPath("recogniser/1"), "1"},
                      {"recogniser", "recogniser/2", NetworkPath("recogniser/2"), "2"}};
    for (const std::string& name : generators) {
      request.inputs.push_back({"generator", name, NetworkPath(name), name});
    }
    request.output = folder_ / "metrics.json";
    return request;
  }

  /// The artifact of a request that must succeed.
  static nlohmann::json Evaluated(const OpenGenerator& open, const StageRequest& request) {
    const auto outcome = MakeEvaluateStage(open)(request);
    if (!outcome) {
      ADD_FAILURE() << outcome.error().Message();
      return {};
    }
    return nlohmann::json::parse(ReadFile(request.output).value_or("{}"));
  }

  inline static std::filesystem::path folder_;
  inline static Dataset dataset_;
};

/// Generators that no program had to train: each answers a list of requests in its own way, whatever the checkpoint.
inline OpenGenerator Answering(AnswerRequests answer) {
  return [answer = std::move(answer)](const std::filesystem::path&) -> Expected<AnswerRequests> { return answer; };
}

/// A real motion of the wanted class, drawn by the request's seed.
inline std::vector<Motion> RealMotions(const Dataset& dataset, const std::vector<MotionRequest>& requests) {
  std::vector<Motion> motions;
  for (const MotionRequest& request : requests) {
    std::vector<const Clip*> members;
    for (const Clip& clip : dataset.clips) {
      if (clip.label == dataset.labels[static_cast<std::size_t>(request.label)].name) members.push_back(&clip);
    }
    Random random(request.seed, "answer");
    motions.push_back(*members[random.Below(members.size())]->motion);
  }
  return motions;
}

/// The first pose of one clip, held for as long as wanted, whatever the class.
inline std::vector<Motion> FrozenMotions(const Dataset& dataset, const std::vector<MotionRequest>& requests) {
  std::vector<Motion> motions;
  for (const MotionRequest& request : requests) {
    Motion motion = *dataset.clips.front().motion;
    JointPositions held(request.frames, motion.joint_count());
    for (int f = 0; f < request.frames; ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) held.at(f, j) = motion.joints.at(0, j);
    }
    motion.joints = std::move(held);
    motions.push_back(std::move(motion));
  }
  return motions;
}

/// What the worker program hands to the stage: the networks of train.
inline Expected<AnswerRequests> OpenTrained(const std::filesystem::path& checkpoint) {
  auto loaded = MotionGenerator::Load(checkpoint);
  if (!loaded) return Forward(loaded);
  const std::shared_ptr<const MotionGenerator> generator = std::move(*loaded);
  return [generator](const std::vector<MotionRequest>& requests) -> Expected<std::vector<Motion>> {
    auto answered = generator->Generate(requests);
    if (!answered) return Forward(answered);
    std::vector<Motion> motions;
    for (Clip& clip : answered->clips) motions.push_back(std::move(*clip.motion));
    return motions;
  };
}

}  // namespace mocurate
