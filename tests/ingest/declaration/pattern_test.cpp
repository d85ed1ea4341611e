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
  const auto other = [](const std::string& text, const std::string& name) {
    const auto pattern = NamePattern::Parse(text, "files");
    const auto first = pattern->Match(name);
    return pattern->OtherMatch(name, [&](const NameFields& fields) { return first && fields != *first; });
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

/// A source of BVH files in a folder, read by their names alone.
IngestOptions Named(const std::filesystem::path& folder, const std::vector<std::string>& names,
                    const std::string& files) {
  IngestOptions options = Declared("bandai2");
  options.path = folder;
  options.source.files = files;
  options.source.person = "{person}";
  options.source.label = "{action}";
  options.source.labels.clear();
  options.source.label_table.clear();
  options.source.style.clear();
  options.source.recording = "{file}";
  for (const std::string& name : names) Put(folder / name, "HIERARCHY\n");
  return options;
}

/// Codes of what became of excluded files, by name.
std::map<std::string, std::string> ExcludedFrom(const IngestOptions& options) {
  std::map<std::string, std::string> codes;
  const auto found = Discover(options);
  if (!found) return {{"error", found.error().Message()}};
  for (const ItemResult& file : found->excluded) {
    EXPECT_EQ(file.outcome.kind, OutcomeKind::kRefused) << file.item;
    codes[file.item] = file.outcome.findings.front().code;
  }
  return codes;
}

TEST(FileNames, ThatFitTheirPatternInTwoWaysAreRefusedWithBoth) {
  const std::filesystem::path folder = FreshFolder("ambiguous");
  IngestOptions options = Named(folder, {"climb_stairs_s01_e01.bvh", "walk_s01_e01.bvh", "walk_s02_e01.bvh"},
                                "{action}_s{person}_e{rep}.bvh");
  EXPECT_THAT(ExcludedFrom(options), ElementsAre(Pair("climb_stairs_s01_e01.bvh", "name_ambiguous")));
  const auto found = Discover(options);
  EXPECT_EQ(found->items.size(), 2u);
  EXPECT_THAT(found->persons, ElementsAre("01", "02"));
  for (const char* part : {"climb'", "tairs_s01'", "climb_stairs'", "'01'"}) {
    EXPECT_THAT(found->excluded[0].outcome.error.what, ::testing::HasSubstr(part));
  }
  options.source.labels = {{"climb_stairs", "climb"}, {"walk", "walk"}};
  EXPECT_THAT(ExcludedFrom(options), ElementsAre(Pair("climb_stairs_s01_e01.bvh", "name_ambiguous"))) << "not a label";
  options.source.files = "{action}_s{person:2}_e{rep}.bvh";
  EXPECT_THAT(ExcludedFrom(options), ElementsAre()) << "the width that the error proposes";
}

TEST(FileNames, OfTwoWaysThatMakeTheSameClipOrOfWhichOneIsMeantAreRead) {
  const std::filesystem::path folder = FreshFolder("ambiguous");
  IngestOptions options = Named(folder, {"female_walk_noisy_a_b.bvh"}, "{person}_{action}_{a}_{b}.bvh");
  EXPECT_THAT(ExcludedFrom(options), ElementsAre(Pair("error", ::testing::HasSubstr("two ways"))));
  options.source.labels = {{"walk", "walk"}};
  EXPECT_THAT(ExcludedFrom(options), ElementsAre()) << "only `walk` is a label; {a} and {b} name nothing";
  options.source.labels.clear();
  options.source.label.clear();
  options.source.person = "p";
  EXPECT_THAT(ExcludedFrom(options), ElementsAre());
}

TEST(FileNames, OfAClipOfManyFilesAreRefusedTogether) {
  const std::filesystem::path folder = FreshFolder("ambiguous");
  IngestOptions options = Declared("pose2sim_single");
  options.path = folder;
  options.source.files = "{recording}_{camera}_{frame}.json";
  options.source.recording = "{recording}";
  for (const char* name :
       {"run_cam1_0001.json", "run_cam1_0002.json", "walk_cam1_0001.json", "walk_fast_cam1_0002.json"}) {
    Put(folder / name, R"({"version": 1.3, "people": []})");
  }
  Put(folder / "Calib.qca.txt", "");
  const auto found = Discover(options);
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_EQ(found->items.size(), 1u);
  ASSERT_EQ(found->excluded.size(), 1u);
  EXPECT_EQ(found->excluded[0].outcome.findings.front().code, "name_ambiguous");
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
