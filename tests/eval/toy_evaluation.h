#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/store/feature_file.h"
#include "eval/options.h"
#include "eval/protocols/score.h"
#include "eval/stages.h"
#include "tests/support/scratch_folder.h"
#include "tests/train/toy_dataset.h"
#include "train/generators/motion_generator.h"
#include "train/items.h"
#include "train/stages.h"

namespace mocurate {

/// The loader that the worker program passes to the stage: the networks of train.
inline Expected<AnswerRequests> OpenTrained(const GeneratorFiles& files, int) {
  auto loaded = MotionGenerator::Load(files.main);
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

/// A toy dataset with two recognisers and a barely trained generator, made once for all tests of a suite; requests on
/// them.
class ToyEvaluation : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = std::make_unique<ScratchFolder>();
    folder_ = *scratch_;
    dataset_ = ToyDataset(4);
    Save(dataset_, "dataset.h5");
    NetworkOptions recogniser(NetworkKind::kGruRecogniser);
    recogniser.data.frames = 16;
    recogniser.recogniser.hidden = 16;
    recogniser.recogniser.epochs = 60;
    recogniser.recogniser.refit = false;
    recogniser.learning.learning_rate = 1e-2;
    for (const int seed : {1, 2}) {
      recogniser.seeds = {static_cast<double>(seed)};
      Train("recogniser/" + std::to_string(seed), recogniser);
    }
    NetworkOptions generator(NetworkKind::kAction2Motion);
    generator.data.frames = 16;
    generator.action2motion.lie = false;
    generator.action2motion.hidden = 8;
    generator.action2motion.latent = 2;
    generator.learning.iterations = 3;
    Train("Action2Motion", generator);
  }
  static void TearDownTestSuite() { scratch_.reset(); }

  static void Save(const Dataset& dataset, const std::string& name) {
    const Status written = WriteDataset(dataset, folder_ / name);
    ASSERT_TRUE(written) << written.error().Message();
  }

  /// Path of an item's network.
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

  /// `repetitions` of `motions` real or generated motions, drawn with replacement.
  static DrawOptions Draws(int repetitions, int motions) {
    DrawOptions draws;
    draws.repetitions = repetitions;
    draws.motions = motions;
    draws.crop = CropDraw::kReleased;
    draws.interval = IntervalKind::kStudent;
    return draws;
  }

  static FeaturesOptions FeaturesOf(const DrawOptions& draws, const std::string& purpose, bool generated,
                                    std::int64_t seed = 1) {
    FeaturesOptions options;
    options.generated = generated;
    options.seed = seed;
    options.purpose = purpose;
    options.passes = draws.repetitions;
    options.motions = draws.motions;
    options.hidden = draws.hidden;
    options.crop = draws.crop;
    return options;
  }

  /// Of a set by the first recogniser, to features.h5.
  static StageRequest FeaturesRequest(const std::string& set, const FeaturesOptions& options) {
    StageRequest request;
    request.stage = "features";
    request.item = "features/" + set;
    request.options = OptionsToJson(options);
    request.inputs = {{"weights", "recogniser/1", NetworkPath("recogniser/1"), "1"},
                      {"motions", set, folder_ / set, "content of " + set}};
    request.output = folder_ / "features.h5";
    return request;
  }

  static StageRequest GeneratorRequest(const DrawOptions& draws, std::int64_t seed = 1) {
    StageRequest request = FeaturesRequest("dataset.h5", FeaturesOf(draws, "generated", true, seed));
    request.inputs.push_back({"generator", "Action2Motion", NetworkPath("Action2Motion"), "2"});
    return request;
  }

  static Expected<StageOutcome> OutcomeOfGenerator(const OpenGenerator& open, const DrawOptions& draws) {
    return MakeFeaturesStage(open)(GeneratorRequest(draws));
  }

  /// Bytes of the feature file.
  static std::string FeaturesFile(const OpenGenerator& open, const FeaturesOptions& options, int threads) {
    StageRequest request = GeneratorRequest({});
    request.options = OptionsToJson(options);
    request.threads = threads;
    const auto outcome = MakeFeaturesStage(open)(request);
    EXPECT_TRUE(outcome) << outcome.error().Message();
    return ReadFile(request.output).value_or("");
  }

  static FeatureSet Read(const Expected<StageOutcome>& outcome) {
    if (!outcome) ADD_FAILURE() << outcome.error().Message();
    auto set = ReadFeatures(folder_ / "features.h5");
    if (!set) ADD_FAILURE() << set.error().Message();
    return set ? *std::move(set) : FeatureSet();
  }

  static FeatureSet FeatureSetOf(const std::string& set, const FeaturesOptions& options) {
    return Read(MakeFeaturesStage(OpenTrained)(FeaturesRequest(set, options)));
  }

  static nlohmann::json Scored(const DrawOptions& draws, bool real, std::int64_t seed, const FeatureSet& row,
                               const FeatureSet& reference) {
    ScoreOptions options;
    options.name = real ? "Real" : "generated";
    options.real = real ? RealRow::kTrain : RealRow::kNone;
    options.seed = seed;
    options.draw = draws;
    options.metrics.diversity_pairs = 500;
    const auto json = ScoreRow(options, row, {&reference, nullptr});
    if (!json) {
      ADD_FAILURE() << json.error().Message();
      return {};
    }
    return *json;
  }

  static nlohmann::json ScoreOfReal(const DrawOptions& draws) {
    const FeatureSet real = FeatureSetOf("dataset.h5", FeaturesOptions());
    return Scored(draws, true, 1, real, real);
  }

  static nlohmann::json ScoreOfGenerator(const OpenGenerator& open, const DrawOptions& draws, std::int64_t seed = 1) {
    const FeatureSet row = Read(MakeFeaturesStage(open)(GeneratorRequest(draws, seed)));
    return Scored(draws, false, seed, row, FeatureSetOf("dataset.h5", FeaturesOptions()));
  }

  /// A set as given against the dataset.
  static nlohmann::json ScoreOfSet(const std::string& set) {
    FeaturesOptions options;
    options.generated = true;
    const FeatureSet row = FeatureSetOf(set, options);
    return Scored({}, false, 1, row, FeatureSetOf("dataset.h5", FeaturesOptions()));
  }

  inline static std::unique_ptr<ScratchFolder> scratch_;
  inline static std::filesystem::path folder_;
  inline static Dataset dataset_;
};

/// Generators without training: each generates motions for requests by a rule of its own, whatever the checkpoint.
inline OpenGenerator Answering(AnswerRequests answer) {
  return [answer = std::move(answer)](const GeneratorFiles&, int) -> Expected<AnswerRequests> { return answer; };
}

/// A real motion of the wanted class, drawn by the request's seed.
inline std::vector<Motion> RealMotions(const Dataset& dataset, const std::vector<MotionRequest>& requests) {
  std::vector<Motion> motions;
  for (const MotionRequest& request : requests) {
    std::vector<const Clip*> members;
    for (const Clip& clip : dataset.clips) {
      if (clip.label == dataset.labels[static_cast<std::size_t>(request.label)]) members.push_back(&clip);
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

}  // namespace mocurate
