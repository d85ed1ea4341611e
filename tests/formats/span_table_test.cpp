// Tables of labelled spans: which frames of which recording are a clip.

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "core/base/file.h"
#include "core/formats/span_table.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

TEST(SpanTable, ReadsColumnsInAnyOrder) {
  const auto spans = ParseSpanTable(
      "# marked by hand\nlabel,clip,end_s,begin_s,note\nwalk,set/p1/r1,2.5,0.5,\"calm, slow\"\n\"sit "
      "\"\"down\"\"\",r2,9,8,\r\n",
      "spans.csv");
  ASSERT_TRUE(spans) << spans.error().Message();
  ASSERT_EQ(spans->size(), 2u);
  EXPECT_EQ((*spans)[0].clip, "set/p1/r1");
  EXPECT_EQ((*spans)[0].begin, 0.5);
  EXPECT_EQ((*spans)[0].end, 2.5);
  EXPECT_FALSE((*spans)[0].in_frames);
  EXPECT_EQ((*spans)[0].place, "spans.csv:3");
  EXPECT_EQ((*spans)[1].label, "sit \"down\"");
  const auto frames = ParseSpanTable("clip,begin_frame,end_frame,label,fine_label\nr1,10,20,a,a1\n", "spans.csv");
  ASSERT_TRUE(frames) << frames.error().Message();
  EXPECT_TRUE((*frames)[0].in_frames);
  EXPECT_EQ((*frames)[0].fine_label, "a1");
  EXPECT_EQ(ParseSpanTable("clip,begin_s,end_s,label\n", "spans.csv")->size(), 0u);
}

TEST(SpanTable, ReadsTextsThatASpreadsheetMustNotCompute) {
  const auto spans =
      ParseSpanTable("clip,begin_s,end_s,label\n\"'=a,b\",0,1,'-x\nc,0,1,''=1\nc,0,1,'quoted'\n", "t.csv");
  ASSERT_TRUE(spans) << spans.error().Message();
  EXPECT_EQ(spans->at(0).clip, "=a,b");
  EXPECT_EQ(spans->at(0).label, "-x");
  EXPECT_EQ(spans->at(1).label, "'=1");
  EXPECT_EQ(spans->at(2).label, "'quoted'");
}

TEST(SpanTable, ReadsFramesAndLabelsFromHumanAct12Names) {
  for (const char* text : {"P03G02R04F0012T0075A0803.npy\n", "P03G02R04F0012T0075A0803\n", "0324001200750803\n"}) {
    const auto spans = ParseSpanTable(text, "names");
    ASSERT_TRUE(spans) << spans.error().Message();
    ASSERT_EQ(spans->size(), 1u);
    EXPECT_EQ((*spans)[0].clip, "subject03_group2_time4");
    EXPECT_EQ((*spans)[0].begin, 12.0);
    EXPECT_EQ((*spans)[0].end, 76.0);
    EXPECT_EQ((*spans)[0].label, "eat");
    EXPECT_EQ((*spans)[0].fine_label, "eat_pie_burger");
  }
}

TEST(SpanTable, RejectsInvalidSpansWithTheirLine) {
  const std::string header = "clip,begin_s,end_s,label\n";
  for (const std::string row :
       {"r1,2,1,walk", "r1,1,1,walk", "r1,-1,1,walk", "r1,one,2,walk", "r1,nan,2,walk", ",0,1,walk", "r1,0,1,",
        "r1,0,1", "r1,0,1,walk,more", "r1,0,\"1,walk", "r1,0,1e300,walk"}) {
    const auto spans = ParseSpanTable(header + "r0,0,1,walk\n" + row + "\n", "spans.csv");
    ASSERT_FALSE(spans) << row;
    EXPECT_EQ(spans.error().code, ErrorCode::kMalformed) << row;
    EXPECT_EQ(spans.error().where, "spans.csv:3") << row;
  }
  for (const char* text :
       {"", "name,from,to\n", "clip,begin_s,end_frame,label\n", "P01G01R01F0009T0008A0101\n",
        "P01G01R01F0001T0008A0199\n", "P01G01R01F0001T0008\n", "clip,begin_frame,end_frame,label\nr,0.5,2,a\n"}) {
    EXPECT_FALSE(ParseSpanTable(text, "spans.csv")) << text;
  }
}

/// Table 5 of the paper (a2m_actor.md A.1): the clips per class.
TEST(SpanTable, OfHumanAct12MatchesTheClassCountsOfThePaper) {
  const auto text = ReadFile(std::string(kSourceFolder) + "/configs/spans/humanact12.csv");
  ASSERT_TRUE(text);
  const auto spans = ParseSpanTable(*text, "humanact12");
  ASSERT_TRUE(spans) << spans.error().Message();
  EXPECT_EQ(spans->size(), 1191u);
  std::map<std::string, int> classes, persons, fine;
  for (const ListedSpan& span : *spans) {
    ++classes[span.label];
    ++fine[span.fine_label];
    ++persons[span.clip.substr(0, 9)];
  }
  const std::map<std::string, int> printed = {
      {"warm_up", 215}, {"walk", 47},  {"run", 50},     {"jump", 94},
      {"drink", 88},    {"sit", 54},   {"eat", 77},     {"turn_steering_wheel", 56},
      {"phone", 61},    {"throw", 91}, {"boxing", 140}, {"lift_dumbbell", 218}};
  EXPECT_EQ(classes, printed);
  EXPECT_EQ(fine.size(), 34u);
  EXPECT_EQ(fine["eat_left_hand"], 25);
  EXPECT_EQ(fine["eat_pie_burger"], 19);
  EXPECT_EQ(persons.size(), 12u);
}

TEST(HumanAct12Codes, MatchTheSourceDeclaration) {
  const auto text = ReadFile(std::string(kSourceFolder) + "/configs/sources/humanact12_npy.yaml");
  ASSERT_TRUE(text);
  std::size_t checked = 0;
  const std::string all(*text);
  for (std::size_t at = all.find("\n      \""); at != std::string::npos; at = all.find("\n      \"", at + 1)) {
    const std::string code = all.substr(at + 8, all.find('"', at + 8) - at - 8);
    if (code.size() != 4) continue;
    const std::size_t colon = all.find(": ", at);
    const auto spans = ParseSpanTable("P01G01R01F0001T0002A" + code + "\n", "names");
    ASSERT_TRUE(spans) << code;
    EXPECT_EQ(all.substr(colon + 2, all.find('\n', colon) - colon - 2), (*spans)[0].fine_label);
    ++checked;
  }
  EXPECT_EQ(checked, 34u);
}

}  // namespace
}  // namespace mocurate
