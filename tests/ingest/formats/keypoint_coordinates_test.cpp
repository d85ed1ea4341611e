// Keypoints outside every image are reported with their place and treated as undetected.

#include "ingest/checks/keypoint_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/ingest/inspections.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

std::vector<ImagePoses> PersonInImages() {
  std::vector<ImagePoses> frames(4, ImagePoses(2));
  for (ImagePoses& people : frames) {
    for (auto& pose : people) {
      for (int k = 0; k < 17; ++k) pose.push_back({100.0 + 50.0 * k, 900.0 - 40.0 * k, 0.8});
    }
  }
  return frames;
}

const std::vector<std::string> kFiles = {"c/0.json", "c/1.json", "c/2.json", "c/3.json"};

TEST(KeypointNumbers, ReportAPointOutsideEveryImageAsUndetected) {
  for (const double px : {1e9, -1e9, 4e4}) {
    std::vector<ImagePoses> frames = PersonInImages();
    frames[2][1][5].u_px = px;
    const auto finding = ExcludeFarKeypoints(kFiles, frames);
    ASSERT_TRUE(finding) << px;
    EXPECT_EQ(finding->code, "keypoint_far");
    EXPECT_EQ(finding->value, std::abs(px));
    EXPECT_EQ(finding->frame_begin, 2);
    EXPECT_EQ(finding->frame_end, 3);
    EXPECT_THAT(finding->message, HasSubstr("c/2.json:/people/1/pose_keypoints_2d"));
    EXPECT_FALSE(frames[2][1][5].detected());
    EXPECT_FALSE(ExcludeFarKeypoints(kFiles, frames)) << "reported once";
  }
}

TEST(KeypointNumbers, AcceptPointsAtOrSlightlyBeyondTheEdge) {
  std::vector<ImagePoses> frames = PersonInImages();
  EXPECT_FALSE(ExcludeFarKeypoints(kFiles, frames));
  frames[0][0][0].u_px = 1920.0;
  frames[1][0][0].v_px = -300.0;
  EXPECT_FALSE(ExcludeFarKeypoints(kFiles, frames));
}

TEST(KeypointNumbers, ReportAConfidenceFarAboveOneAsUndetected) {
  for (const double confidence : {7.5, 90.0}) {
    std::vector<ImagePoses> frames = PersonInImages();
    frames[2][1][5].confidence = confidence;
    frames[1][0][3].confidence = 1.2;  // a heat-map peak may exceed 1
    const auto finding = ExcludeImplausibleConfidences(kFiles, frames);
    ASSERT_TRUE(finding) << confidence;
    EXPECT_EQ(finding->code, "confidence_range");
    EXPECT_EQ(finding->severity, Severity::kWarning) << "the other confidences are valid";
    EXPECT_EQ(finding->value, confidence);
    EXPECT_EQ(finding->frame_begin, 2);
    EXPECT_THAT(finding->message, HasSubstr("c/2.json:/people/1/pose_keypoints_2d"));
    EXPECT_FALSE(frames[2][1][5].detected());
    EXPECT_TRUE(frames[1][0][3].detected());
    EXPECT_FALSE(ExcludeImplausibleConfidences(kFiles, frames)) << "reported once";
  }
}

TEST(KeypointNumbers, AreReportedWithTheirFileInRunAndInspect) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  IngestOptions options = Declared("pose2sim_single");
  const std::filesystem::path from = options.path, folder = FreshFolder("keypoint_far");
  std::filesystem::copy(from / "single", folder / "single", std::filesystem::copy_options::recursive);
  std::filesystem::copy_file(from / "Calib.qca.txt", folder / "Calib.qca.txt");
  const std::filesystem::path name = "single/cam02_json/cam02.0003.json";
  auto document = nlohmann::json::parse(*ReadFile(folder / name));
  document["people"][0]["pose_keypoints_2d"][3] = 1e9;
  document["people"][0]["pose_keypoints_2d"][5] = 0.5;
  document["people"][0]["pose_keypoints_2d"][17] = 7.5;
  Put(folder / name, document.dump());
  options.path = folder;
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "keypoint_far");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const nlohmann::json inspection = InspectPath(folder, std::nullopt);
  std::vector<std::string> in_run;
  for (const Finding& finding : ingested.outcome->findings) {
    in_run.push_back(finding.code);
    EXPECT_EQ(finding.value, finding.code == "keypoint_far" ? 1e9 : 7.5);
    const auto inspected = FindingsOf(inspection, finding.code);
    ASSERT_EQ(inspected.size(), 1u) << finding.code;
    EXPECT_EQ(inspected[0].at("value"), finding.value);
    for (const std::string& message : {finding.message, inspected[0].at("message").get<std::string>()})
      EXPECT_THAT(message, HasSubstr("cam02.0003.json:/people/0/pose_keypoints_2d"));
  }
  EXPECT_THAT(in_run, UnorderedElementsAre("keypoint_far", "confidence_range"));
}

}  // namespace
}  // namespace mocurate
