#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "core/pipeline/stage.h"

namespace mocurate {

/// Record of an artifact in the cache: `objects/ab/cd/<rest of the key>.json`. Caches travel between people: what a
/// record names is an object beside it or nothing, and no link is followed below the cache's folder.
struct CacheRecord {
  std::string key;
  StageOutcome outcome;
  std::string artifact;  ///< name of an object beside the record; empty without an artifact
  std::string sha256;
  std::uint64_t bytes = 0;
};

std::filesystem::path RecordPath(const std::filesystem::path& cache, const std::string& key);

/// Key of a record's file, from its place: the content may be damaged.
std::string KeyOfRecord(const std::filesystem::path& record);

/// Empty when there is none, or when it is not a record of its place (a link, damaged, of an artifact elsewhere).
std::optional<CacheRecord> ReadRecord(const std::filesystem::path& file);
std::string RecordText(const CacheRecord& record);

/// `<rest of the key>-<8 digits of the content's hash><extension>`: two processes with different bytes never overwrite
/// each other. The last written record wins, and each record names complete bytes.
std::string ArtifactName(const std::string& key, const std::string& sha256, const std::filesystem::path& artifact);

/// The record beside an artifact of the cache.
std::filesystem::path RecordOf(const std::filesystem::path& artifact);

/// Whether `path` has the place and the name of an artifact of this cache.
bool IsObject(const std::filesystem::path& cache, const std::filesystem::path& path);

/// Bytes of an artifact; empty where it is missing, or where it or something inside it is neither a file nor a folder
/// (a link, a pipe).
std::optional<std::uint64_t> BytesOfArtifact(const std::filesystem::path& artifact);

/// Removes an artifact of the cache and its record: the item is made again when it is next asked for. Leaves anything
/// else as it is.
void DropObject(const std::filesystem::path& cache, const std::filesystem::path& artifact);

/// Calls `visit` for every record, artifact and unfinished object of the cache; order is that of the names. Links, and
/// names that the cache does not give, are passed over.
void ForEachObject(const std::filesystem::path& cache, const std::function<void(const std::filesystem::path&)>& visit);

}  // namespace mocurate
