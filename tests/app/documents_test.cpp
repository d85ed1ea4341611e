// With --json stdout is one JSON document, whatever the outcome; logs go to stderr, and with -q errors only.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::SmallJob;
using program::Surroundings;
using program::WriteText;
using ::testing::HasSubstr;
using ::testing::Not;

/// The document on stdout: the whole of it, and nothing else.
nlohmann::json ExpectDocument(const Result& result, int exit_code) {
  EXPECT_EQ(result.exit_code, exit_code) << result.out << result.err;
  const nlohmann::json document = nlohmann::json::parse(result.out, nullptr, false);
  EXPECT_TRUE(document.is_object()) << result.out;
  EXPECT_THAT(result.err, Not(HasSubstr("{")));
  if (exit_code == 0) {
    EXPECT_THAT(result.err, Not(HasSubstr("mocurate: ")));
  } else {
    EXPECT_THAT(result.err, HasSubstr("mocurate: "));
  }
  if (document.is_object() && document.contains("error")) {
    EXPECT_EQ(document["error"]["exit_code"], exit_code);
    for (const char* part : {"code", "what", "where", "hint"}) EXPECT_TRUE(document["error"][part].is_string());
  }
  return document;
}

TEST(Documents, AWholeRunAndVerbsThatInspectIt) {
  const ScratchFolder folder;
  std::vector<std::string> job = SmallJob(folder, "r");
  job.emplace_back("--json");
  const Result run = RunProgram(folder, job);
  EXPECT_EQ(ExpectDocument(run, 0)["clips"], 15);
  EXPECT_THAT(run.err, HasSubstr("info: fitting: 15 items"));
  ExpectDocument(RunProgram(folder, {"inspect", (folder / "r/dataset.h5").string(), "--json"}), 0);
  ExpectDocument(RunProgram(folder, {"inspect", (folder / "r/capture").string(), "--json"}), 0);
  EXPECT_GT(ExpectDocument(RunProgram(folder, {"cache", "stat", "--json"}), 0)["objects"], 15);
  EXPECT_TRUE(ExpectDocument(RunProgram(folder, {"cache", "verify", "--json"}), 0)["damaged"].empty());

  for (const auto& entry : fs::recursive_directory_iterator(folder / "cache/objects")) {
    if (entry.path().extension() != ".h5") continue;
    std::string bytes = ReadText(entry.path());
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    WriteText(entry.path(), bytes);
    break;
  }
  EXPECT_EQ(ExpectDocument(RunProgram(folder, {"cache", "verify", "--json"}), 3)["damaged"].size(), 1u);
  const std::vector<std::string> prune = {"cache", "prune", "--days", "0", "--json"};
  const nlohmann::json predicted_decrease =
      ExpectDocument(RunProgram(folder, {"cache", "prune", "--days", "0", "--json", "--dry-run"}), 0);
  EXPECT_TRUE(predicted_decrease["dry_run"].get<bool>());
  EXPECT_GT(ExpectDocument(RunProgram(folder, {"cache", "stat", "--json"}), 0)["objects"], 15) << "nothing is removed";
  const nlohmann::json pruned = ExpectDocument(RunProgram(folder, prune), 0);
  EXPECT_GT(pruned["objects"], 15);
  EXPECT_EQ(pruned["objects"], predicted_decrease["objects"]);
  EXPECT_EQ(pruned["bytes"], predicted_decrease["bytes"]);
  EXPECT_EQ(ExpectDocument(RunProgram(folder, {"cache", "stat", "--json"}), 0)["objects"], 0);
}

TEST(Documents, ARunWithABadClipIsOneDocumentWithExitCode1) {
  const ScratchFolder folder;
  std::vector<std::string> job = SmallJob(folder, "r");
  ASSERT_EQ(RunProgram(folder, job, program::SharedCache()).exit_code, 0);
  fs::copy(folder / "r/capture", folder / "capture");
  WriteText(folder / "capture/clap_p01_r01.txt", "");
  job.insert(job.end(), {"--json", "--set", "ingest.synthetic.enabled=false", "--set",
                         "ingest.path=" + (folder / "capture").string()});
  const Result result = RunProgram(folder, job, program::SharedCache());
  EXPECT_EQ(ExpectDocument(result, 1)["failed"], 1);
  EXPECT_THAT(result.err, HasSubstr("clap_p01_r01.txt"));
}

TEST(Quiet, PrintsOnlyErrorsOfEveryVerb) {
  const ScratchFolder folder;
  std::vector<std::string> job = SmallJob(folder, "r");
  const auto quiet = [&](std::vector<std::string> arguments) {
    arguments.emplace_back("-q");
    return RunProgram(folder, arguments, program::SharedCache());
  };
  const std::string capture = folder / "r/capture", dataset = folder / "r/dataset.h5";
  for (const std::vector<std::string>& arguments : {job,
                                                    {"run", "--dry-run", "-o", folder / "r"},
                                                    {"fit", dataset, "--contacts", "-o", folder / "fit.h5"},
                                                    {"export", dataset, "-o", folder / "arrays"},
                                                    {"inspect", capture},
                                                    {"inspect", dataset},
                                                    {"synthesize", "--show"},
                                                    {"config", "show"},
                                                    {"config", "schema"},
                                                    {"config", "reference"},
                                                    {"config", "init", capture},
                                                    {"cache", "stat"},
                                                    {"cache", "verify"},
                                                    {"doctor"},
                                                    {"doctor", "--source", "studio"}}) {
    const Result result = quiet(arguments);
    EXPECT_EQ(result.out, "") << arguments.front();
    EXPECT_EQ(result.err.empty(), result.exit_code == 0) << arguments.front() << ": " << result.err;
  }
  EXPECT_TRUE(fs::exists(dataset));
  EXPECT_TRUE(ExpectDocument(quiet({"config", "show", "--json"}), 0).contains("ingest"));
  const Result missing = quiet({"inspect", folder / "none"});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_EQ(missing.out, "");
  EXPECT_NE(missing.err, "");

  fs::copy(folder / "r/capture", folder / "capture");
  WriteText(folder / "capture/clap_p01_r01.txt", "");
  job.insert(job.end(), {"--set", "ingest.synthetic.enabled=false", "--set",
                         "ingest.path=" + (folder / "capture").string(), "--json"});
  const Result bad = quiet(job);
  EXPECT_EQ(ExpectDocument(bad, 1)["failed"], 1);
  EXPECT_EQ(std::count(bad.err.begin(), bad.err.end(), '\n'), 1) << "the error and no warning: " << bad.err;
}

TEST(Documents, VerbsThatNeedNoCapture) {
  const ScratchFolder folder;
  EXPECT_TRUE(ExpectDocument(RunProgram(folder, {"config", "show", "--json"}), 0).contains("ingest"));
  EXPECT_TRUE(ExpectDocument(RunProgram(folder, {"config", "schema", "--json"}), 0).contains("properties"));
  EXPECT_TRUE(ExpectDocument(RunProgram(folder, {"config", "reference", "--json"}), 0).contains("markdown"));
  ExpectDocument(RunProgram(folder, {"run", "--dry-run", "-o", (folder / "r").string(), "--json"}), 0);
}

TEST(Documents, WrongUsageAndWrongConfigAreExitCode2) {
  const ScratchFolder folder;
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"run", "--wings", "--json"},
                                                    {"--json", "fly"},
                                                    {"--json"},
                                                    {"inspect", "--json"},
                                                    {"cache", "--json"},
                                                    {"cache", "prune", "--days", "-1", "--json"},
                                                    {"run", "--jobs", "many", "--json"},
                                                    {"run", "--to", "heaven", "--json"}}) {
    const Result result = RunProgram(folder, arguments);
    EXPECT_EQ(result.exit_code, 2);
    const nlohmann::json document = nlohmann::json::parse(result.out, nullptr, false);
    ASSERT_TRUE(document.is_object()) << arguments.back() << ": " << result.out;
    EXPECT_EQ(document["error"]["code"], "usage");
    EXPECT_EQ(document["error"]["exit_code"], 2);
    EXPECT_NE(result.err, "");
  }
  WriteText(folder / "bad.yaml", "name: x\nskeletn: smpl24\n");
  for (const std::vector<std::string>& verb : {std::vector<std::string>{"run"}, {"config", "show"}}) {
    std::vector<std::string> arguments = verb;
    arguments.insert(arguments.end(), {(folder / "bad.yaml").string(), "--json"});
    EXPECT_EQ(ExpectDocument(RunProgram(folder, arguments), 2)["error"]["code"], "config");
  }
}

TEST(Documents, AMissingConfigurationIsExitCode2AndMissingInput3) {
  const ScratchFolder folder;
  const std::string none = folder / "none.yaml";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"run", none}, {"config", "show", none}, {"inspect", none}}) {
    std::vector<std::string> with_json = arguments;
    with_json.emplace_back("--json");
    const bool input = arguments.front() == "inspect";
    const nlohmann::json document = ExpectDocument(RunProgram(folder, with_json), input ? 3 : 2);
    if (input) {  // an answer as of any other file
      EXPECT_TRUE(document["clips"].empty());
      EXPECT_EQ(document["findings"][0]["code"], "not_found");
      EXPECT_EQ(document["findings"][0]["severity"], "error");
      EXPECT_THAT(document["findings"][0]["where"].get<std::string>(), HasSubstr("none.yaml"));
      continue;
    }
    EXPECT_EQ(document["error"]["code"], "config");
    EXPECT_THAT(document["error"]["where"].get<std::string>(), HasSubstr("none.yaml"));
  }
}

}  // namespace
}  // namespace mocurate
