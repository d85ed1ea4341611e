#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "ingest/formats/driver.h"
#include "ingest/sense/inspect.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

/// A format of a program of one's own: JSON, the places of the declared joints in each frame, x y z.
Expected<IngestedClip> ReadToyClip(const SourceFile& file) {
  const Expected<SourceFrame> frame = FrameOf(file.source);
  if (!frame) return Forward(frame);
  const nlohmann::json rows = nlohmann::json::parse(file.bytes, nullptr, false);
  if (!rows.is_array()) return Fail(ErrorCode::kMalformed, "the file is no list of frames", file.name);
  IngestedClip ingested;
  ingested.clip.rate = FrameRate::FromHz(*file.source.rate_hz);
  JointTracks tracks;
  tracks.names = file.source.joints;
  tracks.positions = JointPositions(static_cast<int>(rows.size()), static_cast<int>(tracks.names.size()));
  tracks.confidence.assign(rows.size() * tracks.names.size(), 1.0);
  for (int f = 0; f < tracks.positions.frames; ++f) {
    const std::vector<double> row = rows[static_cast<std::size_t>(f)];
    tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
    for (int j = 0; j < tracks.positions.joints; ++j)
      tracks.positions.at(f, j) = frame->metres_from_file * Vector3d(row[3 * j], row[3 * j + 1], row[3 * j + 2]);
  }
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

/// What a toy says without a declaration: its frames.
Expected<ObservedFile> ToyIn(const FileBytes& file) {
  const nlohmann::json rows = nlohmann::json::parse(file.bytes, nullptr, false);
  if (!rows.is_array()) return Fail(ErrorCode::kMalformed, "the file is no list of frames", file.name);
  ObservedClip clip;
  clip.format = "toy";
  clip.frames = static_cast<int>(rows.size());
  return ObservedFile::Of(std::move(clip));
}

class ToyFormat : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    static FormatDriver driver;
    driver.name = "toy";
    driver.inspected = "toy";
    driver.gives = Gives::kJointTracks;
    driver.lists_joints = true;
    driver.options = {"least_confidence"};
    driver.sniff = [](const FileBytes& file, FileKind) { return file.path.extension() == ".toy"; };
    driver.observe = ToyIn;
    driver.to_clip = ReadToyClip;
    AddFormat(driver);
  }

  static IngestOptions Source(const std::string& name, const std::string& bytes) {
    const std::filesystem::path folder = FreshFolder(name);
    Put(folder / "wave_anna.toy", bytes);
    Put(folder / "toy.yaml",
        "ingest:\n  path: .\n  source: {name: toys, format: toy, files: '{action}_{person}.toy', units: cm,\n"
        "    axes: '+x +y +z', rate: 20 Hz, joints: [left_hip, right_hip]}\n");
    const auto config = LoadConfig(folder / "toy.yaml", {});
    const auto options = config ? OptionsFromConfig<IngestOptions>(*config->Find("ingest")) : Forward(config);
    EXPECT_TRUE(options) << options.error().Message();
    return *options;
  }
};

TEST_F(ToyFormat, ADeclarationNamesItAndItsClipsAreIngested) {
  const IngestOptions options =
      Source("toy", "[[10, 90, 0, -10, 90, 0], [10, 95, 0, -10, 95, 5], [10, 99, 0, 0, 9, 0]]");
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 1u);
  const Ingested ingested = RunIngest(discovery->items[0], "toy");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.identity.person, "anna");
  EXPECT_EQ(ingested.clip.label, "wave");
  ASSERT_TRUE(ingested.clip.evidence.tracks);
  EXPECT_EQ(ingested.clip.evidence.tracks->positions.frames, 3);
  EXPECT_TRUE(ingested.clip.evidence.tracks->positions.at(1, 1).isApprox(Vector3d(-0.1, 0.95, 0.05), 1e-6));
}

TEST_F(ToyFormat, FilesAreRecognisedWithoutADeclaration) {
  const std::filesystem::path folder = FreshFolder("toy_inspected");
  Put(folder / "anna.toy", "[[10, 90, 0, -10, 90, 0], [10, 95, 0, -10, 95, 5]]");
  Put(folder / "torn.toy", "10 90 0");
  const Inspection inspection = InspectPath(folder, std::nullopt);
  ASSERT_EQ(inspection.clips.size(), 1u);
  EXPECT_EQ(inspection.clips[0].format, "toy");
  EXPECT_EQ(inspection.clips[0].frames.value, 2);
  ASSERT_EQ(inspection.findings.size(), 1u);
  EXPECT_EQ(inspection.findings[0].code, "malformed");
}

TEST_F(ToyFormat, ItsErrorsAndRulesAreThoseOfEveryFormat) {
  ExpectError(IngestOnly(Source("toy_torn", "[[10, 90"), "toy_torn"), ErrorCode::kMalformed, "wave_anna.toy");
  IngestOptions options = Source("toy_rules", "[]");
  options.source.columns = {"x", "z", "y"};
  ExpectError(CheckSource(options.source), ErrorCode::kConfig, "ingest.source.columns");
  options = Source("toy_rules", "[]");
  options.source.rate_hz.reset();
  ExpectError(CheckSource(options.source), ErrorCode::kConfig, "ingest.source.rate");
}

}  // namespace
}  // namespace mocurate
