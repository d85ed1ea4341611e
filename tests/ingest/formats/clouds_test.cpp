// Clips of PLY and PCD files, one file per frame.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/sha256.h"
#include "ingest/inspect/inspect.h"
#include "ingest/inspect/source_declaration.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Rows of points in a box of human size, millimetres.
std::string Points(int frame) {
  std::string rows;
  for (int i = 0; i < 200; ++i)
    rows +=
        std::to_string(17 * i % 400) + " " + std::to_string(9 * i) + " " + std::to_string(5 * i % 300 + frame) + "\n";
  return rows;
}

std::string PlyOf(int frame) {
  return "ply\nformat ascii 1.0\nelement vertex 200\nproperty float x\nproperty float y\nproperty float "
         "z\nend_header\n" +
         Points(frame);
}

std::string PcdOf(int frame) {
  return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 200\nHEIGHT 1\nPOINTS 200\nDATA ascii\n" +
         Points(frame);
}

/// walk/scan_010.ply to walk/scan_012.ply.
IngestOptions ThreeClouds(const std::string& name) {
  IngestOptions options;
  options.path = FreshFolder(name);
  for (int frame = 10; frame < 13; ++frame)
    Put(options.path / "walk" / ("scan_0" + std::to_string(frame) + ".ply"), PlyOf(frame));
  SourceOptions& source = options.source;
  source.name = "scans";
  source.format = "clouds";
  source.files = "{recording}/scan_{frame}.ply";
  source.units = "mm";
  source.axes = "+x +z +y";
  source.rate_hz = 10.0;
  source.person = "p1";
  source.recording = "{recording}";
  source.label = "";
  return options;
}

/// The error code of ingesting the only clip.
ErrorCode RefusalCode(const IngestOptions& options, const std::string& name) {
  const Status status = IngestOnly(options, name);
  return status ? ErrorCode::kInternal : status.error().code;
}

Finding FindingOf(const Outcome& outcome, const std::string& code) {
  for (const Finding& finding : outcome.findings) {
    if (finding.code == code) return finding;
  }
  ADD_FAILURE() << "no finding " << code;
  return {};
}

TEST(CloudSource, ReadsOneFilePerFrameInDeclaredUnitAndAxes) {
  const IngestOptions options = ThreeClouds("clouds");
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 1u);
  for (const StageInput& input : discovery->items[0].inputs) EXPECT_EQ(input.role, "depth");
  const Ingested ingested = RunIngest(discovery->items[0], "clouds");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_TRUE(ingested.outcome->findings.empty());
  const Clip& clip = ingested.clip;
  EXPECT_EQ(clip.id(), "scans/p1/walk#0-3");
  ASSERT_TRUE(clip.evidence.clouds);
  const CloudFiles& clouds = *clip.evidence.clouds;
  EXPECT_THAT(clouds.files, ElementsAre("walk/scan_010.ply", "walk/scan_011.ply", "walk/scan_012.ply"));
  EXPECT_EQ(clouds.sha256[1], *Sha256OfFile(options.path / "walk/scan_011.ply"));
  EXPECT_THAT(clouds.time_s, ElementsAre(0.0, 0.1, 0.2));
  EXPECT_DOUBLE_EQ(clouds.metres_per_unit, -0.001) << "the axes are left-handed";
  const Vector3d world = clouds.world_from_file * (clouds.metres_per_unit * Vector3d(100, 200, 300));
  EXPECT_LT((world - Vector3d(0.1, 0.3, 0.2)).norm(), 1e-12) << world.transpose();
  Put(options.path / "walk/scan_011.ply", PlyOf(1));
  EXPECT_NE(RunIngest(discovery->items[0], "clouds").clip.evidence_sha256, clip.evidence_sha256);
}

TEST(CloudSource, LeavesTheNameEmptyForAMissingOrUnreadableFrame) {
  const IngestOptions options = ThreeClouds("cloud_gaps");
  std::filesystem::remove(options.path / "walk/scan_011.ply");
  Put(options.path / "walk/scan_013.ply", PlyOf(13).substr(0, 1000));
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "cloud_gaps");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const CloudFiles& clouds = *ingested.clip.evidence.clouds;
  EXPECT_THAT(clouds.files, ElementsAre("walk/scan_010.ply", "", "walk/scan_012.ply")) << "the last is cut";
  EXPECT_EQ(clouds.sha256[1], "");
  EXPECT_EQ(FindingOf(*ingested.outcome, "frames_missing").frame_begin, 1);
  const Finding unreadable = FindingOf(*ingested.outcome, "unreadable_frames");
  EXPECT_THAT(unreadable.message, HasSubstr("walk/scan_013.ply"));
  for (const char* name : {"010", "012"})
    Put(options.path / "walk" / ("scan_" + std::string(name) + ".ply"), "ply\nformat ascii 1.0\nend_header\n");
  EXPECT_EQ(RefusalCode(options, "cloud_gaps"), ErrorCode::kMalformed);
}

TEST(CloudSource, DropsPointsWithoutDepth) {
  const IngestOptions options = ThreeClouds("cloud_zeros");
  std::string zeros = PlyOf(11);
  zeros.replace(zeros.find("200"), 3, "500");
  for (int i = 0; i < 300; ++i) zeros += "0 0 0\n";
  Put(options.path / "walk/scan_011.ply", zeros);
  const Ingested ingested = RunIngest(Discover(options)->items.at(0), "cloud_zeros");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_DOUBLE_EQ(FindingOf(*ingested.outcome, "points_without_depth").value, 0.6);
  const nlohmann::json inspection = InspectPath(options.path / "walk/scan_011.ply", std::nullopt);
  EXPECT_EQ(inspection.at("clouds").at(0).at("points"), 200);
}

TEST(CloudSource, RejectsAnImplausibleUnit) {
  IngestOptions options = ThreeClouds("cloud_units");
  for (const char* unit : {"m", "0.01 mm"}) {
    options.source.units = unit;
    EXPECT_EQ(RefusalCode(options, "cloud_units"), ErrorCode::kInconsistent) << unit;
  }
  options.source.units = "";
  ExpectError(Discover(options), ErrorCode::kConfig, "ingest.source.units");
}

TEST(CloudSource, AcceptsPlyAndPcdInOneClipButNotForOneFrame) {
  IngestOptions options = ThreeClouds("cloud_kinds");
  options.source.files = "{recording}/scan_{frame}.{-}";
  Put(options.path / "walk/scan_013.pcd", PcdOf(13));
  EXPECT_TRUE(IngestOnly(options, "cloud_kinds"));
  Put(options.path / "walk/scan_012.pcd", PcdOf(12));
  EXPECT_EQ(RefusalCode(options, "cloud_kinds"), ErrorCode::kInconsistent) << "two files for one frame";
}

TEST(CloudSource, RejectsADeclarationWithoutFramesOrOfAnotherFormat) {
  IngestOptions options = ThreeClouds("cloud_names");
  for (const char* files : {"{recording}/scan_{number}.ply", "{recording}/{camera}_{frame}.ply"}) {
    options.source.files = files;
    ExpectError(Discover(options), ErrorCode::kConfig, "ingest.source.files");
  }
  IngestOptions table = SmallTable(options.path);
  table.source.files = "{person}/scan_{action}.ply";
  ExpectError(Discover(table), ErrorCode::kConfig, "ingest.source.format");
}

TEST(CloudSource, IsInspectedWithAndWithoutADeclaration) {
  const IngestOptions options = ThreeClouds("cloud_inspection");
  Put(options.path / "walk/scan_013.ply", PlyOf(13));
  const Inspection declared = InspectPath(options.path, options.source);
  ASSERT_EQ(declared.clips.size(), 1u);
  EXPECT_EQ(declared.clips[0].format, "clouds");
  EXPECT_EQ(declared.clips[0].frames.value, 4);
  EXPECT_TRUE(declared.clouds.empty()) << "the clouds are the clip";
  EXPECT_TRUE(declared.findings.empty());

  const Inspection bare = InspectPath(options.path, std::nullopt);
  EXPECT_EQ(bare.format, "ply");
  EXPECT_EQ(bare.clouds.size(), 4u);
  EXPECT_THAT(InspectionText(bare), HasSubstr("4 clouds in walk/"));
  const auto draft = DeclareSource(bare, options.path, "scans");
  ASSERT_TRUE(draft) << draft.error().Message();
  EXPECT_THAT(draft->yaml, HasSubstr("format: clouds"));
  EXPECT_THAT(draft->yaml, HasSubstr("files: \"{recording}/scan_{frame}.ply\""));
  EXPECT_THAT(draft->yaml, HasSubstr("units: mm"));
  EXPECT_THAT(draft->yaml, HasSubstr("fitting: {method: point_clouds}"));
  EXPECT_THAT(draft->unknown, ElementsAre("person", "label", "axes", "rate"));
}

TEST(CloudSource, DistinguishesClipsOfOneFolderByRecording) {
  IngestOptions options = ThreeClouds("cloud_folder");
  options.path = FreshFolder("cloud_folder");
  options.source.files = "{recording}_{frame}.ply";
  for (const char* name : {"run_1.ply", "run_2.ply", "walk_1.ply"}) Put(options.path / name, PlyOf(1));
  const Inspection inspection = InspectPath(options.path, options.source);
  ASSERT_EQ(inspection.clips.size(), 2u);
  EXPECT_EQ(inspection.clips[0].file, "run");
  EXPECT_EQ(inspection.clips[1].file, "walk");
}

TEST(CloudSource, ReportsPointsFarFromTheOthers) {
  const std::filesystem::path folder = FreshFolder("cloud_far");
  std::string cloud = PlyOf(0);
  EXPECT_TRUE(InspectPath(folder, std::nullopt).clouds.empty());
  Put(folder / "near.ply", cloud);
  cloud.replace(cloud.rfind('\n', cloud.size() - 2), std::string::npos, "\n0 0 65535\n");
  Put(folder / "far.ply", cloud);
  const std::vector<Finding> findings = InspectPath(folder, std::nullopt).findings;
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "point_far");
  EXPECT_EQ(findings[0].clip, "far.ply");
}

}  // namespace
}  // namespace mocurate
