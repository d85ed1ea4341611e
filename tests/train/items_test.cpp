// Which networks a job trains: one per seed and kind, the longest first, each with options of its own only.

#include "train/items.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace mocurate {
namespace {

StageInput Input(const std::string& name) { return {"dataset", name, "/nowhere/" + name, "sha of " + name}; }

TrainOptions EveryKind() {
  TrainOptions options;
  options.seeds = {4, 9};
  options.baseline = true;
  options.crop = true;
  return options;
}

std::vector<TrainItem> ItemsOf(const TrainOptions& options) {
  return TrainItems(options, {Input("dataset"), Input("baseline")});
}

std::set<std::string> KeysOf(const std::vector<TrainItem>& items, const std::string& role) {
  std::set<std::string> keys;
  for (const TrainItem& item : items) {
    if (item.role == role) keys.insert(Cache::Key(TrainDeclaration(), item.spec));
  }
  return keys;
}

TEST(TrainItems, TheGeneratorTakesLongestAndStartsFirst) { EXPECT_EQ(ItemsOf(EveryKind()).front().role, "generator"); }

TEST(TrainItems, ThereIsOneRecogniserOfEachKindPerSeedAndTheSeedIsInItsOptions) {
  TrainOptions options = EveryKind();
  options.recogniser.seed = 77;  // seeds decide
  std::vector<std::string> names;
  for (const TrainItem& item : ItemsOf(options)) {
    names.push_back(item.spec.item);
    if (item.role == "generator") continue;
    const auto network = OptionsFromJson<NetworkOptions>(item.spec.options);
    ASSERT_TRUE(network) << network.error().Message();
    EXPECT_EQ(item.spec.item, item.role + "/" + std::to_string(network->recogniser.seed));
    EXPECT_EQ(network->recogniser.input == RecogniserInputKind::kCrop, item.role == "crop_recogniser");
    EXPECT_EQ(item.spec.inputs.at(0).name, item.role == "baseline_recogniser" ? "baseline" : "dataset");
  }
  EXPECT_EQ(names, (std::vector<std::string>{"Action2Motion", "recogniser/4", "recogniser/9", "baseline_recogniser/4",
                                             "baseline_recogniser/9", "crop_recogniser/4", "crop_recogniser/9"}));
}

TEST(TrainItems, SeedsAreWholeAndDistinctOrTheConfigIsRefused) {
  TrainOptions options;
  EXPECT_TRUE(CheckSeeds(options));
  options.seeds = {1, 1.5};
  const Status broken = CheckSeeds(options);
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().code, ErrorCode::kConfig);
  EXPECT_EQ(broken.error().where, "train.seeds");
  EXPECT_EQ(broken.error().what, "1.5 is not a whole number");
  options.seeds = {3, 1, 3};
  const Status twice = CheckSeeds(options);
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().what, "seed 3 stands there twice");
}

TEST(TrainItems, AnOptionOfOneNetworkLeavesTheKeysOfTheOthersAlone) {
  const TrainOptions before = EveryKind();
  TrainOptions longer = before;
  longer.generator.iterations *= 2;
  EXPECT_EQ(KeysOf(ItemsOf(before), "recogniser"), KeysOf(ItemsOf(longer), "recogniser"));
  EXPECT_NE(KeysOf(ItemsOf(before), "generator"), KeysOf(ItemsOf(longer), "generator"));
  TrainOptions wider = before;
  wider.recogniser.hidden *= 2;
  EXPECT_NE(KeysOf(ItemsOf(before), "recogniser"), KeysOf(ItemsOf(wider), "recogniser"));
  EXPECT_EQ(KeysOf(ItemsOf(before), "generator"), KeysOf(ItemsOf(wider), "generator"));
}

TEST(TrainItems, WithoutABaselineDatasetNothingIsTrainedOnIt) {
  for (const TrainItem& item : TrainItems(EveryKind(), {Input("dataset"), std::nullopt})) {
    EXPECT_NE(item.role, "baseline_recogniser");
  }
}

TEST(TrainItems, OptionsOfAnotherNetworkAreUnknown) {
  nlohmann::json options = OptionsToJson(NetworkOptions{NetworkKind::kAction2Motion, {}, {}});
  EXPECT_FALSE(options.contains("recogniser"));
  options["recogniser"] = {{"epochs", 3}};
  EXPECT_FALSE(OptionsFromJson<NetworkOptions>(options));
}

TEST(TrainingBudget, MultipliesTheGeneratorsIterationsAndStaysInRange) {
  TrainOptions options;
  options.generator.iterations = 300;
  ASSERT_TRUE(ScaleTraining(2.5, options));
  EXPECT_EQ(options.generator.iterations, 750);
  ASSERT_TRUE(ScaleTraining(1e-6, options));
  EXPECT_EQ(options.generator.iterations, 1);
  options.generator.iterations = 1000;
  const Status refused = ScaleTraining(1e6, options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  EXPECT_EQ(options.generator.iterations, 1000);
}

TEST(TrainingNotes, SayHowLongEachNetworkIsTrained) {
  TrainOptions options;
  options.recogniser.epochs = 1;
  options.generator.iterations = 300;
  const std::vector<std::string> notes = TrainingNotes(options);
  EXPECT_EQ(
      notes.at(0),
      "Recogniser: 1 epoch on all training clips, after as many without the validation part, in batches of 32 clips.");
  options.recogniser.anneal = false;
  EXPECT_EQ(TrainingNotes(options).at(0),
            "Recogniser: at most 1 epoch to select and as many as were best to refit, in batches of 32 clips.");
  EXPECT_NE(notes.at(1).find("300 iterations of 128 clips"), std::string::npos);
}

TEST(TrainingNotes, SayWhetherTestClipsWereTrainedOnAndWhetherRowsAreAlike) {
  TrainOptions options;
  options.seeds.clear();
  options.generator.all_clips = true;
  EXPECT_NE(TrainingNotes(options).at(0).find("test clips included"), std::string::npos);
  options.generator.input = options.recogniser.input;
  EXPECT_EQ(TrainingNotes(options).size(), 1u);
  options.generator.input = RecogniserInputKind::kCrop;
  options.recogniser.input = RecogniserInputKind::kResample;
  EXPECT_EQ(TrainingNotes(options).size(), 2u);
  options.generator_enabled = false;
  EXPECT_TRUE(TrainingNotes(options).empty());
}

}  // namespace
}  // namespace mocurate
