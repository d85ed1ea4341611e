// `mocurate survey`: from two sets of motions to a page, from answers to shares.

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

/// The file that the page of a survey saves of a participant who always chooses one source.
nlohmann::json AnswersFor(const std::string& source, const std::string& participant, const nlohmann::json& key) {
  nlohmann::json answers = {
      {"survey", key["survey"]}, {"participant", participant}, {"missing", nlohmann::json::array()}};
  for (const nlohmann::json& question : key["questions"]) {
    const bool left = question["left"]["source"] == source;
    answers["answers"].push_back({{"question", question["question"]}, {"answer", left ? "left" : "right"}});
  }
  return answers;
}

TEST(Surveyed, AnswersAreCountedAndEditedOnesRefused) {
  const ScratchFolder folder;
  std::vector<std::string> job = SmallJob(folder, "run");
  job.insert(job.end(), {"--set", "ingest.synthetic.actions=[walk, wave]"});
  ASSERT_EQ(RunProgram(folder, job).exit_code, 0);
  const std::string set = (folder / "run/dataset.h5").string();
  const auto make = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"survey", "make"});
    more.insert(more.end(), {"-o", (folder / "survey").string(), "--json"});
    return RunProgram(folder, more);
  };
  const std::string ours = "ours_4711=" + set, theirs = "theirs_0815=" + set;
  const Result made = make({"preference", "--motions", ours, "--motions", theirs});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.Json()["questions"], 6);
  const std::string page = ReadText(folder / "survey/survey.html");
  EXPECT_THAT(page, Not(HasSubstr("ours_4711")));
  EXPECT_THAT(page, Not(HasSubstr("theirs_0815")));
  const nlohmann::json key = nlohmann::json::parse(ReadText(folder / "survey/key.json"));
  EXPECT_EQ(make({"preference", "--motions", ours, "--motions", theirs}).exit_code, 2) << "the files are there";
  EXPECT_EQ(make({"preference", "--motions", set, "--motions", theirs, "--force"}).exit_code, 2) << "no name";
  EXPECT_EQ(make({"preference", "--motions", ours, "--force"}).exit_code, 2) << "one source";
  EXPECT_EQ(make({"preference", "--motions", ours, "--motions", "a=none.h5", "--force"}).exit_code, 3);
  EXPECT_EQ(make({"real_or_fake", "--motions", ours, "--motions", theirs, "--force"}).exit_code, 2) << "no real one";
  EXPECT_EQ(make({"real_or_fake", "--motions", ours, "--motions", theirs, "--real", "ours_4711", "--force"}).exit_code,
            0);

  WriteText(folder / "victim", "old");
  for (const char* file : {"survey/key.json", "tally/figure.svg"}) {
    std::filesystem::create_directories((folder / file).parent_path());
    std::filesystem::remove(folder / file);
    std::filesystem::create_symlink(folder / "victim", folder / file);
  }
  EXPECT_EQ(make({"preference", "--motions", ours, "--motions", theirs, "--force"}).exit_code, 74) << "a link";

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
  EXPECT_EQ(row["first"], "ours_4711");
  EXPECT_EQ(row["preferred_first"], 12);
  EXPECT_EQ(row["votes"], 18);
  EXPECT_FALSE(row["bootstrap_95"].is_null());
  EXPECT_EQ(nlohmann::json::parse(ReadText(folder / "tally/tally.json")), counted.Json());
  EXPECT_THAT(ReadText(folder / "tally/tally.csv"), HasSubstr("ours_4711,theirs_0815,walk,6,9,"));

  nlohmann::json edited = AnswersFor("ours_4711", "d", key);
  edited["answers"][1]["answer"] = "both";
  const std::string d = put("d.json", edited);
  const Result refused = tally({a, d});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("d.json: /answers/1/answer"));
  EXPECT_EQ(tally({a, put("again.json", AnswersFor("ours_4711", "a", key))}).exit_code, 3) << "one participant twice";
  const Result skipped = tally({a, d, "--skip-bad"});
  ASSERT_EQ(skipped.exit_code, 0) << skipped.err;
  EXPECT_EQ(skipped.Json()["participants"], nlohmann::json::array({"a"}));
  EXPECT_EQ(skipped.Json()["skipped"].size(), 1u);
  EXPECT_THAT(skipped.err, HasSubstr("d.json"));
  nlohmann::json other = key;
  other["questions"][0]["left"]["source"] = key["questions"][0]["right"]["source"];
  WriteText(folder / "key.json", other.dump());
  EXPECT_EQ(tally({a}).exit_code, 3) << "an edited key";
}

}  // namespace
}  // namespace mocurate
