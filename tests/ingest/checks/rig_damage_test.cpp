// Contradictory or incomplete calibrations, and the PHSPD rig in two dialects.

#include <algorithm>

#include "core/formats/camera_files.h"
#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Json = nlohmann::json;

std::string Matrix(const std::string& key, int rows, int columns, const std::string& numbers) {
  return key + ": !!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: " + std::to_string(columns) +
         "\n   dt: d\n   data: [ " + numbers + " ]\n";
}

constexpr const char* kHead = "%YAML:1.0\n---\n";
constexpr const char* kNames = "names:\n   - a\n   - b\n";
const std::string kLens = "1000, 0, 500, 0, 1000, 400, 0, 0, 1";

std::string Intri() {
  return kHead + std::string(kNames) + Matrix("K_a", 3, 3, kLens) + Matrix("dist_a", 1, 5, "0, 0, 0, 0, 0") +
         Matrix("K_b", 3, 3, kLens) + Matrix("dist_b", 1, 5, "0, 0, 0, 0, 0");
}
std::string Extri() {
  return kHead + std::string(kNames) + Matrix("R_a", 3, 1, "0, 0, 0") + Matrix("T_a", 3, 1, "0, 0, 3") +
         Matrix("R_b", 3, 1, "0, 1, 0") + Matrix("T_b", 3, 1, "0, 0, 3");
}

std::string Without(std::string text, const std::string& key) {
  const std::size_t begin = text.find(key + ":");
  const std::size_t end = text.find("]\n", begin);
  return text.erase(begin, end + 2 - begin);
}

std::string With(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

class DamagedRigs : public WrittenFormats {
 protected:
  /// "code place" of the errors. A rig has several storages, so the field precedes the message.
  static std::vector<std::string> Fields(const Json& inspection) {
    std::vector<std::string> fields;
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("severity") != "error") continue;
      const std::string message = finding.at("message");
      fields.push_back(finding.at("code").get<std::string>() + " " + message.substr(0, message.find(": ")));
    }
    return fields;
  }
  std::vector<std::string> Errors(const std::string& name, const std::string& bytes) {
    return Fields(InspectPath(Written(name, bytes), std::nullopt));
  }
};

TEST_F(DamagedRigs, ReportTheContradictoryField) {
  const std::string rotated = "0.5403023, 0, 0.8414710, 0, 1, 0, -0.8414710, 0, 0.5403023";  // one radian about y
  Written("extri.yml", Extri() + Matrix("Rot_b", 3, 3, rotated));
  EXPECT_THAT(Errors("intri.yml", Intri()), IsEmpty()) << "the matrix matches its rotation vector";
  Written("extri.yml", Extri() + Matrix("Rot_a", 3, 3, rotated));
  EXPECT_THAT(Errors("intri.yml", Intri()), ElementsAre("malformed extri.yml"));
  Written("extri.yml", Extri());
  EXPECT_THAT(
      Errors("intri.yml", With(Intri(), "K_b: !!opencv-matrix\n   rows: 3", "K_b: !!opencv-matrix\n   rows: 2")),
      ElementsAre("malformed intri.yml:K_b"));
}

TEST_F(DamagedRigs, ReportAStorageWithADamagedFirstLine) {
  Written("intri.yml", Intri());
  Written("extri.yml", With(Extri(), "%YAML", "%YMAL"));
  for (const char* asked : {"intri.yml", "extri.yml"})
    EXPECT_THAT(Fields(InspectPath(folder_ / asked, std::nullopt)), ElementsAre("malformed extri.yml:1")) << asked;
  EXPECT_THAT(Fields(InspectPath(folder_, std::nullopt)), Contains("malformed extri.yml:1"));
}

TEST_F(DamagedRigs, ReportTheMissingFieldOfAnIncompleteCamera) {
  EXPECT_THAT(Errors("intri.yml", Intri()), ElementsAre("malformed intri.yml:R_a"));
  Written("extri.yml", Extri());
  const Json beside = InspectPath(folder_ / "intri.yml", std::nullopt);
  EXPECT_THAT(Codes(beside, "error"), IsEmpty()) << "the other file completes the cameras";
  EXPECT_EQ(beside.at("cameras").size(), 2u);
  EXPECT_THAT(Errors("intri.yml", Without(Intri(), "K_b")), ElementsAre("malformed intri.yml:K_b"));
  EXPECT_THAT(Errors("intri.yml", Without(Intri(), "dist_b")), ElementsAre("malformed intri.yml:dist_b"));
  Written("intri.yml", Intri());
  EXPECT_THAT(Errors("extri.yml", Without(Extri(), "T_b")), ElementsAre("malformed extri.yml:T_b"));
  Written("extri.yml", Extri());
  EXPECT_THAT(Errors("intri.yml", With(Intri(), kLens, "1000, 0, 500, 0, 1000, 400")),
              ElementsAre("malformed intri.yml:K_a"));
  EXPECT_THAT(Errors("intri.yml", With(Intri(), kNames, "")), ElementsAre("malformed intri.yml:names"));
  EXPECT_THAT(Errors("view.yml", kHead + Matrix("R", 3, 1, "0, 0, 0") + Matrix("t", 3, 1, "0, 0, 0")),
              ElementsAre("malformed view.yml:intrinsic"));
  EXPECT_EQ(Errors("other.yml", std::string(kHead) + "shape: 3\n").size(), 1u)
      << "inspected alone, the file is unknown";
}

TEST_F(DamagedRigs, ReportAMissingFieldInAFolderToo) {
  const char* rig = R"({"0": {"R": [[1,0,0],[0,1,0],[0,0,1]], "T": [[0],[0],[0]], "fy": 1, "cx": 1, "cy": 1,
                              "k": [[0],[0],[0]], "p": [[0],[0]]}})";
  EXPECT_THAT(Places(InspectPath(Written("rig.json", rig), std::nullopt)), ElementsAre("malformed rig.json:/0"));
  Written("notes.json", R"({"author": "a person")");
  const Json folder = InspectPath(folder_, std::nullopt);
  EXPECT_THAT(Places(folder), Contains("malformed rig.json:/0"));
  EXPECT_THAT(Codes(folder, "info"), ElementsAre("other_files")) << "notes.json is no calibration";
}

TEST_F(RecordedFormats, ReadThePhspdRigFromPickleAndText) {
  const std::string folder = TestData() + "/cameras/phspd/";
  const auto pickle = ParseCalibration(*ReadFile(folder + "CamParams0906.pkl"), "CamParams0906.pkl");
  const auto text = ParseCalibration(*ReadFile(folder + "phspd_rigs.json"), "phspd_rigs.json");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  ASSERT_TRUE(text);
  for (const CalibratedView& view : pickle->views) {
    EXPECT_EQ(view.world, "CamParams0906");
    const auto same = std::find_if(text->views.begin(), text->views.end(), [&](const CalibratedView& other) {
      return other.world == view.world && other.name == view.name;
    });
    ASSERT_NE(same, text->views.end()) << view.name;
    EXPECT_NEAR(same->fx, view.fx, 1e-6);
  }
  EXPECT_EQ(pickle->views.size(), 7u);
}

}  // namespace
}  // namespace mocurate
