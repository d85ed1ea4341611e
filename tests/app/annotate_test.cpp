// `mocurate review --annotate`: from recordings without labels to a dataset cut by marked spans.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/store/store.h"
#include "tests/app/program.h"

namespace mocurate {
namespace {

using program::ReadText;
using program::Result;
using program::RunProgram;
using program::SmallJob;
using program::WriteText;
using ::testing::HasSubstr;

TEST(Annotated, RecordingsAreCutByTheSpansThatThePageSaves) {
  const ScratchFolder folder;
  const auto run = [&](const char* name, const std::string& rule, const std::string& spans) {
    std::vector<std::string> job = SmallJob(folder, name);
    for (const std::string& set :
         {std::string("ingest.synthetic.actions=[wave, kick]"), std::string("ingest.synthetic.subjects=1"),
          "canon.trim.rule=" + rule, "canon.trim.spans=" + spans}) {
      job.insert(job.end(), {"--set", set});
    }
    return RunProgram(folder, job);
  };
  ASSERT_EQ(run("whole", "none", "''").exit_code, 0);
  const std::string set = (folder / "whole/dataset.h5").string(), page = (folder / "page.html").string();
  const auto annotate = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"review", set, "--annotate", "-o", page, "--force", "--json"});
    return RunProgram(folder, more);
  };
  EXPECT_EQ(annotate({}).exit_code, 3) << "every clip has a label";
  const std::string clip = ReadDataset(folder / "whole/dataset.h5")->clips.front().id();
  const std::string recording = clip.substr(0, clip.rfind('#'));
  WriteText(folder / "spans.csv",
            "clip,begin_s,end_s,label\n" + recording + ",0.2,0.7,\"turn, left\"\n" + recording + ",0.5,1.2,stop\n");
  const std::string spans = (folder / "spans.csv").string();
  const Result made = annotate({"--all", "--recipe", "kard18", "--spans", spans});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.Json()["clips"], 2);
  EXPECT_EQ(made.Json()["spans"], 2);
  EXPECT_EQ(made.Json()["labels"], 20) << "the recipe's and those of spans";
  EXPECT_THAT(ReadText(page), HasSubstr("turn, left"));

  EXPECT_EQ(annotate({"--all", "--labels", ""}).exit_code, 2);
  EXPECT_EQ(annotate({"--all", "--labels", "walk,,run"}).exit_code, 2);
  EXPECT_EQ(annotate({"--all", "--labels", "walk", "--recipe", "kard18"}).exit_code, 2);
  EXPECT_EQ(annotate({"--all", "--recipe", "kard81"}).exit_code, 2);
  EXPECT_EQ(annotate({"--clip", "unknown"}).exit_code, 2);
  EXPECT_EQ(annotate({"--all", "--most", "3"}).exit_code, 2) << "an option of the other page";
  EXPECT_EQ(annotate({"--all", "--spans", (folder / "none.csv").string()}).exit_code, 3);
  EXPECT_EQ(RunProgram(folder, {"review", set, "--labels", "walk", "-o", page, "--force"}).exit_code, 2);
  EXPECT_EQ(RunProgram(folder, {"review", spans, "--annotate", "-o", page, "--force"}).exit_code, 3);
  Dataset empty = *ReadDataset(folder / "whole/dataset.h5");
  empty.clips.clear();
  empty.splits.clear();
  empty.findings.clear();
  ASSERT_TRUE(WriteDataset(empty, folder / "empty.h5"));
  const std::string none = (folder / "empty.h5").string();
  EXPECT_EQ(RunProgram(folder, {"review", none, "--annotate", "-o", page, "--force"}).exit_code, 3);

  const Result cut = run("cut", "annotated", spans);
  ASSERT_EQ(cut.exit_code, 0) << cut.err;
  const auto dataset = ReadDataset(folder / "cut/dataset.h5");
  ASSERT_TRUE(dataset) << dataset.error().Message();
  std::vector<std::string> labels;
  for (const Clip& one : dataset->clips) labels.push_back(one.label);
  EXPECT_THAT(labels, ::testing::UnorderedElementsAre("turn, left", "stop"));
}

}  // namespace
}  // namespace mocurate
