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

TEST(Names, OfPersonsOfASplitMustExistBeforeAnythingIsIngested) {
  const ScratchFolder folder;
  const auto with = [&](const std::string& split, const std::string& roles = "{}") {
    return RunWith(folder, {"assemble.splits=[{name: s, " + split + "}]", "ingest.source.roles=" + roles});
  };
  for (const char* split : {"by: person, test: [P1]", "by: person, test: [p01], validation: [p1]", "by: role"}) {
    const Result refused = with(split, "{p1: test, p02: train}");
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("did you mean 'p01'? the set has: p01, p02, p03")) << split;
    EXPECT_THAT(refused.err, ::testing::Not(HasSubstr("ingest: "))) << split;
    EXPECT_FALSE(fs::exists(folder / "r/dataset.h5")) << split;
  }
  const Result drawn = with("by: person, test: [p0], absent: draw");
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_THAT(drawn.err, HasSubstr("no clip has the person 'p0'"));
  const Result all_test = with("by: person, test: [p01, p02, p03]");
  EXPECT_EQ(all_test.exit_code, 2) << all_test.err;
  EXPECT_THAT(all_test.err, HasSubstr("assemble.splits.s: every person of the set"));
  EXPECT_THAT(all_test.err, ::testing::Not(HasSubstr("ingest: ")));
  const Result nameless = with("by: fraction, test: [p01]");
  EXPECT_EQ(nameless.exit_code, 2) << nameless.err;
}

}  // namespace
}  // namespace mocurate
