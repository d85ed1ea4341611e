// A dataset's card, and the differences of two datasets.

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "canon/card/dataset_card.h"
#include "canon/diff/dataset_diff.h"
#include "core/base/sha256.h"
#include "tests/canon/moving_clips.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class TwoSets : public testing::Test {
 protected:
  void SetUp() override {
    dataset_ = SetOf({ClipMoving("p1", "a", 40, 5, 30, 1), ClipMoving("p2", "a", 41, 5, 30, 1),
                      ClipMoving("p3", "b", 42, 5, 30, 1), ClipMoving("p4", "b", 43, 5, 30, 1)});
    dataset_.labels = {"a", "b", "c"};
    Split split;
    split.name = "persons";
    split.train = {0, 1};
    split.test = {2, 3};
    split.rule = "by person";
    split.leak_check = "ok: no person";
    dataset_.splits = {split};
    Finding finding;
    finding.code = "position_jump";
    dataset_.findings = {finding, finding};
    dataset_.clips[1].identity.licence = "CC0 | free";
  }
  fs::path Written(const Dataset& dataset, const char* name) const {
    const Status written = WriteDataset(dataset, folder_ / name);
    EXPECT_TRUE(written) << written.error().Message();
    return folder_ / name;
  }

  const ScratchFolder folder_;
  Dataset dataset_;
};

TEST_F(TwoSets, TheCardCountsClassesPersonsSplitsAndFindings) {
  const fs::path file = Written(dataset_, "a.h5");
  const auto card = DescribeDataset(file);
  ASSERT_TRUE(card) << card.error().Message();
  EXPECT_EQ(card->at("clips"), 4);
  EXPECT_EQ(card->at("frames"), 40 + 41 + 42 + 43);
  EXPECT_EQ(card->at("persons").size(), 4u);
  EXPECT_EQ(card->at("classes").size(), 3u) << "a class without clips is one";
  EXPECT_EQ(card->at("classes")[2], (nlohmann::json{{"name", "c"}, {"clips", 0}, {"seconds", 0.0}}));
  EXPECT_EQ(card->at("splits")[0].at("test"), 2);
  EXPECT_EQ(card->at("findings").at("position_jump"), 2);
  EXPECT_EQ(card->at("sha256"), *Sha256OfFile(file));
  const std::string text = CardMarkdown(*card);
  EXPECT_THAT(text, HasSubstr("| a | 2 | "));
  EXPECT_THAT(text, HasSubstr("CC0 \\| free")) << "a licence does not end its cell";
  const nlohmann::json croissant = CardCroissant(*card);
  EXPECT_EQ(croissant.at("@type"), "sc:Dataset");
  EXPECT_EQ(croissant.at("distribution")[0].at("sha256"), card->at("sha256"));
  EXPECT_EQ(croissant.at("recordSet")[0].at("data").size(), 3u);
  EXPECT_FALSE(DescribeDataset(folder_ / "nowhere.h5"));
}

TEST_F(TwoSets, NamesOnTheCardAreNoMarkup) {
  dataset_.recipe = "# heading <script>alert(1)</script>";
  dataset_.clips[0].identity.person = "[a](http://b) \x1b[2J";
  dataset_.clips[0].label = dataset_.labels[0] = "<img src=x>";
  dataset_.splits[0].name = "> `s`";
  const auto card = DescribeDataset(Written(dataset_, "a.h5"));
  ASSERT_TRUE(card) << card.error().Message();
  const std::string text = CardMarkdown(*card);
  for (std::size_t i = 1; i < text.size(); ++i) {
    const bool markup = text[i] == '<' || text[i] == '[' || text[i] == '`';
    EXPECT_TRUE(!markup || text[i - 1] == '\\') << text.substr(i, 20);
    EXPECT_NE(text[i], '\x1b');
  }
  EXPECT_THAT(text, HasSubstr("\n\\# heading"));
  EXPECT_THAT(text, HasSubstr("| \\> "));
}

TEST_F(TwoSets, EachKindOfDifferenceIsReportedOnceAndEqualSetsDifferInNothing) {
  const fs::path before = Written(dataset_, "a.h5");
  const auto none = DiffDatasets(before, Written(dataset_, "same.h5"));
  ASSERT_TRUE(none) << none.error().Message();
  EXPECT_EQ(none->at("equal"), 4);
  for (const char* kind : {"added", "removed", "relabelled", "refitted", "moved", "splits_added", "splits_removed",
                           "changed", "dataset"}) {
    EXPECT_TRUE(none->at(kind).empty()) << kind;
  }
  Dataset changed = dataset_;
  const std::string gone = changed.clips[3].id(), relabelled = changed.clips[0].id(), refitted = changed.clips[1].id();
  changed.clips[0].label = "c";
  for (double& value : changed.clips[1].motion->joints.xyz) value += 0.003;
  changed.clips[3] = ClipMoving("p5", "b", 50, 5, 30, 1);
  changed.clips[2].rate = changed.clips[2].motion->rate = FrameRate{60, 1};
  changed.splits[0].train = {0, 2};
  changed.splits[0].test = {1, 3};
  const auto diff = DiffDatasets(before, Written(changed, "b.h5"));
  ASSERT_TRUE(diff) << diff.error().Message();
  EXPECT_EQ(diff->at("added"), nlohmann::json({changed.clips[3].id()}));
  EXPECT_EQ(diff->at("removed"), nlohmann::json({gone}));
  ASSERT_EQ(diff->at("relabelled").size(), 1u);
  EXPECT_EQ(diff->at("relabelled")[0], (nlohmann::json{{"clip", relabelled}, {"before", "a"}, {"after", "c"}}));
  ASSERT_EQ(diff->at("refitted").size(), 1u);
  EXPECT_EQ(diff->at("refitted")[0].at("clip"), refitted);
  EXPECT_NEAR(diff->at("refitted")[0].at("joint_mm").get<double>(), 3.0 * std::sqrt(3.0), 1e-3);
  EXPECT_TRUE(diff->at("refitted")[0].at("rotation_deg").is_null()) << "joints alone";
  EXPECT_EQ(diff->at("moved").size(), 2u);
  ASSERT_EQ(diff->at("changed").size(), 1u);
  EXPECT_EQ(diff->at("changed")[0].at("field"), "rate");
  EXPECT_EQ(diff->at("equal"), 0);
  changed.splits[0].name = "other";
  const auto splits = DiffDatasets(before, Written(changed, "c.h5"));
  ASSERT_TRUE(splits);
  EXPECT_EQ(splits->at("splits_added"), nlohmann::json({"other"}));
  EXPECT_TRUE(splits->at("moved").empty());
}

}  // namespace
}  // namespace mocurate
