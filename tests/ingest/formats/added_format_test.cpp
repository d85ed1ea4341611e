#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "ingest/formats/driver.h"
#include "ingest/inspect/inspect.h"
#include "ingest/inspect/read_raw.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

/// JSON: a list of frames of `numbers` each; 0: any number.
Expected<std::vector<std::vector<double>>> ToyRows(std::string_view bytes, const std::string& name,
                                                   std::size_t numbers) {
  const nlohmann::json frames = nlohmann::json::parse(bytes, nullptr, false);
  if (!frames.is_array()) {
    return Fail(ErrorCode::kMalformed, "the file is no list of frames", name, "export it again");
  }
  std::vector<std::vector<double>> rows;
  for (const nlohmann::json& frame : frames) {
    const bool sound = frame.is_array() && (numbers == 0 || frame.size() == numbers) &&
                       std::all_of(frame.begin(), frame.end(), [](const auto& value) { return value.is_number(); });
    if (!sound) {
      return Fail(ErrorCode::kMalformed, "the frame is no list of " + std::to_string(numbers) + " numbers",
                  name + ": frame " + std::to_string(rows.size()), "list x, y, z of each joint that is declared");
    }
    rows.push_back(frame.get<std::vector<double>>());
  }
  return rows;
}

/// A user-defined format. JSON: the positions x y z of the declared joints in each frame.
Expected<IngestedClip> ReadToyClip(const SourceFile& file) {
  const Expected<SourceFrame> frame = FrameOf(file.source);
  if (!frame) return Forward(frame);
  const auto rows = ToyRows(file.bytes, file.name, 3 * file.source.joints.size());
  if (!rows) return Forward(rows);
  IngestedClip ingested;
  ingested.clip.rate = FrameRate::FromHz(*file.source.rate_hz);
  JointTracks tracks;
  tracks.names = file.source.joints;
  tracks.positions = JointPositions(static_cast<int>(rows->size()), static_cast<int>(tracks.names.size()));
  tracks.confidence.assign(rows->size() * tracks.names.size(), 1.0);
  for (int f = 0; f < tracks.positions.frames; ++f) {
    const std::vector<double>& row = (*rows)[static_cast<std::size_t>(f)];
    tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
    for (int j = 0; j < tracks.positions.joints; ++j)
      tracks.positions.at(f, j) = frame->metres_from_file * Vector3d(row[3 * j], row[3 * j + 1], row[3 * j + 2]);
  }
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

/// The number of frames of a toy file, known without a declaration.
Expected<RawFile> ToyIn(const FileBytes& file) {
  const auto rows = ToyRows(file.bytes, file.name, 0);
  if (!rows) return Forward(rows);
  RawClip clip;
  clip.format = "toy";
  clip.frames = static_cast<int>(rows->size());
  return RawFile::Of(std::move(clip));
}

class ToyFormat : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    static FormatDriver driver;
    if (driver.to_clip != nullptr) return;  // already added
    driver.name = "toy";
    driver.inspected = "toy";
    driver.gives = EvidenceKind::kJointTracks;
    driver.lists_joints = true;
    driver.options = {"least_confidence"};
    driver.sniff = [](const FileBytes& file, FileKind) { return file.path.extension() == ".toy"; };
    driver.open = ToyIn;
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

TEST_F(ToyFormat, IsIngestedByDeclaration) {
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

TEST_F(ToyFormat, IsRecognisedWithoutADeclaration) {
  const std::filesystem::path folder = FreshFolder("toy_inspected");
  Put(folder / "anna.toy", "[[10, 90, 0, -10, 90, 0], [10, 95, 0, -10, 95, 5]]");
  Put(folder / "truncated.toy", "10 90 0");
  const Inspection inspection = InspectPath(folder, std::nullopt);
  ASSERT_EQ(inspection.clips.size(), 1u);
  EXPECT_EQ(inspection.clips[0].format, "toy");
  EXPECT_EQ(inspection.clips[0].frames.value, 2);
  ASSERT_EQ(inspection.findings.size(), 1u);
  EXPECT_EQ(inspection.findings[0].code, "malformed");
}

TEST_F(ToyFormat, FollowsTheErrorsAndRulesOfEveryFormat) {
  ExpectError(IngestOnly(Source("toy_violation", "[[10, 90"), "toy_violation"), ErrorCode::kMalformed, "wave_anna.toy");
  ExpectError(IngestOnly(Source("toy_short", "[[1, 2, 3, 4, 5, 6], [1, 2, 3, 4, 5]]"), "toy_short"),
              ErrorCode::kMalformed, "wave_anna.toy: frame 1");
  IngestOptions options = Source("toy_rules", "[]");
  options.source.columns = {"x", "z", "y"};
  ExpectError(CheckSource(options.source), ErrorCode::kConfig, "ingest.source.columns");
  options = Source("toy_rules", "[]");
  options.source.rate_hz.reset();
  ExpectError(CheckSource(options.source), ErrorCode::kConfig, "ingest.source.rate");
}

TEST_F(ToyFormat, RejectsADriverWithoutAReaderOrWithAUsedName) {
  FormatDriver driver;
  driver.name = "no_reader";
  EXPECT_THROW(AddFormat(driver), std::logic_error);
  driver.to_clip = ReadToyClip;
  driver.options = {"no_such_option"};
  EXPECT_THROW(AddFormat(driver), std::logic_error);
  driver.options = {};
  driver.name = "bvh";
  EXPECT_THROW(AddFormat(driver), std::logic_error);
}

}  // namespace
}  // namespace mocurate
