#include "core/formats/bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/formats/corruption.h"
#include "tests/formats/expect_error.h"
#include "tests/support/rotations.h"

namespace mocurate {
namespace {

/// Two joints. The second has one position channel and another rotation order than the first.
std::string TwoJoints(const std::string& rows = "1 2 3 0 0 90  7 0 0 0\n4 5 6 0 0 0  8 0 90 0\n",
                      const std::string& frames = "2", const std::string& time = "0.5") {
  return "HIERARCHY\nROOT Hips\n{\n OFFSET 100 100 100\n CHANNELS 6 Xposition Yposition Zposition Xrotation Yrotation "
         "Zrotation\n JOINT Knee Left\n {\n  OFFSET 1 2 3\n  CHANNELS 4 Yposition Zrotation Yrotation Xrotation\n "
         "}\n}\n"
         "MOTION\nFrames: " +
         frames + "\nFrame Time: " + time + "\n" + rows;
}

/// The two-joint file with one piece of its text replaced.
Expected<Bvh> Altered(const std::string& from, const std::string& to) {
  return ParseBvh(Replaced(TwoJoints(), from, to), "clip.bvh", DamagedRows::kReport);
}

TEST(Bvh, ReplacesOffsetComponentsByPositionChannels) {
  const auto bvh = ParseBvh(TwoJoints(), "clip.bvh");
  ASSERT_TRUE(bvh) << bvh.error().Message();
  ASSERT_EQ(bvh->joints.size(), 2u);
  EXPECT_EQ(bvh->joints[1].name, "Knee Left");
  EXPECT_FALSE(bvh->joints[1].has_end_site);
  EXPECT_EQ(bvh->frames, 2);
  EXPECT_DOUBLE_EQ(bvh->hz(), 2.0);
  EXPECT_TRUE(BvhLocalPosition(*bvh, 0, 0).isApprox(Vector3d(1, 2, 3)));
  EXPECT_TRUE(BvhLocalPosition(*bvh, 0, 1).isApprox(Vector3d(1, 7, 3)));
  std::vector<Vector3d> positions;
  BvhForward(*bvh, 0, positions);
  // The root is rotated by 90 degrees about z: (1,7,3) becomes (-7,1,3).
  EXPECT_TRUE(positions[1].isApprox(Vector3d(1 - 7, 2 + 1, 3 + 3), 1e-12)) << positions[1].transpose();
}

TEST(Bvh, MultipliesRotationsInChannelOrderOfTheJoint) {
  const auto bvh = ParseBvh(TwoJoints("0 0 0 10 20 30 0 40 50 60\n", "1"), "clip.bvh");
  ASSERT_TRUE(bvh);
  const double degree = M_PI / 180;
  EXPECT_TRUE(BvhLocalRotation(*bvh, 0, 0)
                  .isApprox(MatrixFromEuler(degree * Vector3d(10, 20, 30), *EulerOrder::Parse("XYZ")), 1e-12));
  EXPECT_TRUE(BvhLocalRotation(*bvh, 0, 1)
                  .isApprox(MatrixFromEuler(degree * Vector3d(40, 50, 60), *EulerOrder::Parse("ZYX")), 1e-12));
}

TEST(Bvh, RoundTripsThroughTheWriter) {
  const auto bvh = ParseBvh(TwoJoints(), "clip.bvh");
  const auto again = ParseBvh(WriteBvh(*bvh), "again.bvh");
  ASSERT_TRUE(again) << again.error().Message();
  EXPECT_EQ(again->values, bvh->values);
  EXPECT_EQ(again->joints[1].channels, bvh->joints[1].channels);
  EXPECT_EQ(again->joints[1].offset, bvh->joints[1].offset);
  EXPECT_EQ(again->frame_time_s, bvh->frame_time_s);
  EXPECT_EQ(WriteBvh(*again), WriteBvh(*bvh));
}

TEST(Bvh, IgnoresCarriageReturnsAndByteOrderMark) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : TwoJoints()) text += c == '\n' ? "\r\n" : std::string(1, c);
  const auto bvh = ParseBvh(text, "clip.bvh");
  ASSERT_TRUE(bvh) << bvh.error().Message();
  EXPECT_EQ(bvh->values, ParseBvh(TwoJoints(), "clip.bvh")->values);
}

TEST(Bvh, AcceptsTabsBetweenAllWords) {
  std::string text = TwoJoints();
  std::replace(text.begin(), text.end(), ' ', '\t');
  const auto bvh = ParseBvh(text, "clip.bvh");
  ASSERT_TRUE(bvh) << bvh.error().Message();
  EXPECT_EQ(bvh->values, ParseBvh(TwoJoints(), "clip.bvh")->values);
}

TEST(Bvh, ReportsDamageAmongThousandsOfJointsWithOneName) {
  std::string text = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n";
  for (int j = 0; j < 2000; ++j) text += "JOINT a\n{\nOFFSET 0 0 0\n}\n";
  text += "}\nMOTION\nFrames: 2\nFrame Time: 0.1\nx\ny\n";
  ExpectMalformed(ParseBvh(text, "clip.bvh", DamagedRows::kReport), "clip.bvh:8010");
}

TEST(Bvh, RejectsJointsWithoutNumbersThatTakeMoreMemoryThanTheFileMay) {
  const auto of = [](int joints, int frames) {
    std::string text = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n";
    for (int j = 1; j < joints; ++j) text += "JOINT j\n{\nOFFSET 0 1 0\n}\n";
    text += "}\nMOTION\nFrames: " + std::to_string(frames) + "\nFrame Time: 0.1\n";
    for (int f = 0; f < frames; ++f) text += "1\n";
    return ParseBvh(text, "clip.bvh");
  };
  ExpectMalformed(of(2000, 2000), "clip.bvh");
  EXPECT_TRUE(of(100, 2000));
}

TEST(Bvh, FillsDamagedRowsFromTheNearestRowBefore) {
  const auto bvh =
      ParseBvh(TwoJoints("x\n1 2 3 0 0 90 7 0 0 0\n4\n4 5 6 0 0 0 8 0 90 0\ny\n1 1 1 1 1 1 1 1 1 1\n", "6"), "clip.bvh",
               DamagedRows::kReport);
  ASSERT_TRUE(bvh) << bvh.error().Message();
  EXPECT_EQ(bvh->damaged, (std::vector<int>{0, 2, 4}));
  for (const auto& [frame, first] : {std::pair{0, 1}, {1, 1}, {2, 1}, {3, 4}, {4, 4}, {5, 1}}) {
    EXPECT_EQ(bvh->value(frame, 0), first) << frame;
  }
}

TEST(Bvh, RejectsARepeatedAxisWithItsLine) {
  std::string text = "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n}\n";
  text += "MOTION\nFrames: 2\nFrame Time: 0.1\n1 2 3\n4 5 6\n";
  ASSERT_TRUE(ParseBvh(text, "clip.bvh"));
  text.replace(text.find("Xrotation"), 9, "Zrotation");
  ExpectMalformed(ParseBvh(text, "clip.bvh"), "clip.bvh:5");
}

TEST(Bvh, RejectsBadInputWithItsPlace) {
  ExpectMalformed(Altered("Frames: 2", "Frames: two"), "clip.bvh:13");
  ExpectMalformed(Altered("Frame Time: ", "Frame Time: -"), "clip.bvh:14");
  ExpectMalformed(Altered("Frame Time: ", "Frame Time: nan"), "clip.bvh:14");
  ExpectMalformed(Altered("Frame Time: ", "Frame Time: 0,"), "clip.bvh:14");
  ExpectMalformed(Altered("Frame Time: ", "FrameTime: "), "clip.bvh:14");
  ExpectMalformed(Altered("Frame Time: 0.5", "Frame Time: 0"), "clip.bvh:14");
  ExpectMalformed(Altered("Frame Time: 0.5", "Frame Time: nan"), "clip.bvh:14");
  ExpectMalformed(Altered("Frame Time: 0.5", "Frame Time: 1e-320"), "clip.bvh:14");
  ExpectMalformed(Altered("MOTION\n", ""), "clip.bvh:12");
  ExpectMalformed(Altered("OFFSET 1 2 3", "OFFSET 1 2"), "clip.bvh:8");
  ExpectMalformed(Altered("OFFSET 1 2 3", "OFFSET 1 2 1e300"), "clip.bvh:8");
  ExpectMalformed(Altered("CHANNELS 4", "CHANNELS 3"), "clip.bvh:9");
  ExpectMalformed(Altered("CHANNELS 4 Yposition Zrotation Yrotation Xrotation", ""), "clip.bvh:15");
  ExpectMalformed(Altered("Zrotation\n JOINT", "Wrotation\n JOINT"), "clip.bvh:5");
  ExpectMalformed(Altered("JOINT", "JOINTS"), "clip.bvh:6");
  ExpectMalformed(Altered("}\nMOTION", "MOTION"), "clip.bvh:11");
  ExpectMalformed(Altered("}\nMOTION", "}\n}\nMOTION"), "clip.bvh:12");
  ExpectMalformed(Altered("}\nMOTION", "}\nROOT Other\n{\n}\nMOTION"), "clip.bvh:12");
  const std::string row = "1 2 3 0 0 90 7 0 0 0\n", text = TwoJoints();
  for (const auto& [bytes, where] : {std::pair<std::string, std::string>{"", "clip.bvh"},
                                     {"%PDF", "clip.bvh:1"},
                                     {std::string("\xFF\xFEH\0I\0", 6), "clip.bvh:1"},
                                     {text.substr(0, 150), "clip.bvh:9"},
                                     {text.substr(0, text.find("MOTION") - 20), "clip.bvh:9"},
                                     {TwoJoints("", "0"), "clip.bvh:15"},
                                     {TwoJoints(row + "4 5 6 0\n"), "clip.bvh:16"},
                                     {TwoJoints("1 2 nan 0 0 90 7 0 0 0\n", "1"), "clip.bvh:15"},
                                     {TwoJoints("1 2 x 0 0 90 7 0 0 0\n", "1"), "clip.bvh:15"},
                                     {TwoJoints("1\n", "99999999999999"), "clip.bvh:15"}}) {
    ExpectMalformed(ParseBvh(bytes, "clip.bvh"), where);
  }
  ExpectError(ParseBvh(TwoJoints(row), "clip.bvh"), ErrorCode::kInconsistent, "clip.bvh:13");
}

TEST(Bvh, RejectsAFileTruncatedAtAnyByte) {
  const std::string text = TwoJoints();
  const std::size_t last_digit = text.find_last_of("0123456789");
  for (std::size_t length = 0; length < last_digit; ++length) {
    EXPECT_FALSE(ParseBvh(text.substr(0, length), "clip.bvh")) << length;
  }
}

struct Fact {
  const char* file;
  std::size_t joints;
  int channels, frames;
  double hz;
  double least_y;  ///< of joints and end sites, file units; NaN: not stated
};

class BvhExporters : public ::testing::TestWithParam<Fact> {};

TEST_P(BvhExporters, ReadsTheKnownFactsOfEachFile) {
  const Fact& fact = GetParam();
  const std::filesystem::path folder = RecordedData("bvh/misc");
  if (folder.empty()) GTEST_SKIP() << "MOCURATE_DATA has no bvh/misc";
  const auto bvh = ParseBvh(Bytes(folder / fact.file), fact.file);
  ASSERT_TRUE(bvh) << bvh.error().Message();
  EXPECT_EQ(bvh->joints.size(), fact.joints);
  EXPECT_EQ(bvh->channel_count, fact.channels);
  EXPECT_EQ(bvh->frames, fact.frames);
  EXPECT_NEAR(bvh->hz(), fact.hz, 1e-3 * fact.hz);
  if (std::isnan(fact.least_y)) return;
  double least = std::numeric_limits<double>::infinity();
  std::vector<Vector3d> positions;
  std::vector<Matrix3d> global;
  for (int f = 0; f < bvh->frames; ++f) {
    BvhForward(*bvh, f, positions, &global);
    for (std::size_t j = 0; j < positions.size(); ++j) {
      least = std::min(least, positions[j].y());
      if (bvh->joints[j].has_end_site)
        least = std::min(least, (positions[j] + global[j] * bvh->joints[j].end_site).y());
    }
  }
  EXPECT_NEAR(least, fact.least_y, 0.5);
}

constexpr double kUnstated = std::numeric_limits<double>::quiet_NaN();
INSTANTIATE_TEST_SUITE_P(Files, BvhExporters,
                         ::testing::Values(Fact{"omimo_AV_8Walk_HVHA.bvh", 23, 72, 1064, 120, -0.24},
                                           Fact{"olafhaag_walk01.bvh", 19, 60, 101, 24, 5.8},
                                           Fact{"olafhaag_test_mocapbank.bvh", 19, 60, 455, 30, kUnstated},
                                           Fact{"olafhaag_test_freebvh_mixamo.bvh", 55, 168, 69, 30, kUnstated},
                                           Fact{"kevinxie4c_walk_mixed_orders.bvh", 19, 60, 299, 120, kUnstated},
                                           Fact{"kevinxie4c_sample_2frames.bvh", 18, 57, 2, 30, kUnstated},
                                           Fact{"chenzunh23_walk_noitom_yxz.bvh", 59, 180, 498, 90, kUnstated},
                                           Fact{"dme_xia_angry_13.bvh", 31, 96, 140, 120, kUnstated},
                                           Fact{"fairmotion_sinusoidal.bvh", 4, 15, 120, 60, kUnstated},
                                           Fact{"nlarion_mediapipe_walking.bvh", 21, 66, 37, 15, -71}));

}  // namespace
}  // namespace mocurate
