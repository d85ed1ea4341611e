// A rule gives a label to every text that its pattern is found in.

#include <gtest/gtest.h>

#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

TEST(LabelRules, TakeTheFirstThatFitsAfterTheListedTexts) {
  SourceOptions source;
  source.labels = {{"walk like a dog", "other"}};
  source.label_rules = {{"\\bdog\\b|cat", "animal"}, {"walk|stroll", "walk"}};
  EXPECT_EQ(*LabelOf(source, "walk like a dog", "01_01"), "other");
  EXPECT_EQ(*LabelOf(source, "Walks the DOG", "01_02"), "animal");
  EXPECT_EQ(*LabelOf(source, "slow Stroll", "01_03"), "walk");
  const auto none = LabelOf(source, "hotdogs", "01_04");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kInconsistent);
}

TEST(LabelRules, ThatAreNoPatternsOrHaveNoLabelAreRefused) {
  SourceOptions source;
  source.label_rules = {{"(", "a"}};
  EXPECT_EQ(CheckLabelRules(source).error().code, ErrorCode::kConfig);
  source.label_rules = {{"a", ""}};
  EXPECT_EQ(CheckLabelRules(source).error().code, ErrorCode::kConfig);
  source.label_rules = {{"a", "b"}};
  EXPECT_TRUE(CheckLabelRules(source));
}

}  // namespace
}  // namespace mocurate
