#include "core/formats/joint_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "core/base/text.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

JointTableLayout TableRows(int rows_per_frame, int columns = 0) {
  JointTableLayout layout;
  layout.rows_per_frame = rows_per_frame;
  layout.columns = columns;
  return layout;
}

TEST(JointTable, AcceptsBlanksCommasTabsAndLineEndsAsSeparators) {
  for (const char* text :
       {"1 2 3\n4 5 6\n", "1,2,3\r\n4,5,6", "1\t2 3 \r\n\r\n4, 5, 6,\n", "\xEF\xBB\xBF+1 2 3\r4 5 6e0"}) {
    const auto table = ParseJointTable(text, TableRows(2, 3), "a.txt");
    ASSERT_TRUE(table) << table.error().Message();
    EXPECT_EQ(table->frames, 1);
    EXPECT_THAT(table->values, ElementsAre(1, 2, 3, 4, 5, 6));
  }
}

TEST(JointTable, RejectsBadInputWithItsLine) {
  for (const auto& [text, layout, where] : {std::tuple{"", TableRows(2), "a.txt"},
                                            {"\n \n", TableRows(2), "a.txt"},
                                            {"1 2\n3 4\n5 6\n", TableRows(2), "a.txt:4"},
                                            {"1 2\n3\n", TableRows(2), "a.txt:2"},
                                            {"1 2\n3 4 5\n", TableRows(1, 3), "a.txt:1"},
                                            {"1 2\nx 4\n", TableRows(1), "a.txt:2"},
                                            {"1 2\n3 4z\n", TableRows(1), "a.txt:2"},
                                            {"1 2\n3,5 -4,25\n", TableRows(1), "a.txt:2"},
                                            {"1 2\n3,5;4,25\n", TableRows(1), "a.txt:2"},
                                            {"1 2\n3,5,6,7\n", TableRows(1), "a.txt:2"},
                                            {"1 nan\n", TableRows(1), "a.txt:1"},
                                            {"1 1e999\n", TableRows(1), "a.txt:1"}}) {
    ExpectMalformed(ParseJointTable(text, layout, "a.txt"), where);
  }
}

TEST(JointTable, ReadsNanAsMissingWhenDeclared) {
  JointTableLayout layout = TableRows(1);
  layout.allow_nan = true;
  const auto table = ParseJointTable("1 nan -nan\n", layout, "a.txt");
  ASSERT_TRUE(table);
  EXPECT_TRUE(std::isnan(table->at(0, 0, 1)));
}

TEST(JointTable, MarksOnlyAnImplausibleNumberMissing) {
  ExpectMalformed(ParseJointTable("1 2\n3 -1e300\n", TableRows(1), "a.txt"), "a.txt:2");
  JointTableLayout layout = TableRows(1, 2);
  layout.damaged_rows = DamagedRows::kReport;
  const auto table = ParseJointTable("1 2\n1e300 4\n5 6\n", layout, "a.txt");
  ASSERT_TRUE(table) << table.error().Message();
  EXPECT_EQ(table->at(0, 0, 1), 2.0);
  EXPECT_TRUE(std::isnan(table->at(1, 0, 0)));
  EXPECT_EQ(table->at(1, 0, 1), 4.0);
  EXPECT_EQ(table->at(2, 0, 0), 5.0);
  ASSERT_EQ(table->findings.size(), 1u);
  EXPECT_EQ(table->findings[0].code, "number_too_large");
  EXPECT_EQ(table->findings[0].frame_begin, 1);
}

TEST(JointTable, MarksNonFiniteNumbersMissingInOneFinding) {
  JointTableLayout layout = TableRows(1, 3);
  layout.damaged_rows = DamagedRows::kReport;
  const auto table = ParseJointTable("1 2 3\nnan 5 -inf\n7 8 9\n1 nan 3\n1 2\n4 5 6\n", layout, "a.txt");
  ASSERT_TRUE(table) << table.error().Message();
  EXPECT_EQ(table->frames, 6);
  EXPECT_TRUE(std::isnan(table->at(1, 0, 0)) && std::isnan(table->at(1, 0, 2)));
  EXPECT_EQ(table->at(1, 0, 1), 5.0) << "the value beside it is valid";
  EXPECT_TRUE(std::isnan(table->at(4, 0, 0))) << "columns of a row of wrong length are unknown";
  ASSERT_EQ(table->findings.size(), 2u);
  EXPECT_EQ(table->findings[0].code, "row_length");
  EXPECT_EQ(table->findings[1].code, "not_a_number");
  EXPECT_EQ(table->findings[1].value, 3.0);
  EXPECT_EQ(table->findings[1].frame_begin, 1);
  EXPECT_EQ(table->findings[1].frame_end, 4);
}

TEST(JointTable, RejectsInfinityAsAMissingValue) {
  JointTableLayout layout = TableRows(1);
  layout.allow_nan = true;
  ExpectMalformed(ParseJointTable("1 2\nnan inf\n", layout, "a.txt"), "a.txt:2");
  ExpectMalformed(ParseJointTable("1 2\nnan 1e999\n", layout, "a.txt"), "a.txt:2");
}

TEST(JointTable, ReadsNumbersBelowDoubleRangeAsZero) {
  const auto table = ParseJointTable("1.6e-380 -1e-0400 4e-310\n", TableRows(1), "a.txt");
  ASSERT_TRUE(table) << table.error().Message();
  EXPECT_EQ(table->at(0, 0, 0), 0.0);
  EXPECT_GT(table->at(0, 0, 2), 0.0);
}

TEST(JointTable, RoundTripsThroughTheWriter) {
  JointTable table;
  table.frames = 2, table.rows_per_frame = 1, table.columns = 3;
  table.values = {0.1, -1e-7, 1.0 / 3.0, 2687.6377, 0, 1e30};
  const auto again = ParseJointTable(WriteJointTable(table), TableRows(1, 3), "a.txt");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->values, table.values);
}

TEST(JointTable, SkipsAHeaderWithoutShiftingRows) {
  JointTableLayout layout = TableRows(2, 3);
  layout.damaged_rows = DamagedRows::kReport;
  const auto table = ParseJointTable("x y z\n1 2 3\n4 5 6\n", layout, "a.txt");
  ASSERT_TRUE(table) << table.error().Message();
  EXPECT_EQ(table->frames, 1);
  EXPECT_EQ(table->at(0, 1, 2), 6.0);
  ASSERT_EQ(table->findings.size(), 1u);
  EXPECT_EQ(table->findings[0].code, "not_a_number");
  EXPECT_EQ(table->findings[0].value, 3.0) << "words";
}

TEST(JointTable, RejectsOtherSeparatorsAndEncodings) {
  JointTableLayout layout = TableRows(1, 3);
  layout.damaged_rows = DamagedRows::kReport;
  for (const std::string& text :
       {std::string("1.5;2;3\n4;5;6\n"), std::string("1|2|3\n"), std::string("\xFF\xFE\x31\0", 4)}) {
    ExpectMalformed(ParseJointTable(text, layout, "a.txt"), "a.txt:1");
  }
  ExpectMalformed(ParseJointTable("<html>404</html>\n", layout, "a.txt"), "a.txt");
}

}  // namespace
}  // namespace mocurate
