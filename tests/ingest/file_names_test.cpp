#include "ingest/sense/file_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

TEST(GuessedFileNames, LettersBeforeNumbersSayWhatTheyAre) {
  const std::vector<std::string> names = {"a01_s01_e01_realworld.txt", "a02_s01_e02_realworld.txt",
                                          "a01_s03_e01_realworld.txt"};
  const GuessedNames guessed = GuessNames(names);
  EXPECT_EQ(guessed.pattern, "a{action}_s{person}_e{repetition}_realworld.txt");
  EXPECT_THAT(guessed.fields, ElementsAre("action", "person", "repetition"));
  const auto pattern = NamePattern::Parse(guessed.pattern, "test");
  for (const std::string& name : names) EXPECT_TRUE(pattern->Match(name)) << name;
}

TEST(GuessedFileNames, WordsThatComeAgainAreActionAndStyleAndWhatIsTheSameStays) {
  EXPECT_EQ(GuessNames({"dataset-2_walk_normal_001.bvh", "dataset-2_run_active_001.bvh",
                        "dataset-2_walk_active_002.bvh", "dataset-2_run_normal_002.bvh"})
                .pattern,
            "dataset-2_{action}_{style}_{repetition}.bvh");
  EXPECT_EQ(GuessNames({"walk_s1.txt", "walk_s2.txt", "sit_s2.txt"}).pattern, "{action}_s{person}.txt");
}

TEST(GuessedFileNames, EachItsOwnNameIsAClip) {
  EXPECT_EQ(GuessNames({"0512164529.txt", "0512165327.txt"}).pattern, "{repetition}.txt");
  EXPECT_EQ(GuessNames({"walk.bvh", "jump.bvh"}).pattern, "{clip}.bvh");
  EXPECT_EQ(GuessNames({"one.bvh"}).pattern, "{clip}.bvh");
}

TEST(GuessedFileNames, NamesWithoutACommonFormAreTakenWhole) {
  const GuessedNames guessed = GuessNames({"day/walk_01.bvh", "day/jump.bvh"});
  EXPECT_EQ(guessed.pattern, "{folder1}/{clip}.bvh");
  EXPECT_FALSE(guessed.common);
}

TEST(GuessedFileNames, ASkeletonFileIsNamedByTheBeginningOfItsMotions) {
  const std::vector<std::string> names = {"01/HDM_bd_jog_001_120.amc", "02/HDM_mm_jog_002_120.amc",
                                          "02/HDM_bd_kick_001_120.amc"};
  const GuessedNames guessed = GuessNames(names);
  EXPECT_EQ(GuessBelonging(guessed, names, {"HDM_bd.asf", "", "HDM_bd.asf"}), "HDM_{action}.asf");
  EXPECT_EQ(GuessBelonging(guessed, names, {"HDM_bd.asf", "HDM_xx.asf", ""}), std::nullopt);
  EXPECT_EQ(GuessBelonging(guessed, names, {"", "", ""}), std::nullopt);
}

}  // namespace
}  // namespace mocurate
