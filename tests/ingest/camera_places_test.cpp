// A camera of a rig that is not where the others are, and numbers of lenses that nobody makes.

#include <gmock/gmock.h>

#include "core/formats/amass.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class CameraPlaces : public WrittenFormats {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
    WrittenFormats::SetUp();
  }

  static Json Recorded(const std::string& name) { return Json::parse(*ReadFile(TestData() + "/cameras/" + name)); }
  static Json Panoptic() { return Recorded("panoptic/calibration_160906_band1.json"); }
  static Json Human36m() { return Recorded("human36m/camera-parameters.json"); }

  std::vector<std::string> Messages(const Json& calibration) {
    std::vector<std::string> messages;
    const Json inspection = InspectPath(Written("cameras.json", calibration.dump()), std::nullopt);
    for (const Json& finding : inspection.at("findings")) messages.push_back(finding.at("message"));
    return messages;
  }

  static void TenTimes(Json& translation) {
    for (Json& row : translation) row[0] = 10.0 * row[0].get<double>();
  }
};

TEST_F(CameraPlaces, OneTranslationThatIsTenTimesAsLongIsToldOfItsCamera) {
  Json dome = Panoptic();
  TenTimes(dome["cameras"][3]["t"]);
  const std::string name = dome["cameras"][3]["name"];
  EXPECT_THAT(Messages(dome), ElementsAre(HasSubstr("camera '" + name + "' stands ")));
  Json rig = Human36m();
  TenTimes(rig["extrinsics"]["S1"]["54138969"]["t"]);
  EXPECT_THAT(Messages(rig), ElementsAre(HasSubstr("camera '54138969' of 'S1' stands ")));
}

TEST_F(CameraPlaces, OneFocalLengthThatIsTenTimesTheOtherMakesNoPixel) {
  Json dome = Panoptic();
  Json& matrix = dome["cameras"][3]["K"];
  matrix[0][0] = 10.0 * matrix[0][0].get<double>();
  EXPECT_THAT(Messages(dome), ElementsAre(HasSubstr("times as long as wide: mend one of them")));
}

TEST_F(CameraPlaces, EveryRecordedRigIsWhereItIs) {
  const Json inspection = InspectPath(TestData() + "/cameras", std::nullopt);
  EXPECT_GT(inspection.at("cameras").size(), 500u);
  EXPECT_THAT(Codes(inspection, "error"), IsEmpty());
  EXPECT_THAT(Codes(inspection, "warning"), IsEmpty());
}

TEST_F(CameraPlaces, WhatIsWrongWithACameraComesWithAWayOut) {
  Json rig = Human36m();
  Json& camera = rig["extrinsics"]["S1"]["54138969"];
  const Json sound = camera;
  camera["R"][0][0] = 2.0;
  EXPECT_THAT(Messages(rig), ElementsAre(HasSubstr("mend the number that is not, or copy the file again")));
  camera = sound;
  camera.erase("t");
  EXPECT_THAT(Messages(rig), ElementsAre(HasSubstr("the key 't' is missing (there are 'R'")));
  Json dome = Panoptic();
  dome["cameras"][3]["K"][0][0] = -1400;
  EXPECT_THAT(Messages(dome), ElementsAre(HasSubstr("not -1400 and ")));
}

TEST_F(CameraPlaces, MarkersOfAmassInMillimetresAreBlamedAndNotThePerson) {
  Amass amass = *ParseAmass(*ReadFile(TestData() + "/amass_babel/amass_sample.npz"), "sample.npz");
  const auto findings = [&] {
    return InspectPath(Written("motion.npz", *EncodeAmass(amass, "motion.npz")), std::nullopt);
  };
  EXPECT_THAT(Codes(findings(), "error"), IsEmpty());
  for (const auto& [factor, words] : {std::pair<double, const char*>{1000.0, "divided by 1000 (millimetres)"},
                                      {0.1, "divided by 100 (centimetres)"}}) {
    for (double& value : amass.marker_data_m) value *= factor;
    const Json inspection = findings();
    ASSERT_THAT(Codes(inspection, "error"), ElementsAre("units_contradiction")) << inspection.at("findings").dump(1);
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("severity") != "error") continue;
      EXPECT_THAT(finding.at("message"), HasSubstr("`marker_data` is "));
      EXPECT_THAT(finding.at("message"), HasSubstr(words));
    }
    EXPECT_EQ(Value(inspection.at("clips").at(0), "up"), "+z") << "of the body";
  }
}

}  // namespace
}  // namespace mocurate
