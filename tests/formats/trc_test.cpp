#include "core/formats/trc.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/base/file.h"
#include "core/formats/c3d.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

/// A file with these names and rows.
std::string Text(const std::string& names, const std::string& rows, const std::string& frames = "2") {
  return "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n100\t100\t" + frames +
         "\t2\tmm\n" + names + "\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n" + rows;
}
constexpr const char* kNames = "Frame#\tTime\tR.Knee\t\t\tC 7\t\t";

TEST(Trc, ComesBackAsItWasWritten) {
  const auto trc = ParseTrc(Text(kNames, "1\t0\t1\t2\t3\t\t\t\n2\t0.01\t\t\t\t4\t5.5\t6e1\n"), "a.trc");
  ASSERT_TRUE(trc) << trc.error().Message();
  EXPECT_THAT(trc->names, ElementsAre("R.Knee", "C 7"));
  EXPECT_EQ(trc->units, "mm");
  EXPECT_DOUBLE_EQ(trc->rate_hz, 100.0);
  EXPECT_TRUE(std::isnan(trc->values[3]) && std::isnan(trc->values[6]));
  EXPECT_DOUBLE_EQ(trc->values[11], 60.0);
  EXPECT_TRUE(trc->findings.empty());
  const auto again = ParseTrc(WriteTrc(*trc), "b.trc");
  ASSERT_TRUE(again) << again.error().Message();
  EXPECT_EQ(WriteTrc(*again), WriteTrc(*trc));
}

TEST(Trc, OtherSeparatorsHolesAndHeadersAreRead) {
  const auto commas = ParseTrc(Text("Frame#,Time,A,,,B,,", "1,0,1,2,3,,,\n2,0.01,NaN,nan,NaN,4,5,6\n"), "a.trc");
  ASSERT_TRUE(commas) << commas.error().Message();
  EXPECT_TRUE(std::isnan(commas->values[3]) && std::isnan(commas->values[6]));
  const auto blanks = ParseTrc(Text("Frame# Time A B", "1 0 1 2 3 4 5 6\n2 0.01 1 2 3 4 5 6\n"), "a.trc");
  ASSERT_TRUE(blanks) << blanks.error().Message();
  EXPECT_THAT(blanks->names, ElementsAre("A", "B"));
  const auto seven = ParseTrc(
      "PathFileType 4 (X/Y/Z) a\r\nDataRate NumFrames Units\r\n50 1 m\r\nFrame#\tTime\tA\r\n"
      "\t\tX7\tY7\tZ7\r\n1\t0\t1\t2\t3\r\n",
      "a.trc");
  ASSERT_TRUE(seven) << seven.error().Message();
  EXPECT_EQ(seven->units, "m");
  EXPECT_THAT(seven->values, ElementsAre(1, 2, 3));
}

TEST(Trc, CountsThatDifferAreFindings) {
  const auto codes = [](const Expected<TrcFile>& trc) {
    std::vector<std::string> found;
    if (!trc) return std::vector<std::string>{trc.error().Message()};
    for (const Finding& finding : trc->findings) found.push_back(finding.code);
    return found;
  };
  EXPECT_THAT(codes(ParseTrc(Text("Frame#\tTime\tA\t\t", "1\t0\t1\t2\t3\t7\t8\t9\n2\t0\t1\t2\t3\n"), "a.trc")),
              ElementsAre("count_contradiction", "unnamed_points"));
  const std::string fewer = Text(kNames, "1\t0\t1\t2\t3\t4\t5\t6\n", "9");
  ExpectError(ParseTrc(fewer, "a.trc"), ErrorCode::kInconsistent, "a.trc");
  EXPECT_THAT(codes(ParseTrc(fewer, "a.trc", DamagedRows::kReport)), ElementsAre("cut_off"));
  const std::string two = Text(kNames, "1\t0\t1\t2\t\t4\t5\t6\n2\t0\t1\tx\t3\t4\t5\t6\n");
  ExpectMalformed(ParseTrc(two, "a.trc"), "a.trc:7");
  const auto reported = ParseTrc(two, "a.trc", DamagedRows::kReport);
  EXPECT_THAT(codes(reported), ElementsAre("row_length", "not_a_number"));
  EXPECT_TRUE(std::isnan(reported->values[0]) && std::isnan(reported->values[6]));
  const std::string shifted = Text(kNames, "1\t0\t1\t2\t3\t4\t5\t6\n2\t0.01\t1\t3\t4\t5\t6\n");
  ExpectMalformed(ParseTrc(shifted, "a.trc"), "a.trc:8");
  const std::string ends =
      Text(kNames, "1\t0\t1\t2\t3\t4\t5\t6\t\n2\t0.01\t1\t2\t3\t4\t5\t6\t\n3\t0.02\t1\t3\t4\t5\t6\t\n", "3");
  ExpectMalformed(ParseTrc(ends, "a.trc"), "a.trc:9");
  const auto lost = ParseTrc(shifted, "a.trc", DamagedRows::kReport);
  EXPECT_THAT(codes(lost), ElementsAre("row_length"));
  EXPECT_TRUE(std::isnan(lost->values[6]) && std::isnan(lost->values[11])) << "no number goes to another marker";
}

TEST(Trc, WhatIsNoTrcIsRefused) {
  ExpectMalformed(ParseTrc("time 1 2\n", "a.trc"), "a.trc:1");
  ExpectMalformed(ParseTrc("PathFileType\t4\n", "a.trc"), "a.trc:1");
  ExpectMalformed(ParseTrc(Text("Frame#\tTime\tA\t\t\tA\t\t", ""), "a.trc"), "a.trc:4");
  ExpectMalformed(ParseTrc(Text(kNames, ""), "a.trc"), "a.trc:6");
  ExpectMalformed(ParseTrc(Text(kNames, "2\t0\t1\t2\t3\t4\t5\t6\n1\t0\t1\t2\t3\t4\t5\t6\n"), "a.trc"), "a.trc:8");
  ExpectMalformed(ParseTrc(Text("Frame# Time A B", "1 0 1 2 3\n"), "a.trc"), "a.trc:7");
}

TEST(RecordedTrc, ProgramsFilesAreRead) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto read = [&](const char* name) {
    return ParseTrc(ReadFile(std::filesystem::path(data) / "c3d_trc" / name).value(), name);
  };
  const auto motek = read("motek_T.trc"), coco = read("pose2sim_coco.trc"), gait = read("Gait.trc");
  ASSERT_TRUE(motek) << motek.error().Message();
  EXPECT_THAT(motek->names, SizeIs(41));
  EXPECT_EQ(motek->rows(), 89);
  ASSERT_TRUE(coco) << coco.error().Message();
  EXPECT_THAT(coco->names, SizeIs(29));
  EXPECT_EQ(coco->units, "m");
  EXPECT_NEAR(coco->time_s[0], 9.5416667, 1e-9);
  ASSERT_TRUE(gait) << gait.error().Message();
  EXPECT_THAT(gait->names, SizeIs(33));
  // The same take as C3D, which its program smoothed: columns in the same order.
  const auto c3d = ParseC3d(ReadFile(std::filesystem::path(data) / "c3d_trc/Gait.c3d").value(), "Gait.c3d");
  ASSERT_TRUE(c3d) << c3d.error().Message();
  ASSERT_EQ(c3d->frames, gait->rows());
  std::vector<double> apart;
  for (int f = 0; f < c3d->frames; ++f) {
    for (int p = 0; p < 33; ++p) {
      const double* a = c3d->at(f, p);
      const double* b = &gait->values[3 * (static_cast<std::size_t>(f) * 33 + static_cast<std::size_t>(p))];
      if (!c3d->seen(f, p) || std::isnan(b[0])) continue;
      for (int k = 0; k < 3; ++k) apart.push_back(std::abs(a[k] - b[k]));
    }
  }
  EXPECT_THAT(apart, SizeIs(3 * 5515));
  std::sort(apart.begin(), apart.end());
  EXPECT_LT(apart[apart.size() / 2], 0.35);
  EXPECT_LT(apart.back(), 7.7);
}

}  // namespace
}  // namespace mocurate
