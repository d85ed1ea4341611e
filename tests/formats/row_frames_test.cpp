#include "core/formats/row_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/base/text.h"
#include "core/formats/joint_layout.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kJoints = 12;

/// Lines of a body whose joints stand apart and move a little from frame to frame; the frame's number stands behind.
std::vector<std::string> Lines(int frames) {
  std::vector<std::string> lines;
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < kJoints; ++j) {
      const double x = 300.0 * std::cos(2.4 * j) + 10.0 * f, y = 150.0 * j, z = 300.0 * std::sin(2.4 * j);
      lines.push_back(FormatDouble(x) + " " + FormatDouble(y) + " " + FormatDouble(z) + " " + std::to_string(f));
    }
  }
  return lines;
}

std::string TextOfLines(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

Expected<JointRows> ReadRows(const std::vector<std::string>& lines, OddFrame odd = OddFrame::kLast,
                             DamagedRows damaged = DamagedRows::kReport) {
  JointTableLayout table;
  table.rows_per_frame = kJoints;
  table.damaged_rows = damaged;
  return ParseJointRows(TextOfLines(lines), ParseJointLayout("12*(x y z confidence)", "").value(), table, "t.txt", odd);
}

/// Frames that are missing; every other must hold its own number.
std::vector<int> Missing(const JointRows& rows) {
  std::vector<int> missing;
  for (int f = 0; f < rows.frames; ++f) {
    for (int j = 0; j < kJoints; ++j) {
      const double number = rows.confidence[static_cast<std::size_t>(f * kJoints + j)];
      if (std::isnan(number)) {
        if (j == 0) missing.push_back(f);
        continue;
      }
      EXPECT_EQ(number, f) << "joint " << j;
    }
  }
  return missing;
}

TEST(RowFrames, ARowThatIsMissingCostsItsFrameAndShiftsNothing) {
  for (const int row : {12, 40, 59, 60, 71, 100}) {
    SCOPED_TRACE(row);
    std::vector<std::string> lines = Lines(10);
    lines.erase(lines.begin() + row);
    const Expected<JointRows> rows = ReadRows(lines);
    ASSERT_TRUE(rows) << rows.error().Message();
    EXPECT_EQ(rows->frames, 10);
    EXPECT_THAT(Missing(*rows), ElementsAre(row / kJoints));
    ASSERT_EQ(rows->findings.size(), 1U);
    EXPECT_EQ(rows->findings[0].code, "frame_rows");
    EXPECT_EQ(rows->findings[0].value, kJoints - 1);
    EXPECT_EQ(rows->findings[0].frame_begin, row / kJoints);
  }
}

TEST(RowFrames, ARowTooManyCostsItsFrameAndShiftsNothing) {
  std::vector<std::string> lines = Lines(10);
  lines.insert(lines.begin() + 40, lines[39]);
  const Expected<JointRows> rows = ReadRows(lines);
  ASSERT_TRUE(rows) << rows.error().Message();
  EXPECT_THAT(Missing(*rows), ElementsAre(3));
  ASSERT_EQ(rows->findings.size(), 1U);
  EXPECT_EQ(rows->findings[0].value, kJoints + 1);
  EXPECT_EQ(rows->findings[0].frame_begin, 3);
}

TEST(RowFrames, ARowTooManyInTheFirstFrameCostsBothFramesThatItMayStandIn) {
  std::vector<std::string> lines = Lines(10);
  lines.insert(lines.begin() + 10, lines[9]);
  const Expected<JointRows> rows = ReadRows(lines);
  ASSERT_TRUE(rows) << rows.error().Message();
  for (const int frame : Missing(*rows)) EXPECT_LE(frame, 1);
}

TEST(RowFrames, OneRowMissingAndOneTooManyAreSeenThoughTheCountIsRight) {
  std::vector<std::string> lines = Lines(10);
  lines.insert(lines.begin() + 90, lines[3]);
  lines.erase(lines.begin() + 30);
  const Expected<JointRows> rows = ReadRows(lines);
  ASSERT_TRUE(rows) << rows.error().Message();
  EXPECT_THAT(Missing(*rows), ElementsAre(2, 7));
  EXPECT_EQ(rows->findings.size(), 2U);
}

TEST(RowFrames, WhichEndOfATableIsNotWholeIsForTheCallerToSay) {
  std::vector<std::string> lines = Lines(10);
  lines.erase(lines.begin() + 5);
  const Expected<JointRows> cut = ReadRows(lines);
  ASSERT_TRUE(cut);
  EXPECT_EQ(cut->rows_left_over, kJoints - 1);
  EXPECT_EQ(cut->findings.at(0).code, "cut_off");
  const Expected<JointRows> first = ReadRows(lines, OddFrame::kFirst);
  ASSERT_TRUE(first);
  EXPECT_THAT(Missing(*first), ElementsAre(0));
  EXPECT_EQ(first->findings.at(0).code, "frame_rows");
}

TEST(RowFrames, AWholeTableHasNoBreaksHoweverFarTheBodyJumps) {
  std::vector<std::string> lines = Lines(10);
  const std::vector<std::string> later = Lines(500);
  lines.insert(lines.end(), later.end() - 5 * kJoints, later.end());
  for (int row = 0; row < 8; ++row) lines[static_cast<std::size_t>(50 + row)] = "0 0 0 0";
  const Expected<JointRows> rows = ReadRows(lines);
  ASSERT_TRUE(rows);
  EXPECT_THAT(rows->findings, IsEmpty());
}

TEST(RowFrames, WhereDamageIsRefusedTheErrorNamesTheLine) {
  std::vector<std::string> lines = Lines(10);
  lines.insert(lines.begin() + 90, lines[3]);
  lines.erase(lines.begin() + 30);
  ExpectMalformed(ReadRows(lines, OddFrame::kLast, DamagedRows::kRefuse), "t.txt:31");
}

TEST(RowFrames, ATableOfAnotherCountOfJointsIsRefused) {
  std::vector<std::string> lines = Lines(10);
  for (int f = 9; f >= 0; --f) lines.erase(lines.begin() + f * kJoints + 5);
  ExpectError(ReadRows(lines), ErrorCode::kInconsistent, "t.txt:13");
}

TEST(RowFrames, MostRowsGoOnInFramesOfTheTablesCountAlone) {
  std::vector<double> values;
  for (const std::string& line : Lines(20)) {
    double row[3];
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf %lf %lf", &row[0], &row[1], &row[2]), 3);
    values.insert(values.end(), row, row + 3);
  }
  for (const int torn : {0, 1, 8}) {  // a row of so many frames is missing
    std::vector<double> rows = values;
    for (int f = 2 * torn; f > 0; f -= 2) {
      const auto at = rows.begin() + static_cast<std::ptrdiff_t>(3 * (f * kJoints + 5));
      rows.erase(at, at + 3);
    }
    const JointPerRow table{rows.data(), static_cast<long long>(rows.size()) / 3, 3};
    EXPECT_TRUE(MostRowsGoOn(table, kJoints)) << torn;
    for (const int others : {kJoints - 2, kJoints - 1, kJoints + 1, kJoints + 3}) {
      EXPECT_FALSE(MostRowsGoOn(table, others)) << torn << ", " << others;
    }
  }
}

}  // namespace
}  // namespace mocurate
