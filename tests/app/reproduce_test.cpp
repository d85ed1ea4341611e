// `mocurate reproduce`: the papers' tables and figures by one command, and refused arguments.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/app/program.h"

namespace mocurate {
namespace {

using program::ReadText;
using program::Result;
using program::RunProgram;
using ::testing::HasSubstr;

namespace fs = std::filesystem;

/// An item in profile smoke, its answer as JSON.
nlohmann::json Reproduced(const ScratchFolder& folder, const std::string& id, std::vector<std::string> more = {}) {
  std::string name = id;
  std::replace(name.begin(), name.end(), '/', '_');
  std::vector<std::string> arguments = {"reproduce", id, "--profile", "smoke", "--json", "-o", (folder / name).string(),
                                        "--jobs",    "1"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Result result = RunProgram(folder, arguments);
  EXPECT_EQ(result.exit_code, 0) << id << ": " << result.err;
  const nlohmann::json answer = nlohmann::json::parse(result.out, nullptr, false);
  EXPECT_TRUE(answer.is_object()) << result.out;
  return answer.is_object() ? answer : nlohmann::json::object();
}

const nlohmann::json& RowOf(const nlohmann::json& set, const std::string& method) {
  static const nlohmann::json kNone;
  for (const nlohmann::json& row : set.at("rows")) {
    if (row.at("method") == method) return row;
  }
  ADD_FAILURE() << "no row '" << method << "'";
  return kNone;
}

bool HasPictures(const nlohmann::json& answer, std::size_t count) {
  if (answer.at("pictures").size() != count) return false;
  for (const nlohmann::json& picture : answer["pictures"]) {
    if (!fs::is_regular_file(picture.get<std::string>())) return false;
  }
  return true;
}

TEST(Reproduce, TheListHasItemsMissingInputsAndDurations) {
  const ScratchFolder folder;
  program::Surroundings bare;  // a machine without a body for losses on vertices
  bare.before_start = [] {
    unsetenv("MOCURATE_DATA");
    unsetenv("MOCURATE_WEIGHTS");
  };
  const Result result = RunProgram(folder, {"reproduce", "list", "--json", "--data", "humanact12=/data/ha12"}, bare);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json items = nlohmann::json::parse(result.out);
  std::map<std::string, nlohmann::json> by_id;
  for (const nlohmann::json& item : items) by_id[item.at("id")] = item;
  for (const char* id : {"a2m/table1", "a2m/table5", "a2m/figure4", "a2m/figure9", "actor/table4", "actor/tableA1",
                         "actor/tableA4", "actor/figure3", "actor/one_euro", "multiact/tableB", "multiact/figure1",
                         "multiact/figure7", "multiact/figureB"}) {
    EXPECT_EQ(by_id.count(id), 1U) << id;
  }
  EXPECT_EQ(by_id["a2m/figure4"]["kind"], "study");
  EXPECT_EQ(by_id["actor/figure2"]["kind"], "diagram");
  EXPECT_EQ(by_id["a2m/table1"]["at_hand"], nlohmann::json({"humanact12"}));
  EXPECT_EQ(by_id["a2m/table1"]["missing"][0]["name"], "ntu13");
  EXPECT_TRUE(by_id["a2m/table1"]["profiles"].contains("smoke"));
}

TEST(Reproduce, TablesOfCountsAreExactWithoutData) {
  const ScratchFolder folder;
  const nlohmann::json classes = Reproduced(folder, "a2m/table5");
  ASSERT_EQ(classes.at("sets").size(), 1U);
  for (const nlohmann::json& row : classes["sets"][0]["rows"]) {
    EXPECT_EQ(row["metrics"]["clips"]["ratio"], 1.0) << row;
  }
  const nlohmann::json parameters = Reproduced(folder, "a2m/table3");
  ASSERT_EQ(parameters.at("sets").size(), 1U);
  ASSERT_EQ(parameters["sets"][0]["rows"].size(), 3U);
  for (const nlohmann::json& row : parameters["sets"][0]["rows"]) {
    EXPECT_EQ(row["metrics"]["parameters"]["ratio"], 1.0) << row;
  }
}

TEST(Reproduce, ATableHasThePublishedNumbersAndNamesItsSubstitute) {
  const ScratchFolder folder;
  const nlohmann::json table = Reproduced(folder, "a2m/table2");
  ASSERT_EQ(table.at("sets").size(), 2U) << "the paper's split, and one with held-out recordings";
  const nlohmann::json& set = table["sets"][0];
  EXPECT_EQ(set["substitute"], "cmu8");
  EXPECT_EQ(RowOf(set, "Ours")["metrics"]["FID_train"]["published"], 2.885);
  EXPECT_EQ(RowOf(set, "Ours")["metrics"]["FID_train"]["why_no_ratio"], "other_features");
  EXPECT_EQ(RowOf(set, "Ours")["profile"], "smoke");
  EXPECT_EQ(RowOf(set, "CondGRU zeros")["published_as"], "CondGRU") << "the published row is of zeros (F4)";
  EXPECT_TRUE(RowOf(set, "CondGRU")["published_as"].is_null());
  EXPECT_GT(set["order"].size(), 0U);
  for (const char* ending : {".md", ".csv", ".tex", ".json"}) {
    EXPECT_TRUE(fs::is_regular_file(folder / ("a2m_table2/tables/table2" + std::string(ending)))) << ending;
  }
  EXPECT_EQ(Reproduced(folder, "a2m/table2"), table) << "again";
  const Result ours = RunProgram(folder, {"inspect", folder / "a2m_table2/data/cmu8/checkpoints/Ours_1.h5", "--json"});
  ASSERT_EQ(ours.exit_code, 0) << ours.err;
  EXPECT_EQ(ours.Json()["options"]["frames"], 100) << "the set's windows and weights";
  EXPECT_EQ(ours.Json()["options"]["kl_weight"], 0.01);
}

TEST(Reproduce, AStudyHasItsPageAndAFigureWithoutAnswers) {
  const ScratchFolder folder;
  const nlohmann::json study = Reproduced(folder, "a2m/figure4");
  EXPECT_TRUE(HasPictures(study, 2U));
  EXPECT_EQ(study["kind"], "study");
  if (std::getenv("MOCURATE_DATA") == nullptr) return;  // which has a body for the loss on vertices
  EXPECT_TRUE(HasPictures(Reproduced(folder, "actor/figure5"), 2U));
  EXPECT_EQ(RunProgram(folder, {"draw", (folder / "actor_figure5/motions/throws_ACTOR.h5").string(), "--stills", "3",
                                "--figure", "skin", "-o", (folder / "skin.png").string()})
                .exit_code,
            0);
  EXPECT_GT(fs::file_size(folder / "skin.png"), 5000U);
}

TEST(Reproduce, ATimeBudgetBoundsTrainingAndIsSaved) {
  const ScratchFolder folder;
  const std::string place = (folder / "r").string();
  const std::vector<std::string> asked = {
      "reproduce", "a2m/figure6", "--profile", "small", "--set",        "substitutes=[subjects=2]",
      "-o",        place,         "--jobs",    "1",     "--time-budget"};
  std::vector<std::string> short_one = asked, enough = asked;
  short_one.emplace_back("1 ms");
  const Result refused = RunProgram(folder, short_one);
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("--time-budget"));
  enough.emplace_back("2 s");
  const Result done = RunProgram(folder, enough);
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const std::string kept = ReadText(folder / "r/time_budget.json");
  EXPECT_LT(nlohmann::json::parse(kept).at("factor").get<double>(), 1.0);
  ASSERT_EQ(RunProgram(folder, enough).exit_code, 0);
  EXPECT_EQ(ReadText(folder / "r/time_budget.json"), kept) << "the same run goes on with the same share";
}

TEST(Reproduce, UnknownItemsAndBudgetsAreRefusedWithTheRemedy) {
  const ScratchFolder folder;
  const std::pair<std::vector<std::string>, const char*> asked[] = {
      {{"actor/tabel3"}, "actor/table3"},
      {{"table3"}, "a2m/table3 or actor/table3 or multiact/table3"},
      {{"multiact/figure2"}, "drawing of the method"},
      {{"a2m/table1", "--data", "humanact=/x"}, "humanact12=PATH"},
      {{"a2m/table1", "--time-budget", "soon"}, "--time-budget soon"},
      {{"a2m/table1", "--time-budget", "0 s"}, "--time-budget 0 s"}};
  for (const auto& [words, way_out] : asked) {
    std::vector<std::string> arguments = {"reproduce", "-o", (folder / "r").string()};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const Result result = RunProgram(folder, arguments);
    EXPECT_EQ(result.exit_code, 2) << words.front() << result.err;
    EXPECT_THAT(result.err, HasSubstr(way_out));
  }
  const Result layout = RunProgram(folder, {"reproduce", "a2m/table5", "--data", "humanact12=" + (folder / "").string(),
                                            "-o", (folder / "r").string()});
  EXPECT_NE(layout.exit_code, 0) << "a folder of another layout";
  EXPECT_THAT(layout.err, HasSubstr("humanact12"));
  EXPECT_FALSE(fs::exists(folder / "r/tables/table5.md")) << "the recipe's numbers are not the user's";
  program::WriteText(folder / "mine/tables/table5.tex", "written by the user");
  const Result mine = RunProgram(folder, {"reproduce", "a2m/table5", "-o", (folder / "mine").string()});
  EXPECT_EQ(mine.exit_code, 2);
  EXPECT_EQ(ReadText(folder / "mine/tables/table5.tex"), "written by the user");
  EXPECT_EQ(RunProgram(folder, {"reproduce", "list", "--data", "humanact=/x"}).exit_code, 2);
}

TEST(Draw, PicturesAndVideosAreWrittenAndNothingElseIsOverwritten) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, program::SmallJob(folder, "r"), program::SharedCache()).exit_code, 0);
  const std::string set = (folder / "r/dataset.h5").string();
  for (const char* name : {"a.svg", "a.png", "a.mp4"}) {
    const std::vector<std::string> draw = {"draw", "Real=" + set, "--label", "kick", "-o", (folder / name).string()};
    EXPECT_EQ(RunProgram(folder, draw).exit_code, 0) << name;
    EXPECT_GT(fs::file_size(folder / name), 1000U) << name;
    EXPECT_EQ(RunProgram(folder, draw).exit_code, 2) << "the file is there: --force";
  }
  const std::string out = (folder / "b.svg").string();
  EXPECT_EQ(RunProgram(folder, {"draw", set, "-o", (folder / "b.gif").string()}).exit_code, 2);
  EXPECT_EQ(RunProgram(folder, {"draw", set, "--label", "kcik", "-o", out}).exit_code, 3);
  EXPECT_EQ(RunProgram(folder, {"draw", (folder / "none.h5").string(), "-o", out}).exit_code, 3);
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace mocurate
