// Clips of many files: findings when some or all files of the clip are missing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/formats/expect_error.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A frame with one body of coco19.
std::string OneBody(double time_ms) {
  std::string joints;
  for (int j = 0; j < 19; ++j)
    joints += (j == 0 ? "" : ", ") + std::to_string(j % 3) + ", -" + std::to_string(9 * j) + ", 0, 0.9";
  return "{\"version\": 0.7, \"univTime\": " + std::to_string(time_ms) +
         ", \"fpsType\": \"hd_29_97\", \"bodies\": [{\"id\": 0, \"joints19\": [" + joints + "]}]}";
}

IngestOptions Panoptic(const std::filesystem::path& folder) {
  IngestOptions options;
  options.path = folder;
  SourceOptions& source = options.source;
  source.name = "dome";
  source.format = "panoptic";
  source.files = "{recording}/body3DScene_{frame}.json";
  source.axes = "+x -y -z";
  source.rate_hz = 29.97;
  source.person = "p1";
  source.recording = "{recording}";
  source.label = "";
  source.on_contradiction = OnContradiction::kFlag;  // the joints form no real body
  return options;
}

IngestOptions OpenPose(const std::filesystem::path& folder) {
  IngestOptions options;
  options.path = folder;
  SourceOptions& source = options.source;
  source.name = "rig";
  source.format = "openpose";
  source.files = "single/{camera}_json/{camera}.{frame}.json";
  source.other_files = OtherFiles::kIgnore;
  source.axes = "+x +z -y";
  source.rate_hz = 60.0;
  source.calibration = {"Calib.qca.txt"};
  source.person = "p1";
  source.recording = "single";
  source.label = "balance";
  return options;
}

void Link(const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
  std::filesystem::create_symlink("nowhere.json", file);
}

TEST(GroupedFiles, AreRefusedWhenNoneCanBeRead) {
  const std::filesystem::path folder = FreshFolder("dangling_panoptic");
  for (const char* frame : {"1", "2", "3"}) Link(folder / "band" / ("body3DScene_" + std::string(frame) + ".json"));
  const auto alone = Discover(Panoptic(folder));
  ExpectError(alone, ErrorCode::kNotFound, folder.string());
  EXPECT_THAT(alone.error().what, HasSubstr("band/body3DScene_1.json"));

  Put(folder / "dance/body3DScene_1.json", OneBody(1000.0));
  const auto beside = Discover(Panoptic(folder));
  ASSERT_TRUE(beside) << beside.error().Message();
  ASSERT_EQ(beside->items.size(), 1u);
  EXPECT_EQ(beside->items[0].inputs.at(0).name, "dance/body3DScene_1.json");
  ASSERT_EQ(beside->excluded.size(), 1u);
  const Outcome& band = beside->excluded[0].outcome;
  EXPECT_EQ(band.findings.at(0).code, "unreadable_file");
  EXPECT_EQ(band.error.where, "band/body3DScene_1.json");
}

TEST(GroupedFiles, AreReportedBeforeTheirCalibrationWhenNoneCanBeRead) {
  const std::filesystem::path folder = FreshFolder("dangling_openpose");
  for (const char* camera : {"cam01", "cam02"}) {
    Link(folder / "single" / (std::string(camera) + "_json") / (std::string(camera) + ".0000.json"));
  }
  Put(folder / "Calib.qca.txt", "<calibration>");
  const auto discovery = Discover(OpenPose(folder));
  ExpectError(discovery, ErrorCode::kNotFound, folder.string());
  EXPECT_THAT(discovery.error().what, HasSubstr("single/cam01_json/cam01.0000.json"));
}

TEST(GroupedFiles, WithoutTheirCalibrationAreExcluded) {
  const std::filesystem::path folder = FreshFolder("openpose_calibrations");
  for (const char* recording : {"band", "dance"}) {
    for (const char* camera : {"cam01", "cam02"}) {
      Put(folder / recording / (std::string(camera) + "_json") / (std::string(camera) + ".0000.json"),
          "{\"version\": 1.3, \"people\": []}");
    }
  }
  Put(folder / "dance/Calib.qca.txt", "<calibration>");
  IngestOptions options = OpenPose(folder);
  options.source.files = "{recording}/{camera}_json/{camera}.{frame}.json";
  options.source.recording = "{recording}";
  options.source.calibration = {"{recording}/Calib.qca.txt"};
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 1u);
  EXPECT_EQ(discovery->excluded.at(0).outcome.findings.at(0).code, "calibration_missing");
}

TEST(GroupedFiles, OfPanopticLeaveMissingFramesInTheClip) {
  const std::filesystem::path folder = FreshFolder("panoptic_gaps");
  for (const int frame : {10, 11, 13, 14}) {
    Put(folder / "band" / ("body3DScene_" + std::to_string(frame) + ".json"), OneBody(1000.0 + 1000.0 * frame / 29.97));
  }
  Put(folder / "band/body3DScene_11.json", "{\"version\": 0.7, \"bod");
  const auto discovery = Discover(Panoptic(folder));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "panoptic_gaps");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  std::map<std::string, Finding> findings;
  for (const Finding& finding : ingested.outcome->findings) findings.emplace(finding.code, finding);
  ASSERT_EQ(findings.count("frames_missing"), 1u);
  ASSERT_EQ(findings.count("unreadable_frames"), 1u);
  EXPECT_EQ(findings["frames_missing"].frame_begin, 2);
  EXPECT_EQ(findings["frames_missing"].frame_end, 3);
  EXPECT_EQ(findings["frames_missing"].value, 1.0);
  EXPECT_EQ(findings["unreadable_frames"].frame_begin, 1);
  EXPECT_THAT(findings["unreadable_frames"].message, HasSubstr("body3DScene_11.json"));
}

TEST(GroupedFiles, OfPanopticAreInspectedForMissingFramesAndRate) {
  const std::filesystem::path folder = FreshFolder("panoptic_inspected");
  for (int frame = 100; frame < 120; ++frame) {
    if (frame == 107 || frame == 111) continue;
    Put(folder / "band" / ("body3DScene_" + std::to_string(frame) + ".json"), OneBody(1000.0 + 1000.0 * frame / 29.97));
  }
  Put(folder / "band/body3DScene_115.json", "{\"version\": 0.7, \"bod");
  Put(folder / "band/body3DScene_116.json", "");
  Put(folder / "band/notes.json", "{\"day\": ");
  for (const std::optional<SourceOptions>& source :
       {std::optional(Panoptic(folder).source), std::optional<SourceOptions>()}) {
    const nlohmann::json inspection = InspectPath(folder, source);
    ASSERT_EQ(inspection.at("clips").size(), 1u);
    const nlohmann::json& rate = inspection.at("clips")[0].at("rate_hz");
    EXPECT_NEAR(rate.at("value").get<double>(), 29.97, 0.005);
    std::map<std::string, nlohmann::json> findings;
    for (const nlohmann::json& finding : inspection.at("findings")) findings[finding.at("code")] = finding;
    EXPECT_EQ(findings.count("rate_contradiction"), 0u);
    ASSERT_EQ(findings.count("frames_missing"), 1u) << inspection.at("findings").dump(1);
    ASSERT_EQ(findings.count("unreadable_frames"), 1u);
    EXPECT_EQ(findings["frames_missing"].at("value"), 2);
    EXPECT_THAT(findings["frames_missing"].at("message"), HasSubstr("107"));
    EXPECT_EQ(findings["unreadable_frames"].at("value"), 2);
    EXPECT_THAT(findings["unreadable_frames"].at("message"),
                AllOf(HasSubstr("body3DScene_115.json"), HasSubstr("body3DScene_116.json")));
    EXPECT_EQ(findings["other_files"].at("where"), "band/notes.json");
  }
}

TEST(GroupedFiles, OfKeypointsAreInspectedForDamagedAndMissingFrames) {
  const std::filesystem::path folder = FreshFolder("keypoints_inspected");
  std::string numbers;
  for (int i = 0; i < 75; ++i) numbers += (i == 0 ? "" : ", ") + std::to_string(100 + i);
  const std::string file = "{\"version\": 1.3, \"people\": [{\"pose_keypoints_2d\": [" + numbers + "]}]}";
  for (const std::string camera : {"cam01", "cam02", "cam03", "cam04"}) {
    for (int frame = 0; frame < 30; ++frame) {
      if (camera == "cam03" && frame >= 20) continue;
      const std::string name = camera + "." + std::to_string(1000 + frame) + ".json";
      std::string bytes = file;
      if (camera == "cam01" && frame == 4) bytes.resize(bytes.size() / 2);
      if (camera == "cam02" && frame == 7) bytes.replace(bytes.find("pose_keypoints_2d"), 17, "poses_renamed____");
      Put(folder / (camera + "_json") / name, bytes);
    }
  }
  const nlohmann::json inspection = InspectPath(folder, std::nullopt);
  EXPECT_THAT(Places(inspection, "warning"),
              ElementsAre("unreadable_frames cam01_json", "unreadable_frames cam02_json", "frames_missing cam03_json"));
  const auto broken = FindingsOf(inspection, "unreadable_frames");
  EXPECT_THAT(broken.at(0).at("message"), HasSubstr("cam01.1004.json"));
  EXPECT_THAT(broken.at(1).at("message"), HasSubstr("cam02.1007.json"));
  const nlohmann::json missing = FindingsOf(inspection, "frames_missing").at(0);
  EXPECT_EQ(missing.at("value"), 10);
  EXPECT_THAT(missing.at("message"), HasSubstr("1020"));
}

TEST(GroupedFiles, OfPanopticRejectACameraField) {
  IngestOptions options = Panoptic(FreshFolder("panoptic_cameras"));
  options.source.files = "{recording}/{camera}/body3DScene_{frame}.json";
  const auto discovery = Discover(options);
  ExpectError(discovery, ErrorCode::kConfig, "ingest.source.files");
}

TEST(GroupedFiles, RejectIdentityFieldsThatDifferWithinAClip) {
  const std::pair<const char*, std::string SourceOptions::*> texts[] = {
      {"recording", &SourceOptions::recording}, {"person", &SourceOptions::person}, {"label", &SourceOptions::label},
      {"session", &SourceOptions::session},     {"view", &SourceOptions::view},     {"style", &SourceOptions::style}};
  for (const auto& [option, text] : texts) {
    for (const char* field : {"{camera}", "{frame}", "{file}"}) {
      IngestOptions options = OpenPose(FreshFolder("differing_names"));
      options.source.*text = std::string("x") + field;
      ExpectError(Discover(options), ErrorCode::kConfig, std::string("ingest.source.") + option);
    }
  }
}

}  // namespace
}  // namespace mocurate
