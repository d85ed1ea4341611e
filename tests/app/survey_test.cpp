// `mocurate survey`: from two sets of motions to a page, from answers to ranks and shares.

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
using ::testing::Not;

/// The file that the page of a ranking saves of a participant who always ranks one of two sources first.
nlohmann::json AnswersFor(const std::string& source, const std::string& participant, const nlohmann::json& key) {
  nlohmann::json answers = {
      {"survey", key["survey"]}, {"participant", participant}, {"missing", nlohmann::json::array()}};
  for (const nlohmann::json& question : key["questions"]) {
    const int first = question["shown"][0]["source"] == source ? 1 : 2;
    answers["answers"].push_back({{"question", question["question"]}, {"answer", {first, 3 - first}}});
  }
  return answers;
}

TEST(Surveyed, AnswersAreCountedAndEditedOnesRefused) {
  const ScratchFolder folder;
  std::vector<std::string> job = SmallJob(folder, "run");
  job.insert(job.end(), {"--set", "ingest.synthetic.actions=[walk, wave]"});
  ASSERT_EQ(RunProgram(folder, job).exit_code, 0);
  const std::string set = (folder / "run/dataset.h5").string();
  const std::string ours = "ours_4711=" + set, theirs = "theirs_0815=" + set;
  const auto make = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"survey", "make"});
    more.insert(more.end(), {"-o", (folder / "survey").string(), "--json"});
    program::Surroundings bare;
    bare.before_start = [] {
      unsetenv("MOCURATE_WEIGHTS");
      unsetenv("MOCURATE_DATA");
    };
    return RunProgram(folder, more, bare);
  };
  const Result made = make({"ranking", "--motions", ours, "--motions", theirs});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.Json()["questions"], 2) << "one for each label";
  const std::string page = ReadText(folder / "survey/survey.html");
  EXPECT_THAT(page, Not(HasSubstr("ours_4711")));
  EXPECT_THAT(page, Not(HasSubstr("theirs_0815")));
  const nlohmann::json key = nlohmann::json::parse(ReadText(folder / "survey/key.json"));
  EXPECT_EQ(make({"ranking", "--motions", ours, "--motions", theirs}).exit_code, 2) << "the files are there";
  const auto refused = [&](std::vector<std::string> more, int code, const char* message) {
    more.push_back("--force");
    const Result result = make(more);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  refused({"ranking", "--motions", set, "--motions", theirs}, 2, "is not NAME=FILE");
  refused({"ranking", "--motions", ours}, 2, "a ranking has 2 to 9");
  refused({"ranking", "--motions", ours, "--motions", "a=none.h5"}, 3, "no such file or folder");
  refused({"ranking", "--motions", ours, "--motions", theirs, "--label", "jump"}, 2,
          "source 'ours_4711' has no motions of the label 'jump'");
  refused({"ranking", "--motions", ours, "--motions", theirs, "--real", "ours_4711"}, 2, "do not apply");
  refused({"preference", "--motions", ours, "--motions", theirs}, 2, "preference");
  const std::vector<std::string> judged = {"real_or_fake", "--motions", ours, "--motions", theirs};
  const auto judge = [&](std::vector<std::string> more) {
    more.insert(more.begin(), judged.begin(), judged.end());
    return more;
  };
  refused(judge({}), 4, "SMPL_NEUTRAL.pkl");
  refused(judge({"--body", "none.pkl"}), 3, "there is no such file");
  refused(judge({"--figure", "bones"}), 2, "no source has the name 'real'");
  refused(judge({"--figure", "bones", "--real", "ours_4711"}), 2, "are needed, because none is shown twice");
  EXPECT_EQ(make(judge({"--figure", "bones", "--real", "ours_4711", "--questions", "2", "--clips", "2", "--force"}))
                .exit_code,
            0);

  WriteText(folder / "victim", "old");
  for (const char* file : {"survey/key.json", "tally/figure.svg"}) {
    std::filesystem::create_directories((folder / file).parent_path());
    std::filesystem::remove(folder / file);
    std::filesystem::create_symlink(folder / "victim", folder / file);
  }
  EXPECT_EQ(make({"ranking", "--motions", ours, "--motions", theirs, "--force"}).exit_code, 74) << "a link";

  WriteText(folder / "key.json", key.dump());
  const auto tally = [&](std::vector<std::string> files) {
    files.insert(files.begin(), {"survey", "tally", (folder / "key.json").string(), "--json", "--force", "-o",
                                 (folder / "tally").string()});
    return RunProgram(folder, files);
  };
  const auto put = [&](const std::string& name, const nlohmann::json& answers) {
    WriteText(folder / name, answers.dump(1));
    return (folder / name).string();
  };
  EXPECT_EQ(tally({}).exit_code, 74) << "a link";
  EXPECT_EQ(ReadText(folder / "victim"), "old");
  std::filesystem::remove(folder / "tally/figure.svg");
  const Result none = tally({});
  ASSERT_EQ(none.exit_code, 0) << none.err;
  EXPECT_EQ(none.Json()["rows"][0]["votes"], 0);
  EXPECT_THAT(ReadText(folder / "tally/figure.svg"), HasSubstr("<svg"));

  const std::string a = put("a.json", AnswersFor("ours_4711", "a", key));
  const std::string b = put("b.json", AnswersFor("theirs_0815", "b", key));
  const std::string c = put("c.json", AnswersFor("ours_4711", "c", key));
  const Result counted = tally({a, b, c});
  ASSERT_EQ(counted.exit_code, 0) << counted.err;
  const nlohmann::json row = counted.Json()["rows"][0];
  EXPECT_EQ(row["source"], "ours_4711");
  EXPECT_EQ(row["ranks"], nlohmann::json({4, 2}));
  EXPECT_FALSE(row["first"]["bootstrap_95"]["low"].is_null());
  EXPECT_EQ(counted.Json()["differences"][0]["p"], 1.0) << "-1, 1, -1: all 8 sign patterns are as large";
  EXPECT_EQ(nlohmann::json::parse(ReadText(folder / "tally/tally.json")), counted.Json());
  EXPECT_THAT(ReadText(folder / "tally/tally.csv"), HasSubstr("\nours_4711,walk,3,2,1,1.3333,2,0.6667,"));
  EXPECT_THAT(ReadText(folder / "tally/differences.csv"), HasSubstr("ours_4711,theirs_0815,-0.3333,3,1.0000,1.0000"));

  nlohmann::json edited = AnswersFor("ours_4711", "d", key);
  edited["answers"][1]["answer"] = {1, 1};
  const std::string d = put("d.json", edited);
  const Result wrong = tally({a, d});
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_THAT(wrong.err, HasSubstr("d.json: /answers/1/answer"));
  nlohmann::json half = AnswersFor("ours_4711", "e", key);
  half["answers"].erase(1);
  half["missing"] = {key["questions"][1]["question"]};
  EXPECT_EQ(tally({a, put("e.json", half)}).exit_code, 3) << "an open question";
  EXPECT_EQ(tally({a, put("again.json", AnswersFor("ours_4711", "a", key))}).exit_code, 3) << "one participant twice";
  const Result skipped = tally({a, d, "--skip-bad"});
  ASSERT_EQ(skipped.exit_code, 0) << skipped.err;
  EXPECT_EQ(skipped.Json()["participants"], nlohmann::json::array({"a"}));
  EXPECT_EQ(skipped.Json()["skipped"].size(), 1u);
  EXPECT_THAT(skipped.err, HasSubstr("d.json"));
  nlohmann::json other = key;
  other["questions"][0]["shown"][0]["source"] = key["questions"][0]["shown"][1]["source"];
  WriteText(folder / "key.json", other.dump());
  EXPECT_EQ(tally({a}).exit_code, 3) << "an edited key";
}

}  // namespace
}  // namespace mocurate
