// People in detector files: OpenPose and CMU Panoptic.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/formats/json_place.h"
#include "core/formats/openpose.h"
#include "core/formats/panoptic_bodies.h"
#include "tests/formats/damage.h"
#include "tests/formats/expect_error.h"
#include "tests/support/keypoints_equal.h"

namespace mocurate {
namespace {

using nlohmann::json;

Status ReadFrame(const std::string& bytes) { return StatusOf(ParseOpenPose(bytes, "f.json")); }

TEST(OpenPose, RoundTripsManyPeopleAndEmptyLists) {
  OpenPoseFrame frame;
  frame.people.resize(3);
  frame.people[0].pose = {{505.232, 431.63, 0.664216}, {0, 0, 0}, {-3.25, 1e-7, 1.0}};
  frame.people[2].pose.assign(25, {});
  const auto back = ParseOpenPose(WriteOpenPose(frame), "f.json");
  ASSERT_TRUE(back) << back.error().Message();
  EXPECT_TRUE(back->people == frame.people);
  EXPECT_TRUE(ParseOpenPose(R"({"people":[]})", "f.json")->people.empty());
}

TEST(OpenPose, NamesEveryDamagedField) {
  const json document = json::parse(R"({"people":[{"pose_keypoints_2d":[1,2,0.5,0,0,0]}]})");
  test::ExpectEveryDamagedFieldIsRejected(document, ReadFrame);
  ExpectMalformed(ReadFrame(R"({"people":[{"pose_keypoints_2d":[1,2,-0.5]}]})"),
                  "f.json:/people/0/pose_keypoints_2d/2");
  ExpectMalformed(ReadFrame(R"({"people":[{}]})"), "f.json:/people/0");
}

TEST(OpenPose, CountsAPointWithoutConfidenceAsUndetected) {
  const auto frame = ParseOpenPose(R"({"people":[{"pose_keypoints_2d":[1,2,0,3,4,0.5,0,0,0]}]})", "f.json");
  ASSERT_TRUE(frame) << frame.error().Message();
  EXPECT_EQ(frame->uncertain_points, 1);
  EXPECT_TRUE((frame->people[0].pose == std::vector<DetectedKeypoint>{{}, {3, 4, 0.5}, {}}));
}

TEST(OpenPose, CountsANonFinitePointAsUndetected) {
  const auto frame = ParseOpenPose(
      R"({"people":[{"pose_keypoints_2d":[NaN,2,0.5, 3,4,0.5, 1,-Infinity,0.5, null,null,0.5, NaN,NaN,0, 5,6,NaN]}]})",
      "f.json");
  ASSERT_TRUE(frame) << frame.error().Message();
  EXPECT_EQ(frame->not_finite, 4);
  EXPECT_TRUE((frame->people[0].pose == std::vector<DetectedKeypoint>{{}, {3, 4, 0.5}, {}, {}, {}, {}}));
}

TEST(JsonPlaces, NameThePlaceOfAnInvalidNumber) {
  const std::string name = "calib.json";
  const auto document = ParseLenientJson(R"({"NaN\"NaN": "NaN", "K": [1, NaN, -Infinity]})", name);
  ASSERT_TRUE(document) << document.error().Message();
  ExpectMalformed(NumbersAt({&*document, "", &name}, "K", 3), "calib.json:/K/1");
  ExpectMalformed(TableAt({&*document, "", &name}, "K", 3, 1), "calib.json:/K/1");
  EXPECT_TRUE(document->contains("NaN\"NaN"));
  EXPECT_FALSE(ParseLenientJson(R"({"K": [1, NaNa]})", name));
}

TEST(OpenPose, NamesEachPointOfALayoutOnce) {
  for (const KeypointLayout& layout : KeypointLayouts()) {
    std::vector<std::string> points = layout.points;
    std::sort(points.begin(), points.end());
    EXPECT_EQ(std::unique(points.begin(), points.end()), points.end()) << layout.name;
  }
  EXPECT_EQ(KeypointLayouts()[0].points.size(), 25u);
  EXPECT_EQ(KeypointLayouts()[0].Find("mid_hip"), 8);
  EXPECT_EQ(KeypointLayouts()[0].Find("left_heel"), 21);
  EXPECT_EQ(KeypointLayouts()[1].Find("right_heel"), 24);
  EXPECT_EQ(KeypointLayouts()[1].Find("upper_neck"), 17);
  EXPECT_EQ(KeypointLayouts()[2].Find("right_ankle"), 16);
  EXPECT_EQ(KeypointLayouts()[3].Find("left_ear"), 17);
  EXPECT_EQ(KeypointLayouts()[3].Find("mid_hip"), -1);
}

TEST(OpenPose, ReadsTrialsWithBystandersAndAnEmptyPerson) {
  MOCURATE_RECORDED(single, "pose2sim/single/cam01_json/cam01.0000.json");
  const auto frame = ParseOpenPose(single, "cam01.0000.json");
  ASSERT_TRUE(frame) << frame.error().Message();
  EXPECT_GE(frame->people.size(), 2u);
  EXPECT_EQ(frame->people[0].pose.size(), 25u);
  EXPECT_DOUBLE_EQ(frame->people[0].pose[0].u_px, 505.232);
  int empty = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(std::getenv("MOCURATE_DATA")) /
                                                               "pose2sim/two/cam01_json")) {
    const auto two = ParseOpenPose(*ReadFile(entry.path()), entry.path().string());
    ASSERT_TRUE(two) << two.error().Message();
    for (const OpenPosePerson& person : two->people) empty += person.pose.empty() ? 1 : 0;
    ASSERT_TRUE(ParseOpenPose(WriteOpenPose(*two), "again")->people == two->people);
  }
  EXPECT_EQ(empty, 1);
}

Status ReadBodies(const std::string& bytes) { return StatusOf(ParsePanopticBodies(bytes, "b.json")); }

TEST(PanopticBodies, NamesEveryDamagedField) {
  json body = {{"id", 0}, {"joints19", json::array()}};
  for (int i = 0; i < 76; ++i) body["joints19"].push_back(i % 4 == 3 ? 0.5 : i);
  const json document = {{"version", 0.7}, {"univTime", 5.5}, {"fpsType", "hd"}, {"bodies", {body}}};
  test::ExpectEveryDamagedFieldIsRejected(document, ReadBodies,
                                          [](const std::string& path) { return path == "/fpsType"; });
  json wrong = document;
  wrong["bodies"][0]["joints19"][3] = -0.5;
  ExpectMalformed(ReadBodies(wrong.dump()), "b.json:/bodies/0/joints19/3");
}

TEST(PanopticBodies, OfTheBandHaveHumanLimbLengths) {
  MOCURATE_RECORDED(first, "cameras/panoptic/160906_band1/body3DScene_00000168.json");
  std::vector<double> thighs_cm;
  double time_ms = 0.0;
  for (int f = 168; f <= 187; ++f) {
    const auto scene = ParsePanopticBodies(
        test::RecordedFile("cameras/panoptic/160906_band1/body3DScene_00000" + std::to_string(f) + ".json"), "b.json");
    ASSERT_TRUE(scene) << scene.error().Message();
    ASSERT_EQ(scene->bodies.size(), 3u);
    if (f > 168) {
      EXPECT_NEAR(scene->time_ms - time_ms, 33.36, 0.02);
    }
    time_ms = scene->time_ms;
    for (const PanopticBody& body : scene->bodies) {
      if (body.confidence[6] < 0 || body.confidence[7] < 0) continue;
      thighs_cm.push_back((body.position_cm[6] - body.position_cm[7]).norm());
    }
  }
  std::sort(thighs_cm.begin(), thighs_cm.end());
  EXPECT_NEAR(thighs_cm[thighs_cm.size() / 2], 43.1, 1.0);
}

}  // namespace
}  // namespace mocurate
