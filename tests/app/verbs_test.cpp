// The command for a user: help, errors with place and remedy, exit codes, JSON on stdout.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/program.h"

namespace mocurate {
namespace {

using program::Result;
using program::RunProgram;
using program::WriteText;
using ::testing::HasSubstr;

TEST(Help, EveryVerbHasAnExample) {
  const ScratchFolder folder;
  for (const auto& verb : std::vector<std::vector<std::string>>{{"run"},
                                                                {"generate"},
                                                                {"audit"},
                                                                {"rig", "audit"},
                                                                {"draw"},
                                                                {"view"},
                                                                {"reproduce"},
                                                                {"survey", "make"},
                                                                {"survey", "tally"},
                                                                {"dataset", "card"},
                                                                {"dataset", "diff"},
                                                                {"inspect"},
                                                                {"synthesize"},
                                                                {"config", "show"},
                                                                {"config", "schema"},
                                                                {"config", "reference"},
                                                                {"doctor"},
                                                                {"cache", "stat"},
                                                                {"cache", "verify"},
                                                                {"cache", "prune"}}) {
    std::vector<std::string> arguments = verb;
    arguments.emplace_back("--help");
    const Result result = RunProgram(folder, arguments);
    EXPECT_EQ(result.exit_code, 0) << verb.front();
    EXPECT_THAT(result.out, HasSubstr("Example")) << verb.front();
  }
  EXPECT_THAT(RunProgram(folder, {"--help"}).out, HasSubstr("Exit codes"));
  EXPECT_THAT(RunProgram(folder, {"--version"}).out, HasSubstr("mocurate 0."));
}

TEST(Usage, AnUnknownVerbOrOptionIsExitCode2) {
  const ScratchFolder folder;
  EXPECT_EQ(RunProgram(folder, {"fly"}).exit_code, 2);
  EXPECT_EQ(RunProgram(folder, {"run", "--wings"}).exit_code, 2);
  EXPECT_EQ(RunProgram(folder, {}).exit_code, 2);
  EXPECT_THAT(RunProgram(folder, {"runn"}).err, HasSubstr("there is no verb 'runn' (did you mean 'mocurate run'?)"));
  EXPECT_THAT(
      RunProgram(folder, {"fly"}).err,
      HasSubstr(
          "the verbs are: run, plan, jobs, fit, rig, export, generate, draw, view, reproduce, eval, audit, review, "
          "survey, dataset, inspect, synthesize, config, doctor, cache"));
  EXPECT_THAT(RunProgram(folder, {"kard.yaml"}).err, HasSubstr("did you mean 'mocurate run kard.yaml'?"));
  EXPECT_THAT(RunProgram(folder, {"run", "--to", "asemble"}).err, HasSubstr("did you mean 'assemble'?"));
  const Result stage = RunProgram(folder, {"run", "--to", "heaven", "-o", (folder / "r").string()});
  EXPECT_EQ(stage.exit_code, 2);
  EXPECT_THAT(stage.err, HasSubstr("the stages are: ingest, proportions, fitting"));
}

TEST(Usage, HelpAndVersionOfAVerbThatDoesNotExistAreExitCode2) {
  const ScratchFolder folder;
  for (const char* asked : {"--help", "-h", "--version"}) {
    for (const std::vector<std::string>& verb :
         {std::vector<std::string>{"runn"}, {"fly"}, {"config", "shwo"}, {"cache", "fly"}}) {
      std::vector<std::string> arguments = verb;
      arguments.emplace_back(asked);
      const Result text = RunProgram(folder, arguments);
      EXPECT_EQ(text.exit_code, 2) << verb.back() << " " << asked;
      EXPECT_EQ(text.out, "") << "help is no answer to it";
      arguments.emplace_back("--json");
      const Result json = RunProgram(folder, arguments);
      EXPECT_EQ(json.exit_code, 2) << verb.back() << " " << asked;
      EXPECT_EQ(json.Json()["error"]["code"], "usage");
      EXPECT_EQ(json.Json()["error"]["exit_code"], 2);
    }
  }
  EXPECT_THAT(RunProgram(folder, {"runn", "--help", "--json"}).Json()["error"]["hint"].get<std::string>(),
              HasSubstr("mocurate run"));
  EXPECT_EQ(RunProgram(folder, {"config", "--help"}).exit_code, 0);
  EXPECT_EQ(RunProgram(folder, {"cache", "stat", "--help"}).exit_code, 0);
}

TEST(Usage, AnAssignmentDoesNotConsumeTheConfigAfterIt) {
  const ScratchFolder folder;
  WriteText(folder / "mine.yaml", "name: mine\n");
  const Result result =
      RunProgram(folder, {"config", "show", "--set", "evaluate.motions=77", (folder / "mine.yaml").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("name: mine"));
  EXPECT_THAT(result.out, HasSubstr("motions: 77"));
}

TEST(Config, AllProblemsAreReportedAtOnceWithPlaceAndNearestName) {
  const ScratchFolder folder;
  WriteText(folder / "bad.yaml",
            "name: x\nskeletn: smpl24\ncanon:\n  trim:\n    min_length: 5 kg\n  facing: {anchor: centre}\n");
  const Result result = RunProgram(folder, {"run", (folder / "bad.yaml").string(), "-o", (folder / "r").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("bad.yaml:2:1"));
  EXPECT_THAT(result.err, HasSubstr("skeleton"));
  EXPECT_THAT(result.err, HasSubstr("bad.yaml:5:"));
  EXPECT_THAT(result.err, HasSubstr("bad.yaml:6:"));
}

TEST(Config, ShowPrintsTheOriginOfEachValue) {
  const ScratchFolder folder;
  WriteText(folder / "a.yaml", "name: mine\ncanon:\n  rate: \"20\"\n");
  const Result result =
      RunProgram(folder, {"config", "show", (folder / "a.yaml").string(), "--origins", "--set", "audit.split=s"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("a.yaml:3"));
  EXPECT_THAT(result.out, HasSubstr("--set"));
  EXPECT_THAT(result.out, HasSubstr("default"));
}

TEST(Config, TheSchemaIsJson) {
  const ScratchFolder folder;
  const Result result = RunProgram(folder, {"config", "schema"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.Json().contains("properties"));
}

TEST(Errors, AMissingConfigOrFolderIsNamed) {
  const ScratchFolder folder;
  const Result config = RunProgram(folder, {"run", (folder / "none.yaml").string()});
  EXPECT_EQ(config.exit_code, 2);
  EXPECT_THAT(config.err, HasSubstr("none.yaml: the configuration cannot be read: no such file"));
  WriteText(folder / "nine.yaml", "name: x\n");
  EXPECT_THAT(RunProgram(folder, {"run", (folder / "none.yaml").string()}).err,
              HasSubstr("did you mean '" + (folder / "nine.yaml").string() + "'?"));
  const Result path = RunProgram(folder, {"inspect", (folder / "none").string(), "--json"});
  EXPECT_EQ(path.exit_code, 3);
  EXPECT_EQ(path.Json()["findings"][0]["code"], "not_found");
}

TEST(Errors, AnOutputThatCannotBeWrittenIsExitCode74) {
  const ScratchFolder folder;
  const Result result = RunProgram(folder, {"run", "-o", "/proc/mocurate_run", "--to", "ingest"});
  EXPECT_EQ(result.exit_code, 74);
  EXPECT_THAT(result.err, HasSubstr("/proc/mocurate_run"));
}

TEST(Inspect, AnEmptyFileIsAnErrorThatNamesIt) {
  const ScratchFolder folder;
  WriteText(folder / "empty.bvh", "");
  const Result result = RunProgram(folder, {"inspect", (folder / "empty.bvh").string(), "--json"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.out, HasSubstr("error"));
}

}  // namespace
}  // namespace mocurate
