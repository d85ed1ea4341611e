#include "ingest/sources/container.h"

#include <cstdio>
#include <memory>
#include <optional>

#include "core/base/file.h"
#include "core/store/dataset_clips.h"
#include "ingest/sources/mapped_file.h"
#include "ingest/sources/uestc_folder.h"

namespace mocurate {
namespace {

/// What a container looked like when it was opened: another file under its name is opened again.
struct FileVersion {
  std::filesystem::path path;
  std::uintmax_t size = 0;
  std::filesystem::file_time_type written;
};

bool operator==(const FileVersion& a, const FileVersion& b) {
  return a.path == b.path && a.size == b.size && a.written == b.written;
}

FileVersion VersionOf(const std::filesystem::path& path) {
  std::error_code unknown;
  return {path, std::filesystem::file_size(path, unknown), std::filesystem::last_write_time(path, unknown)};
}

/// UESTC's cache with the bytes that it points into.
struct OpenCache {
  FileVersion version;
  std::shared_ptr<const MappedFile> file;
  VibeCache cache;
};

struct OpenPickle {
  FileVersion version;
  std::shared_ptr<const MappedFile> file;
  HumanAct12Archive archive;
};

Expected<std::vector<ContainerEntry>> UestcEntries(const std::filesystem::path& folder) {
  const Expected<UestcFolder> info = ReadUestcFolder(folder);
  if (!info) return Forward(info);
  std::vector<ContainerEntry> entries;
  for (std::size_t i = 0; i < info->videos.size(); ++i) {
    const UestcVideo& video = info->videos[i];
    ContainerEntry entry{video.Name(), info->actions[static_cast<std::size_t>(video.action)], info->frames[i], ""};
    if (video.side == 2 && video.view == 8) entry.left_out = "the second camera moves in view 8";
    if (info->frames[i] == 0) entry.left_out = "info/num_frames_min.txt says that it has no frame";
    entries.push_back(std::move(entry));
  }
  return entries;
}

Expected<std::shared_ptr<const OpenPickle>> HumanAct12Of(const std::filesystem::path& path) {
  static std::shared_ptr<const OpenPickle> last;
  const FileVersion version = VersionOf(path);
  if (last && last->version == version) return last;
  last.reset();
  auto file = MappedFile::Open(path);
  if (!file) return Forward(file);
  Expected<HumanAct12Archive> archive = HumanAct12Archive::Open((*file)->bytes(), DisplayPath(path.filename()));
  if (!archive) return Forward(archive);
  last = std::make_shared<const OpenPickle>(OpenPickle{version, std::move(*file), std::move(*archive)});
  return last;
}

Expected<std::vector<ContainerEntry>> HumanAct12Entries(const std::filesystem::path& path) {
  const auto pickle = HumanAct12Of(path);
  if (!pickle) return Forward(pickle);
  std::vector<ContainerEntry> entries;
  for (std::size_t i = 0; i < (*pickle)->archive.size(); ++i) {
    const Expected<int> label = (*pickle)->archive.Label(i);
    if (!label) return Forward(label);
    char name[48];
    std::snprintf(name, sizeof(name), "c%04zu_y%02d", i + 1, *label + 1);
    entries.push_back({name, "", 0, ""});
  }
  return entries;
}

struct OpenMotions {
  FileVersion version;
  DatasetClips clips;
};

Expected<std::shared_ptr<const OpenMotions>> MotionsOf(const std::filesystem::path& path, DatasetClips::Check check) {
  static std::shared_ptr<const OpenMotions> last;
  const FileVersion version = VersionOf(path);
  if (last && last->version == version) return last;
  last.reset();
  Expected<DatasetClips> clips = DatasetClips::Open(path, check);
  if (!clips) return Forward(clips);
  if (!(clips->axes() == AxisConvention())) {
    return Fail(ErrorCode::kUnsupported, "its axes are not the canonical ones", DisplayPath(path.filename()),
                "write it with right-handed axes, y up, facing +z");
  }
  last = std::make_shared<const OpenMotions>(OpenMotions{version, std::move(*clips)});
  return last;
}

Expected<std::vector<ContainerEntry>> MotionsEntries(const std::filesystem::path& path) {
  const auto motions = MotionsOf(path, DatasetClips::Check::kHashes);
  if (!motions) return Forward(motions);
  const DatasetClips& clips = (*motions)->clips;
  std::vector<ContainerEntry> entries;
  for (std::size_t row = 0; row < clips.size(); ++row) entries.push_back({clips.Id(row), clips.Label(row), 0, ""});
  return entries;
}

tl::unexpected<Error> NoEntry(int entry, std::size_t count, const std::string& name) {
  return Fail(ErrorCode::kInconsistent,
              "clip " + std::to_string(entry) + " is asked for, the file holds " + std::to_string(count), name,
              "does what stands beside the container belong to it?");
}

}  // namespace

Expected<std::vector<ContainerEntry>> EntriesOf(const SourceOptions& source, const std::filesystem::path& folder) {
  if (source.format == SourceFormat::kUestc) return UestcEntries(folder);
  const std::filesystem::path container = folder / source.container;
  return source.format == SourceFormat::kMotions ? MotionsEntries(container) : HumanAct12Entries(container);
}

Expected<VibeTrack> ReadUestcVideo(const std::filesystem::path& container, int entry, const std::string& name) {
  static std::optional<OpenCache> last;
  const FileVersion version = VersionOf(container);
  if (!last || !(last->version == version)) {
    last.reset();
    auto file = MappedFile::Open(container);
    if (!file) return Forward(file);
    Expected<VibeCache> cache = VibeCache::Open((*file)->bytes(), DisplayPath(container.filename()));
    if (!cache) return Forward(cache);
    last = OpenCache{version, std::move(*file), std::move(*cache)};
  }
  if (entry < 0 || static_cast<std::size_t>(entry) >= last->cache.size())
    return NoEntry(entry, last->cache.size(), name);
  return last->cache.Track(static_cast<std::size_t>(entry));
}

Expected<Clip> ReadMotionsEntry(const std::filesystem::path& container, int entry, const std::string& name) {
  // Whoever listed the clips has compared the hashes.
  const auto motions = MotionsOf(container, DatasetClips::Check::kNone);
  if (!motions) return Forward(motions);
  const DatasetClips& clips = (*motions)->clips;
  if (entry < 0 || static_cast<std::size_t>(entry) >= clips.size()) return NoEntry(entry, clips.size(), name);
  return clips.Read(static_cast<std::size_t>(entry));
}

Expected<HumanAct12Clip> ReadHumanAct12Entry(const std::filesystem::path& container, int entry,
                                             const std::string& name) {
  const auto pickle = HumanAct12Of(container);
  if (!pickle) return Forward(pickle);
  const HumanAct12Archive& archive = (*pickle)->archive;
  if (entry < 0 || static_cast<std::size_t>(entry) >= archive.size()) return NoEntry(entry, archive.size(), name);
  return archive.Clip(static_cast<std::size_t>(entry));
}

}  // namespace mocurate
