// Calibrations of OpenCV's FileStorage: errors and their places. Recorded rigs are in
// tests/ingest/view_source_test.cpp.

#include "core/formats/opencv_storage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/formats/json_place.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

std::string Matrix(const std::string& key, const std::string& numbers) {
  return key + ": !!opencv-matrix\n   rows: 1\n   cols: 1\n   dt: d\n   data: [ " + numbers + " ]\n";
}

const std::string kHead = "%YAML:1.0\n---\n";
const std::string kView = kHead + Matrix("intrinsic", "500, 0, 320, 0, 500, 240., 0, 0, 1") +
                          Matrix("R", "1, 0, 0, 0, 1, 0, 0, 0, 1") + Matrix("t", "1, 2,\n  3");

std::string MessageOf(const std::vector<std::pair<std::string, std::string>>& storages) {
  const auto calibration = ParseOpenCvCalibration(storages);
  return calibration ? "parsed" : calibration.error().Message();
}

TEST(OpenCvStorage, XmlAndYamlGiveTheSameView) {
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

TEST(OpenCvStorage, NamesMayBeNumbersOrHoldBlanks) {
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
  EXPECT_EQ(MessageOf(files), "i:H_01: 1e+30 is no size in pixels");
}

TEST(OpenCvStorage, RefusesDamageWithItsPlace) {
  const auto yaml = [](const std::string& text) { return MessageOf({{"a.yml", kHead + text}}); };
  const auto xml = [](const std::string& text) {
    return MessageOf({{"a.xml", "<opencv_storage>" + text + "</opencv_storage>"}});
  };
  EXPECT_THAT(MessageOf({{"a.yml", kView + "R: 1\n"}}), HasSubstr("a.yml:R: the key stands twice"));
  EXPECT_THAT(xml("<a>1</a><a>2</a>"), HasSubstr("a.xml:a: the key stands twice"));
  EXPECT_THAT(yaml("K: !!opencv-matrix\n   rows: 3\n"), HasSubstr("a.yml:K: the data are missing"));
  EXPECT_THAT(yaml("K: !!opencv-matrix\n   ro"), HasSubstr("a.yml:K: the data are missing"));
  EXPECT_THAT(MessageOf({{"a.yml", kView + "junk\n"}}), HasSubstr("a.yml:junk: the data are missing"));
  EXPECT_THAT(xml("<K type_id=\"opencv-matrix\"/>"), HasSubstr("a.xml:K: the data are missing"));
  EXPECT_THAT(yaml("K: {rows: 2, cols: 3, data: [1, 2]}\n"), HasSubstr("a.yml:K: 2 rows of 3, 6 numbers, are"));
  EXPECT_THAT(yaml("K: {rows: 9223372036854775807, cols: 3, data: [.Nan]}\n"), HasSubstr("'.Nan' is no finite number"));
  EXPECT_THAT(yaml("K: {data: [[1]]}\n"), HasSubstr("a.yml:K: a list of values is expected"));
  EXPECT_THAT(yaml("K: {data: [1, 2\n"), HasSubstr("the file is no YAML"));
  EXPECT_THAT(yaml("a: " + std::string(1'000'000, '[')), HasSubstr("a.yml:3:"));
  EXPECT_THAT(yaml("a: \xFF\n"), HasSubstr("a.yml:3: a byte is not UTF-8"));
  EXPECT_THAT(yaml("a: \x04\n"), HasSubstr("a.yml:3: a control character"));
  EXPECT_THAT(yaml("K: {data: [1], data: [2]}\n"), HasSubstr("a.yml:K:data: the key stands twice"));
  EXPECT_THAT(yaml("a: 1\n---\na: 2\n"), HasSubstr("a.yml: one YAML document is expected"));
  EXPECT_THAT(yaml("- 1\n"), HasSubstr("a.yml: the storage is no calibration"));
  EXPECT_THAT(MessageOf({{"a.yml", "names: [a]\n"}}), HasSubstr("a.yml:1: the storage begins with neither"));
  EXPECT_THAT(MessageOf({}), HasSubstr("no calibration"));
}

}  // namespace
}  // namespace mocurate
