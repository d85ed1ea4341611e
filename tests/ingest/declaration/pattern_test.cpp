#include "ingest/sources/pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

NameFields Match(const std::string& pattern, const std::string& name) {
  const auto parsed = NamePattern::Parse(pattern, "files");
  if (!parsed) return {{"no", "pattern"}};
  return parsed->Match(name).value_or(NameFields{{"no", "match"}});
}

TEST(NamePattern, MatchesFieldsBetweenLiterals) {
  EXPECT_THAT(Match("a{action}_s{person}_e{repetition}_realworld.txt", "a01_s07_e03_realworld.txt"),
              ElementsAre(Pair("action", "01"), Pair("person", "07"), Pair("repetition", "03")));
  EXPECT_THAT(Match("dataset-2_{action}_{style}_{n}.bvh", "dataset-2_walk-turn-left_active_001.bvh"),
              ElementsAre(Pair("action", "walk-turn-left"), Pair("n", "001"), Pair("style", "active")));
  EXPECT_THAT(Match("P{person:2}G{group:2}A{action:4}.npy", "P01G02A0304.npy"),
              ElementsAre(Pair("action", "0304"), Pair("group", "02"), Pair("person", "01")));
  EXPECT_THAT(Match("{a:2}{b}.x", "12345.x"), ElementsAre(Pair("a", "12"), Pair("b", "345")));
}

TEST(NamePattern, FindsASecondMatchOfAnAmbiguousName) {
  const auto other = [](const std::string& pattern, const std::string& name) {
    return NamePattern::Parse(pattern, "files")->OtherMatch(name);
  };
  const auto cut = other("{person}_{pose}.bvh", "old_female_punch.bvh");
  ASSERT_TRUE(cut);
  EXPECT_THAT(*cut, ElementsAre(Pair("person", "old_female"), Pair("pose", "punch")));
  EXPECT_FALSE(other("{person}_{pose}.bvh", "old_punch.bvh"));
  EXPECT_FALSE(other("{person:3}_{pose}.bvh", "old_female_punch.bvh"));
  EXPECT_FALSE(other("{take?/}seq_{person}.json", "a/seq_b.json"));
  EXPECT_FALSE(other("a{n}.txt", "b.txt")) << "no match";
}

TEST(NamePattern, RejectsNamesThatDoNotMatch) {
  const NameFields no_match{{"no", "match"}};
  EXPECT_EQ(Match("a{n}.txt", "a1.txt.bak"), no_match);
  EXPECT_EQ(Match("a{n}.txt", "a.txt"), no_match);
  EXPECT_EQ(Match("a{n:2}.txt", "a1.txt"), no_match);
  EXPECT_EQ(Match("a{n}.txt", "a1/2.txt"), no_match);
  EXPECT_EQ(Match("{s}/a_{s}.txt", "x/a_y.txt"), no_match);
  EXPECT_THAT(Match("{s}/a_{s}.txt", "x/a_x.txt"), ElementsAre(Pair("s", "x")));
}

TEST(NamePattern, ReportsANameWithAnAmbiguousPerson) {
  const std::filesystem::path folder = FreshFolder("ambiguous");
  IngestOptions options = Declared("bandai2");
  options.path = folder;
  options.source.files = "{person}_{pose}.bvh";
  options.source.person = "{person}";
  options.source.label.clear();
  options.source.labels.clear();
  options.source.label_table.clear();
  options.source.style.clear();
  options.source.recording = "{file}";
  for (const bool ambiguous : {false, true}) {
    Put(folder / (ambiguous ? "old_female_punch.bvh" : "old_punch.bvh"), "HIERARCHY\n");
    const auto found = Discover(options);
    ASSERT_TRUE(found) << found.error().Message();
    ASSERT_EQ(found->findings.size(), ambiguous ? 1u : 0u);
    if (!ambiguous) continue;
    EXPECT_EQ(found->findings[0].code, "name_ambiguous");
    EXPECT_EQ(found->findings[0].value, 1.0);
  }
}

TEST(NamePattern, AcceptsAnOptionalFolder) {
  EXPECT_THAT(Match("{take?/}seq_{person}.json", "t1/seq_a.json"),
              ElementsAre(Pair("person", "a"), Pair("take", "t1")));
  EXPECT_THAT(Match("{take?/}seq_{person}.json", "seq_a.json"), ElementsAre(Pair("person", "a")));
  EXPECT_EQ(Match("{take?/}seq_{person}.json", "s/t/seq_a.json"), (NameFields{{"no", "match"}}));
  EXPECT_EQ(Match("{take?/}seq_{person}.json", "t1seq_a.json"), (NameFields{{"no", "match"}}));
  EXPECT_THAT(Match("{take?/}{camera}.png", "t1/c.png"), ElementsAre(Pair("camera", "c"), Pair("take", "t1")));
  const auto pattern = NamePattern::Parse("x/{take?/}{camera}.png", "files");
  ASSERT_TRUE(pattern);
  EXPECT_EQ(pattern->depth(), 2);
  EXPECT_EQ(pattern->least_depth(), 1);
  EXPECT_EQ(FillFields("{take?/}a.yml", {{"take", "t1"}}), "t1/a.yml");
  EXPECT_EQ(FillFields("{take?/}a.yml", {}), "a.yml");
}

TEST(NamePattern, RejectsAnInvalidPattern) {
  for (const char* pattern : {"a{n.txt", "a}n.txt", "a{}.txt", "{a}{b}", "{a:0}"})
    ExpectError(NamePattern::Parse(pattern, "files"), ErrorCode::kConfig, "files");
}

TEST(NamePattern, MatchesALongNameInBoundedTime) {
  EXPECT_EQ(Match("{a}x{b}x{c}x{d}x{e}x{f}!", std::string(4000, 'x')), (NameFields{{"no", "match"}}));
}

TEST(NamePattern, FillsInFields) { EXPECT_EQ(FillFields("s{person}-{no}{open", {{"person", "07"}}), "s07-{open"); }

}  // namespace
}  // namespace mocurate
