// Small text tables: OpenSim, exponential maps, Bandai labels, UESTC, PHSPD.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/text.h"
#include "core/formats/bandai_label.h"
#include "core/formats/expmap_table.h"
#include "core/formats/opensim_table.h"
#include "core/formats/phspd_text.h"
#include "core/formats/uestc_info.h"
#include "tests/formats/corruption.h"
#include "tests/formats/expect_error.h"
#include "tests/support/expmap_writer.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

const char* const kMot =
    "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\n\nendheader\ntime\tknee\tpelvis_tx\n"
    "  0.0\t 10.5\t0.1\n  0.1\t 11.5\t0.2\n";

TEST(OpenSim, ReadsHeaderLabelsAndRows) {
  const auto table = ParseOpenSimTable(kMot, "ik.mot");
  ASSERT_TRUE(table) << table.error().Message();
  EXPECT_EQ(table->title, "Coordinates");
  EXPECT_EQ(table->in_degrees, true);
  EXPECT_THAT(table->labels, ElementsAre("knee", "pelvis_tx"));
  EXPECT_THAT(table->time_s, ElementsAre(0.0, 0.1));
  EXPECT_EQ(table->value(1, 0), 11.5);
}

TEST(OpenSim, ReadsCellsOfSeveralNumbersAndHeadersWithoutCounts) {
  const auto table = ParseOpenSimTable(
      "DataRate=100.0\nDataType=Quaternion\nversion=3\nOpenSimVersion=4.1\nendheader\ntime\tpelvis\ttibia_r\n"
      "0\t1,0,0,0\t0.5,0.5,0.5,0.5\n",
      "imu.sto");
  ASSERT_TRUE(table) << table.error().Message();
  EXPECT_EQ(table->components, 4);
  EXPECT_FALSE(table->in_degrees);
  EXPECT_EQ(table->value(0, 1, 3), 0.5);
  EXPECT_EQ(table->header.at("OpenSimVersion"), "4.1");
  EXPECT_EQ(ParseOpenSimTable("DataType=SpatialVec\nendheader\ntime a\n0 1\n", "a.sto").error().code,
            ErrorCode::kUnsupported);
}

TEST(OpenSim, RejectsAHeaderThatContradictsTheData) {
  const auto altered = [](const std::string& from, const std::string& to) {
    return ParseOpenSimTable(Replaced(kMot, from, to), "ik.mot");
  };
  ExpectError(altered("nRows=2", "nRows=3"), ErrorCode::kInconsistent, "ik.mot:3");
  ExpectError(altered("nColumns=3", "nColumns=2"), ErrorCode::kInconsistent, "ik.mot:4");
  ExpectMalformed(altered(" 11.5", ""), "ik.mot:10");
  ExpectMalformed(altered(" 11.5", "x"), "ik.mot:10");
  ExpectMalformed(altered("  0.1", "  0"), "ik.mot:10");
  ExpectMalformed(altered("knee", "pelvis_tx"), "ik.mot:8");
  ExpectMalformed(altered("endheader\n", ""), "ik.mot:9");
  ExpectMalformed(ParseOpenSimTable("", "ik.mot"), "ik.mot");
}

TEST(OpenSim, ReportsTheLineOfEveryDamagedField) {
  ExpectEveryDamagedWordIsNamed(
      kMot, [](const std::string& text) { return StatusOf(ParseOpenSimTable(text, "file")); },
      [](std::string_view line, std::string_view word) {
        const bool name = line == "Coordinates" || word == "knee" || word == "pelvis_tx";
        const bool key = word == "version" || word == "nRows" || word == "nColumns" || word == "inDegrees";
        return name || key || word == "endheader";  // unknown keys are allowed; endheader is tested above
      },
      " \t\n=");
}

TEST(OpenSim, ReadsTheRecordedInverseKinematics) {
  const auto path = RecordedData("pose2sim/opensim_ik_body25b.mot");
  if (path.empty()) GTEST_SKIP() << "Pose2Sim data not found";
  const auto table = ParseOpenSimTable(Bytes(path), "ik.mot");
  ASSERT_TRUE(table) << table.error().Message();
  EXPECT_EQ(table->rows(), 100);
  EXPECT_EQ(table->labels.size(), 62u);
  EXPECT_NEAR(table->time_s[1] - table->time_s[0], 1.0 / 60.0, 1e-6);
  EXPECT_NEAR(table->value(0, 4), 0.96918196, 1e-12) << "pelvis_ty, metres";
}

TEST(Expmap, ReadsColumnsAsRootAndRotationVectors) {
  const auto table = ParseExpmapTable("1,2,3,0,0,0.5,0.1,0.2,0.3\n4,5,6,0,0,1,0,0,0\n", "a.txt");
  ASSERT_TRUE(table) << table.error().Message();
  EXPECT_EQ(table->joints, 2);
  EXPECT_THAT(table->root, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(table->rotation_rad[2], 0.5);
  const auto again = ParseExpmapTable(WriteExpmapTable(*table), "again");
  EXPECT_EQ(again->rotation_rad, table->rotation_rad);
  EXPECT_EQ(again->root, table->root);
  ExpectMalformed(ParseExpmapTable("1,2,3,4\n", "a.txt"), "a.txt:1");
  ExpectMalformed(ParseExpmapTable("1,2,3,4,5,6\n1,2,3,4,x,6\n", "a.txt"), "a.txt:2");
  EXPECT_FALSE(ParseExpmapTable("", "a.txt"));
}

TEST(Expmap, ReportsARowOfWrongLengthAndKeepsItsTime) {
  const auto table = ParseExpmapTable("1,2,3,0,0,1\n4,5,6,0,0\n7,8,9,0,0,3\n", "a.txt", 0, DamagedRows::kReport);
  ASSERT_TRUE(table) << table.error().Message();
  EXPECT_EQ(table->frames, 3);
  EXPECT_TRUE(std::isnan(table->root[3]));
  EXPECT_EQ(table->root[6], 7.0);
  ASSERT_EQ(table->findings.size(), 1u);
  EXPECT_EQ(table->findings[0].frame_begin, 1);
}

TEST(Expmap, ReportsTheLineOfEveryDamagedField) {
  ExpectEveryDamagedWordIsNamed(
      "1,2,3,0,0,1\n4,5,6,0,0,2\n", [](const std::string& text) { return StatusOf(ParseExpmapTable(text, "file")); },
      nullptr);
}

TEST(Expmap, Reads38JointsFromTheRecordedTables) {
  const auto folder = RecordedData("cmu/expmap");
  if (folder.empty()) GTEST_SKIP() << "CMU data not found";
  int files = 0;
  for (const auto& path : FilesEndingIn(folder, ".txt")) {
    const auto table = ParseExpmapTable(Bytes(path), path.filename().string());
    ASSERT_TRUE(table) << table.error().Message();
    EXPECT_EQ(table->joints, 38);
    EXPECT_EQ(ParseExpmapTable(WriteExpmapTable(*table), "again")->rotation_rad, table->rotation_rad);
    ++files;
  }
  EXPECT_EQ(files, 5);
}

TEST(Bandai, ReadsALabelAsTwoIndices) {
  const auto label = ParseBandaiLabel(R"({"content": 6, "style": 11})", "a.json");
  ASSERT_TRUE(label);
  EXPECT_EQ(label->content, 6);
  EXPECT_EQ(label->style, 11);
  for (const auto& [text, where] : {std::pair{R"({"content": -1, "style": 1})", "a.json:/content"},
                                    {R"({"content": 1.5, "style": 1})", "a.json:/content"},
                                    {R"({"content": 1, "style": "x"})", "a.json:/style"},
                                    {R"({"content": 1})", "a.json"},
                                    {R"({"content": 1, "stile": 2})", "a.json:/"},
                                    {"{\"content\": 6,\n \"style\": }", "a.json:2:11"},
                                    {"[]", "a.json:/"},
                                    {"", "a.json"},
                                    {R"({"content": 99999999999999999999, "style": 1})", "a.json:/content"},
                                    {R"({"content": 1e999, "style": 1})", "a.json"}}) {
    ExpectMalformed(ParseBandaiLabel(text, "a.json"), where);
  }
}

/// One label a line, the set's prefix up to the first '_' removed.
std::vector<std::string> LabelsOf(const std::filesystem::path& list) {
  std::vector<std::string> labels;
  const std::string text = Bytes(list);
  for (const std::string_view line : SplitText(text, '\n')) {
    if (const std::string_view label = Trim(line); !label.empty())
      labels.emplace_back(label.substr(label.find('_') + 1));
  }
  return labels;
}

TEST(Bandai, MatchesRecordedLabelsWithTheirFileNames) {
  const auto folder = RecordedData("bvh");
  if (folder.empty()) GTEST_SKIP() << "Bandai data not found";
  int files = 0;
  for (const char* set : {"bandai1", "bandai2"}) {
    const auto contents = LabelsOf(folder / set / "content_label.txt");
    const auto styles = LabelsOf(folder / set / "style_label.txt");
    for (const auto& path : FilesEndingIn(folder / set, ".json")) {
      const auto label = ParseBandaiLabel(Bytes(path), path.string());
      ASSERT_TRUE(label) << label.error().Message();
      const auto parts = SplitText(path.filename().string(), '_');
      const std::string name = path.filename().string();
      ASSERT_LT(static_cast<std::size_t>(label->content), contents.size());
      ASSERT_LT(static_cast<std::size_t>(label->style), styles.size());
      const std::string expected = "_" + contents[static_cast<std::size_t>(label->content)] + "_" +
                                   styles[static_cast<std::size_t>(label->style)] + "_";
      EXPECT_NE(name.find(expected), std::string::npos) << name << " is " << expected;
      ++files;
    }
  }
  EXPECT_EQ(files, 194);
}

TEST(Uestc, ReadsActionViewSubjectAndSideFromAName) {
  const auto video = ParseUestcName("a12_d4_p007_c2_color.avi", "names.txt:1");
  ASSERT_TRUE(video) << video.error().Message();
  EXPECT_EQ(video->action, 12);
  EXPECT_EQ(video->view, 4);
  EXPECT_EQ(video->subject, 7);
  EXPECT_EQ(video->side, 2);
  EXPECT_EQ(video->Name(), "a12_d4_p007_c2_color.avi");
  EXPECT_TRUE(*ParseUestcName("a12_d4_p007_c2_skeleton.mat", "x") == *video);
  for (const char* text :
       {"a40_d4_p007_c2_color.avi", "a1_d9_p007_c2_color.avi", "a1_d0_p000_c2_color.avi", "a1_d0_p119_c2_color.avi",
        "a1_d0_p001_c3_color.avi", "a_d0_p001_c1_color.avi", "a1_d+1_p001_c1_color.avi", "a1_d1", ""}) {
    ExpectMalformed(ParseUestcName(text, "names.txt:1"), "names.txt:1");
  }
}

TEST(Uestc, CountsListEntriesByLines) {
  const std::string names = "a0_d0_p001_c1_color.avi\na0_d0_p001_c2_color.avi\n";
  const auto videos = ParseUestcNames(names, "names.txt");
  ASSERT_TRUE(videos) << videos.error().Message();
  EXPECT_EQ(WriteUestcNames(*videos), names);
  ExpectMalformed(ParseUestcNames("a0_d0_p001_c1_color.avi\n\na0_d0_p001_c2_color.avi\n", "names.txt"), "names.txt:3");
  ExpectMalformed(ParseUestcNames(names + names, "names.txt"), "names.txt:3");
  ExpectMalformed(ParseUestcNames("a0_d0_p001_c1_depth.avi\n", "names.txt"), "names.txt:1");
  const auto frames = ParseUestcFrameCounts("300\n0\n", "num_frames_min.txt", videos->size());
  ASSERT_TRUE(frames) << frames.error().Message();
  EXPECT_THAT(*frames, ElementsAre(300, 0));
  EXPECT_EQ(WriteUestcFrameCounts(*frames), "300\n0\n");
  ExpectError(ParseUestcFrameCounts("300\n", "n.txt", 2), ErrorCode::kInconsistent, "n.txt:1");
  ExpectMalformed(ParseUestcFrameCounts("300\n-1\n", "n.txt"), "n.txt:2");
  std::string actions;
  for (int i = 0; i < 40; ++i) actions += "action " + std::to_string(i) + "\n";
  EXPECT_EQ(ParseUestcActions(actions, "action_classes.txt")->at(39), "action 39");
  ExpectError(ParseUestcActions("punching\n", "a.txt"), ErrorCode::kInconsistent, "a.txt:1");
}

PhspdPose Pose(std::vector<int> frames) {
  PhspdPose pose;
  pose.frame = std::move(frames);
  for (std::size_t i = 0; i < pose.frame.size() * kPhspdJoints * 3; ++i) {
    pose.position_m.push_back(0.1 * static_cast<double>(i) - 1.0 / 3.0);
  }
  return pose;
}

TEST(Phspd, ReadsFramesWithGapsAndKeepsAllDigits) {
  const auto pose = ParsePhspdPose(WritePhspdPose(Pose({0, 1, 5})), "pose.txt");
  ASSERT_TRUE(pose) << pose.error().Message();
  EXPECT_THAT(pose->frame, ElementsAre(0, 1, 5));
  EXPECT_EQ(pose->position_m, Pose({0, 1, 5}).position_m);
  PhspdShape shape;
  shape.frame = {3};
  shape.translation_m = {1, 2, 3};
  shape.betas.assign(10, 0.25);
  shape.pose_rad.assign(72, 1.0 / 7.0);
  const std::string text = WritePhspdShape(shape);
  EXPECT_EQ(SplitText(text, ' ').size(), 86u);
  const auto again = ParsePhspdShape(text, "shape_smpl.txt");
  ASSERT_TRUE(again) << again.error().Message();
  EXPECT_EQ(again->translation_m, shape.translation_m);
  EXPECT_EQ(again->betas, shape.betas);
  EXPECT_EQ(again->pose_rad, shape.pose_rad);
}

TEST(Phspd, RejectsBadInputWithItsLine) {
  const std::string text = WritePhspdPose(Pose({4, 5}));
  ExpectEveryDamagedWordIsNamed(
      text, [](const std::string& damaged) { return StatusOf(ParsePhspdPose(damaged, "file")); }, nullptr);
  ExpectMalformed(ParsePhspdPose(WritePhspdPose(Pose({4, 4})), "pose.txt"), "pose.txt:2");
  ExpectMalformed(ParsePhspdPose("1.5" + text.substr(1), "pose.txt"), "pose.txt:1");
  ExpectMalformed(ParsePhspdShape(text, "s.txt"), "s.txt:1");
}

TEST(Phspd, ExcludesADamagedRowAndReportsItsFrame) {
  std::string text = WritePhspdPose(Pose({4, 5, 9, 10}));
  const std::size_t third = text.find("\n9 ") + 1;
  text.replace(third, text.find('\n', third) - third, "9 1.5 2");
  const auto pose = ParsePhspdPose(text, "pose.txt", DamagedRows::kReport);
  ASSERT_TRUE(pose) << pose.error().Message();
  EXPECT_THAT(pose->frame, ElementsAre(4, 5, 10));
  EXPECT_EQ(pose->position_m.size(), 3u * kPhspdJoints * 3);
  EXPECT_EQ(pose->position_m[2 * kPhspdJoints * 3], Pose({4, 5, 9, 10}).position_m[3 * kPhspdJoints * 3]);
  ASSERT_EQ(pose->findings.size(), 1u);
  EXPECT_EQ(pose->findings[0].code, "row_length");
  EXPECT_EQ(pose->findings[0].frame_begin, 6) << "the frame after 5";
  EXPECT_EQ(pose->findings[0].value, 3.0) << "numbers in the row";
  ExpectMalformed(ParsePhspdPose("a header\n" + WritePhspdPose(Pose({4, 4})), "p.txt", DamagedRows::kReport),
                  "p.txt:3");
}

TEST(Phspd, ReadsTheRecordingFromTheFolderName) {
  const auto recording = ParsePhspdRecording("subject03_group2_time4");
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->subject, 3);
  EXPECT_EQ(recording->time, 4);
  EXPECT_EQ(recording->Name(), "subject03_group2_time4");
  for (const char* wrong :
       {"", "subject03_group2", "subject03_group2_time", "subject_group2_time1", "subject-3_group2_time1"}) {
    EXPECT_FALSE(ParsePhspdRecording(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace mocurate
