// Errors and places of OpenCV FileStorage calibrations. Recorded rigs: tests/ingest/declaration/calibration_test.cpp.

#include "core/formats/camera_files.h"

#include <gtest/gtest.h>

#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

std::string Matrix(const std::string& key, const std::string& numbers) {
  return key + ": !!opencv-matrix\n   rows: 1\n   cols: 1\n   dt: d\n   data: [ " + numbers + " ]\n";
}

const std::string kHead = "%YAML:1.0\n---\n";
const std::string kView = kHead + Matrix("intrinsic", "500, 0, 320, 0, 500, 240., 0, 0, 1") +
                          Matrix("R", "1, 0, 0, 0, 1, 0, 0, 0, 1") + Matrix("t", "1, 2,\n  3");

TEST(OpenCvStorage, ReadsTheSameViewFromXmlAndYaml) {
  const std::string xml =
      "<?xml version=\"1.0\"?>\n<opencv_storage>\n<intrinsic type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols>"
      "<data>\n 500 0. 320 0 500\n 240 0 0 1</data></intrinsic>\n<R type_id=\"opencv-matrix\"><data>1 0 0 0 1 0 0 0 1"
      "</data></R>\n<t type_id=\"opencv-matrix\"><data>1 2 3</data></t></opencv_storage>\n";
  for (const std::string& text : {kView, xml}) {
    const auto views = ParseOpenCvCalibration({{"folder/a.x", text}});
    ASSERT_TRUE(views) << views.error().Message();
    EXPECT_EQ(views->dialect, "opencv_views");
    ASSERT_EQ(views->views.size(), 1u);
    EXPECT_EQ(views->views[0].name, "a.x");
    EXPECT_EQ(views->views[0].cy, 240.0);
    EXPECT_EQ(views->views[0].translation, Vector3d(1, 2, 3));
  }
}

TEST(OpenCvStorage, AcceptsNamesThatAreNumbersOrContainBlanks) {
  const auto rig = [](const std::string& names) {
    std::string intrinsic = kHead + names, extrinsic = intrinsic;
    for (const std::string name : {"01", "b c"}) {
      intrinsic += Matrix("K_" + name, "500, 0, 320, 0, 500, 240, 0, 0, 1") + Matrix("dist_" + name, "0, 0, 0, 0");
      extrinsic += Matrix("R_" + name, "0, 0, 0") + Matrix("T_" + name, "0, 0, 1");
    }
    return std::vector<std::pair<std::string, std::string>>{{"i", intrinsic + "W_01: 640\n"}, {"e", extrinsic}};
  };
  for (const char* names : {"names: [01, \"b c\"]\n", "names:\n   - 01\n   - b c\n"}) {
    const auto calibration = ParseOpenCvCalibration(rig(names));
    ASSERT_TRUE(calibration) << calibration.error().Message();
    ASSERT_EQ(calibration->views.size(), 2u);
    EXPECT_EQ(calibration->views[0].name, "01");
    EXPECT_EQ(calibration->views[0].width, 640);
    EXPECT_EQ(calibration->views[1].name, "b c");
  }
  auto files = rig("names: [01]\n");
  files[0].second += "H_01: 1e30\n";
  ExpectMalformed(ParseOpenCvCalibration(files), "i:H_01");
}

TEST(OpenCvStorage, RejectsDamageWithItsPlace) {
  const std::pair<std::string, const char*> yaml[] = {
      {kView + "R: 1\n", "a.yml:R"},
      {kView + "junk\n", "a.yml:junk"},
      {kHead + "K: !!opencv-matrix\n   rows: 3\n", "a.yml:K"},
      {kHead + "K: !!opencv-matrix\n   ro", "a.yml:K"},
      {kHead + "K: {rows: 9223372036854775807, cols: 3, data: [.Nan]}\n", "a.yml:K"},
      {kHead + "K: {data: [[1]]}\n", "a.yml:K"},
      {kHead + "K: {data: [1, 2\n", "a.yml:4:1"},
      {kHead + "a: " + std::string(1'000'000, '['), "a.yml:3:1"},
      {kHead + "a: \xFF\n", "a.yml:3"},
      {kHead + "a: \x04\n", "a.yml:3"},
      {kHead + "K: {data: [1], data: [2]}\n", "a.yml:K:data"},
      {kHead + "a: 1\n---\na: 2\n", "a.yml"},
      {"names: [a]\n", "a.yml:1"}};
  for (const auto& [text, place] : yaml) ExpectMalformed(ParseOpenCvCalibration({{"a.yml", text}}), place);
  for (const auto& [text, place] :
       {std::pair{"<a>1</a><a>2</a>", "a.xml:a"}, {"<K type_id=\"opencv-matrix\"/>", "a.xml:K"}}) {
    const std::string storage = "<opencv_storage>" + std::string(text) + "</opencv_storage>";
    ExpectMalformed(ParseOpenCvCalibration({{"a.xml", storage}}), place);
  }
  ExpectError(ParseOpenCvCalibration({{"a.yml", kHead + "K: {rows: 2, cols: 3, data: [1, 2]}\n"}}),
              ErrorCode::kInconsistent, "a.yml:K");
  ExpectError(ParseOpenCvCalibration({{"a.yml", kHead + "- 1\n"}}), ErrorCode::kUnsupported, "a.yml");
  ExpectError(ParseOpenCvCalibration({{"a.yml", kHead + "a: [" + std::string(3 << 20, ',')}}), ErrorCode::kUnsupported,
              "a.yml");
  ExpectError(ParseOpenCvCalibration({}), ErrorCode::kUnsupported, "");
}

}  // namespace
}  // namespace mocurate
