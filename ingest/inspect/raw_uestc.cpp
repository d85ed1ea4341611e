// The lists that lie in info/ beside UESTC's cache, and what they say of its videos.

#include <algorithm>

#include "core/base/text.h"
#include "ingest/inspect/inspect_files.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/uestc_folder.h"

namespace mocurate {
namespace {

constexpr const char* kNamesFile = "names.txt";
constexpr const char* kCountsFile = "num_frames_min.txt";
constexpr const char* kActionsFile = "action_classes.txt";

bool LooksLikeVideoInfo(std::string_view head) {
  const std::vector<std::string_view> lines = SplitText(head, '\n');
  return std::any_of(lines.begin(), lines.end(),
                     [](std::string_view line) { return ParseUestcName(Trim(line), kNamesFile).has_value(); });
}

}  // namespace

bool IsUestcInfo(const std::filesystem::path& path) {
  const std::filesystem::path file = path.filename();
  if (file != kNamesFile && file != kCountsFile && file != kActionsFile) return false;
  const Expected<std::string> head = ReadHead(path.parent_path() / kNamesFile);
  return head && LooksLikeVideoInfo(*head);
}

Expected<RawFile> ReadRawUestcInfo(const FileBytes& file) {
  RawCompanion companion{file.name, "uestc_info", {}, {}};
  const std::filesystem::path list = file.path.filename();
  if (list == kNamesFile) {
    const auto videos = ParseUestcNames(file.bytes, file.name);
    if (!videos) return Forward(videos);
    companion.numbers = {{"videos", static_cast<double>(videos->size())}};
  } else if (list == kCountsFile) {
    const auto frames = ParseUestcFrameCounts(file.bytes, file.name);
    if (!frames) return Forward(frames);
    double sum = 0.0;
    for (const int count : *frames) sum += count;
    companion.numbers = {{"videos", static_cast<double>(frames->size())}, {"frames", sum}};
  } else {
    const auto actions = ParseUestcActions(file.bytes, file.name);
    if (!actions) return Forward(actions);
    companion.numbers = {{"classes", static_cast<double>(actions->size())}};
  }
  return RawFile::Of(std::move(companion));
}

void CompareUestcInfo(const std::filesystem::path& cache, RawFile& observed) {
  std::error_code unknown;
  const std::filesystem::path folder = cache.has_parent_path() ? cache.parent_path() : ".";
  if (!std::filesystem::is_directory(folder / "info", unknown)) return;
  const Expected<UestcFolder> info = ReadUestcFolder(folder);
  if (!info) {
    observed.remarks.push_back(MakeFinding("malformed", Severity::kError, 0.0, info.error().Message()));
    return;
  }
  const std::size_t videos = info->videos.size();
  if (videos != observed.clips.size()) {
    observed.remarks.push_back(MakeFinding("count_contradiction", Severity::kError, static_cast<double>(videos),
                                           "info/names.txt names " + std::to_string(videos) +
                                               " videos, the cache holds " + std::to_string(observed.clips.size()) +
                                               ": which name is whose is not known; copy both from one place again"));
    return;
  }
  for (std::size_t i = 0; i < videos; ++i) {
    RawClip& clip = observed.clips[i];
    clip.facts.emplace_back("video", info->videos[i].Name());
    clip.facts.emplace_back("label", info->actions[static_cast<std::size_t>(info->videos[i].action)]);
    const auto doubt = CheckFrameCount(info->frames[i], static_cast<std::size_t>(clip.frames), static_cast<int>(i));
    if (doubt) clip.remarks.push_back(*doubt);
  }
}

}  // namespace mocurate
