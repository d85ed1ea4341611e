// Reports of `mocurate inspect` on each motion format, compared with known facts of the recorded sets.

#include <gmock/gmock.h>

#include <map>

#include "tests/ingest/inspections.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST_F(RecordedFormats, ReadOneClipPerNtuBody) {
  const Json inspection = Inspect("ntu");
  ASSERT_EQ(inspection.at("clips").size(), 5u) << inspection.dump(1);
  std::map<std::string, int> frames;
  for (const Json& clip : inspection.at("clips")) {
    EXPECT_EQ(clip.at("format"), "ntu_skeleton");
    EXPECT_EQ(Value(clip, "joints"), 25);
    EXPECT_EQ(Value(clip, "skeleton"), "ntu25");
    ExpectFrame(clip, "m", "+y", "right");
    EXPECT_EQ(clip.at("units").at("measured").at("value"), "m");
    EXPECT_EQ(clip.at("up").at("measured").at("value"), "+y");
    EXPECT_EQ(Value(clip, "rate_hz"), 30.0) << "not in the file: the sensor has one rate";
    EXPECT_EQ(Value(clip, "missing_share"), 0.0);
    frames[clip.at("file")] = Value(clip, "frames");
    const bool shaking_hands = clip.at("file") == "S001C003P008R002A058.skeleton";
    EXPECT_EQ(Value(clip, "people"), shaking_hands ? 2 : 1);
    EXPECT_EQ(Value(clip, "people_per_frame"), (Json{{"min", shaking_hands ? 2 : 1}, {"max", shaking_hands ? 2 : 1}}));
  }
  EXPECT_EQ(frames, (std::map<std::string, int>{{"S001C001P001R001A011.skeleton", 82},
                                                {"S001C003P008R002A058.skeleton", 70},
                                                {"S002C001P003R001A003.skeleton", 100},
                                                {"S004C002P003R001A017.skeleton", 124}}));
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("code") != "inferred_joints") continue;
    EXPECT_GE(finding.at("value"), 0.04);
    EXPECT_LE(finding.at("value"), 0.19);
  }
  EXPECT_THAT(Codes(inspection, "error"), IsEmpty());
}

TEST_F(RecordedFormats, FindTheSkeletonOfAnAcclaimMotion) {
  const Json hdm05 = Inspect("hdm05");
  ASSERT_EQ(hdm05.at("clips").size(), 33u);
  int frames = 0;
  for (const Json& clip : hdm05.at("clips")) {
    frames += Value(clip, "frames").get<int>();
    EXPECT_EQ(Value(clip, "joints"), 31);
    EXPECT_EQ(Value(clip, "skeleton"), "cmu31");
    EXPECT_EQ(Value(clip, "rate_hz"), 120.0) << clip.at("id");
    ExpectFrame(clip, "2.2222222222222 inch", "+y", "right");
  }
  EXPECT_EQ(frames, 8245);
  EXPECT_THAT(Codes(hdm05, "error"), IsEmpty());
}

TEST_F(RecordedFormats, ReportAMotionWithoutItsSkeleton) {
  const Json inspection = Inspect("cmu/asf_amc");
  std::map<std::string, Json> clips;
  for (const Json& clip : inspection.at("clips")) clips[clip.at("id")] = clip;
  EXPECT_EQ(Value(clips.at("01_01.amc"), "frames"), 2751);
  EXPECT_EQ(clips.at("01_01.amc").at("facts").at("skeleton_file"), "01.asf");
  ExpectFrame(clips.at("01_01.amc"), "2.2222222222222 inch", "+y", "right");
  for (const auto& [name, frames] :
       std::map<std::string, int>{{"02_01.amc", 343}, {"07_01.amc", 316}, {"09_01.amc", 148}}) {
    EXPECT_EQ(Value(clips.at(name), "frames"), frames);
    ExpectFrame(clips.at(name), nullptr, nullptr, nullptr);
  }
  const std::vector<std::string> warnings = Codes(inspection, "warning");
  EXPECT_EQ(std::count(warnings.begin(), warnings.end(), "skeleton_missing"), 3);
}

TEST_F(RecordedFormats, ReadTheAmassRateAndEstimateItsFrame) {
  const Json inspection = Inspect("amass_babel/amass_sample.npz");
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
  const Json& clip = inspection.at("clips")[0];
  EXPECT_EQ(clip.at("format"), "amass");
  EXPECT_EQ(Value(clip, "frames"), 601);
  EXPECT_EQ(Value(clip, "rate_hz"), 120.0);
  EXPECT_EQ(Value(clip, "joints"), 52);
  EXPECT_EQ(clip.at("facts").at("gender"), "male");
  ExpectFrame(clip, "m", "+z", "right");
  EXPECT_EQ(clip.at("up").at("from"), "measured");
}

TEST_F(RecordedFormats, DoNotReadExponentialMapsAsPositions) {
  const Json inspection = Inspect("cmu/expmap");
  ASSERT_EQ(inspection.at("clips").size(), 5u);
  for (const Json& clip : inspection.at("clips")) {
    EXPECT_EQ(clip.at("format"), "expmap_table");
    EXPECT_EQ(Value(clip, "joints"), 38);
    ExpectFrame(clip, nullptr, nullptr, nullptr);
    EXPECT_TRUE(Value(clip, "rate_hz").is_null());
    EXPECT_THAT(clip.at("joints").at("evidence").get<std::string>(), HasSubstr("47"));
  }
}

TEST_F(RecordedFormats, ReadOneClipPerCameraOfDetections) {
  const Json inspection = Inspect("pose2sim");
  std::map<std::string, Json> clips;
  for (const Json& clip : inspection.at("clips")) clips[clip.at("id")] = clip;
  const auto people = [&](const std::string& id) { return Value(clips.at(id), "people_per_frame"); };
  EXPECT_EQ(people("single/cam01_json"), (Json{{"min", 2}, {"max", 3}}));
  EXPECT_EQ(people("single/cam02_json"), (Json{{"min", 2}, {"max", 2}}));
  EXPECT_EQ(people("single/cam03_json"), (Json{{"min", 1}, {"max", 1}}));
  EXPECT_EQ(people("two/cam01_json"), (Json{{"min", 2}, {"max", 4}}));
  EXPECT_EQ(people("two/cam02_json"), (Json{{"min", 3}, {"max", 3}}));
  EXPECT_EQ(Value(clips.at("single/cam01_json"), "frames"), 80);
  EXPECT_EQ(Value(clips.at("two/cam01_json"), "frames"), 60);
  int cameras = 0;
  for (const auto& [id, clip] : clips) {
    if (clip.at("format") != "openpose") continue;
    ++cameras;
    EXPECT_EQ(Value(clip, "skeleton"), "BODY_25B") << id;
    EXPECT_EQ(clip.at("skeleton").at("from"), "measured");
    ExpectFrame(clip, "px", nullptr, nullptr);
  }
  EXPECT_EQ(cameras, 16);
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("code") != "empty_person") continue;
    EXPECT_EQ(finding.at("where"), "two/cam01_json");
    EXPECT_EQ(finding.at("value"), 1.0);
  }
  EXPECT_EQ(Value(clips.at("opensim_ik_body25b.mot"), "frames"), 100);
  EXPECT_EQ(Value(clips.at("opensim_ik_body25b.mot"), "rate_hz"), 60.0);
  EXPECT_EQ(clips.at("opensim_ik_body25b.mot").at("facts").at("coordinates"), "62");
  ExpectFrame(clips.at("reference_3d_own_dlt.npz[single]"), "m", "+z", "right");
  EXPECT_EQ(Value(clips.at("reference_3d_own_dlt.npz[single]"), "skeleton"), "BODY_25B");
  EXPECT_EQ(inspection.at("cameras").size(), 12u);
  EXPECT_THAT(Codes(inspection, "error"), ::testing::ElementsAre("motionless_clip"))
      << "the reference is a standing person";
}

TEST_F(RecordedFormats, ReportNoWrongAnswerOnKinectTables) {
  struct Set {
    const char* folder;
    std::size_t clips;
    int frames;
    const char* units;
    const char* handedness;
    Json rate_hz;  ///< known only where the joint order identifies the set
  };
  for (const Set& set :
       {Set{"kinect/kard", 432, 51228, "mm", "left", {}}, Set{"kinect/msr_action3d", 448, 18883, "m", "right", 15.0},
        Set{"kinect/utkinect", 160, 4867, "m", "right", {}}, Set{"kinect/florence3d", 173, 3096, "mm", "right", {}},
        Set{"kinect/cad60", 3, 900, "mm", "right", 30.0}}) {
    SCOPED_TRACE(set.folder);
    std::size_t clips = 0;
    int frames = 0;
    const Json inspection = Inspect(set.folder);
    for (const Json& clip : inspection.at("clips")) {
      if (clip.at("file").get<std::string>().rfind("screen/", 0) == 0) continue;
      ++clips;
      frames += Value(clip, "frames").get<int>();
      EXPECT_EQ(Value(clip, "rate_hz"), set.rate_hz) << clip.at("rate_hz");
      EXPECT_THAT(clip.at("rate_hz").at("evidence").get<std::string>(), Not(IsEmpty()));
      const Json handedness = Value(clip, "handedness");
      EXPECT_TRUE(handedness.is_null() || handedness == set.handedness) << clip.at("id");
      EXPECT_EQ(Value(clip, "units"), set.units) << clip.at("id");
      EXPECT_EQ(Value(clip, "up"), "+y") << clip.at("id");
    }
    EXPECT_EQ(clips, set.clips);
    EXPECT_EQ(frames, set.frames);
    for (const Json& group : inspection.at("groups")) {
      const bool of_clips = group.at("folder") == "";
      EXPECT_TRUE(!of_clips || group.at("handedness").at("value") == set.handedness) << group;
    }
  }
}

}  // namespace
}  // namespace mocurate
