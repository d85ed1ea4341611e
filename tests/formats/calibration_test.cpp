// Calibrations of every dialect, read into one type.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/formats/camera_files.h"
#include "tests/formats/corruption.h"
#include "tests/formats/damage.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

std::vector<Camera> CamerasOf(const Calibration& calibration) {
  std::vector<Camera> cameras;
  for (const CalibratedView& view : calibration.views) {
    cameras.push_back(CameraOf(view, calibration.reading, calibration.metres_per_unit));
  }
  return cameras;
}

Status ReadCameras(const std::string& bytes) { return StatusOf(ParseCalibration(bytes, "c.json")); }

TEST(Calibration, ProjectsAlikeFromPose2SimXmlTomlAndJson) {
  MOCURATE_RECORDED(xml, "pose2sim/Calib.qca.txt");
  const auto qualisys = ParseCalibration(xml, "Calib.qca.txt");
  const auto toml = ParseCalibration(test::RecordedFile("pose2sim/Calib_converted.toml"), "Calib.toml");
  const auto plain = ParseCalibration(test::RecordedFile("pose2sim/calib_converted.json"), "calib.json");
  ASSERT_TRUE(qualisys && toml && plain)
      << (qualisys ? toml ? plain.error() : toml.error() : qualisys.error()).Message();
  EXPECT_EQ(qualisys->dialect, "qualisys");
  EXPECT_EQ(toml->dialect, "pose2sim_toml");
  EXPECT_EQ(plain->dialect, "plain_json");
  const std::vector<Camera> cameras = CamerasOf(*qualisys);
  ASSERT_EQ(cameras.size(), 4u);
  EXPECT_LT((cameras[2].Centre() - Vector3d(-3.217, 2.231, 2.088)).norm(), 1e-3);
  EXPECT_EQ(cameras[0].width, 1088);
  EXPECT_EQ(cameras[0].height, 1920);
  const std::vector<std::vector<Camera>> dialects = {CamerasOf(*toml), CamerasOf(*plain)};
  for (const std::vector<Camera>& others : dialects) {
    ASSERT_EQ(others.size(), 4u);
    for (std::size_t c = 0; c < 4; ++c) {
      for (const Vector3d& point : {Vector3d(0, 0, 0), Vector3d(-1, -1, 1.7), Vector3d(0.8, 0.4, 1)}) {
        const auto a = cameras[c].ProjectWorld(point);
        const auto b = others[c].ProjectWorld(point);
        ASSERT_TRUE(a && b);
        EXPECT_LT((*a - *b).norm(), 1e-3) << c;
      }
    }
  }
}

TEST(Calibration, NamesEveryDamagedAttributeOfAQualisysCamera) {
  const std::string text =
      R"(<?xml version="1.0"?><calibration><cameras><camera serial="a &amp; b"><fov_video left="0" top="0" right="99" bottom="49"/>
<transform r11="1" r12="0" r13="0" r21="0" r22="1" r23="0" r31="0" r32="0" r33="1" x="1000" y="0" z="0"/>
<intrinsic focalLengthU="6400" focalLengthV="6400" centerPointU="3200" centerPointV="1600" skew="0" radialDistortion1="0"
radialDistortion2="0" radialDistortion3="0" tangentalDistortion1="0" tangentalDistortion2="0"/></camera></cameras></calibration>)";
  const auto calibration = ParseCalibration(text, "q.txt");
  ASSERT_TRUE(calibration) << calibration.error().Message();
  EXPECT_EQ(calibration->views[0].name, "a & b");
  EXPECT_EQ(CamerasOf(*calibration)[0].Centre(), Vector3d(1, 0, 0));
  int attributes = 0;
  for (std::size_t at = text.find("fov_video"); (at = text.find("=\"", at)) != std::string::npos; ++attributes) {
    const std::size_t key = text.find_last_of(" \n", at) + 1;
    const std::string name = text.substr(key, at - key);
    at += 2;
    std::string damaged = text;
    damaged.replace(at, text.find('"', at) - at, "x");
    auto refused = ParseCalibration(damaged, "q.txt");
    ASSERT_FALSE(refused) << name;
    EXPECT_THAT(refused.error().where, HasSubstr(name));
    damaged = text;
    damaged.erase(key, text.find('"', at) + 1 - key);
    refused = ParseCalibration(damaged, "q.txt");
    ASSERT_FALSE(refused) << name;
    EXPECT_THAT(refused.error().where, HasSubstr(name));
  }
  EXPECT_EQ(attributes, 26);
  const auto altered = [&](const std::string& from, const std::string& to) {
    return ParseCalibration(Replaced(text, from, to), "q.txt");
  };
  ExpectError(altered("right=\"99\"", "right=\"0\""), ErrorCode::kInconsistent, "q.txt:1:fov_video/left, right");
  ExpectMalformed(altered("skew=", "focallength=\"9.3o\" skew="),
                  "q.txt:3:intrinsic/focallength");  // an optional field
  ExpectError(altered("r11=\"1\"", "r11=\"-1\""), ErrorCode::kInconsistent, "q.txt:2:transform/r11..r33");
}

TEST(Calibration, NamesEveryDamagedFieldOfAJsonDialect) {
  const json matrix = {{1000, 0, 500}, {0, 1000, 500}, {0, 0, 1}};
  const json rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const json column = {{1}, {2}, {3}};
  const json lens = {0.1, 0, 0, 0, 0.2};
  const json plain = {{"units", "mm"},
                      {"convention", "x_cam = R X_world + t"},
                      {"cameras",
                       {{{"name", "a"},
                         {"size", {100, 50}},
                         {"K", matrix},
                         {"dist_k1k2p1p2k3", {0.1, 0, 0, 0, 0}},
                         {"R", rotation},
                         {"t", {1, 2, 3}}}}}};
  // A lens has four or five coefficients: removing one of five is no damage.
  const auto fifth = [](const std::string& path) { return path.find("dist") != std::string::npos; };
  test::ExpectEveryDamagedFieldIsRejected(plain, ReadCameras, fifth);
  const json human = {{"intrinsics", {{"54138969", {{"calibration_matrix", matrix}, {"distortion", lens}}}}},
                      {"extrinsics", {{"S1", {{"54138969", {{"R", rotation}, {"t", column}}}}}}}};
  test::ExpectEveryDamagedFieldIsRejected(human, ReadCameras, fifth);
  const json campus = {{"0",
                        {{"R", rotation},
                         {"T", column},
                         {"fx", 400},
                         {"fy", 401},
                         {"cx", 180},
                         {"cy", 140},
                         {"k", {{0}, {0}, {0}}},
                         {"p", {{0}, {0}}}}}};
  test::ExpectEveryDamagedFieldIsRejected(campus, ReadCameras, [](const std::string& path) { return path == "/0/fx"; });
  const json panoptic = {{"cameras",
                          {{{"name", "00_01"},
                            {"type", "hd"},
                            {"resolution", {1920, 1080}},
                            {"K", matrix},
                            {"distCoef", lens},
                            {"R", rotation},
                            {"t", column}}}}};
  test::ExpectEveryDamagedFieldIsRejected(
      panoptic, ReadCameras, [](const std::string& path) { return path.find("distCoef") != std::string::npos; });
  const json pose = {1, 0, 0, 0, 10, 20, 30};
  const json params = {1000, 1000, 500, 500, 0, 0, 0};
  const json phspd = {{"units", "mm"},
                      {"rig",
                       {{"A",
                         {{"d1p", pose},
                          {"cd1", pose},
                          {"param_p", params},
                          {"param_d1", params},
                          {"param_c1", params},
                          {"p1w", {pose}}}}}}};
  test::ExpectEveryDamagedFieldIsRejected(phspd, ReadCameras, [](const std::string& path) { return path == "/units"; });
  json bad = phspd;
  bad["rig"]["A"]["d1p"][0] = 1.1;
  ExpectError(ReadCameras(bad.dump()), ErrorCode::kInconsistent, "c.json:/rig/A/d1p");
  bad = plain;
  bad["cameras"][0]["R"][2][2] = -1;
  ExpectError(ReadCameras(bad.dump()), ErrorCode::kInconsistent, "c.json:/cameras/0/R");
  bad = plain;
  bad["cameras"][0]["K"][0][1] = 3;
  ExpectMalformed(ReadCameras(bad.dump()), "c.json:/cameras/0/K");
}

TEST(Calibration, ReadsThePhspdRigOfTheRenderings) {
  MOCURATE_RECORDED(bytes, "cameras/phspd/phspd_rigs.json");
  const auto rigs = ParseCalibration(bytes, "rigs.json");
  ASSERT_TRUE(rigs) << rigs.error().Message();
  ASSERT_EQ(rigs->views.size(), 14u);
  const json rendering = json::parse(test::RecordedFile("clouds/rendered_body/male_tpose.json"));
  for (const CalibratedView& view : rigs->views) {
    if (view.world != "CamParams0906" || view.kind != "depth") continue;
    const Camera camera = CameraOf(view, PoseConvention::kWorldToCamera, 0.001);
    const json& truth = rendering["views"][view.name];
    EXPECT_NEAR(camera.camera_from_world.translation.z(), truth["t_m"][2].get<double>(), 1e-6);
    EXPECT_NEAR(camera.camera_from_world.rotation.toRotationMatrix()(0, 2), truth["R_p_to_d"][0][2].get<double>(),
                1e-6);
    EXPECT_NEAR(camera.fx, truth["fx_fy_cx_cy"][0].get<double>(), 1e-9);
  }
  EXPECT_EQ(rigs->subject_points.size(), 34u + 30 + 26 + 35 + 26 + 28);
}

TEST(Calibration, RecognisesEveryRecordedDialect) {
  const std::pair<const char*, std::pair<const char*, std::size_t>> files[] = {
      {"cameras/human36m/camera-parameters.json", {"human36m", 44}},
      {"cameras/campus_shelf/calibration_campus.json", {"campus_shelf", 3}},
      {"cameras/campus_shelf/calibration_shelf.json", {"campus_shelf", 5}},
      {"cameras/panoptic/calibration_160906_band1.json", {"panoptic", 520}}};
  for (const auto& [path, expected] : files) {
    MOCURATE_RECORDED(bytes, path);
    const auto calibration = ParseCalibration(bytes, path);
    ASSERT_TRUE(calibration) << calibration.error().Message();
    EXPECT_EQ(calibration->dialect, expected.first);
    EXPECT_EQ(calibration->views.size(), expected.second);
    EXPECT_EQ(calibration->reading, PoseConvention::kUnknown);
    EXPECT_EQ(calibration->metres_per_unit, 0.0);
  }
}

/// Expects kMalformed at a line or a column of it: "c.toml:2" or "c.toml:2:5".
template <class T>
void ExpectMalformedWithin(const Expected<T>& result, const std::string& place, const std::string& text) {
  ASSERT_FALSE(result) << text;
  EXPECT_EQ(result.error().code, ErrorCode::kMalformed) << text;
  EXPECT_EQ((result.error().where + ":").rfind(place + ":", 0), 0u) << text << " " << result.error().where;
}

TEST(Toml, RejectsSyntaxErrorsWithTheirPlace) {
  std::string key = "a";
  for (int i = 0; i < 60; ++i) key += ".a";
  std::string deep = "[" + key + "]\n" + key + " = 1\n[b]\n";
  for (int i = 0; i < 120; ++i) deep += key + " = [\n{";
  deep += key + " = 1";
  for (int i = 0; i < 120; ++i) deep += "}]";
  const std::pair<std::string, const char*> cases[] = {
      {"a = 1\na = 2\n", "c.toml:2"},
      {"[a]\n[a]\n", "c.toml:2"},
      {"a = [1, 2\n", "c.toml:1"},
      {"a = 1 2\n", "c.toml:1:7"},
      {"a = \"x\n", "c.toml:1"},
      {"a\n", "c.toml:1"},
      {"a = '\xFF'\n", "c.toml:1"},
      {"a = " + std::string(100, '['), "c.toml:1"},
      {deep, "c.toml:/a"},
      {"a." + key + "." + key + " = 1\n", "c.toml:1"},
      {"\u00e4 = 1", "c.toml:1"},
      {"a = \u0416", "c.toml:1"},
      {"a = '\u00e4' \u00e4", "c.toml:1"},
      {"[\u00e4]", "c.toml:1"},
      {"[*]", "c.toml:1"},
      {"b = 'it\u00e4' # \u00e4\n[c]\nname = \"\u00e4\"\n", "c.toml:/b"},
      {"[c]\nname = 2020-01-01\n", "c.toml:/c/name"},
      {"[c]\nname = 'c'\nsize = [nan, 1]\n", "c.toml:/c/size/0"}};
  for (const auto& [text, place] : cases) ExpectMalformedWithin(ParseCalibration(text, "c.toml"), place, text);
}

TEST(Toml, NamesEveryDamagedFieldOfAPose2SimCamera) {
  const std::string text =
      "[c]\nname = \"c\"\nsize = [ 10.0, 20.0,]\nmatrix = [ [ 5.0, 0.0, 1.0,], [ 0.0, 5.0, 2.0,], [ 0.0, 0.0, 1.0,],]\n"
      "distortions = [ 0.1, 0.2, 0.3, 0.4,]\nrotation = [ 1.0, 0.0, 0.0,]\ntranslation = [ 0.0, 0.0, 4.0,]\nfisheye = "
      "false\n";
  ASSERT_TRUE(ParseCalibration(text, "c.toml"));
  for (const char* key : {"name", "size", "matrix", "distortions", "rotation", "translation"}) {
    std::string damaged = text;
    damaged.replace(damaged.find(key), 1, "z");
    ExpectMalformed(ParseCalibration(damaged, "c.toml"), "c.toml:/c");
  }
  for (std::size_t at = text.find("10.0"); (at = text.find(".0", at)) != std::string::npos; ++at) {
    std::string damaged = text;
    damaged.insert(at, "?");
    const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
    ExpectMalformedWithin(ParseCalibration(damaged, "c.toml"), "c.toml:" + std::to_string(line), damaged);
  }
  ExpectError(ParseCalibration(Replaced(text, "false", "true"), "c.toml"), ErrorCode::kUnsupported,
              "c.toml:/c/fisheye");
}

TEST(Xml, RejectsSyntaxErrorsWithTheirLine) {
  std::string deep;
  for (int i = 0; i < 1'000'000; ++i) deep += "<a>";
  const std::pair<std::string, const char*> cases[] = {{"<!-- c --><a b='1'><c/>text<![CDATA[<d>]]></a>\n", "c.xml"},
                                                       {"<a>\n</b>", "c.xml:2"},
                                                       {"<a>\n<b>", "c.xml:2"},
                                                       {"<a>\n<c b='1' b='2'/></a>", "c.xml:2"},
                                                       {"<a/>\n<b/>", "c.xml:2"},
                                                       {"<a/>b", "c.xml:1"},
                                                       {"<!-- c -->", "c.xml"},
                                                       {"<a>\n\xFF</a>", "c.xml:2"},
                                                       {"<a>\n\x04</a>", "c.xml:2"},
                                                       {deep, "c.xml:1"}};
  for (const auto& [text, place] : cases) ExpectMalformed(ParseCalibration(text, "c.xml"), place);
}

}  // namespace
}  // namespace mocurate
