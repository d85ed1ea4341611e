// Damaged images and keypoint files are reported as errors with their place.

#include <string_view>

#include "core/base/text.h"
#include "core/formats/openpose.h"
#include "core/formats/png.h"
#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using Json = nlohmann::json;

class DamagedImages : public WrittenFormats {
 protected:
  Json Inspect(const std::string& name, const std::string& bytes) {
    return InspectPath(Written(name, bytes), std::nullopt);
  }
  Json InspectFolder() { return InspectPath(folder_, std::nullopt); }
};

TEST_F(DamagedImages, ReportsAnIncompleteDepthImage) {
  DepthImage image{64, 48, {}};
  for (int i = 0; i < 64 * 48; ++i) image.values.push_back(static_cast<std::uint16_t>(500 + (i * 37) % 4000));
  const std::string png = *EncodePng(image);
  EXPECT_THAT(Places(Inspect("whole.png", png)), IsEmpty());
  for (std::size_t kept = 9; kept < png.size(); kept += png.size() / 7)
    EXPECT_THAT(Places(Inspect("cut.png", png.substr(0, kept))), ElementsAre(StartsWith("malformed cut.png:")));
  for (std::size_t at = 10; at < png.size(); at += png.size() / 9) {
    std::string flipped = png;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    const Json inspection = Inspect("flipped.png", flipped);
    EXPECT_THAT(Places(inspection), ElementsAre(StartsWith("malformed flipped.png:"))) << at;
    EXPECT_THAT(inspection.at("companions"), IsEmpty());
  }
  EXPECT_EQ(Places(InspectFolder()).size(), 2u) << "two damaged images are errors, the valid one is counted";
}

// Keypoints.

/// One person, shifted to the right by this many pixels.
std::string KeypointFile(int points, double right_px = 0.0) {
  OpenPoseFrame frame;
  frame.people.emplace_back();
  for (int k = 0; k < points; ++k) frame.people[0].pose.push_back({100.0 + 20.0 * k + right_px, 50.0 + 30.0 * k, 0.9});
  return WriteOpenPose(frame);
}

TEST_F(DamagedImages, ReportsTwoFilesForOneFrameOfACamera) {
  for (const char* name : {"cam1.0000.json", "cam1.0001.json", "cam1.0002.json"}) Written(name, KeypointFile(25));
  EXPECT_THAT(Codes(InspectFolder(), "error"), IsEmpty());
  Written("cam1.2.json", KeypointFile(25));
  const std::vector<Json> findings = FindingsOf(InspectFolder(), "malformed");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_THAT(findings[0].at("message"), AllOf(HasSubstr("cam1.2.json"), HasSubstr("cam1.0002.json")));
}

TEST_F(DamagedImages, CountsPeopleWithAnotherNumberOfKeypoints) {
  for (int f = 0; f < 6; ++f) Written("cam1.000" + std::to_string(f) + ".json", KeypointFile(f == 3 ? 26 : 25, f));
  const Json inspection = InspectFolder();
  const std::vector<Json> findings = FindingsOf(inspection, "keypoint_count");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("value"), 1);
  EXPECT_EQ(Value(inspection.at("clips")[0], "joints"), 25);
}

TEST_F(DamagedImages, RecognisesDetectionsUnderAMisspeltKey) {
  const std::string name = "cam1_000000000000_keypoints.json";
  EXPECT_THAT(Places(Inspect(name, R"({"version":1.3,"peopel":[{"pose_keypoints_2d":[1,2,0.5]}]})")),
              ElementsAre("malformed " + name + ":"));
}

TEST_F(DamagedImages, ReportsUnreadableFilesOfAFolder) {
  for (int i = 0; i < 3; ++i)
    Written("take." + std::to_string(i) + ".json", R"({"people":[{"pose_keypoints_2d":[1,2,-0.5]}]})");
  Written("notes.txt", "nothing of the kind\n");
  const std::vector<Json> findings = FindingsOf(InspectFolder(), "other_files");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("value"), 4);
  EXPECT_THAT(findings[0].at("message"), AllOf(HasSubstr("-0.5"), HasSubstr("take.0.json")))
      << "the reason and the first file";
}

}  // namespace
}  // namespace mocurate
