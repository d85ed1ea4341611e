// The lists in info/ of UESTC, and their contradictions with the tracks of the cache.

#include <gmock/gmock.h>

#include "core/formats/vibe_pickle.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

class UestcInfo : public Layouts {
 protected:
  void SetUp() override {
    Layouts::SetUp();
    StudioOptions options = Perfect(StudioLayout::kUestc);
    options.subjects = 1;
    options.actions = {"punching", "squatting"};
    Write(options);
  }

  void Put(const std::string& name, const std::string& bytes) {
    ASSERT_TRUE(WriteFile(folder / "uestc" / name, bytes));
  }

  /// Sets line `line` (from 1) of info/num_frames_min.txt to `count`.
  void WriteFrameCount(std::size_t line, const std::string& count) {
    std::string text = Bytes("uestc/info/num_frames_min.txt");
    std::size_t begin = 0;
    for (std::size_t i = 1; i < line; ++i) begin = text.find('\n', begin) + 1;
    Put("info/num_frames_min.txt", text.replace(begin, text.find('\n', begin) - begin, count));
  }

  /// Findings that contradict a count.
  std::vector<Json> Contradictions(const std::string& path = "uestc") const {
    std::vector<Json> found;
    const Json inspection = InspectPath(folder / path, std::nullopt);
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("code") == "count_contradiction") found.push_back(finding);
    }
    return found;
  }
};

TEST_F(UestcInfo, ReportsAFrameCountAboveTheTrackLengthWithItsLine) {
  const IngestOptions options = Declared("uestc", {"ingest.path=" + (folder / "uestc").string()});
  EXPECT_EQ(CountCode(RunAll(options), "count_contradiction"), 0u);
  WriteFrameCount(3, "9999");
  const std::vector<ItemResult> clips = RunAll(options);
  EXPECT_EQ(CountCode(clips, "count_contradiction"), 1u);
  const std::string third = Bytes("uestc/info/names.txt").substr(48, 13);  // lines of 23 characters: "a4_d2_p001_c1"
  bool found = false;
  for (const ItemResult& clip : clips) {
    for (const Finding& finding : clip.outcome.findings) {
      if (finding.code != "count_contradiction") continue;
      found = true;
      EXPECT_NE(clip.item.find(third), std::string::npos) << clip.item;
      EXPECT_EQ(finding.value, 9999);
    }
  }
  EXPECT_TRUE(found);
}

TEST_F(UestcInfo, RejectsNamesOfAnotherRelease) {
  Put("info/names.txt", Bytes("uestc/info/names.txt") + "a7_d2_p001_c1_color.avi\n");
  Put("info/num_frames_min.txt", Bytes("uestc/info/num_frames_min.txt") + "20\n");
  const auto discovery = Discover(Declared("uestc", {"ingest.path=" + (folder / "uestc").string()}));
  ASSERT_FALSE(discovery);
  EXPECT_EQ(discovery.error().code, ErrorCode::kInconsistent);
  EXPECT_EQ(discovery.error().where, "vibe_cache_refined.pkl") << discovery.error().Message();
}

TEST_F(UestcInfo, AcceptsAFrameCountBelowTheTrackLength) {
  WriteFrameCount(3, "20");
  const IngestOptions options = Declared("uestc", {"ingest.path=" + (folder / "uestc").string()});
  EXPECT_EQ(CountCode(RunAll(options), "count_contradiction"), 0u);
  EXPECT_THAT(Contradictions(), IsEmpty());
}

TEST_F(UestcInfo, ReportsANonPositiveCameraScaleOfAVideo) {
  const std::string name = "vibe_cache_refined.pkl";
  const std::string bytes = Bytes("uestc/" + name);
  const auto cache = VibeCache::Open(bytes, name);
  ASSERT_TRUE(cache);
  std::vector<VibeTrack> videos;
  for (std::size_t video = 0; video < cache->size(); ++video) videos.push_back(*cache->Track(video));
  videos[1].original_camera[4 * 7] *= -1.0;
  Put(name, *EncodeVibeCache(videos, name));
  const Json inspection = InspectPath(folder / "uestc", std::nullopt);
  std::vector<std::string> places;
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("severity") == "error") places.push_back(finding.at("where"));
  }
  EXPECT_THAT(places, ElementsAre(name + "[1]"));
}

TEST_F(UestcInfo, IsUsedByAnInspectionToNameVideos) {
  const Json inspection = InspectPath(folder / "uestc", std::nullopt);
  EXPECT_THAT(Codes(inspection, "info"), Not(Contains("other_files"))) << inspection.at("findings");
  std::size_t lists = 0;
  for (const Json& companion : inspection.at("companions")) lists += companion.at("format") == "uestc_info" ? 1 : 0;
  EXPECT_EQ(lists, 3u);
  EXPECT_EQ(inspection.at("clips").at(0).at("facts").at("video"), Bytes("uestc/info/names.txt").substr(0, 23));
  EXPECT_THAT(Contradictions(), IsEmpty());
}

TEST_F(UestcInfo, ReportsContradictionsOfAFolderAndOfTheCacheAlone) {
  WriteFrameCount(2, "9999");
  for (const std::string path : {"uestc", "uestc/vibe_cache_refined.pkl"}) {
    const std::vector<Json> found = Contradictions(path);
    ASSERT_EQ(found.size(), 1u) << path;
    EXPECT_EQ(found[0].at("where"), "vibe_cache_refined.pkl[1]");
    EXPECT_EQ(found[0].at("value"), 9999);
  }
}

TEST_F(UestcInfo, ReportsDamagedListsAndListsOfOtherVideos) {
  const std::string names = Bytes("uestc/info/names.txt"), counts = Bytes("uestc/info/num_frames_min.txt");
  Put("info/names.txt", names.substr(0, names.rfind('\n', names.size() - 2) + 1));
  Put("info/num_frames_min.txt", counts.substr(0, counts.rfind('\n', counts.size() - 2) + 1));
  const std::vector<Json> found = Contradictions();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].at("value"), 3);
  WriteFrameCount(2, "many");
  const Json inspection = InspectPath(folder / "uestc", std::nullopt);
  EXPECT_THAT(Codes(inspection, "error"), ElementsAre("malformed", "malformed"));
}

}  // namespace
}  // namespace mocurate
