// Unknown names in a configuration are reported before any work, with the nearest known name.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::Result;
using program::RunProgram;
using program::SmallJob;
using ::testing::HasSubstr;

Result RunWith(const ScratchFolder& folder, const std::vector<std::string>& assignments,
               const std::string& to = "assemble") {
  std::vector<std::string> arguments = SmallJob(folder, "r");
  arguments.insert(arguments.end(), {"--to", to});
  arguments.erase(arguments.begin() + 3, arguments.begin() + 5);
  for (const std::string& assignment : assignments) arguments.insert(arguments.end(), {"--set", assignment});
  return RunProgram(folder, arguments);
}

void ExpectRefusedBeforeAnyWork(const ScratchFolder& folder, const Result& result,
                                const std::vector<std::string>& parts) {
  EXPECT_EQ(result.exit_code, 2) << result.err;
  for (const std::string& part : parts) EXPECT_THAT(result.err, HasSubstr(part));
  EXPECT_FALSE(fs::exists(folder / "r"));
  EXPECT_FALSE(fs::exists(folder / "cache"));
}

TEST(Names, OfSkeletonsMustExist) {
  const ScratchFolder folder;
  for (const char* option :
       {"skeleton", "ingest.source.skeleton", "proportions.skeleton", "fitting.skeleton", "canon.skeleton"}) {
    ExpectRefusedBeforeAnyWork(folder, RunWith(folder, {std::string(option) + "=kinect2O"}),
                               {std::string(option) + ": there is no skeleton 'kinect2O'", "did you mean 'kinect20'?"});
  }
}

TEST(Names, OfActionsOfTheStudioMustExist) {
  const ScratchFolder folder;
  ExpectRefusedBeforeAnyWork(folder, RunWith(folder, {"ingest.synthetic.actions=[wave, kik]"}),
                             {"'kik'", "did you mean 'kick'?"});
}

TEST(Names, OfSplitsMustExistForTheStagesThatNeedThem) {
  const ScratchFolder folder;
  const std::string splits = "assemble.splits=[{name: persons, by: person, test: [p01]}]";
  const std::vector<std::string> all = {splits, "train.networks.0.split=persons", "train.networks.1.split=persons"};
  for (const char* option : {"audit.split", "train.networks.0.split", "train.networks.1.split", "evaluate.split"}) {
    std::vector<std::string> assignments = all;
    assignments.push_back(std::string(option) + "=person");
    ExpectRefusedBeforeAnyWork(folder, RunWith(folder, assignments, "report"),
                               {std::string(option) + ": there is no split 'person'", "did you mean 'persons'?"});
  }
  EXPECT_EQ(RunWith(folder, {splits, "train.networks.0.split=person"}, "ingest").exit_code, 0);
}

TEST(Names, OfPersonsOfASplitThatDrawsNoOthersMustExistBeforeAnythingIsIngested) {
  const ScratchFolder folder;
  const std::string splits = "assemble.splits=[{name: s, by: person, test: [p0], absent: ABSENT}]";
  const auto with = [&](const std::string& absent) {
    std::string text = splits;
    return RunWith(folder, {text.replace(text.find("ABSENT"), 6, absent)});
  };
  const Result refused = with("refuse");
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("assemble.splits.s: no clip has the person 'p0'"));
  EXPECT_THAT(refused.err, HasSubstr("the set has: p01, p02, p03"));
  EXPECT_THAT(refused.err, ::testing::Not(HasSubstr("ingest: ")));
  const Result drawn = with("draw");
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_THAT(drawn.err, HasSubstr("no clip has the person 'p0'"));
  const Result all_test = RunWith(folder, {"assemble.splits=[{name: s, by: person, test: [p01, p02, p03]}]"});
  EXPECT_EQ(all_test.exit_code, 2) << all_test.err;
  EXPECT_THAT(all_test.err, HasSubstr("assemble.splits.s: every person of the set"));
  EXPECT_THAT(all_test.err, ::testing::Not(HasSubstr("ingest: ")));
}

}  // namespace
}  // namespace mocurate
