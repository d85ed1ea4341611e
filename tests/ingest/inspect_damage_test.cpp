// What is damaged is an error that names the place, also where the rest of it could be read.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/formats/npy.h"
#include "core/formats/png.h"
#include "tests/ingest/inspections.h"

namespace mocurate {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

/// Messages of the errors, with their places.
std::vector<std::string> Errors(const Json& inspection) {
  std::vector<std::string> errors;
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("severity") != "error") continue;
    errors.push_back(finding.at("code").get<std::string>() + " " + finding.at("where").get<std::string>() + " " +
                     finding.at("message").get<std::string>());
  }
  return errors;
}

class DamagedFiles : public WrittenFormats {
 protected:
  Json Look(const std::string& name, const std::string& bytes) {
    return InspectPath(Written(name, bytes), std::nullopt);
  }
  Json LookAtFolder() { return InspectPath(folder_, std::nullopt); }
};

std::string DepthPng() {
  DepthImage image;
  image.width = 64;
  image.height = 48;
  for (int i = 0; i < 64 * 48; ++i) image.values.push_back(static_cast<std::uint16_t>(500 + (i * 37) % 4000));
  return *EncodePng(image);
}

TEST_F(DamagedFiles, ADepthImageIsWholeOrAnError) {
  const std::string png = DepthPng();
  EXPECT_THAT(Errors(Look("whole.png", png)), IsEmpty());
  for (std::size_t kept = 9; kept < png.size(); kept += png.size() / 7) {
    EXPECT_THAT(Errors(Look("cut.png", png.substr(0, kept))), ElementsAre(HasSubstr("malformed cut.png:")));
  }
  for (std::size_t at = 10; at < png.size(); at += png.size() / 9) {
    std::string flipped = png;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    const Json inspection = Look("flipped.png", flipped);
    EXPECT_THAT(Errors(inspection), ElementsAre(HasSubstr("malformed flipped.png:"))) << at;
    EXPECT_THAT(inspection.at("companions"), IsEmpty());
  }
  EXPECT_EQ(Errors(LookAtFolder()).size(), 2u) << "the whole one beside them is counted, the others are errors";
}

TEST_F(DamagedFiles, AnArrayWithoutOneFiniteNumberSaysSo) {
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    NpyArray array;
    array.dtype = "<f8";
    array.shape = {20, 24, 3};
    array.values.assign(20 * 24 * 3, value);
    EXPECT_THAT(Errors(Look("none.npy", EncodeNpy(array, "none.npy").value())),
                ElementsAre(AllOf(HasSubstr("none.npy"), HasSubstr("all 1440 numbers are NaN or infinite"))));
  }
}

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

TEST_F(DamagedFiles, ARigThatContradictsItselfIsAnErrorThatNamesBoth) {
  const std::string turned = "0.5403023, 0, 0.8414710, 0, 1, 0, -0.8414710, 0, 0.5403023";  // one radian about y
  Written("extri.yml", Extri() + Matrix("Rot_b", 3, 3, turned));
  EXPECT_THAT(Errors(Look("intri.yml", Intri())), IsEmpty()) << "as its vector says";
  Written("extri.yml", Extri() + Matrix("Rot_a", 3, 3, turned));
  EXPECT_THAT(Errors(Look("intri.yml", Intri())),
              ElementsAre(AllOf(HasSubstr("extri.yml"), HasSubstr("R_a and Rot_a are 1.0"), HasSubstr("rad apart"))));
  Written("extri.yml", Extri());
  std::string shape = Intri();
  const std::string rows = "K_b: !!opencv-matrix\n   rows: ";
  shape.replace(shape.find(rows) + rows.size(), 1, "2");
  EXPECT_THAT(Errors(Look("intri.yml", shape)),
              ElementsAre(AllOf(HasSubstr("intri.yml:K_b"), HasSubstr("2 rows of 3, 6 numbers, are announced; 9"))));
}

TEST_F(DamagedFiles, AStorageWithADamagedFirstLineIsNamedItself) {
  Written("intri.yml", Intri());
  std::string damaged = Extri();
  damaged.replace(0, 5, "%YMAL");
  for (const char* asked : {"intri.yml", "extri.yml"}) {
    Written("extri.yml", damaged);
    EXPECT_THAT(Errors(InspectPath(folder_ / asked, std::nullopt)),
                ElementsAre(AllOf(HasSubstr("extri.yml:1"), HasSubstr("begins with neither %YAML:1.0"))));
  }
  EXPECT_THAT(Errors(InspectPath(folder_, std::nullopt)), Contains(HasSubstr("extri.yml:1")));
}

TEST_F(DamagedFiles, PeopleUnderAnotherKeyAreStillADetectors) {
  EXPECT_THAT(
      Errors(Look("cam1_000000000000_keypoints.json", R"({"version":1.3,"peopel":[{"pose_keypoints_2d":[1,2,0.5]}]})")),
      ElementsAre(HasSubstr("cam1_000000000000_keypoints.json: the key 'people' is missing")));
}

TEST_F(DamagedFiles, HalfACameraIsAnErrorThatNamesTheField) {
  EXPECT_THAT(Errors(Look("intri.yml", Intri())), ElementsAre(HasSubstr("intri.yml:R_a")));
  Written("extri.yml", Extri());
  const Json beside = Look("intri.yml", Intri());
  EXPECT_THAT(Errors(beside), IsEmpty()) << "the other half lies beside it";
  EXPECT_EQ(beside.at("cameras").size(), 2u);
  EXPECT_THAT(Errors(Look("intri.yml", Without(Intri(), "K_b"))), ElementsAre(HasSubstr("intri.yml:K_b")));
  EXPECT_THAT(Errors(Look("intri.yml", Without(Intri(), "dist_b"))), ElementsAre(HasSubstr("intri.yml:dist_b")));
  Written("intri.yml", Intri());
  EXPECT_THAT(Errors(Look("extri.yml", Without(Extri(), "T_b"))), ElementsAre(HasSubstr("extri.yml:T_b")));
  std::string small = Intri();
  small.replace(small.find(kLens), kLens.size(), "1000, 0, 500, 0, 1000, 400");
  Written("extri.yml", Extri());
  EXPECT_THAT(Errors(Look("intri.yml", small)), ElementsAre(AllOf(HasSubstr("intri.yml:K_a"), HasSubstr("9 numbers"))));
  std::string nameless = Intri();
  nameless.erase(nameless.find(kNames), std::string(kNames).size());
  EXPECT_THAT(Errors(Look("intri.yml", nameless)), ElementsAre(HasSubstr("intri.yml:names")));
  EXPECT_THAT(Errors(Look("view.yml", kHead + Matrix("R", 3, 1, "0, 0, 0") + Matrix("t", 3, 1, "0, 0, 0"))),
              ElementsAre(HasSubstr("view.yml:intrinsic")));
  EXPECT_EQ(Codes(Look("other.yml", std::string(kHead) + "shape: 3\n"), "error").size(), 1u)
      << "asked for, and unknown";
}

TEST_F(DamagedFiles, ACameraThatLacksAFieldIsAnErrorInAFolderToo) {
  const char* rig = R"({"0": {"R": [[1,0,0],[0,1,0],[0,0,1]], "T": [[0],[0],[0]], "fy": 1, "cx": 1, "cy": 1,
                              "k": [[0],[0],[0]], "p": [[0],[0]]}})";
  EXPECT_THAT(Errors(Look("rig.json", rig)), ElementsAre(HasSubstr("'fx' is missing")));
  Written("notes.json", R"({"author": "somebody")");
  const Json folder = LookAtFolder();
  EXPECT_THAT(Errors(folder), ::testing::Contains(HasSubstr("'fx' is missing")));
  EXPECT_THAT(Codes(folder, "info"), ElementsAre("other_files")) << "notes are no calibration";
}

TEST_F(DamagedFiles, AFolderSaysWhyMostOfItsFilesCouldNotBeRead) {
  for (int i = 0; i < 3; ++i)
    Written("take." + std::to_string(i) + ".json", R"({"people":[{"pose_keypoints_2d":[1,2,-0.5]}]})");
  Written("notes.txt", "nothing of the kind\n");
  const Json findings = LookAtFolder().at("findings");
  std::string told;
  for (const Json& finding : findings) {
    if (finding.at("code") == "other_files") told = finding.at("message");
  }
  EXPECT_THAT(told, HasSubstr("4 files are of no known format; of 3 the reason is: a confidence is at least 0"));
  EXPECT_THAT(told, HasSubstr("(first take.0.json)"));
}

TEST_F(RecordedFormats, FramesThatAreAllZeroAreListedWithTheirPlaces) {
  const Json inspection = Look("kinect/msr_action3d/a14_s03_e01_skeleton3D.txt");
  double frames = 0.0;
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("code") != "zero_frames") continue;
    frames += finding.at("value").get<double>();
    EXPECT_THAT(finding.at("where").get<std::string>(), HasSubstr("a14_s03_e01_skeleton3D.txt frames "));
  }
  EXPECT_EQ(frames, 9.0);
}

}  // namespace
}  // namespace mocurate
