// Runs that train: networks are independent items, what one of them lacks is said and costs the others nothing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::Folder;
using program::ReadText;
using program::Result;
using program::RunProgram;
using ::testing::HasSubstr;

/// A few synthetic clips, the smallest networks, the shortest evaluation.
std::vector<std::string> TrainingJob(const Folder& folder, const std::vector<std::string>& assignments) {
  std::vector<std::string> arguments = {"run", "-o", (folder / "r").string(), "--json"};
  std::vector<std::string> sets = {"ingest.synthetic.subjects=3",
                                   "ingest.synthetic.repetitions=1",
                                   "ingest.synthetic.duration=1.5 s",
                                   "ingest.synthetic.actions=[wave, kick]",
                                   "assemble.splits=[{name: s, by: fraction, test_share: 0.3, validation_share: 0}]",
                                   "train.recogniser.split=s",
                                   "train.generator.split=s",
                                   "audit.split=s",
                                   "train.seeds=[1, 2]",
                                   "train.recogniser.frames=10",
                                   "train.recogniser.hidden=4",
                                   "train.recogniser.epochs=2",
                                   "train.generator.frames=10",
                                   "train.generator.hidden=4",
                                   "train.generator.iterations=1",
                                   "evaluate.repetitions=1",
                                   "evaluate.motions=10",
                                   "evaluate.diversity_pairs=2",
                                   "evaluate.multimodality_quota=1"};
  sets.insert(sets.end(), assignments.begin(), assignments.end());
  for (const std::string& assignment : sets) arguments.insert(arguments.end(), {"--set", assignment});
  return arguments;
}

int StagesNamed(const nlohmann::json& document, const std::string& name) {
  int count = 0;
  for (const auto& stage : document["stages"]) count += stage["stage"] == name ? 1 : 0;
  return count;
}

TEST(TrainingRun, OnePersonAloneIsLearntFromAndNothingIsScored) {
  const Folder folder;
  std::vector<std::string> arguments = TrainingJob(
      folder, {"ingest.synthetic.subjects=1", "assemble.splits=[{name: s, by: person, test: [p09], validation: []}]"});
  arguments.erase(std::find(arguments.begin(), arguments.end(), "--json"));
  const Result result = RunProgram(folder, arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("not scored: no clip tests"));
  EXPECT_THAT(result.err, HasSubstr("it trains and nothing tests"));
}

TEST(TrainingRun, AFolderThatIsGivenTakesThePlaceOfTheCapture) {
  const Folder folder;
  const Result result = RunProgram(folder, TrainingJob(folder, {"ingest.path=" + (folder / "nowhere").string()}));
  EXPECT_EQ(result.exit_code, 3) << result.out;
  EXPECT_THAT(result.err, HasSubstr("nowhere: the folder does not exist"));
}

TEST(TrainingRun, AllNetworksAreItemsOfOneStage) {
  const Folder folder;
  const Result result = RunProgram(folder, TrainingJob(folder, {}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json document = result.Json();
  EXPECT_EQ(StagesNamed(document, "train"), 1);
  for (const auto& stage : document["stages"]) {
    if (stage["stage"] != "train") continue;
    EXPECT_EQ(stage["items"], 3);
  }
  for (const char* name : {"recogniser_1", "recogniser_2", "Action2Motion"}) {
    EXPECT_TRUE(fs::exists(folder / ("r/checkpoints/" + std::string(name) + ".h5"))) << name;
  }
}

TEST(TrainingRun, AGeneratorThatFailsLeavesTheRecognisersAndTheReportSaysSo) {
  const Folder folder;
  const Result result = RunProgram(folder, TrainingJob(folder, {"train.generator.split=nowhere"}));
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("1 of 3 networks were not trained; Action2Motion"));
  EXPECT_THAT(result.err, HasSubstr("nowhere"));
  const nlohmann::json document = result.Json();
  EXPECT_TRUE(document["untrained"].contains("Action2Motion"));
  EXPECT_EQ(document["metrics"]["recogniser"]["test_accuracy"].size(), 2u);
  EXPECT_TRUE(document["metrics"]["rows"].contains("Real"));
  const std::string page = ReadText(folder / "r/report/index.html");
  EXPECT_THAT(page, HasSubstr("Not trained"));
  EXPECT_THAT(page, HasSubstr("nowhere"));
}

TEST(TrainingRun, RecognisersThatFailLeaveTheGenerator) {
  const Folder folder;
  const Result result = RunProgram(folder, TrainingJob(folder, {"train.recogniser.split=nowhere"}));
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("2 of 3 networks were not trained; recogniser/1"));
  EXPECT_TRUE(fs::exists(folder / "r/checkpoints/Action2Motion.h5"));
  EXPECT_THAT(ReadText(folder / "r/report/index.html"), HasSubstr("recogniser/2"));
}

}  // namespace
}  // namespace mocurate
