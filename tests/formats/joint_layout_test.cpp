#include "core/formats/joint_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/text.h"
#include "core/geometry/rotation.h"
#include "tests/formats/corruption.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

constexpr const char* kCad60 = "frame 11*(rotation rotation_confidence x y z confidence) 4*(x y z confidence)";

JointLayout Layout(const std::string& text) { return ParseJointLayout(text, "layout").value(); }

JointTableLayout LayoutRows(int rows_per_frame, DamagedRows damaged = DamagedRows::kRefuse) {
  JointTableLayout rows;
  rows.rows_per_frame = rows_per_frame;
  rows.damaged_rows = damaged;
  return rows;
}

TEST(JointLayout, AssignsAMeaningToEachNumber) {
  const JointLayout layout = Layout(kCad60);
  EXPECT_EQ(layout.Joints(), 15);
  EXPECT_EQ(layout.NumbersPerFrame(), 171);
  EXPECT_EQ(Layout("20*(x, y, z, confidence)").NumbersPerFrame(), 80);
  EXPECT_EQ(Layout("skip 2*(x y z skip skip)").NumbersPerFrame(), 11);
}

TEST(JointLayout, RejectsInvalidDeclarations) {
  for (const char* text :
       {"15*(x y zz)", "15*(x y)", "15*(x y z", "15(x y z)", "15*(x y z x)", "frame", "", "confidence 2*(x y z)",
        "3*(frame) 2*(x y z)", "frame time_ms 2*(x y z)", "2*(time_s) 2*(x y z)", "time 2*(x y z)", "0*(x y z)",
        "99999*(x y z)", "2*() 1*(x y z)", "2*(x y z confidenc)"}) {
    ExpectError(ParseJointLayout(text, "layout"), ErrorCode::kConfig, "layout");
  }
}

TEST(JointRows, AssignNumbersByTheDeclaration) {
  const auto rows = ParseJointRows(
      "7,1,0,0,0,1,0,0,0,1,0.5,10,20,30,1,40,50,60,0,\n8,1,0,0,0,1,0,0,0,1,0,11,21,31,1,41,"
      "51,61,1,\nEND\n",
      Layout("frame 1*(rotation rotation_confidence x y z confidence) 1*(x y z confidence)"),
      [] {
        JointTableLayout table;
        table.end_word = "END";
        return table;
      }(),
      "a.txt");
  ASSERT_TRUE(rows) << rows.error().Message();
  EXPECT_EQ(rows->frames, 2);
  EXPECT_THAT(rows->counter, ElementsAre(7, 8));
  EXPECT_THAT(rows->position, ElementsAre(10, 20, 30, 40, 50, 60, 11, 21, 31, 41, 51, 61));
  EXPECT_THAT(rows->confidence, ElementsAre(1, 0, 1, 1));
  EXPECT_THAT(rows->rotation_confidence, ElementsAre(0.5, 0, 0, 0));
  EXPECT_EQ(rows->rotation[4], 1.0);
  EXPECT_EQ(rows->rotation[9], 0.0) << "the second joint has no rotation";
  EXPECT_TRUE(rows->findings.empty());
}

TEST(JointRows, ReportARowOfWrongLengthAndKeepItsTime) {
  const JointLayout layout = Layout("2*(x y z)");
  const std::string text = "1 2 3\n4 5 6\n7 8\n10 11 12\n13 14 15\n16 17 18\n";
  ExpectMalformed(ParseJointRows(text, layout, LayoutRows(2), "a.txt"), "a.txt:3");
  const auto rows = ParseJointRows(text, layout, LayoutRows(2, DamagedRows::kReport), "a.txt");
  ASSERT_TRUE(rows) << rows.error().Message();
  ASSERT_EQ(rows->frames, 3);
  for (int i = 6; i < 12; ++i) EXPECT_TRUE(std::isnan(rows->position[static_cast<std::size_t>(i)])) << "both joints";
  EXPECT_EQ(rows->position[12], 13.0);
  ASSERT_EQ(rows->findings.size(), 1u);
  EXPECT_EQ(rows->findings[0].code, "row_length");
  EXPECT_EQ(rows->findings[0].frame_begin, 1);
  EXPECT_EQ(rows->findings[0].value, 2.0);
}

TEST(JointRows, ReportWordsAndAnIncompleteLastFrame) {
  const JointLayout layout = Layout("2*(x y z)");
  const auto rows =
      ParseJointRows("1 2 3\n4 oops 6\n7 8 9\n10 11 12\n13 14 15\n", layout, LayoutRows(2, DamagedRows::kReport), "a");
  ASSERT_TRUE(rows) << rows.error().Message();
  EXPECT_EQ(rows->frames, 2);
  EXPECT_EQ(rows->position[6], 7.0);
  ASSERT_EQ(rows->findings.size(), 2u);
  EXPECT_EQ(rows->findings[0].code, "not_a_number");
  EXPECT_EQ(rows->findings[0].frame_begin, 0);
  EXPECT_EQ(rows->findings[1].code, "cut_off");
  std::string other;
  for (int i = 0; i < 100; ++i) other += "1 2 3 4\n";
  ExpectMalformed(ParseJointRows(other, layout, LayoutRows(2, DamagedRows::kReport), "a"), "a:1");
}

TEST(JointRows, RejectRowsAfterTheEndMarker) {
  JointTableLayout table = LayoutRows(1);
  table.end_word = "END";
  EXPECT_TRUE(ParseJointRows("1 2 3\n", Layout("1*(x y z)"), table, "a"));
  ExpectMalformed(ParseJointRows("1 2 3\nEND\n4 5 6\n", Layout("1*(x y z)"), table, "a"), "a:3");
  ExpectMalformed(ParseJointRows("1 2 3\nEND\n", Layout("1*(x y z)"), LayoutRows(1), "a"), "a:2");
}

TEST(JointRows, LeaveFramesMissingThatTheFrameNumbersSkip) {
  const auto rows =
      ParseJointRows("1,1,2,3\n2,1,2,4\n5,1,2,5\n6,1,2,6\n", Layout("frame 1*(x y z)"), LayoutRows(1), "a");
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->findings.size(), 1u);
  EXPECT_EQ(rows->findings[0].code, "time_gap");
  EXPECT_EQ(rows->findings[0].frame_begin, 2);
  EXPECT_EQ(rows->findings[0].frame_end, 4);
  EXPECT_EQ(rows->findings[0].value, 2);
  ASSERT_EQ(rows->frames, 6);
  for (int f = 0; f < 6; ++f) EXPECT_EQ(std::isnan(rows->position[static_cast<std::size_t>(f) * 3]), f == 2 || f == 3);
  EXPECT_EQ(rows->position[4 * 3 + 2], 5.0);
}

TEST(JointRows, AddNoGapAfterADamagedFirstRow) {
  JointTableLayout table = LayoutRows(1);
  table.damaged_rows = DamagedRows::kReport;
  const auto rows = ParseJointRows("7,1,x,3\n8,1,2,3\n9,1,2,3\n", Layout("frame 1*(x y z)"), table, "a");
  ASSERT_TRUE(rows) << rows.error().Message();
  EXPECT_EQ(rows->frames, 3);
}

TEST(JointRows, KeepAndReportFrameNumbersThatDoNotIncrease) {
  for (const char* third : {"2", "1.5", "90000000"}) {
    const auto rows = ParseJointRows("1,1,2,3\n2,1,2,3\n" + std::string(third) + ",1,2,3\n4,1,2,3\n",
                                     Layout("frame 1*(x y z)"), LayoutRows(1), "a");
    ASSERT_TRUE(rows);
    EXPECT_EQ(rows->frames, 4);
    ASSERT_EQ(rows->findings.size(), 1u);
    EXPECT_EQ(rows->findings[0].code, "frame_number");
    EXPECT_EQ(rows->findings[0].frame_begin, 2);
  }
}

TEST(JointRows, LayFramesOutByTheirTimes) {
  const std::pair<const char*, double> units[] = {
      {"time_s", 1.0}, {"time_ms", 1e-3}, {"time_us", 1e-6}, {"time_100ns", 1e-7}, {"time_ns", 1e-9}};
  for (const auto& [word, seconds] : units) {
    std::string text;
    for (const int frame : {0, 1, 2, 3, 6, 7, 8, 9}) {
      text += FormatDouble(1e3 + frame / 30.0 / seconds) + ",1,2," + std::to_string(frame) + "\n";
    }
    const auto rows = ParseJointRows(text, Layout(std::string(word) + " 1*(x y z)"), LayoutRows(1), "a");
    ASSERT_TRUE(rows) << rows.error().Message();
    EXPECT_NEAR(rows->hz, 30.0, 0.01) << word;
    ASSERT_EQ(rows->frames, 10) << word;
    ASSERT_EQ(rows->findings.size(), 1u);
    EXPECT_EQ(rows->findings[0].code, "time_gap");
    EXPECT_EQ(rows->findings[0].frame_begin, 4);
    EXPECT_EQ(rows->findings[0].value, 2);
    EXPECT_TRUE(std::isnan(rows->position[4 * 3]));
    EXPECT_EQ(rows->position[6 * 3 + 2], 6.0);
  }
}

TEST(JointRows, RefuseTimesThatFallAndPassOverThoseThatStandStill) {
  const JointLayout layout = Layout("time_ms 1*(x y z)");
  ExpectError(ParseJointRows("0,1,2,3\n33,1,2,3\n10,1,2,3\n", layout, LayoutRows(1), "a"), ErrorCode::kInconsistent,
              "a");
  const auto still = ParseJointRows("0,1,2,3\n33,1,2,4\n33,1,2,5\n67,1,2,6\n", layout, LayoutRows(1), "a");
  ASSERT_TRUE(still);
  EXPECT_EQ(still->frames, 3);
  EXPECT_EQ(still->position[8], 6.0);
  ASSERT_EQ(still->findings.size(), 1u);
  EXPECT_EQ(still->findings[0].code, "frame_number");
  EXPECT_EQ(still->findings[0].value, 1.0);
  EXPECT_EQ(still->findings[0].action, FindingAction::kDropped);
}

TEST(JointRows, RefuseAClockThatIsDeclaredToCountFrames) {
  const JointLayout layout = Layout("frame 1*(x y z)");
  const auto parse = [&](const std::string& text, double rate_hz) {
    return ParseJointRows(text, layout, LayoutRows(1, DamagedRows::kReport), "a", rate_hz);
  };
  const std::string varies = "0,1,2,3\n33,1,2,3\n67,1,2,3\n100,1,2,3\n133,1,2,3\n167,1,2,3\n200,1,2,3\n";
  const std::string equal = "0,1,2,3\n33,1,2,3\n66,1,2,3\n99,1,2,3\n132,1,2,3\n165,1,2,3\n";
  ExpectError(parse(varies, 0.0), ErrorCode::kInconsistent, "a");
  ExpectError(parse(equal, 30.0), ErrorCode::kInconsistent, "a");
  ExpectError(parse("timestamp,x,y,z\n" + equal, 0.0), ErrorCode::kInconsistent, "a");
  EXPECT_EQ(parse("frame,x,y,z\n1,1,2,3\n6,1,2,3\n11,1,2,3\n", 30.0)->frames, 11) << "every fifth frame";
  ExpectError(
      ParseJointRows("time_us,x,y,z\n" + equal, Layout("time_ms 1*(x y z)"), LayoutRows(1, DamagedRows::kReport), "a"),
      ErrorCode::kInconsistent, "a");
}

TEST(JointRows, ReadANumberThatEachJointRepeats) {
  const JointLayout layout = Layout("2*(frame skip x y z)");
  const auto rows = ParseJointRows("4,0,1,2,3\n4,1,1,2,4\n6,0,1,2,5\n6,1,1,2,6\n", layout, LayoutRows(2), "a");
  ASSERT_TRUE(rows) << rows.error().Message();
  EXPECT_EQ(rows->frames, 3);
  EXPECT_EQ(rows->position[2 * 6 + 2], 5.0);
  ExpectError(ParseJointRows("4,0,1,2,3\n5,0,1,2,5\n5,1,1,2,6\n6,0,1,2,6\n", layout, LayoutRows(2), "a"),
              ErrorCode::kInconsistent, "a");
}

TEST(JointRows, ReportTheLineOfEveryDamagedField) {
  ExpectEveryDamagedWordIsNamed(
      "1,1,2,3\n2,4,5,6\n",
      [](const std::string& text) {
        return StatusOf(ParseJointRows(text, Layout("frame 1*(x y z)"), LayoutRows(1), "file"));
      },
      nullptr);
}

// Recorded files.

struct Set {
  const char* folder;
  const char* ending;
  const char* layout;
  int rows_per_frame, files, frames;
};

class KinectSets : public ::testing::TestWithParam<Set> {};

TEST_P(KinectSets, AreReadWithTheirDeclaration) {
  const Set& set = GetParam();
  const auto folder = RecordedData(set.folder);
  if (folder.empty()) GTEST_SKIP() << set.folder << " not found";
  JointTableLayout table = LayoutRows(set.rows_per_frame);
  table.end_word = "END";
  int files = 0, frames = 0;
  for (const auto& path : FilesEndingIn(folder, set.ending)) {
    const auto rows = ParseJointRows(Bytes(path), Layout(set.layout), table, path.filename().string());
    ASSERT_TRUE(rows) << rows.error().Message();
    EXPECT_TRUE(rows->findings.empty());
    ++files, frames += rows->frames;
  }
  EXPECT_EQ(files, set.files);
  EXPECT_EQ(frames, set.frames);
}

INSTANTIATE_TEST_SUITE_P(Recorded, KinectSets,
                         ::testing::Values(Set{"kinect/kard", "_realworld.txt", "15*(x y z)", 15, 432, 51228},
                                           Set{"kinect/msr_action3d", "_skeleton3D.txt", "20*(x y z confidence)", 20,
                                               449, 18921},
                                           Set{"kinect/utkinect", ".txt", "20*(x y z)", 20, 160, 4867},
                                           Set{"kinect/florence3d", ".txt", "15*(x y z)", 15, 173, 3096},
                                           Set{"kinect/cad60", ".txt", kCad60, 1, 3, 900}),
                         [](const auto& set) { return std::filesystem::path(set.param.folder).filename().string(); });

TEST(KinectSets, ReadWholeBodyRotationsOfCad60) {
  const auto folder = RecordedData("kinect/cad60");
  if (folder.empty()) GTEST_SKIP() << "CAD-60 data not found";
  for (const auto& path : FilesEndingIn(folder, ".txt")) {
    const JointRows rows = ParseJointRows(Bytes(path), Layout(kCad60), LayoutRows(1), path.string()).value();
    EXPECT_EQ(rows.counter[0], 1.0);
    for (const double confidence : rows.confidence) EXPECT_TRUE(confidence == 0 || confidence == 1);
    for (std::size_t i = 0; i < rows.rotation_confidence.size(); ++i) {
      if (rows.rotation_confidence[i] == 0) continue;
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> matrix(&rows.rotation[i * 9]);
      EXPECT_NEAR((matrix * matrix.transpose() - Matrix3d::Identity()).norm(), 0.0, 1e-6);
      EXPECT_NEAR(matrix.determinant(), 1.0, 1e-6);
    }
    for (std::size_t f = 0; f < static_cast<std::size_t>(rows.frames); ++f) {
      EXPECT_GT(rows.position[f * 45 + 1], rows.position[f * 45 + 7]) << "the head is above the torso, y up";
    }
  }
}

}  // namespace
}  // namespace mocurate
