// What `mocurate inspect` says of each format, beside the facts that are known of the recorded sets.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/formats/babel.h"
#include "core/formats/humanact12_pickle.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/vibe_pickle.h"
#include "ingest/sense/inspect.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Json Value(const Json& entry, const char* field) { return entry.at(field).at("value"); }

std::vector<std::string> Codes(const Json& inspection, const std::string& severity) {
  std::vector<std::string> codes;
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("severity") == severity) codes.push_back(finding.at("code"));
  }
  return codes;
}

/// The recorded sets.
class RecordedFormats : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("MOCURATE_TEST_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_TEST_DATA is not set";
  }
  static Json Look(const std::string& path) {
    return InspectPath(fs::path(std::getenv("MOCURATE_TEST_DATA")) / path, std::nullopt);
  }
};

/// Files that the test writes.
class WrittenFormats : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              (std::string("formats_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path Written(const std::string& name, const std::string& bytes) {
    fs::create_directories((folder_ / name).parent_path());
    EXPECT_TRUE(WriteFile(folder_ / name, bytes));
    return folder_ / name;
  }
  fs::path folder_;
};

void ExpectFrame(const Json& clip, const Json& units, const Json& up, const Json& handedness) {
  EXPECT_EQ(Value(clip, "units"), units) << clip.at("id") << clip.at("units");
  EXPECT_EQ(Value(clip, "up"), up) << clip.at("id") << clip.at("up");
  EXPECT_EQ(Value(clip, "handedness"), handedness) << clip.at("id") << clip.at("handedness");
}

TEST_F(RecordedFormats, NtuFilesGiveAClipPerBody) {
  const Json inspection = Look("ntu");
  ASSERT_EQ(inspection.at("clips").size(), 5u) << inspection.dump(1);
  std::map<std::string, int> frames;
  for (const Json& clip : inspection.at("clips")) {
    EXPECT_EQ(clip.at("format"), "ntu_skeleton");
    EXPECT_EQ(Value(clip, "joints"), 25);
    EXPECT_EQ(Value(clip, "skeleton"), "ntu25");
    ExpectFrame(clip, "m", "+y", "right");
    EXPECT_EQ(clip.at("units").at("measured").at("value"), "m");
    EXPECT_EQ(clip.at("up").at("measured").at("value"), "+y");
    EXPECT_TRUE(Value(clip, "rate_hz").is_null()) << "the file does not say it";
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

TEST_F(RecordedFormats, AcclaimMotionsFindTheirSkeleton) {
  const Json hdm05 = Look("hdm05");
  ASSERT_EQ(hdm05.at("clips").size(), 33u);
  int frames = 0;
  for (const Json& clip : hdm05.at("clips")) {
    frames += Value(clip, "frames").get<int>();
    EXPECT_EQ(Value(clip, "joints"), 31);
    EXPECT_EQ(Value(clip, "skeleton"), "cmu31");
    EXPECT_EQ(Value(clip, "rate_hz"), 120.0) << clip.at("id");
    ExpectFrame(clip, "0.0564 m", "+y", "right");
  }
  EXPECT_EQ(frames, 8245);
  EXPECT_THAT(Codes(hdm05, "error"), IsEmpty());
}

TEST_F(RecordedFormats, AMotionWithoutItsSkeletonSaysSo) {
  const Json inspection = Look("cmu/asf_amc");
  std::map<std::string, Json> clips;
  for (const Json& clip : inspection.at("clips")) clips[clip.at("id")] = clip;
  EXPECT_EQ(Value(clips.at("01_01.amc"), "frames"), 2751);
  EXPECT_EQ(clips.at("01_01.amc").at("facts").at("skeleton_file"), "01.asf");
  ExpectFrame(clips.at("01_01.amc"), "0.0564 m", "+y", "right");
  for (const auto& [name, frames] :
       std::map<std::string, int>{{"02_01.amc", 343}, {"07_01.amc", 316}, {"09_01.amc", 148}}) {
    EXPECT_EQ(Value(clips.at(name), "frames"), frames);
    ExpectFrame(clips.at(name), nullptr, nullptr, nullptr);
  }
  const std::vector<std::string> warnings = Codes(inspection, "warning");
  EXPECT_EQ(std::count(warnings.begin(), warnings.end(), "skeleton_missing"), 3);
}

TEST_F(RecordedFormats, AmassSaysItsRateAndItsMarkersShowTheFrame) {
  const Json inspection = Look("amass_babel/amass_sample.npz");
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
  const Json& clip = inspection.at("clips")[0];
  EXPECT_EQ(clip.at("format"), "amass");
  EXPECT_EQ(Value(clip, "frames"), 601);
  EXPECT_EQ(Value(clip, "rate_hz"), 120.0);
  EXPECT_EQ(Value(clip, "joints"), 52);
  EXPECT_EQ(clip.at("facts").at("gender"), "male");
  ExpectFrame(clip, "m", "+z", "right");
  EXPECT_EQ(clip.at("up").at("from"), "measured");
  EXPECT_THAT(Codes(inspection, "info"), Contains("markers_missing"));
}

TEST_F(RecordedFormats, ExponentialMapsAreNoPositions) {
  const Json inspection = Look("cmu/expmap");
  ASSERT_EQ(inspection.at("clips").size(), 5u);
  for (const Json& clip : inspection.at("clips")) {
    EXPECT_EQ(clip.at("format"), "expmap_table");
    EXPECT_EQ(Value(clip, "joints"), 38);
    ExpectFrame(clip, nullptr, nullptr, nullptr);
    EXPECT_TRUE(Value(clip, "rate_hz").is_null());
    EXPECT_THAT(clip.at("joints").at("evidence").get<std::string>(), HasSubstr("47 numbers of them constant"));
  }
}

TEST_F(RecordedFormats, DetectionsAreOneClipPerCamera) {
  const Json inspection = Look("pose2sim");
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
  EXPECT_THAT(Codes(inspection, "error"), IsEmpty());
}

TEST_F(RecordedFormats, CamerasSayWhatTheirNumbersMean) {
  const Json inspection = Look("cameras");
  struct Rig {
    int cameras;
    std::string units, reading, up;
  };
  const std::map<std::string, Rig> rigs = {
      {"campus_shelf/calibration_campus.json", {3, "mm", "centre", "+z"}},
      {"campus_shelf/calibration_shelf.json", {5, "mm", "centre", "+z"}},
      {"human36m/camera-parameters.json", {44, "mm", "world_to_camera", "+z"}},
      {"panoptic/calibration_160906_band1.json", {520, "cm", "world_to_camera", "-y"}},
      {"phspd/phspd_rigs.json", {14, "mm", "world_to_camera", "-y"}},
      {"phspd/CamParams0906.pkl", {7, "mm", "world_to_camera", "-y"}},
      {"phspd/CamParams0909.pkl", {7, "mm", "world_to_camera", "-y"}},
      {"easymocap", {11, "m", "world_to_camera", "+z"}},
      {"opencv_yml", {4, "m", "world_to_camera", "+z"}}};
  std::map<std::string, int> counts;
  for (const Json& camera : inspection.at("cameras")) {
    const auto rig = rigs.find(camera.at("file"));
    ASSERT_NE(rig, rigs.end()) << camera.dump();
    ++counts[rig->first];
    EXPECT_EQ(Value(camera, "units"), rig->second.units) << rig->first;
    EXPECT_EQ(Value(camera, "reading"), rig->second.reading) << rig->first;
    EXPECT_EQ(Value(camera, "up"), rig->second.up) << rig->first;
    if (camera.at("id") != "54138969") continue;
    EXPECT_EQ(Value(camera, "image_size"), (Json{1000, 1002}));
  }
  for (const auto& [name, rig] : rigs) EXPECT_EQ(counts[name], rig.cameras) << name;
  ASSERT_EQ(inspection.at("clips").size(), 3u);
  for (const Json& clip : inspection.at("clips")) {
    EXPECT_EQ(clip.at("format"), "panoptic_bodies");
    EXPECT_EQ(Value(clip, "frames"), 20);
    EXPECT_EQ(Value(clip, "people"), 3);
    EXPECT_NEAR(Value(clip, "rate_hz"), 29.97, 0.01);
    ExpectFrame(clip, "cm", "-y", "right");
  }
}

TEST_F(RecordedFormats, TurntableViewsAreOneRigAndImagesAreCounted) {
  const Json inspection = Look("rgbd100");
  ASSERT_EQ(inspection.at("cameras").size(), 80u);
  EXPECT_EQ(inspection.at("format"), "opencv_views");
  EXPECT_EQ(Value(inspection.at("cameras")[0], "reading"), "camera_to_world");
  EXPECT_EQ(Value(inspection.at("cameras")[0], "units"), "m");
  EXPECT_EQ(Value(inspection.at("cameras")[0], "up"), "-y");
  std::map<std::string, Json> images;
  for (const Json& image : inspection.at("companions")) images[image.at("format")] = image.at("facts");
  EXPECT_EQ(images.at("png"),
            (Json{{"files", 80.0}, {"width", 640.0}, {"height", 480.0}, {"bits", 16.0}, {"channels", 1.0}}));
  EXPECT_EQ(images.at("jpeg"), (Json{{"files", 80.0}}));
  ASSERT_EQ(inspection.at("clouds").size(), 2u);
  EXPECT_TRUE(Value(inspection.at("clouds")[0], "units").is_null());
  EXPECT_THAT(Codes(inspection, "error"), IsEmpty());
}

TEST_F(RecordedFormats, MeshesTellTheirUnitByAPersonsHeight) {
  const Json body = Look("body_cc0/male_tpose.obj").at("clouds").at(0);
  EXPECT_EQ(body.at("points"), 13380);
  EXPECT_EQ(body.at("triangles"), 26756);
  EXPECT_NEAR(Value(body, "extent")[1].get<double>(), 1.737, 1e-3);
  EXPECT_EQ(Value(body, "units"), "m");
  const Json scan = Look("clouds/handheld_head");
  ASSERT_EQ(scan.at("clouds").size(), 1u);
  EXPECT_EQ(scan.at("clouds")[0].at("points"), 8611);
  EXPECT_EQ(scan.at("clouds")[0].at("triangles"), 16672);
  EXPECT_TRUE(Value(scan.at("clouds")[0], "units").is_null()) << "head and torso: no person's height";
}

TEST_F(RecordedFormats, RenderedMomentsSayTheirFrame) {
  const Json inspection = Look("clouds/rendered_body");
  ASSERT_EQ(inspection.at("clips").size(), 6u);
  for (const Json& clip : inspection.at("clips")) {
    EXPECT_EQ(clip.at("format"), "depth_still");
    EXPECT_EQ(Value(clip, "frames"), 1);
    ExpectFrame(clip, "m", "-y", "right");
  }
  EXPECT_EQ(inspection.at("companions")[0].at("facts").at("files"), 18.0);
}

TEST_F(RecordedFormats, NothingTellsTheRateOfKinectTablesAndNoAnswerIsWrong) {
  struct Set {
    const char* folder;
    std::size_t clips;
    int frames;
    const char* units;
    const char* handedness;
  };
  for (const Set& set :
       {Set{"kinect/kard", 432, 51228, "mm", "left"}, Set{"kinect/msr_action3d", 448, 18883, "m", "right"},
        Set{"kinect/utkinect", 160, 4867, "m", "right"}, Set{"kinect/florence3d", 173, 3096, "mm", "right"},
        Set{"kinect/cad60", 3, 900, "mm", "right"}}) {
    SCOPED_TRACE(set.folder);
    std::size_t clips = 0;
    int frames = 0;
    const Json inspection = Look(set.folder);
    for (const Json& clip : inspection.at("clips")) {
      if (clip.at("file").get<std::string>().rfind("screen/", 0) == 0) continue;
      ++clips;
      frames += Value(clip, "frames").get<int>();
      EXPECT_TRUE(Value(clip, "rate_hz").is_null());
      EXPECT_THAT(clip.at("rate_hz").at("evidence").get<std::string>(), Not(IsEmpty()));
      EXPECT_TRUE(set.clips < 5 || Value(clip, "handedness") == set.handedness) << clip.at("id");
      EXPECT_EQ(Value(clip, "units"), set.units) << clip.at("id");
      EXPECT_EQ(Value(clip, "up"), "+y") << clip.at("id");
    }
    EXPECT_EQ(clips, set.clips);
    EXPECT_EQ(frames, set.frames);
  }
}

TEST_F(WrittenFormats, BabelTellsItsSegmentsAndTimesThatCannotBe) {
  BabelSequence sequence;
  sequence.key = "7692";
  sequence.babel_sid = 7692;
  sequence.url = "https://example.org/007692.mp4";
  sequence.feat_p = "CMU/CMU/01/01_01_poses.npz";
  sequence.dur = 6.5;
  BabelAnnotation annotation;
  annotation.babel_lid = "1";
  annotation.anntr_id = "2";
  annotation.mul_act = true;
  for (const auto& [start, end] : {std::pair{0.0, 2.5}, {2.5, 6.0}, {5.0, 4.0}}) {
    BabelLabel label;
    label.raw_label = label.proc_label = "walk";
    label.act_cat = std::vector<std::string>{"walk"};
    label.seg_id = "s" + std::to_string(start);
    label.start_t = start;
    label.end_t = end;
    annotation.labels.push_back(label);
  }
  sequence.frame_anns = {annotation};
  BabelAnnotation whole = annotation;
  whole.labels = {annotation.labels[0]};
  whole.labels[0].start_t.reset();
  whole.labels[0].end_t.reset();
  sequence.seq_anns = {whole};
  const Json inspection = InspectPath(Written("train.json", EncodeBabel({sequence})), std::nullopt);
  ASSERT_EQ(inspection.at("companions").size(), 1u) << inspection.dump(1);
  EXPECT_EQ(inspection.at("format"), "babel");
  const Json& facts = inspection.at("companions")[0].at("facts");
  EXPECT_EQ(facts.at("sequences"), 1.0);
  EXPECT_EQ(facts.at("segments"), 3.0);
  EXPECT_EQ(facts.at("sequence_labels"), 1.0);
  EXPECT_EQ(facts.at("duration_s"), 6.5);
  EXPECT_EQ(facts.at("segments_s"), 6.0);
  EXPECT_THAT(Codes(inspection, "warning"), ::testing::ElementsAre("babel_times"));
}

/// A person of 24 joints that sways.
std::vector<double> StandingPerson(std::size_t frames) {
  constexpr double kRest[24][3] = {{0, 0, 0},           {0.06, 0.09, 0},      {-0.06, 0.09, 0},    {0, -0.12, 0},
                                   {0.1, 0.47, -0.02},  {-0.1, 0.47, -0.02},  {0, -0.25, 0},       {0.1, 0.87, 0},
                                   {-0.1, 0.87, 0},     {0, -0.31, 0},        {0.11, 0.93, -0.12}, {-0.11, 0.93, -0.12},
                                   {0, -0.52, 0},       {0.08, -0.42, 0},     {-0.08, -0.42, 0},   {0, -0.62, -0.04},
                                   {0.19, -0.46, 0},    {-0.19, -0.46, 0},    {0.25, -0.21, 0},    {-0.25, -0.21, 0},
                                   {0.27, 0.02, -0.05}, {-0.27, 0.02, -0.05}, {0.28, 0.1, -0.06},  {-0.28, 0.1, -0.06}};
  std::vector<double> xyz;
  for (std::size_t f = 0; f < frames; ++f) {
    const double sway = 0.05 * static_cast<double>(f) / static_cast<double>(frames);
    for (const auto& joint : kRest) xyz.insert(xyz.end(), {joint[0] + sway, joint[1], joint[2]});
  }
  return xyz;
}

TEST_F(WrittenFormats, HumanAct12sPickleIsAClipPerEntry) {
  std::vector<HumanAct12Clip> clips(2);
  for (std::size_t i = 0; i < clips.size(); ++i) {
    clips[i].frames = 20 + i;
    clips[i].poses.assign(clips[i].frames * 72, 0.0);
    clips[i].joints = StandingPerson(clips[i].frames);
    clips[i].label = static_cast<int>(3 + i);
  }
  const auto bytes = EncodeHumanAct12Pickle(clips, "poses");
  ASSERT_TRUE(bytes);
  const Json inspection = InspectPath(Written("humanact12poses.pkl", *bytes), std::nullopt);
  ASSERT_EQ(inspection.at("clips").size(), 2u) << inspection.dump(1);
  const Json& clip = inspection.at("clips")[1];
  EXPECT_EQ(clip.at("format"), "humanact12_pickle");
  EXPECT_EQ(Value(clip, "frames"), 21);
  EXPECT_EQ(Value(clip, "skeleton"), "smpl24");
  EXPECT_EQ(clip.at("facts").at("label"), "4");
  ExpectFrame(clip, "m", "-y", "right");
}

TEST_F(WrittenFormats, VibesTracksAndCachesAreClips) {
  VibeTrack track;
  track.id = 7;
  track.frames = 12;
  track.joints = 49;
  track.pose.assign(12 * 72, 0.0);
  track.joints3d.assign(12 * 49 * 3, 0.0);
  for (std::size_t i = 0; i < track.joints3d.size(); ++i) track.joints3d[i] = 0.001 * static_cast<double>(i % 147);
  track.betas.assign(12 * 10, 0.0);
  for (std::int64_t f = 0; f < 12; ++f) track.frame_ids.push_back(f);
  const auto tracks = EncodeVibeTracks({track}, "tracks");
  ASSERT_TRUE(tracks) << tracks.error().Message();
  const Json one = InspectPath(Written("vibe_output.pkl", *tracks), std::nullopt);
  ASSERT_EQ(one.at("clips").size(), 1u) << one.dump(1);
  EXPECT_EQ(one.at("clips")[0].at("format"), "vibe_tracks");
  EXPECT_EQ(one.at("clips")[0].at("facts").at("track"), "7");
  EXPECT_EQ(Value(one.at("clips")[0], "joints"), 49);
  const auto cache = EncodeVibeCache({track, track}, "cache");
  ASSERT_TRUE(cache) << cache.error().Message();
  const Json two = InspectPath(Written("vibe_cache_refined.pkl", *cache), std::nullopt);
  ASSERT_EQ(two.at("clips").size(), 2u) << two.dump(1);
  EXPECT_EQ(Value(two.at("clips")[1], "frames"), 12);
}

TEST_F(WrittenFormats, JointsThatAreNotTrackedAreMissing) {
  NtuSkeleton skeleton;
  skeleton.frames.resize(4);
  for (std::size_t f = 0; f < 2; ++f) {
    NtuBody body;
    body.id = 72057594037931101ULL;
    for (std::size_t j = 0; j < body.joints.size(); ++j) {
      body.joints[j].y_m = 0.1 * static_cast<double>(j);
      body.joints[j].tracking = j < 5 ? 0 : 2;
    }
    skeleton.frames[f].push_back(body);
  }
  const Json inspection =
      InspectPath(Written("S001C001P001R001A001.skeleton", WriteNtuSkeleton(skeleton)), std::nullopt);
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
  const Json& clip = inspection.at("clips")[0];
  EXPECT_EQ(clip.at("facts").at("body"), "72057594037931101");
  EXPECT_EQ(Value(clip, "missing_share"), 0.6) << "5 of 25 joints in half of the frames, 25 in the other half";
  EXPECT_EQ(Value(clip, "people_per_frame"), (Json{{"min", 0}, {"max", 1}}));
  EXPECT_THAT(Codes(inspection, "warning"), Contains("many_missing"));
}

TEST_F(WrittenFormats, ADamagedFileOfEveryKindIsAnErrorWithItsPlace) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"cut.skeleton", "2\n1\n72057594037931101 0 1 1 1 1 0 0.1 0.1 2\n25\n0 0 1 0 0 0 0 0 0 0 0 2\n"},
      {"cut.ply",
       "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 "
       "0\n"},
      {"cut.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n"},
      {"cut.mot", "Coordinates\nversion=1\nnRows=2\nnColumns=2\ninDegrees=yes\nendheader\ntime\ta\n0\t1\n"},
      {"cut.asf", ":version 1.10\n:name x\n:units\n  length 0.45\n  angle deg\n:root\n  order TX nothing\n"},
      {"cut.pkl", std::string("\x80\x02}q", 4)}};
  for (const auto& [name, bytes] : files) {
    const Json inspection = InspectPath(Written(name, bytes), std::nullopt);
    EXPECT_TRUE(inspection.at("clips").empty()) << name;
    EXPECT_THAT(Codes(inspection, "error"), ::testing::SizeIs(1)) << name << inspection.dump(1);
    EXPECT_THAT(inspection.at("findings").dump(), HasSubstr(name));
  }
}

}  // namespace
}  // namespace mocurate
