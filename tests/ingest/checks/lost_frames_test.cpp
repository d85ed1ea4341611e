// HumanAct12 clips omit unannotated frames and state neither the frames nor the rate.

#include <gmock/gmock.h>

#include "core/formats/npy.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::Not;

class LostFrames : public Layouts {
 protected:
  void WriteClips(int seed, int clips) {
    StudioOptions options = Perfect(StudioLayout::kHumanAct12);
    options.subjects = 2;
    options.seed = seed;
    options.clips = clips;
    options.actions = {"run", "jump", "walk"};
    fs::remove_all(folder);
    Write(options);
  }

  std::vector<fs::path> Clips() const {
    std::vector<fs::path> clips;
    for (const auto& entry : fs::directory_iterator(folder / "HumanAct12")) clips.push_back(entry.path());
    std::sort(clips.begin(), clips.end());
    return clips;
  }

  static std::vector<std::string> Warnings(const fs::path& file) {
    return Codes(InspectPath(file, std::nullopt), "warning");
  }
};

TEST_F(LostFrames, AreNotReportedAsPositionJumps) {
  std::size_t clips = 0;
  for (const int seed : {1, 2, 3, 4, 5, 6, 7}) {
    WriteClips(seed, 8);
    for (const fs::path& clip : Clips()) {
      EXPECT_THAT(Warnings(clip), Not(Contains("position_jump"))) << clip << " of seed " << seed;
      ++clips;
    }
    IngestOptions declared = Declared("humanact12_npy");
    declared.path = folder / "HumanAct12";
    for (const ItemResult& clip : RunAll(declared)) {
      for (const Finding& finding : clip.outcome.findings) EXPECT_NE(finding.code, "position_jump") << clip.item;
    }
  }
  EXPECT_GE(clips, 200u);
}

TEST_F(LostFrames, DoNotHideAFiveMetrePositionJump) {
  WriteClips(1, 2);
  for (const fs::path& clip : Clips()) {
    NpyArray array = *ParseNpy(*ReadFile(clip), "clip.npy");
    const std::size_t wide = array.values.size() / array.shape[0];
    const std::size_t begin = array.shape[0] / 3;
    for (std::size_t i = begin * wide; i < (begin + 5) * wide; i += 3) array.values[i] += 5.0;
    ASSERT_TRUE(WriteFile(clip, WriteNpy(array)));
    EXPECT_THAT(Warnings(clip), Contains("position_jump")) << clip;
  }
}

}  // namespace
}  // namespace mocurate
