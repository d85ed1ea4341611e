#include "core/formats/bvh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>

namespace mocurate {
namespace {

using ::testing::HasSubstr;

/// Two joints; the second has a position channel on one axis only and another rotation order than the first.
std::string TwoJoints(const std::string& rows = "1 2 3 0 0 90  7 0 0 0\n4 5 6 0 0 0  8 0 90 0\n",
                      const std::string& frames = "2", const std::string& time = "0.5") {
  return "HIERARCHY\nROOT Hips\n{\n OFFSET 100 100 100\n CHANNELS 6 Xposition Yposition Zposition Xrotation Yrotation "
         "Zrotation\n JOINT Knee Left\n {\n  OFFSET 1 2 3\n  CHANNELS 4 Yposition Zrotation Yrotation Xrotation\n "
         "}\n}\n"
         "MOTION\nFrames: " +
         frames + "\nFrame Time: " + time + "\n" + rows;
}

std::string BvhFails(const std::string& text) {
  const auto parsed = ParseBvh(text, "clip.bvh");
  return parsed ? "parsed" : parsed.error().Message();
}

std::string WithReplaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::string ReadAll(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream content;
  content << file.rdbuf();
  return content.str();
}

TEST(Bvh, PositionChannelsReplaceOffsetComponentwise) {
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
  // The root is turned by 90 degrees about z: (1,7,3) becomes (-7,1,3).
  EXPECT_TRUE(positions[1].isApprox(Vector3d(1 - 7, 2 + 1, 3 + 3), 1e-12)) << positions[1].transpose();
}

TEST(Bvh, RotationsMultiplyInTheOrderOfTheJointsOwnChannels) {
  const auto bvh = ParseBvh(TwoJoints("0 0 0 10 20 30 0 40 50 60\n", "1"), "clip.bvh");
  ASSERT_TRUE(bvh);
  const double degree = M_PI / 180;
  EXPECT_TRUE(BvhLocalRotation(*bvh, 0, 0)
                  .isApprox(MatrixFromEuler(degree * Vector3d(10, 20, 30), *EulerOrder::Parse("XYZ")), 1e-12));
  EXPECT_TRUE(BvhLocalRotation(*bvh, 0, 1)
                  .isApprox(MatrixFromEuler(degree * Vector3d(40, 50, 60), *EulerOrder::Parse("ZYX")), 1e-12));
}

TEST(Bvh, WrittenAndReadAgainIsTheSame) {
  const auto bvh = ParseBvh(TwoJoints(), "clip.bvh");
  const auto again = ParseBvh(WriteBvh(*bvh), "again.bvh");
  ASSERT_TRUE(again) << again.error().Message();
  EXPECT_EQ(again->values, bvh->values);
  EXPECT_EQ(again->joints[1].channels, bvh->joints[1].channels);
  EXPECT_EQ(again->joints[1].offset, bvh->joints[1].offset);
  EXPECT_EQ(again->frame_time_s, bvh->frame_time_s);
  EXPECT_EQ(WriteBvh(*again), WriteBvh(*bvh));
}

TEST(Bvh, CarriageReturnsAndByteOrderMarkChangeNothing) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : TwoJoints()) text += c == '\n' ? "\r\n" : std::string(1, c);
  const auto bvh = ParseBvh(text, "clip.bvh");
  ASSERT_TRUE(bvh) << bvh.error().Message();
  EXPECT_EQ(bvh->values, ParseBvh(TwoJoints(), "clip.bvh")->values);
}

TEST(Bvh, TabsBetweenAllWordsChangeNothing) {
  std::string text = TwoJoints();
  std::replace(text.begin(), text.end(), ' ', '\t');
  const auto bvh = ParseBvh(text, "clip.bvh");
  ASSERT_TRUE(bvh) << bvh.error().Message();
  EXPECT_EQ(bvh->values, ParseBvh(TwoJoints(), "clip.bvh")->values);
}

TEST(Bvh, ACountOfFramesThatIsNoneIsAContradictionAsAnyOther) {
  for (const char* count : {"0", "-5", "1", "3", "99999999999"}) {
    const auto bvh =
        ParseBvh(TwoJoints("1 2 3 0 0 90 7 0 0 0\n4 5 6 0 0 0 1 2 3 4\n", count), "clip.bvh", DamagedRows::kReport);
    ASSERT_TRUE(bvh) << count << bvh.error().Message();
    EXPECT_EQ(bvh->frames, 2);
    ASSERT_EQ(bvh->findings.size(), 1u);
    EXPECT_EQ(bvh->findings[0].code, "count_contradiction");
    EXPECT_THAT(bvh->findings[0].message,
                HasSubstr("clip.bvh:13: Frames announces " + std::string(count).substr(0, 9)));
  }
}

TEST(Bvh, ThousandsOfJointsOfOneNameHideNoDamage) {
  std::string text = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n";
  for (int j = 0; j < 2000; ++j) text += "JOINT a\n{\nOFFSET 0 0 0\n}\n";
  text += "}\nMOTION\nFrames: 2\nFrame Time: 0.1\nx\ny\n";
  const auto bvh = ParseBvh(text, "clip.bvh", DamagedRows::kReport);
  ASSERT_FALSE(bvh);
  EXPECT_THAT(bvh.error().what, HasSubstr("'x' in frame 0"));
}

TEST(Bvh, AnAxisThatStandsTwiceIsRefusedWithItsLineItsJointAndTheOneThatIsMissing) {
  std::string text = "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n}\n";
  text += "MOTION\nFrames: 2\nFrame Time: 0.1\n1 2 3\n4 5 6\n";
  ASSERT_TRUE(ParseBvh(text, "clip.bvh"));
  text.replace(text.find("Xrotation"), 9, "Zrotation");
  const auto bvh = ParseBvh(text, "clip.bvh");
  ASSERT_FALSE(bvh);
  EXPECT_EQ(bvh.error().code, ErrorCode::kMalformed);
  EXPECT_EQ(bvh.error().where, "clip.bvh:5");
  EXPECT_EQ(bvh.error().what, "channel 'Zrotation' of joint 'hips' stands twice, Xrotation nowhere");
}

TEST(Bvh, EveryRefusalSaysAWayOut) {
  const std::string text = TwoJoints();
  for (const auto& [from, to] : {std::pair{"Frames: 2", "Frames: two"},
                                 {"Frame Time: ", "Frame Time: -"},
                                 {"Frame Time: ", "Frame Time: nan"},
                                 {"Frame Time: ", "Frame Time: 0,"},
                                 {"Frame Time: ", "FrameTime: "},
                                 {"MOTION\n", ""},
                                 {"OFFSET 1 2 3", "OFFSET 1 2"},
                                 {"OFFSET 1 2 3", "OFFSET 1 2 1e300"},
                                 {"CHANNELS 4", "CHANNELS 3"},
                                 {"JOINT", "JOINTS"}}) {
    const auto bvh = ParseBvh(WithReplaced(text, from, to), "clip.bvh", DamagedRows::kReport);
    ASSERT_FALSE(bvh) << to;
    EXPECT_THAT(bvh.error().where, HasSubstr("clip.bvh:")) << to;
    EXPECT_FALSE(bvh.error().hint.empty()) << to << ": " << bvh.error().what;
  }
  EXPECT_THAT(BvhFails(text.substr(0, text.find("MOTION") - 20)), HasSubstr("it is cut off"));
  EXPECT_THAT(BvhFails(std::string("\xFF\xFEH\0I\0", 6)), HasSubstr("the text is UTF-16: save it as UTF-8"));
  EXPECT_THAT(BvhFails(WithReplaced(text, "}\nMOTION", "MOTION")),
              HasSubstr("a '}' is missing before it, with 1 joint still"));
  EXPECT_THAT(BvhFails(WithReplaced(text, "}\nMOTION", "}\n}\nMOTION")), HasSubstr("one '}' too many"));
  EXPECT_THAT(BvhFails(WithReplaced(text, "}\nMOTION", "}\nROOT Other\n{\n}\nMOTION")),
              HasSubstr("a file has one ROOT"));
  const auto lacks = ParseBvh(WithReplaced(text, "CHANNELS 4 Yposition Zrotation Yrotation Xrotation", ""), "clip.bvh",
                              DamagedRows::kReport);
  ASSERT_FALSE(lacks);
  EXPECT_THAT(lacks.error().hint, HasSubstr("every row has 10 numbers: mend the CHANNELS"));
  EXPECT_THAT(lacks.error().hint, HasSubstr("joint 'Knee Left' has none"));
}

TEST(Bvh, BadInputIsRefusedWithPlaceAndReason) {
  EXPECT_EQ(BvhFails(""), "clip.bvh: the file is empty (copy it again)");
  EXPECT_THAT(BvhFails("%PDF"), HasSubstr("clip.bvh:1: a BVH file begins with HIERARCHY, not '%PDF'"));
  EXPECT_THAT(BvhFails(TwoJoints("1 2 3 0 0 90 7 0 0 0\n4 5 6 0\n")),
              HasSubstr("clip.bvh:16: frame 1 has 4 numbers, the hierarchy has 10 channels (the file is cut off"));
  EXPECT_THAT(BvhFails(TwoJoints("1 2 3 0 0 90 7 0 0 0\n")),
              HasSubstr("clip.bvh:13: Frames announces 2, the file holds 1 (the file is cut off"));
  EXPECT_THAT(BvhFails(TwoJoints("1 2 nan 0 0 90 7 0 0 0\n", "1")),
              HasSubstr("clip.bvh:15: 'nan' in frame 0, channel 2 is no finite number"));
  EXPECT_THAT(BvhFails(TwoJoints("1 2 x 0 0 90 7 0 0 0\n", "1")), HasSubstr("'x' in frame 0, channel 2"));
  EXPECT_THAT(BvhFails(WithReplaced(TwoJoints(), "Zrotation\n JOINT", "Wrotation\n JOINT")),
              HasSubstr("clip.bvh:5: unknown channel 'Wrotation' of joint 'Hips'"));
  EXPECT_THAT(BvhFails(WithReplaced(TwoJoints(), "CHANNELS 4", "CHANNELS 3")),
              HasSubstr("must say how many names follow"));
  EXPECT_THAT(BvhFails(TwoJoints("", "0")), HasSubstr("'Frames: 0' says so as well"));
  EXPECT_THAT(BvhFails(TwoJoints("1 2 3 0 0 90 7 0 0 0\n", "1", "0")), HasSubstr("frame time 0 s gives no frame rate"));
  EXPECT_THAT(BvhFails(TwoJoints("1 2 3 0 0 90 7 0 0 0\n", "1", "nan")), HasSubstr("gives no frame rate"));
  EXPECT_THAT(BvhFails(TwoJoints("1 2 3 0 0 90 7 0 0 0\n", "1", "1e-320")), HasSubstr("gives no frame rate"));
  EXPECT_THAT(BvhFails(TwoJoints("1\n", "99999999999999")), HasSubstr("has 1 numbers"));
  EXPECT_THAT(BvhFails(TwoJoints().substr(0, 150)), HasSubstr("clip.bvh:9: the file ends where"));
}

TEST(Bvh, CutOffAnywhereItIsRefusedNeverReadAsShorter) {
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

TEST_P(BvhExporters, ReadsAsItsFactsSay) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const Fact& fact = GetParam();
  const auto bvh = ParseBvh(ReadAll(std::string(data) + "/bvh/misc/" + fact.file), fact.file);
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
