// Cameras far from the rest of their rig, and implausible focal lengths.

#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class CameraPlaces : public ChangedFiles {
 protected:
  static Json Panoptic() { return Json::parse(Recorded("cameras/panoptic/calibration_160906_band1.json")); }
  static Json Human36m() { return Json::parse(Recorded("cameras/human36m/camera-parameters.json")); }

  /// Expects this as the only finding of a calibration.
  Json OnlyFinding(const Json& calibration) {
    const Json findings = Json(InspectPath(Written("cameras.json", calibration.dump()), std::nullopt)).at("findings");
    EXPECT_EQ(findings.size(), 1u) << findings;
    return findings.at(0);
  }
  void ExpectContradiction(const Json& calibration, double value, const std::string& camera) {
    const Json finding = OnlyFinding(calibration);
    EXPECT_EQ(finding.at("code"), "calibration_contradiction");
    EXPECT_EQ(finding.at("severity"), "error");
    EXPECT_NEAR(finding.at("value"), value, 0.01);
    EXPECT_THAT(finding.at("message"), HasSubstr("'" + camera + "'"));
  }

  static void TenTimes(Json& translation) {
    for (Json& row : translation) row[0] = 10.0 * row[0].get<double>();
  }
};

TEST_F(CameraPlaces, ReportTheCameraOfATenfoldTranslation) {
  Json dome = Panoptic();
  TenTimes(dome["cameras"][3]["t"]);
  ExpectContradiction(dome, 9.55, dome["cameras"][3]["name"]);
  Json rig = Human36m();
  TenTimes(rig["extrinsics"]["S1"]["54138969"]["t"]);
  ExpectContradiction(rig, 4.8, "54138969");
}

TEST_F(CameraPlaces, ReportAFocalLengthTenTimesTheOther) {
  Json dome = Panoptic();
  Json& matrix = dome["cameras"][3]["K"];
  matrix[0][0] = 10.0 * matrix[0][0].get<double>();
  ExpectContradiction(dome, 10.0, dome["cameras"][3]["name"]);
}

TEST_F(CameraPlaces, AreAcceptedForEveryRecordedRig) {
  const Json inspection = InspectPath(TestData() + "/cameras", std::nullopt);
  EXPECT_GT(inspection.at("cameras").size(), 500u);
  EXPECT_THAT(Codes(inspection, "error"), IsEmpty());
  EXPECT_THAT(Codes(inspection, "warning"), IsEmpty());
}

TEST_F(CameraPlaces, ReportInvalidCamerasWithTheirPlace) {
  Json rig = Human36m();
  Json& camera = rig["extrinsics"]["S1"]["54138969"];
  const Json sound = camera;
  const auto expect = [&](const Json& calibration, const char* place) {
    const Json finding = OnlyFinding(calibration);
    EXPECT_EQ(finding.at("code"), "malformed");
    EXPECT_EQ(finding.at("where"), place);
  };
  camera["R"][0][0] = 2.0;
  expect(rig, "cameras.json:/extrinsics/S1/54138969/R");
  camera = sound;
  camera.erase("t");
  expect(rig, "cameras.json:/extrinsics/S1/54138969");
  Json dome = Panoptic();
  dome["cameras"][3]["K"][0][0] = -1400;
  expect(dome, "cameras.json:/cameras/3/K");
}

}  // namespace
}  // namespace mocurate
