#include "ingest/sources/uestc_folder.h"

#include "core/base/file.h"

namespace mocurate {
namespace {

constexpr const char* kCounts = "info/num_frames_min.txt";

Expected<std::string> ReadBeside(const std::filesystem::path& folder, const std::string& name) {
  Expected<std::string> bytes = ReadFile(folder / name);
  if (!bytes && bytes.error().code == ErrorCode::kNotFound) {
    return Fail(ErrorCode::kNotFound, "the file is not in the folder: the container does not name its clips", name,
                "put it beside the container; `mocurate doctor --source NAME` lists what is needed");
  }
  return bytes;
}

}  // namespace

Expected<UestcFolder> ReadUestcFolder(const std::filesystem::path& folder) {
  const Expected<std::string> names = ReadBeside(folder, "info/names.txt");
  if (!names) return Forward(names);
  Expected<std::vector<UestcVideo>> videos = ParseUestcNames(*names, "info/names.txt");
  if (!videos) return Forward(videos);
  const Expected<std::string> counts = ReadBeside(folder, kCounts);
  if (!counts) return Forward(counts);
  Expected<std::vector<int>> frames = ParseUestcFrameCounts(*counts, kCounts, videos->size());
  if (!frames) return Forward(frames);
  const Expected<std::string> words = ReadBeside(folder, "info/action_classes.txt");
  if (!words) return Forward(words);
  Expected<std::vector<std::string>> actions = ParseUestcActions(*words, "info/action_classes.txt");
  if (!actions) return Forward(actions);
  return UestcFolder{*std::move(videos), *std::move(frames), *std::move(actions)};
}

std::optional<Finding> CheckFrameCount(int declared, std::size_t frames, int entry) {
  if (declared <= 0 || static_cast<std::size_t>(declared) <= frames) return std::nullopt;
  return MakeFinding(
      "count_contradiction", Severity::kError, declared,
      std::string(kCounts) + ":" + std::to_string(entry + 1) + " declares " + std::to_string(declared) +
          " frames, VIBE's track of the video has " + std::to_string(frames) +
          ": those are used; correct the line, or copy info/ and the cache again if other lines differ too",
      FindingAction::kKept);
}

}  // namespace mocurate
