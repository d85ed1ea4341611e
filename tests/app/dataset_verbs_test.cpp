// Verbs that make datasets from datasets: answers, exit codes, and unchanged inputs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/program.h"
#include "tests/store/builders.h"

namespace mocurate {
namespace {

using program::Result;
using program::RunProgram;
using program::WriteText;

/// Three clips of a walker: two walk, one runs.
class DatasetVerbs : public ::testing::Test {
 protected:
  void SetUp() override {
    const Status written = WriteDataset(test::MakeDataset(), folder_ / "set.h5");
    ASSERT_TRUE(written) << written.error().Message();
  }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  Result Dataset(const std::string& verb, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"dataset", verb});
    return RunProgram(folder_, arguments);
  }

  ScratchFolder folder_;
};

TEST_F(DatasetVerbs, SplitAndMergeADataset) {
  const Result walks =
      Dataset("subset", {Path("set.h5"), "--where", "label == walk and frames > 4", "-o", Path("walk.h5"), "--json"});
  ASSERT_EQ(walks.exit_code, 0) << walks.err;
  EXPECT_EQ(walks.Json()["clips"], 2);
  EXPECT_EQ(walks.Json()["clips_before"], 3);
  EXPECT_EQ(walks.Json()["labels"], (nlohmann::json{"locomotion", "run", "walk"}));
  ASSERT_EQ(Dataset("subset", {Path("set.h5"), "--where", "label == run", "-o", Path("run.h5"), "--drop-empty-labels"})
                .exit_code,
            0);
  const Result merged = Dataset("merge", {Path("walk.h5"), Path("run.h5"), "-o", Path("all.h5"), "--json"});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(merged.Json()["clips"], 3);
  EXPECT_EQ(merged.Json()["repeated"], 0);
  const Result same = RunProgram(folder_, {"dataset", "diff", Path("set.h5"), Path("all.h5"), "--json"});
  EXPECT_EQ(same.Json()["equal"], 3) << same.out;

  WriteText(folder_ / "map.yaml", "labels: {run: walk}\nclasses: [walk]\n");
  const Result one = Dataset("relabel", {Path("all.h5"), Path("map.yaml"), "-o", Path("one.h5"), "--json"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(one.Json()["relabelled"], 1);
  EXPECT_EQ(one.Json()["changes"], (nlohmann::json{{{"before", "run"}, {"after", "walk"}, {"clips", 1}}}));
  EXPECT_EQ(one.Json()["labels"], nlohmann::json{"walk"});
}

TEST_F(DatasetVerbs, EndWithTheExitCodesOfEveryVerb) {
  WriteText(folder_ / "map.yaml", "wlk: run\n");
  const std::string set = Path("set.h5"), out = Path("new.h5"), map = Path("map.yaml");
  const struct {
    const char* verb;
    std::vector<std::string> arguments;
    int exit_code;
  } cases[] = {{"subset", {set, "--where", "labl == walk", "-o", out}, 2},
               {"subset", {set, "--where", "part(persons) == test", "-o", out}, 2},
               {"subset", {set, "-o", out}, 2},
               {"subset", {set, "--where", "label == jump", "-o", out}, 3},
               {"subset", {Path("none.h5"), "--where", "label == walk", "-o", out}, 3},
               {"subset", {set, "--where", "label == walk", "-o", set, "--force"}, 2},
               {"subset", {set, "--where", "label == walk", "-o", map}, 2},
               {"subset", {set, "--where", "label == walk", "-o", Path("nowhere/new.h5")}, 74},
               {"merge", {set, "-o", out}, 2},
               {"merge", {set, set, "-o", set, "--force"}, 2},
               {"merge", {set, map, "-o", out}, 3},
               {"relabel", {set, map, "-o", out}, 2},
               {"relabel", {set, Path("none.yaml"), "-o", out}, 3},
               {"relabel", {set, map, "-o", map, "--force"}, 2}};
  const std::string before = program::ReadText(folder_ / "set.h5");
  for (const auto& [verb, arguments, exit_code] : cases) {
    const Result result = Dataset(verb, arguments);
    EXPECT_EQ(result.exit_code, exit_code) << verb << " " << ::testing::PrintToString(arguments) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << verb;
  }
  EXPECT_EQ(program::ReadText(folder_ / "set.h5"), before);
  EXPECT_EQ(program::ReadText(folder_ / "map.yaml"), "wlk: run\n");
}

TEST_F(DatasetVerbs, RefuseOneIdOfTwoMotionsAndOverwriteWhenAsked) {
  mocurate::Dataset other = test::MakeDataset();
  other.clips[1].motion = test::Wander(test::Walker(), other.clips[1].rate, 9, "another");
  ASSERT_TRUE(WriteDataset(other, folder_ / "other.h5"));
  EXPECT_EQ(Dataset("merge", {Path("set.h5"), Path("other.h5"), "-o", Path("new.h5")}).exit_code, 3);
  WriteText(folder_ / "new.h5", "old");
  EXPECT_EQ(Dataset("merge", {Path("set.h5"), Path("set.h5"), "-o", Path("new.h5")}).exit_code, 2);
  EXPECT_EQ(program::ReadText(folder_ / "new.h5"), "old");
  const Result twice = Dataset("merge", {Path("set.h5"), Path("set.h5"), "-o", Path("new.h5"), "--force", "--json"});
  ASSERT_EQ(twice.exit_code, 0) << twice.err;
  EXPECT_EQ(twice.Json()["clips"], 3);
  EXPECT_EQ(twice.Json()["repeated"], 3);
  EXPECT_TRUE(ReadDataset(folder_ / "new.h5"));
}

}  // namespace
}  // namespace mocurate
