// A label rule applies to every text that its pattern matches.

#include <gtest/gtest.h>

#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

TEST(LabelRules, ApplyTheFirstMatchAfterListedTexts) {
  SourceOptions source;
  source.labels = {{"walk like a dog", "other"}};
  source.label_rules = {{"\\bdog\\b|cat", "animal"}, {"walk|stroll", "walk"}};
  EXPECT_EQ(*LabelOf(source, "walk like a dog", "01_01"), "other");
  EXPECT_EQ(*LabelOf(source, "Walks the DOG", "01_02"), "animal");
  EXPECT_EQ(*LabelOf(source, "slow Stroll", "01_03"), "walk");
  const auto unmatched = LabelOf(source, "hotdogs", "01_04");
  ASSERT_FALSE(unmatched);
  EXPECT_EQ(unmatched.error().code, ErrorCode::kInconsistent);
}

TEST(LabelRules, RejectInvalidPatternsAndEmptyLabels) {
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
