#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "ingest/synthetic/studio_layouts.h"
#include "tests/ingest/sources.h"

namespace mocurate {

/// Options without errors.
inline StudioOptions Perfect(StudioLayout layout) {
  StudioOptions options;
  options.layout = layout;
  options.subjects = 2;
  options.tracker = TrackerOptions{0, 0, 0, 4, 0, 0.1, 0.5, 0, 2, 0, 0, 8};
  options.keypoints = KeypointOptions{0, 0, 0, 0, 1, 0};
  options.depth.enabled = false;
  return options;
}

/// All ground-truth clips of a folder.
inline std::map<std::string, Motion> TruthOf(const std::filesystem::path& folder) {
  std::map<std::string, Motion> all;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "truth")) {
    const auto truth = ReadTruth(entry.path());
    EXPECT_TRUE(truth) << truth.error().Message();
    for (const auto& [id, motion] : truth->motion) all.emplace(id, motion);
  }
  return all;
}

inline std::map<std::string, std::string> BytesBelow(const std::filesystem::path& folder) {
  std::map<std::string, std::string> bytes;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file())
      bytes[std::filesystem::relative(entry.path(), folder).string()] = *ReadFile(entry.path());
  }
  return bytes;
}

/// A studio folder of one test, and its ground truth.
class Layouts : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = FreshFolder(std::string("layout_") + test->name());
    std::filesystem::remove_all(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  void Write(const StudioOptions& options) {
    const auto counts = WriteStudioLayout(options, folder, 2);
    ASSERT_TRUE(counts) << counts.error().Message();
    truth = TruthOf(folder);
    ASSERT_FALSE(truth.empty());
  }

  std::string Bytes(const std::string& name) const {
    const auto bytes = ReadFile(folder / name);
    EXPECT_TRUE(bytes) << bytes.error().Message();
    return bytes ? *bytes : std::string();
  }

  /// The clips of the stage `ingest` under a declaration of configs/sources, by clip id.
  std::map<std::string, Clip> Ingested(const std::string& declaration, const std::string& below) {
    std::map<std::string, Clip> clips;
    const IngestOptions ingest = Declared(declaration, {"ingest.path=" + (folder / below).string()});
    const auto discovery = Discover(ingest);
    EXPECT_TRUE(discovery) << discovery.error().Message();
    EXPECT_TRUE(discovery->excluded.empty());
    for (const ItemSpec& item : discovery->items) {
      const StageRequest request{"ingest", item.item, item.options.Whole(), item.inputs, folder / "clip.h5", folder};
      const auto outcome = IngestStage(request);
      EXPECT_TRUE(outcome) << outcome.error().Message();
      if (!outcome) continue;
      for (const Finding& finding : outcome->findings) {
        if (finding.severity == Severity::kError) ADD_FAILURE() << item.item << ": " << finding.message;
      }
      auto clip = ReadEvidence(request.output);
      EXPECT_TRUE(clip) << clip.error().Message();
      clips.emplace(clip->id(), std::move(*clip));
    }
    return clips;
  }

  std::filesystem::path folder;
  std::map<std::string, Motion> truth;
};

}  // namespace mocurate
