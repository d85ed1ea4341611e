// `mocurate audit` of a dataset whose splits leak: findings, exit codes and the page.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/app/program.h"
#include "tests/store/builders.h"

namespace mocurate {
namespace {

using program::ReadText;
using program::Result;
using program::RunProgram;
using ::testing::HasSubstr;

/// p1/a trains; p1/b, and p2/a of the same source file but another motion, test.
Dataset LeakingSet() {
  Dataset dataset = test::MakeDataset();
  Clip& copy = dataset.clips[2];
  copy.identity.end_frame = dataset.clips[0].identity.end_frame;
  copy.motion = test::Wander(test::OtherWalker(), copy.rate, dataset.clips[0].motion->frame_count(), copy.id());
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    dataset.clips[i].evidence_sha256 = std::string(64, i == 1 ? 'b' : 'a');
    dataset.clips[i].provenance["file"] = "file" + std::to_string(i) + ".txt";
  }
  dataset.findings.clear();
  dataset.splits = {{"s", {0}, {}, {1, 2}, "by person; test: p2", "leaks: 1 clip of equal content in two parts"}};
  return dataset;
}

class Audit : public ::testing::Test {
 protected:
  Result Run(const Dataset& dataset, std::vector<std::string> more) const {
    const Status written = WriteDataset(dataset, folder_ / "set.h5");
    EXPECT_TRUE(written) << written.error().Message();
    more.insert(more.begin(), {"audit", (folder_ / "set.h5").string(), "--force", "-o", (folder_ / "out").string()});
    return RunProgram(folder_, more);
  }

  static std::vector<nlohmann::json> WithCode(const nlohmann::json& audit, const std::string& code) {
    std::vector<nlohmann::json> found;
    for (const nlohmann::json& finding : audit.at("findings")) {
      if (finding.at("code") == code) found.push_back(finding);
    }
    return found;
  }

  ScratchFolder folder_;
};

TEST_F(Audit, EveryLeakIsAFindingWithBothClipsAndTheirParts) {
  const Dataset dataset = LeakingSet();
  const Result result = Run(dataset, {"--json", "--fail-on", "error"});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  const nlohmann::json audit = result.Json();
  const nlohmann::json parts = nlohmann::json::array({{{"split", "s"}, {"part", "train"}, {"other", "test"}}});
  const std::pair<const char*, std::size_t> others[] = {{"leak", 2}, {"split_leak", 1}};
  for (const auto& [code, other] : others) {
    const auto found = WithCode(audit, code);
    ASSERT_EQ(found.size(), 1u) << code;
    EXPECT_EQ(found[0]["severity"], "error");
    EXPECT_EQ(found[0]["clip"], dataset.clips[0].id());
    EXPECT_EQ(found[0]["suggested"], dataset.clips[other].id());
    EXPECT_EQ(found[0]["parts"], parts);
  }
  EXPECT_EQ(audit["summary"]["splits"][0]["leaks"], 2);
  EXPECT_EQ(audit["findings"][0]["severity"], "error");
  const std::string page = ReadText(folder_ / "out/audit.html");
  for (const char* code : {"leak", "split_leak"}) {
    EXPECT_THAT(page, HasSubstr("\"code\":\"" + std::string(code) + "\""));
  }
  EXPECT_THAT(page, HasSubstr("\"id\":\"" + dataset.clips[2].id() + "\""));
  const Result text = Run(dataset, {});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  for (const Clip& clip : dataset.clips) EXPECT_THAT(text.out, HasSubstr(clip.id()));
}

TEST_F(Audit, PeopleOfOneFileAndASplitWithoutLeakAreNoErrors) {
  Dataset dataset = LeakingSet();
  dataset.clips[2].provenance["file"] = dataset.clips[0].provenance["file"];
  dataset.splits[0].train = {0, 1};
  dataset.splits[0].test = {2};
  const Result stated = Run(dataset, {"--json", "--fail-on", "error"});
  EXPECT_EQ(stated.exit_code, 0) << stated.err;
  const auto found = WithCode(stated.Json(), "split_leak");
  ASSERT_EQ(found.size(), 1u) << "the file's own check";
  EXPECT_EQ(found[0]["severity"], "warning");
  EXPECT_EQ(found[0]["parts"], nlohmann::json::array());
  dataset.splits[0].leak_check = "ok";
  EXPECT_TRUE(WithCode(Run(dataset, {"--json"}).Json(), "split_leak").empty());
}

TEST_F(Audit, APersonInTwoPartsOfASplitByAnotherRuleIsNoError) {
  Dataset dataset = LeakingSet();
  dataset.clips[2].evidence_sha256 = std::string(64, 'c');
  dataset.splits[0].leak_check = "ok";
  for (const char* rule : {"by performance", "drawn by a friend"}) {
    dataset.splits[0].rule = rule;
    const Result result = Run(dataset, {"--json", "--fail-on", "error"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(WithCode(result.Json(), "split_leak").size(), rule == std::string("by performance") ? 0u : 1u);
  }
}

TEST_F(Audit, LinksInTheFolderOfTheOutputAreNotFollowed) {
  program::WriteText(folder_ / "victim", "old");
  std::filesystem::create_directories(folder_ / "out");
  for (const char* name : {"audit.json", "audit.html", "clips.csv"}) {
    for (const char* target : {"victim", "none"}) {
      std::filesystem::create_symlink(folder_ / target, folder_ / "out" / name);
      EXPECT_EQ(Run(LeakingSet(), {}).exit_code, 74) << name;
      std::filesystem::remove(folder_ / "out" / name);
    }
  }
  EXPECT_EQ(ReadText(folder_ / "victim"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
}

}  // namespace
}  // namespace mocurate
