// Classes of a dataset: indices come from the recipe's list, never from sorting.

#include <gtest/gtest.h>

#include <algorithm>

#include "canon/options.h"
#include "canon/recipes/classes.h"
#include "tests/canon/moving_clips.h"

namespace mocurate {
namespace {

Clip Labelled(const std::string& recording, const std::string& label, const std::string& fine_label) {
  Clip clip;
  clip.identity = {"test", "p" + recording.substr(0, 1), recording, "", "", "", 0, 4};
  clip.label = label;
  clip.fine_label = fine_label;
  clip.motion = Motion();
  clip.motion->joints = JointPositions(4, 1);
  return clip;
}

Dataset SetOfClips(std::vector<Clip> clips) {
  Dataset dataset;
  dataset.clips = std::move(clips);
  return dataset;
}

AssembleOptions Recipe() {
  AssembleOptions options;
  options.classes = {{"warm_up", {"stretch"}, {"warm_up_elbows", "warm_up_bow"}, 2.0},
                     {"walk", {}, {}, 1.0},
                     {"boxing", {}, {"boxing_left"}, {}}};
  return options;
}

TEST(Classes, HaveTheRecipesOrderAndAbsentOnesKeepTheirPlace) {
  Dataset dataset = SetOfClips({Labelled("1a", "boxing", "boxing_left"), Labelled("1b", "warm_up", "warm_up_bow")});
  std::vector<Finding> findings;
  ApplyClasses(Recipe(), dataset, findings);
  EXPECT_EQ(dataset.labels, (std::vector<std::string>{"warm_up", "walk", "boxing"}));
  EXPECT_EQ(dataset.LabelIndex(dataset.clips[0].label), 2);
  EXPECT_TRUE(findings.empty());
  ASSERT_EQ(dataset.fine_labels.size(), 3u);
  EXPECT_EQ(dataset.FineLabelIndex("warm_up_bow"), 1);
  EXPECT_EQ(dataset.fine_labels[2].parent, 2);
}

TEST(Classes, WithoutAClipAreReportedTogether) {
  const Dataset dataset = SetOfClips({Labelled("1a", "walk", "")});
  std::vector<Finding> findings, none;
  FindEmptyClasses(Recipe(), dataset, findings);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "class_without_clips");
  EXPECT_EQ(findings[0].value, 2.0);
  FindEmptyClasses(AssembleOptions(), dataset, none);
  EXPECT_TRUE(none.empty());
}

TEST(Classes, TakeTheLabelsTheyListAndExcludeOthersWithAFinding) {
  Dataset dataset =
      SetOfClips({Labelled("1a", "stretch", ""), Labelled("1b", "sleep", ""), Labelled("2a", "walk", "")});
  std::vector<Finding> findings;
  ApplyClasses(Recipe(), dataset, findings);
  ASSERT_EQ(dataset.clips.size(), 2u);
  EXPECT_EQ(dataset.clips[0].label, "warm_up");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, kLabelNotListed);
  EXPECT_EQ(findings[0].clip, "test/p1/1b#0-4");
}

TEST(Classes, OfASetWithoutAListFollowTheSourcesOrder) {
  AssembleOptions options;
  options.label_order = {"walk", "sit", "boxing"};
  Dataset dataset = SetOfClips({Labelled("1a", "boxing", ""), Labelled("1b", "walk", ""), Labelled("1c", "bend", "")});
  std::vector<Finding> findings;
  ApplyClasses(options, dataset, findings);
  EXPECT_EQ(dataset.labels, (std::vector<std::string>{"walk", "boxing", "bend"}));
}

TEST(Classes, OtherCountsThanExpectedAreFindings) {
  AssembleOptions options = Recipe();
  options.expected.clips = 3.0;
  options.expected.persons = 1.0;
  Dataset dataset = SetOfClips({Labelled("1a", "warm_up", ""), Labelled("1b", "warm_up", "")});
  std::vector<Finding> findings;
  ApplyClasses(options, dataset, findings);
  std::vector<Finding> differing;
  CompareWithExpected(options, dataset, differing);
  ASSERT_EQ(differing.size(), 2u);  // clips in all, and none of `walk`
  EXPECT_EQ(differing[0].value, 2.0);
  EXPECT_EQ(differing[1].value, 0.0);
}

TEST(Classes, AreRefusedWhereALabelIsOfTwo) {
  AssembleOptions options = Recipe();
  options.classes[1].from = {"stretch"};
  const Status checked = CheckClasses(options);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::kConfig);
  options.classes[1].from = {"walk"};
  EXPECT_TRUE(CheckClasses(options));
}

}  // namespace
}  // namespace mocurate
