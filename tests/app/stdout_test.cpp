// An answer that is not completely written to stdout is an error; usage errors suggest the intended command.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::Result;
using program::RunProgram;
using program::Surroundings;
using program::WriteText;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(FullStdout, IsExitCode74WithOneLineOnStderr) {
  const ScratchFolder folder;
  WriteText(folder / "walk.bvh",
            "HIERARCHY\nROOT a\n{\n OFFSET 0 0 0\n CHANNELS 3 Xposition Yposition Zposition\n}\nMOTION\n"
            "Frames: 2\nFrame Time: 0.033\n0 0 0\n0 1 0\n");
  Surroundings full;
  full.before_start = [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); };
  const std::string walk = (folder / "walk.bvh").string();
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"inspect", walk},
                                                    {"inspect", walk, "--json"},
                                                    {"doctor"},
                                                    {"config", "show"},
                                                    {"config", "reference"},
                                                    {"cache", "stat"},
                                                    {"--help"},
                                                    {"run", "--help"},
                                                    {"--version"},
                                                    {"run", "--dry-run"}}) {
    const Result result = RunProgram(folder, arguments, full);
    EXPECT_EQ(result.exit_code, 74) << arguments.front() << result.err;
    EXPECT_THAT(result.err, HasSubstr("mocurate: stdout: cannot be written"));
  }
}

TEST(Version, IsADocumentWithJson) {
  const ScratchFolder folder;
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--version", "--json"}, {"--json", "--version"}}) {
    const Result result = RunProgram(folder, arguments);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.Json()["program"], "mocurate");
    EXPECT_EQ(result.Json()["version"].get<std::string>().rfind("0.", 0), 0u);
  }
}

TEST(Usage, AMistypedOptionOrVerbIsReportedWithTheNearest) {
  const ScratchFolder folder;
  const std::pair<std::vector<std::string>, std::string> said[] = {
      {{"run", "--sett", "x"}, "there is no option '--sett' of 'mocurate run' (did you mean '--set'?)"},
      {{"config", "shwo"}, "there is no 'mocurate config shwo' (did you mean 'mocurate config show'?)"},
      {{"cache", "foo"}, "there is no 'mocurate cache foo' (there are: stat, verify, prune)"},
      {{"cache"}, "'mocurate cache' alone does nothing"},
      {{"doctor", "x"}, "'x' is one word too many for 'mocurate doctor'"},
      {{"run", "--jobs", "abc"}, "--jobs: Value abc not in range"},
      {{}, "'mocurate' alone does nothing"}};
  for (const auto& [arguments, text] : said) {
    const Result result = RunProgram(folder, arguments);
    EXPECT_EQ(result.exit_code, 2) << text;
    EXPECT_EQ(result.err.rfind("mocurate: ", 0), 0u) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
  }
}

TEST(Inspect, IrregularFilesAreReportedAndNotRead) {
  const ScratchFolder folder;
  fs::create_directories(folder / "data");
  ASSERT_EQ(mkfifo((folder / "data/pipe").c_str(), 0600), 0);
  for (const std::string& path : {(folder / "data/pipe").string(), std::string("/dev/zero")}) {
    const Result result = RunProgram(folder, {"inspect", path});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.err, HasSubstr(path + ": is not a regular file"));
  }
  const Result inspected = RunProgram(folder, {"inspect", (folder / "data").string(), "--json"});
  const nlohmann::json findings = inspected.Json()["findings"];
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0]["code"], "no_regular_file");
}

TEST(ConfigShow, KeepsAnEnvironmentVariableThatIsNotSetAndARunRefusesIt) {
  const ScratchFolder folder;
  program::Surroundings bare;
  bare.before_start = [] { unsetenv("MOCURATE_DATA"); };
  const Result json = RunProgram(folder, {"config", "show", "kard", "--json"}, bare);
  ASSERT_EQ(json.exit_code, 0) << json.err;
  EXPECT_EQ(json.Json()["ingest"]["path"], "${MOCURATE_DATA}/kinect/kard");
  const Result text = RunProgram(folder, {"config", "show", "kard"}, bare);
  ASSERT_EQ(text.exit_code, 0) << text.err;
  WriteText(folder / "shown.yaml", text.out);
  EXPECT_EQ(RunProgram(folder, {"config", "show", (folder / "shown.yaml").string()}, bare).out, text.out);
  EXPECT_EQ(RunProgram(folder, {"config", "show", "kard", "--set", "name=${titel}"}, bare).exit_code, 2);
  EXPECT_EQ(RunProgram(folder, {"run", "kard", "-o", (folder / "r").string(), "--dry-run"}, bare).exit_code, 2);
}

TEST(Origins, OfInheritedSkeletonsAreThatOfTheJobs) {
  const ScratchFolder folder;
  WriteText(folder / "a.yaml", "name: mine\nskeleton: openni16\ncanon:\n  rate: \"20\"\n");
  const std::string config = (folder / "a.yaml").string();
  const Result json = RunProgram(folder, {"config", "show", config, "--origins", "--json"});
  ASSERT_EQ(json.exit_code, 0) << json.err;
  const nlohmann::json origins = json.Json()["origins"];
  EXPECT_EQ(json.Json()["options"]["canon"]["rate"], "20");
  EXPECT_THAT(origins["canon"]["rate"].get<std::string>(), HasSubstr("a.yaml:4"));
  EXPECT_EQ(origins["audit"]["split"], "default");
  for (const char* group : {"proportions", "fitting", "canon"}) {
    EXPECT_THAT(origins[group]["skeleton"].get<std::string>(), HasSubstr("a.yaml:2")) << group;
  }
  const Result text = RunProgram(folder, {"config", "show", config, "--origins"});
  EXPECT_THAT(text.out, Not(HasSubstr("skeleton: openni16  # default")));
}

}  // namespace
}  // namespace mocurate
