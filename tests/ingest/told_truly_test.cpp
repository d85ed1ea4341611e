// What is told of a file that is damaged, odd or no motion: true, once, with its number, and the same by a run and by
// an inspection.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <regex>

#include "core/formats/camera_files.h"
#include "core/formats/npy.h"
#include "ingest/sense/declaration_writer.h"
#include "ingest/sense/fault_codes.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Json = nlohmann::json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Takes of 22 joints as arrays, and what a run and an inspection say of them.
class Arrays : public WrittenFormats {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
    WrittenFormats::SetUp();
    options_.path = folder_;
    SourceOptions& source = options_.source;
    source.name = "mine";
    source.format = "npy";
    source.files = "{clip}.npy";
    source.person = "p";
    source.recording = "{clip}";
    source.units = "m";
    source.axes = "+x +y +z";
    source.rate_hz = 20.0;
    source.skeleton = "smpl24";
    source.joints = {"pelvis",     "left_hip",    "right_hip",    "spine1",     "left_knee",     "right_knee",
                     "spine2",     "left_ankle",  "right_ankle",  "spine3",     "left_foot",     "right_foot",
                     "neck",       "left_collar", "right_collar", "head",       "left_shoulder", "right_shoulder",
                     "left_elbow", "right_elbow", "left_wrist",   "right_wrist"};
  }
  static NpyArray Take() {
    NpyArray array = *ParseNpy(*ReadFile(TestData() + "/humanact12/humanml3d_sample/012314_joints.npy"), "a");
    array.dtype = "<f8";
    return array;
  }
  struct Told {
    Expected<StageOutcome> run = tl::unexpected<Error>(Error());
    Json inspection;

    std::vector<std::string> run_codes() const {
      std::vector<std::string> codes;
      if (run) {
        for (const Finding& finding : run->findings) codes.push_back(finding.code);
      }
      return codes;
    }
    std::vector<std::string> codes() const {
      std::vector<std::string> codes;
      for (const Json& finding : inspection.at("findings")) codes.push_back(finding.at("code"));
      return codes;
    }
    std::string message(std::size_t at) const { return inspection.at("findings").at(at).at("message"); }
  };
  Told Of(const std::string& bytes) {
    Told told;
    const auto file = Written("take.npy", bytes);
    told.inspection = InspectPath(file, options_.source);
    const auto discovery = Discover(options_);
    EXPECT_TRUE(discovery && discovery->items.size() == 1);
    const ItemSpec& item = discovery->items.at(0);
    StageRequest request;
    request.stage = "ingest";
    request.item = item.item;
    request.options = item.options;
    request.inputs = item.inputs;
    request.output = folder_ / "told.h5";
    told.run = IngestStage(request);
    return told;
  }
  Told Of(const std::function<void(NpyArray&)>& change) {
    NpyArray array = Take();
    change(array);
    return Of(WriteNpy(array));
  }
  IngestOptions options_;
};

TEST_F(Arrays, NumbersThatAreNotFiniteAreOneFindingWithTheirCountAndTheFirstPlace) {
  const Told told = Of([](NpyArray& array) {
    for (std::size_t f = 10; f < 100; ++f) {
      array.values[(f * 22 + 3) * 3 + 1] = kNan;
      array.values[(f * 22 + 4) * 3] = std::numeric_limits<double>::infinity();
    }
  });
  ASSERT_TRUE(told.run) << told.run.error().Message();
  EXPECT_THAT(told.run_codes(), ElementsAre("not_a_number"));
  EXPECT_THAT(told.codes(), ElementsAre("not_a_number"));
  const Finding& finding = told.run->findings[0];
  EXPECT_EQ(finding.value, 180.0);
  EXPECT_EQ(finding.frame_begin, 10);
  EXPECT_EQ(finding.frame_end, 100);
  EXPECT_THAT(finding.message,
              HasSubstr("180 numbers in 90 of 170 frames are not finite, the first in frame 10, joint 3, y"));
  EXPECT_EQ(told.message(0), finding.message);
}

TEST_F(Arrays, OneFrameIsAPoseAndNothingIsSaidOfBonesThatChange) {
  const Told told = Of([](NpyArray& array) {
    array.shape[0] = 1;
    array.values.resize(66);
  });
  EXPECT_THAT(told.run_codes(), ElementsAre("single_frame"));
  EXPECT_THAT(told.codes(), ElementsAre("single_frame"));
  const Json alone = InspectPath(folder_ / "take.npy", std::nullopt);
  EXPECT_THAT(Codes(alone, "error"), IsEmpty()) << alone.at("findings");
  EXPECT_THAT(alone.dump(), Not(HasSubstr("100 %")));
}

TEST_F(Arrays, ZerosAreToldAsZerosOnce) {
  const Told told = Of([](NpyArray& array) { std::fill(array.values.begin(), array.values.end(), 0.0); });
  ASSERT_TRUE(told.run);
  EXPECT_EQ(told.run_codes(), told.codes());
  EXPECT_THAT(Codes(told.inspection, "error"), ElementsAre("lifeless_clip"));
  EXPECT_THAT(Codes(told.inspection, "warning"), IsEmpty());
  EXPECT_THAT(told.run->error.what, HasSubstr("all joints are at 0 0 0 in 100 %"));
  const Json alone = InspectPath(folder_ / "take.npy", std::nullopt);
  EXPECT_THAT(Codes(alone, "error"), ElementsAre("lifeless_clip"));
}

TEST_F(Arrays, PointsOfAPlaneAreNoBodiesInSpace) {
  const Told told = Of([](NpyArray& array) {
    for (std::size_t i = 2; i < array.values.size(); i += 3) array.values[i] = 1.5;
  });
  EXPECT_THAT(told.run_codes(), ElementsAre("flat_body"));
  EXPECT_THAT(told.codes(), ElementsAre("flat_body"));
}

TEST_F(Arrays, AWrongUnitIsNamedByBothHoweverFarItPutsThePersonAndItsConsequencesAreNotTold) {
  for (const auto& [factor, unit] : {std::pair{1000.0, "in mm it would be a person"}, {1e-3, "measures 0.0015 m"}}) {
    const Told told = Of([factor = factor](NpyArray& array) {
      for (double& value : array.values) value *= factor;
    });
    ASSERT_TRUE(told.run) << told.run.error().Message();
    EXPECT_THAT(told.run_codes(), ElementsAre("units_contradiction"));
    EXPECT_THAT(told.codes(), ElementsAre("units_contradiction"));
    EXPECT_THAT(told.message(0), HasSubstr(unit));
    EXPECT_THAT(told.run->findings[0].message, HasSubstr(told.message(0)));
    if (factor > 1.0) {
      EXPECT_EQ(told.run->kind, OutcomeKind::kRefused) << "nobody is a kilometre away";
      EXPECT_THAT(told.run->error.Message(), HasSubstr(unit));
    }
  }
}

TEST_F(Arrays, AFileThatGivesNoClipHasOneCodeAndEveryErrorAWayOut) {
  const std::string whole = WriteNpy(Take());
  const std::string nobody = [] {
    NpyArray array = Take();
    std::fill(array.values.begin(), array.values.end(), kNan);
    return WriteNpy(array);
  }();
  NpyArray transposed = Take();
  std::swap(transposed.shape[1], transposed.shape[2]);
  for (const std::string& bytes : {whole.substr(0, 60), whole.substr(0, 5000), whole.substr(0, 9), whole + "more",
                                   nobody, std::string(), WriteNpy(transposed)}) {
    const Told told = Of(bytes);
    const bool counted = told.run.has_value();
    const Error error = counted ? told.run->error : told.run.error();
    EXPECT_THAT(told.codes(), ElementsAre(FaultCode(error, "npy"))) << error.Message();
    EXPECT_FALSE(error.hint.empty()) << error.Message();
    EXPECT_FALSE(error.where.empty()) << error.Message();
  }
}

/// Numbers of a text, as written.
std::vector<double> NumbersIn(const std::string& text) {
  static const std::regex number(R"((?:^|[^\w.])(-?\d+(?:\.\d+)?(?:e[+-]?\d+)?))");
  std::vector<double> numbers;
  for (auto at = std::sregex_iterator(text.begin(), text.end(), number); at != std::sregex_iterator(); ++at) {
    numbers.push_back(std::stod((*at)[1]));
  }
  return numbers;
}

TEST_F(RecordedFormats, TheValueOfAFindingIsANumberOfItsMessage) {
  std::size_t told = 0;
  for (const char* path : {"ntu", "cameras", "bvh", "cmu", "humanact12", "kinect/cad60", "kinect/msr_action3d",
                           "pose2sim", "amass_babel"}) {
    const Json inspection = Look(path);
    for (const Json& finding : inspection.at("findings")) {
      const double value = finding.at("value");
      if (value == 0.0) continue;  // the message states none
      ++told;
      const std::string message = finding.at("message");
      const std::vector<double> numbers = NumbersIn(message);
      const bool stated = std::any_of(numbers.begin(), numbers.end(), [&](double number) {
        const double slack = 0.006 * std::abs(value) + 1e-4;
        return std::abs(number - value) <= slack || std::abs(number / 100.0 - value) <= slack;
      });
      EXPECT_TRUE(stated) << finding;
    }
  }
  EXPECT_GT(told, 20u);
}

TEST(ImageNames, ACameraOfOneLetterIsOnlyWhereItStandsAlone) {
  const std::vector<std::string> names = {"p_depth_0001.png", "p_depth_0002.png"};
  EXPECT_EQ(GuessImages(names, {"p"}, "camera"), "{camera}_depth_{frame:4}.png");
  EXPECT_EQ(GuessImages({"depth/0001.png"}, {"p"}, "camera"), "");
  EXPECT_EQ(GuessImages({"depth/p0001.png"}, {"p"}, "camera"), "depth/{camera}{frame:4}.png");
  EXPECT_EQ(GuessImages({"cam10_0001.png"}, {"cam1", "cam10"}, "camera"), "{camera}_{frame:4}.png");
  EXPECT_EQ(GuessImages({"cam10_0001.png"}, {"cam1"}, "camera"), "");
}

TEST_F(RecordedFormats, ThePickleOfARigOfPhspdIsACalibrationAsItsTextIs) {
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
