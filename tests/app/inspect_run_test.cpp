// Descriptions of run folders: each result is assigned to the run that made it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "core/base/file.h"
#include "core/base/text.h"
#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::Result;
using program::RunProgram;
using program::SharedCache;
using program::SmallJob;
using program::WriteText;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> Failing(const ScratchFolder& folder) {
  std::vector<std::string> arguments = SmallJob(folder, "runs/a");
  arguments.insert(arguments.end(), {"--set", "ingest.synthetic.enabled=false", "--set",
                                     "ingest.path=" + (folder / "nowhere").string()});
  return arguments;
}

TEST(InspectRun, AFailedLaterRunHasNoResultsOfTheEarlierOne) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "runs/a"), SharedCache()).exit_code, 0);
  const std::string run = (folder / "runs/a").string();
  const std::string whole = RunProgram(folder, {"inspect", run}).out;
  EXPECT_THAT(whole, HasSubstr("15 clips, 15 kept"));
  EXPECT_THAT(whole, Not(HasSubstr("stale")));

  ASSERT_EQ(RunProgram(folder, Failing(folder)).exit_code, 3);
  const Result failed = RunProgram(folder, {"inspect", run});
  EXPECT_THAT(failed.out, HasSubstr("with exit code 3"));
  EXPECT_THAT(failed.out, Not(HasSubstr("15 kept")));
  EXPECT_THAT(failed.out, HasSubstr("curation_log.jsonl (canon), dataset.h5 (assemble)"));
  const nlohmann::json json = RunProgram(folder, {"inspect", run, "--json"}).Json();
  EXPECT_TRUE(json["files"].empty());
  EXPECT_TRUE(json["clips"].empty());
  const nlohmann::json both = {{{"file", "curation_log.jsonl"}, {"stage", "canon"}},
                               {{"file", "dataset.h5"}, {"stage", "assemble"}}};
  EXPECT_EQ(json["stale"], both);
}

TEST(InspectRun, OutputsOlderThanARunThatWasCutShortAreStale) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "runs/a"), SharedCache()).exit_code, 0);
  const fs::path run = folder / "runs/a";
  nlohmann::json record = nlohmann::json::parse(program::ReadText(run / "run.json"));
  for (const char* key : {"ended", "stale"}) record.erase(key);
  WriteText(run / "run.json", record.dump());
  const auto begun = fs::file_time_type::clock::now() - std::chrono::hours(1);
  fs::last_write_time(run / "run.json", begun);
  fs::last_write_time(run / "dataset.h5", begun - std::chrono::hours(1));
  WriteText(run / "progress.json",
            R"({"stage": "train", "items": [{"item": "A/1", "share": 0.5, "text": "step 5 of 10", "time": "9999"},
                {"item": "B/1", "share": 0.5, "text": "of an earlier run", "time": "1999"}]})");
  const nlohmann::json json = RunProgram(folder, {"inspect", run.string(), "--json"}).Json();
  EXPECT_EQ(json["state"], "cut_short");
  ASSERT_EQ(json["at_work"].size(), 1u);
  EXPECT_EQ(json["at_work"][0]["text"], "step 5 of 10");
  EXPECT_EQ(json["files"], nlohmann::json({"curation_log.jsonl"}));
  EXPECT_EQ(json["stale"], nlohmann::json::array({{{"file", "dataset.h5"}, {"stage", "assemble"}}}));
}

TEST(InspectRun, CountsDecisionsOfTheLog) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "runs/a"), SharedCache()).exit_code, 0);
  const fs::path run = folder / "runs/a";
  const std::string text = *ReadFile(run / "curation_log.jsonl");
  std::string changed;
  std::size_t i = 0;
  for (const std::string_view part : SplitText(text, '\n')) {
    if (part.empty()) continue;
    nlohmann::json line = nlohmann::json::parse(part);
    if (i < 2) line["decision"] = "excluded";
    if (i < 5) line["suspect"] = i >= 2;
    changed += line.dump() + "\n";
    ++i;
  }
  WriteText(run / "curation_log.jsonl", changed);
  const nlohmann::json json = RunProgram(folder, {"inspect", run.string(), "--json"}).Json();
  EXPECT_EQ(json["suspect"], 3);
  EXPECT_EQ(json["clips"]["excluded"], 2);
}

TEST(InspectRun, ARemovedResultIsReportedAsMissing) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "runs/a"), SharedCache()).exit_code, 0);
  fs::remove(folder / "runs/a/dataset.h5");
  const std::string run = (folder / "runs/a").string();
  EXPECT_THAT(RunProgram(folder, {"inspect", run}).out, HasSubstr("dataset.h5: written by this run and removed since"));
  EXPECT_EQ(RunProgram(folder, {"inspect", run, "--json"}).Json()["missing"], nlohmann::json({"dataset.h5"}));
}

TEST(InspectRun, AFolderOfRunsNamesThemAndTheirFilesAreKnown) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "runs/a"), SharedCache()).exit_code, 0);
  fs::copy(folder / "runs/a", folder / "runs/b", fs::copy_options::recursive);
  const Result runs = RunProgram(folder, {"inspect", (folder / "runs").string()});
  EXPECT_EQ(runs.exit_code, 0) << runs.err;
  EXPECT_THAT(runs.out, HasSubstr("a folder of 2 runs"));
  EXPECT_THAT(runs.out, HasSubstr("demo up to assemble, started "));
  EXPECT_EQ(RunProgram(folder, {"inspect", (folder / "runs").string(), "--json"}).Json()["runs"][1]["folder"], "b");

  WriteText(folder / "runs/a/report/index.html", "<!DOCTYPE html>");
  for (const char* file : {"run.json", "curation_log.jsonl", "report/index.html"}) {
    const Result inspected = RunProgram(folder, {"inspect", (folder / "runs/a" / file).string()});
    EXPECT_EQ(inspected.exit_code, 0) << inspected.err;
    EXPECT_THAT(inspected.out, HasSubstr("of a run of demo")) << file;
  }
}

TEST(Comparison, NeverStopsTheFittedDatasetAndIsReportedBeforeTheWork) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const ScratchFolder folder;
  fs::create_directories(folder / "kard");
  for (const char* clip : {"a12_s01_e01", "a17_s01_e01"}) {
    const std::string name = std::string(clip) + "_realworld.txt";
    fs::copy_file(fs::path(data) / "kinect/kard" / name, folder / ("kard/" + name));
  }
  const Result result =
      RunProgram(folder, {"run", std::string(kSourceFolder) + "/configs/kard.yaml", "-o", (folder / "r").string(),
                          "--to", "assemble", "--set", "skeleton=kinect20", "--set", "assemble.splits=[]", "--set",
                          "ingest.path=" + (folder / "kard").string(), "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(fs::exists(folder / "r/dataset.h5"));
  const std::size_t reported = result.err.find(
      "the comparison with the raw tracks (trained_on: unfitted) was dropped: the source has no tracks of ");
  ASSERT_NE(reported, std::string::npos) << result.err;
  EXPECT_LT(reported, result.err.find("ingest: 2 items"));
  EXPECT_EQ(result.err.find("refused"), std::string::npos) << result.err;
  EXPECT_EQ(result.Json()["set_findings"].back()["code"], "comparison_dropped");
}

}  // namespace
}  // namespace mocurate
