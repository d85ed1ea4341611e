// What an Acclaim skeleton says that no body can be, beside the recorded ones.

#include <gmock/gmock.h>

#include <regex>

#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class AsfSense : public WrittenFormats {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
    WrittenFormats::SetUp();
    skeleton_ = Cmu("01.asf");
    Written("01_01.amc", Cmu("01_01.amc"));
  }

  static std::string Cmu(const std::string& name) { return *ReadFile(TestData() + "/cmu/asf_amc/" + name); }

  /// `key` of bone `bone` becomes `value`.
  std::string With(const std::string& bone, const std::string& key, const std::string& value) const {
    const std::size_t at = skeleton_.find(key, skeleton_.find("name " + bone));
    return std::string(skeleton_).replace(at, skeleton_.find('\r', at) - at, key + " " + value);
  }

  /// The findings of severity error of the skeleton file; a run of its motion tells the same codes.
  std::vector<Json> Errors(const std::string& skeleton) {
    Written("01.asf", skeleton);
    std::vector<Json> errors;
    std::vector<std::string> codes;
    const Json inspection = InspectPath(folder_, std::nullopt);
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("severity") != "error" || finding.at("where") != "01.asf") continue;
      errors.push_back(finding);
      codes.push_back(finding.at("code"));
    }
    IngestOptions options = Declared("cmu_amc");
    options.path = folder_;
    for (const std::string& code : codes) EXPECT_THAT(ErrorCodes(RunAll(options).at(0).outcome), Contains(code));
    return errors;
  }

  std::string skeleton_;
};

TEST_F(AsfSense, ABoneWithoutLengthIsToldWithItsLine) {
  for (const std::string bone : {"lfemur", "upperback"}) {
    const std::vector<Json> errors = Errors(With(bone, "length", "0"));
    ASSERT_EQ(errors.size(), 1u) << bone;
    EXPECT_EQ(errors[0].at("code"), "bone_length");
    EXPECT_EQ(errors[0].at("value"), 0.0);
    EXPECT_TRUE(std::regex_search(errors[0].at("message").get<std::string>(),
                                  std::regex("^01.asf:[0-9]+: bone '" + bone + "' .*length 0.*mend")))
        << errors[0];
  }
}

TEST_F(AsfSense, AThighThatIsLongerThanTheOtherByMoreThanAnyRecordedOneIsTold) {
  const double length = 7.1578;
  const std::vector<Json> errors = Errors(With("lfemur", "length", std::to_string(1.6 * length)));
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].at("code"), "bone_length");
  EXPECT_NEAR(errors[0].at("value"), 1.6 * length / 7.43374, 0.01);
  EXPECT_THAT(errors[0].at("message"), HasSubstr("times shorter than 'lfemur'"));
  EXPECT_THAT(Errors(With("lfemur", "length", std::to_string(1.2 * length))), IsEmpty());
}

TEST_F(AsfSense, ADirectionWithTheSignOfXChangedIsToldOfTheBoneThatPointsToTheWrongSide) {
  for (const auto& [bone, direction] :
       {std::pair<std::string, std::string>{"lfemur", "-0.34202 -0.939693 0"}, {"rfemur", "0.34202 -0.939693 0"}}) {
    const std::vector<Json> errors = Errors(With(bone, "direction", direction));
    ASSERT_EQ(errors.size(), 1u) << bone;
    EXPECT_EQ(errors[0].at("code"), "bone_direction");
    EXPECT_NEAR(errors[0].at("value"), 40.0, 0.1);
    EXPECT_THAT(errors[0].at("message"), HasSubstr(": bone '" + bone + "' has the direction"));
    EXPECT_THAT(errors[0].at("message"), HasSubstr("sign of x changed"));
  }
}

TEST_F(AsfSense, AnOrderOfTheRootThatLacksAnAngleIsOneErrorOfTheSkeletonAndNoneOfTheMotion) {
  std::string five = skeleton_;
  Written("01.asf", five.replace(five.find("TX TY TZ RX RY RZ"), 17, "TX TY TZ RX RY"));
  const Json inspection = InspectPath(folder_, std::nullopt);
  ASSERT_EQ(inspection.at("findings").size(), 2u) << inspection.at("findings").dump(1);
  EXPECT_EQ(inspection.at("findings").at(1).at("code"), "no_clips");
  EXPECT_THAT(inspection.at("findings").at(0).at("where").get<std::string>(), HasSubstr("01.asf:"));
  EXPECT_THAT(inspection.at("findings").at(0).at("message"), HasSubstr("names 5 channels and lacks rz"));
}

TEST_F(AsfSense, OfEveryRecordedSkeletonNothingIsTold) {
  int skeletons = 0;
  for (const char* set : {"cmu", "hdm05"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(TestData()) / set)) {
      if (entry.path().extension() != ".asf" || entry.path().stem() == "skel") continue;
      ++skeletons;
      const Json inspection = InspectPath(entry.path(), std::nullopt);
      EXPECT_THAT(Codes(inspection, "error"), IsEmpty()) << entry.path() << inspection.at("findings").dump(1);
    }
  }
  EXPECT_EQ(skeletons, 7);
}

}  // namespace
}  // namespace mocurate
