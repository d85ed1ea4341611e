// The networks that a job trains: one item per seed, each with its own options only.

#include "train/items.h"
#include "train/stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace mocurate {
namespace {

StageInput Input(const std::string& name) { return {"dataset", name, "/nowhere/" + name, "sha of " + name}; }

NetworkOptions Named(NetworkKind kind, const std::string& name, std::vector<double> seeds) {
  NetworkOptions network(kind);
  network.name = name;
  network.seeds = std::move(seeds);
  return network;
}

TrainOptions Several() {
  TrainOptions options;
  options.networks = {Named(NetworkKind::kGruRecogniser, "recogniser", {4, 9}),
                      Named(NetworkKind::kGruRecogniser, "unfitted recogniser", {4}),
                      Named(NetworkKind::kAction2Motion, "Ours", {1}),
                      Named(NetworkKind::kAction2Motion, "Ours w/o Lie", {1, 2})};
  options.networks[1].trained_on = TrainingSetChoice::kUnfitted;
  options.networks[3].action2motion.lie = false;
  return options;
}

std::vector<TrainItem> ItemsOf(const TrainOptions& options) {
  return TrainItems(options, {Input("dataset"), Input("unfitted")});
}

std::set<std::string> KeysOf(const std::vector<TrainItem>& items, std::size_t network) {
  std::set<std::string> keys;
  for (const TrainItem& item : items) {
    if (item.network == network) keys.insert(Cache::Key(TrainDeclaration(), item.spec));
  }
  return keys;
}

TEST(TrainItems, GeneratorsTakeLongestAndStartFirstAndEachSeedIsAnItem) {
  std::vector<std::string> names, rows;
  for (const TrainItem& item : ItemsOf(Several())) {
    names.push_back(item.spec.item);
    rows.push_back(item.row);
    const auto network = OptionsFromJson<NetworkOptions>(item.spec.options.Whole());
    ASSERT_TRUE(network) << network.error().Message();
    EXPECT_EQ(item.spec.item, network->name + "/" + std::to_string(network->seed()));
    EXPECT_EQ(item.spec.inputs.at(0).name, item.network == 1 ? "unfitted" : "dataset");
  }
  EXPECT_EQ(names, (std::vector<std::string>{"Ours/1", "Ours w/o Lie/1", "Ours w/o Lie/2", "recogniser/4",
                                             "recogniser/9", "unfitted recogniser/4"}));
  EXPECT_EQ(rows[0], "Ours");
  EXPECT_EQ(rows[1], "Ours w/o Lie/1");
}

TEST(TrainItems, ANetworkThatIsKeptOnTheWayGoesOnFromThere) {
  TrainOptions options = Several();
  options.networks[2].learning.iterations = 100;
  options.networks[2].learning.samples_at = {10, 40, 100};
  std::vector<std::string> names, after;
  for (const TrainItem& item : ItemsOf(options)) {
    if (item.network != 2) continue;
    names.push_back(item.spec.item);
    after.push_back(item.after);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"Ours/1@10", "Ours/1@40", "Ours/1"}));
  EXPECT_EQ(after, (std::vector<std::string>{"", "Ours/1@10", "Ours/1@40"}));
  const std::set<std::string> whole = KeysOf(ItemsOf(options), 2);
  options.networks[2].learning.until = 40;
  names.clear();
  for (const TrainItem& item : ItemsOf(options)) {
    if (item.network == 2) names.push_back(item.spec.item);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"Ours/1@10", "Ours/1@40"})) << "none at or beyond the end";
  EXPECT_EQ(SeedOfItem("Ours/1@40"), "1");
  const std::set<std::string> beginning = KeysOf(ItemsOf(options), 2);
  EXPECT_EQ(beginning.size(), 2u);
  EXPECT_TRUE(std::includes(whole.begin(), whole.end(), beginning.begin(), beginning.end()))
      << "the beginning of a training is the training that ends there";
}

TEST(TrainItems, AnOptionOfOneNetworkLeavesTheKeysOfTheOthersAlone) {
  const TrainOptions before = Several();
  TrainOptions longer = before;
  longer.networks[2].learning.iterations *= 2;
  EXPECT_EQ(KeysOf(ItemsOf(before), 0), KeysOf(ItemsOf(longer), 0));
  EXPECT_EQ(KeysOf(ItemsOf(before), 3), KeysOf(ItemsOf(longer), 3));
  EXPECT_NE(KeysOf(ItemsOf(before), 2), KeysOf(ItemsOf(longer), 2));
}

TEST(TrainItems, WithoutUnfittedClipsNothingIsTrainedOnThem) {
  EXPECT_TRUE(Several().NeedsUnfitted());
  for (const TrainItem& item : TrainItems(Several(), {Input("dataset"), std::nullopt})) EXPECT_NE(item.network, 1u);
}

TEST(NetworkOptions, KnowTheOptionsOfTheirKindAloneAndItsDefaults) {
  nlohmann::json options = OptionsToJson(NetworkOptions(NetworkKind::kAction2Motion));
  EXPECT_FALSE(options.contains("epochs"));
  options["epochs"] = 3;
  EXPECT_FALSE(OptionsFromJson<NetworkOptions>(options));
  const auto recogniser = OptionsFromJson<NetworkOptions>({{"kind", "gru_recogniser"}, {"epochs", 3}});
  ASSERT_TRUE(recogniser) << recogniser.error().Message();
  EXPECT_EQ(recogniser->learning.batch, NetworkOptions(NetworkKind::kGruRecogniser).learning.batch);
  EXPECT_EQ(recogniser->recogniser.epochs, 3);
  for (const NetworkKind kind :
       {NetworkKind::kGruRecogniser, NetworkKind::kCondGru, NetworkKind::kActMoCoGan, NetworkKind::kTwoStageGan}) {
    const auto read = OptionsFromJson<NetworkOptions>(OptionsToJson(NetworkOptions(kind)));
    ASSERT_TRUE(read) << read.error().Message();
    EXPECT_EQ(OptionsToJson(*read), OptionsToJson(NetworkOptions(kind)));
  }
}

TEST(CheckNetworks, RefusesNamesAndSeedsThatStandTwice) {
  EXPECT_TRUE(CheckNetworks(Several()));
  TrainOptions options = Several();
  options.networks[1].name = "recogniser";
  EXPECT_EQ(CheckNetworks(options).error().where, "train.networks[1].name");
  options = Several();
  options.networks[0].seeds = {1, 1.5};
  EXPECT_EQ(CheckNetworks(options).error().where, "train.networks[0].seeds");
  options.networks[0].seeds = {3, 1, 3};
  EXPECT_EQ(CheckNetworks(options).error().code, ErrorCode::kConfig);
  options = Several();
  options.networks[2].name = "a@b";
  EXPECT_FALSE(CheckNetworks(options));
  options = Several();
  for (const std::vector<double>& steps : {std::vector<double>{5, 5}, {1000, 1000.5}}) {
    options.networks[2].learning.samples_at = steps;
    EXPECT_EQ(CheckNetworks(options).error().where, "train.networks[2].samples_at");
  }
}

TEST(CheckNetworks, RefusesRowsThatStandTwiceOrAreTheRealMotions) {
  TrainOptions options = Several();
  options.networks[2].name = "Ours w/o Lie/2";  // the second row of the network below it
  EXPECT_EQ(CheckNetworks(options).error().code, ErrorCode::kConfig);
  options.networks[2].name = "Real";
  EXPECT_EQ(CheckNetworks(options).error().where, "train.networks[2].name");
  options.networks[0].name = "Ours w/o Lie/1";  // a recogniser has no row
  options.networks[2].name = "Ours";
  EXPECT_TRUE(CheckNetworks(options));
}

TEST(TrainingBudget, MultipliesTheGeneratorsIterationsAndStaysInRange) {
  TrainOptions options = Several();
  options.networks[2].learning.iterations = 300;
  ASSERT_TRUE(ScaleTraining(2.5, options));
  EXPECT_EQ(options.networks[2].learning.iterations, 750);
  ASSERT_TRUE(ScaleTraining(1e-6, options));
  EXPECT_EQ(options.networks[2].learning.iterations, 1);
  options.networks[2].learning.iterations = 1000;
  const Status refused = ScaleTraining(1e6, options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  EXPECT_EQ(options.networks[2].learning.iterations, 1000);
}

TEST(TrainingNotes, AreOnePerNetworkAndOneWhereRowsAreNotAlike) {
  const TrainOptions options = Several();
  EXPECT_EQ(TrainingNotes(options, "recogniser").size(), 6u) << "two generators learn windows, the recogniser clips";
  EXPECT_EQ(TrainingNotes(options, "").size(), 4u);
}

}  // namespace
}  // namespace mocurate
