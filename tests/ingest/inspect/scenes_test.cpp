// Reports of `mocurate inspect` on cameras, clouds and depth views, compared with known facts.

#include <gmock/gmock.h>

#include <map>

#include "tests/ingest/inspections.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::IsEmpty;

TEST_F(RecordedFormats, EstimateCameraConventions) {
  const Json inspection = Inspect("cameras");
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

TEST_F(RecordedFormats, ReadTurntableViewsAsOneRigAndCountImages) {
  const Json inspection = Inspect("rgbd100");
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

TEST_F(RecordedFormats, ReportNoUnitForAPartialScan) {
  const Json scan = Inspect("clouds/handheld_head");
  ASSERT_EQ(scan.at("clouds").size(), 1u);
  EXPECT_EQ(scan.at("clouds")[0].at("points"), 8611);
  EXPECT_EQ(scan.at("clouds")[0].at("triangles"), 16672);
  EXPECT_TRUE(Value(scan.at("clouds")[0], "units").is_null()) << "head and torso only: no body height";
}

TEST_F(RecordedFormats, ReadTheFrameOfRenderedStills) {
  const Json inspection = Inspect("clouds/rendered_body");
  ASSERT_EQ(inspection.at("clips").size(), 6u);
  for (const Json& clip : inspection.at("clips")) {
    EXPECT_EQ(clip.at("format"), "depth_still");
    EXPECT_EQ(Value(clip, "frames"), 1);
    ExpectFrame(clip, "m", "-y", "right");
  }
  EXPECT_EQ(inspection.at("companions")[0].at("facts").at("files"), 18.0);
}

}  // namespace
}  // namespace mocurate
