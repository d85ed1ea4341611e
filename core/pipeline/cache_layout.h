#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/pipeline/stage.h"

namespace mocurate {

/// Record of an artifact in the cache: `objects/ab/cd/<rest of the key>.json`.
struct CacheRecord {
  std::string key;
  StageOutcome outcome;
  std::string artifact;  ///< file name beside the record; empty without an artifact
  std::string sha256;
  std::uint64_t bytes = 0;
};

std::filesystem::path RecordPath(const std::filesystem::path& cache, const std::string& key);

/// The record of a cache with one level of folders, which is still read.
std::filesystem::path OldRecordPath(const std::filesystem::path& cache, const std::string& key);

/// Key of a record's file, from its place: the content may be damaged.
std::string KeyOfRecord(const std::filesystem::path& record);

/// Empty when there is none or it cannot be read.
std::optional<CacheRecord> ReadRecord(const std::filesystem::path& file);
std::string RecordText(const CacheRecord& record);

/// `<rest of the key>-<8 digits of the content's hash><extension>`: two processes with different bytes never overwrite
/// each other. The last written record wins, and each record names complete bytes.
std::string ArtifactName(const std::string& key, const std::string& sha256, const std::filesystem::path& artifact);

/// The record beside an artifact of the cache.
std::filesystem::path RecordOf(const std::filesystem::path& artifact);

/// Whether `path` is an artifact of this cache (by its place alone).
bool IsObject(const std::filesystem::path& cache, const std::filesystem::path& path);

/// Removes an artifact and its record: the item is made again when it is next asked for.
void DropObject(const std::filesystem::path& artifact);

/// Calls `visit` for every file or folder of the objects/??/??/; order is that of the names.
void ForEachObject(const std::filesystem::path& cache, const std::function<void(const std::filesystem::path&)>& visit);

}  // namespace mocurate
