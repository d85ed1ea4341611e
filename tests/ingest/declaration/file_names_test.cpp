#include "ingest/inspect/file_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

TEST(EstimatedFileNames, NumberThePartsThatDiffer) {
  const std::vector<std::string> names = {"a01_s01_e01_realworld.txt", "a02_s01_e02_realworld.txt",
                                          "a01_s03_e01_realworld.txt"};
  const NamePatternEstimate estimate = EstimateNamePattern(names);
  EXPECT_EQ(estimate.pattern, "a{part1}_s{part2}_e{part3}_realworld.txt");
  EXPECT_THAT(estimate.fields, ElementsAre("part1", "part2", "part3"));
  const auto pattern = NamePattern::Parse(estimate.pattern, "test");
  for (const std::string& name : names) EXPECT_TRUE(pattern->Match(name)) << name;
  EXPECT_EQ(EstimateNamePattern({"dataset-2_walk_normal_001.bvh", "dataset-2_run_active_001.bvh",
                                 "dataset-2_walk_active_002.bvh", "dataset-2_run_normal_002.bvh"})
                .pattern,
            "dataset-2_{part1}_{part2}_{part3}.bvh");
  EXPECT_EQ(EstimateNamePattern({"walk_s1.txt", "walk_s2.txt", "sit_s2.txt"}).pattern, "{part1}_s{part2}.txt");
  EXPECT_EQ(EstimateNamePattern({"0512164529.txt", "0512165327.txt"}).pattern, "{part1}.txt");
  EXPECT_EQ(EstimateNamePattern({"walk.bvh", "jump.bvh"}).pattern, "{part1}.bvh");
}

TEST(EstimatedFileNames, TakeWholeNamesWithoutACommonForm) {
  EXPECT_EQ(EstimateNamePattern({"one.bvh"}).pattern, "{part1}.bvh");
  const NamePatternEstimate estimate = EstimateNamePattern({"day/walk_01.bvh", "day/jump.bvh"});
  EXPECT_EQ(estimate.pattern, "{part1}/{part2}.bvh");
  EXPECT_FALSE(estimate.common);
}

TEST(EstimatedFileNames, FitTheirPatternInOneWay) {
  for (const std::vector<std::string>& names : {std::vector<std::string>{"walk_s01_e01.bvh", "sit_s02_e02.bvh"},
                                                {"climb_stairs_s01_e01.bvh", "walk_s01_e01.bvh", "walk_s02_e01.bvh"},
                                                {"a/push-up_p1.npy", "b/walk_p2.npy", "a/walk_p1.npy"}}) {
    const auto pattern = NamePattern::Parse(EstimateNamePattern(names).pattern, "test");
    for (const std::string& name : names) {
      const auto fields = pattern->Match(name);
      ASSERT_TRUE(fields) << name;
      EXPECT_FALSE(pattern->OtherMatch(name, [&](const NameFields& other) { return other != *fields; })) << name;
    }
  }
}

TEST(EstimatedFileNames, FindTheSkeletonFileByThePrefixOfItsMotions) {
  const std::vector<std::string> names = {"01/HDM_bd_jog_001_120.amc", "02/HDM_mm_jog_002_120.amc",
                                          "02/HDM_bd_kick_001_120.amc"};
  const NamePatternEstimate guessed = EstimateNamePattern(names);
  EXPECT_EQ(EstimateCompanionPattern(guessed, names, {"HDM_bd.asf", "", "HDM_bd.asf"}), "HDM_{part2}.asf");
  EXPECT_EQ(EstimateCompanionPattern(guessed, names, {"HDM_bd.asf", "HDM_xx.asf", ""}), std::nullopt);
  EXPECT_EQ(EstimateCompanionPattern(guessed, names, {"", "", ""}), std::nullopt);
}

}  // namespace
}  // namespace mocurate
