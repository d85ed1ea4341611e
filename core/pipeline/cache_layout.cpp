#include "core/pipeline/cache_layout.h"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <vector>

#include "core/base/file.h"
#include "core/pipeline/wire.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// So that a person can open an artifact: stages write to a name without extension.
std::string ExtensionOf(const fs::path& artifact) {
  std::error_code problem;
  if (fs::is_directory(artifact, problem)) return "";
  std::string begin(16, '\0');
  std::ifstream stream(artifact, std::ios::binary);
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(stream.gcount()));
  if (begin.rfind("\x89HDF", 0) == 0) return ".h5";
  if (begin.rfind("<!DOCTYPE", 0) == 0 || begin.rfind("<!doctype", 0) == 0) return ".html";
  if (begin.rfind('{', 0) == 0 || begin.rfind('[', 0) == 0) return ".json";
  return ".bin";
}

constexpr std::size_t kKeyDigits = 64;             ///< of a SHA-256
constexpr std::size_t kContentDigits = 8;          ///< in the name of an artifact
constexpr std::uint64_t kLargestRecord = 1 << 28;  ///< as of a worker's answer, which it holds

bool IsHex(std::string_view text) { return text.find_first_not_of("0123456789abcdef") == std::string_view::npos; }

/// Whether this is a folder and not a link to one.
bool IsRealFolder(const fs::path& path) {
  std::error_code problem;
  return fs::symlink_status(path, problem).type() == fs::file_type::directory;
}

/// What follows the digits of the key in the name of an object; empty where the name does not begin with them.
std::string_view AfterDigits(std::string_view name) {
  constexpr std::size_t kDigits = kKeyDigits - 4;  // the first four name the folders
  if (name.size() <= kDigits || !IsHex(name.substr(0, kDigits)) || IsHex(name.substr(kDigits, 1))) return {};
  return name.substr(kDigits);
}

bool IsArtifactName(std::string_view name) {
  const std::string_view rest = AfterDigits(name);
  if (rest.size() < 1 + kContentDigits || rest[0] != '-' || !IsHex(rest.substr(1, kContentDigits))) return false;
  const std::string_view extension = rest.substr(1 + kContentDigits);
  return extension.empty() || extension == ".h5" || extension == ".html" || extension == ".json" || extension == ".bin";
}

/// Whether the cache gives such names, also to what it has not finished.
bool IsOurName(std::string_view name) {
  return IsArtifactName(name) || AfterDigits(name).substr(0, 5) == ".json" || name.rfind(".copy-", 0) == 0 ||
         name.rfind(".tmp-", 0) == 0;
}

/// Whether no folder from `objects` down to this object is a link.
bool BelowRealFolders(const fs::path& object) {
  fs::path folder = object.parent_path();
  for (; folder.filename() != "objects"; folder = folder.parent_path()) {
    if (!folder.has_relative_path() || !IsRealFolder(folder)) return false;
  }
  return IsRealFolder(folder);
}

std::vector<fs::path> Sorted(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code problem;
  if (!IsRealFolder(folder)) return entries;
  for (fs::directory_iterator it(folder, problem), end; !problem && it != end; it.increment(problem)) {
    entries.push_back(it->path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace

fs::path RecordPath(const fs::path& cache, const std::string& key) {
  return cache / "objects" / key.substr(0, 2) / key.substr(2, 2) / (key.substr(4) + ".json");
}

std::string KeyOfRecord(const fs::path& record) {
  const fs::path folder = record.parent_path();
  return folder.parent_path().filename().string() + folder.filename().string() + record.stem().string();
}

std::string ArtifactName(const std::string& key, const std::string& sha256, const fs::path& artifact) {
  return key.substr(4) + "-" + sha256.substr(0, 8) + ExtensionOf(artifact);
}

fs::path RecordOf(const fs::path& artifact) {
  const std::string name = artifact.filename().native();
  return artifact.parent_path() / (name.substr(0, name.rfind('-')) + ".json");
}

bool IsObject(const fs::path& cache, const fs::path& path) {
  const std::string objects = (cache / "objects").native() + "/";
  if (path.native().compare(0, objects.size(), objects) != 0) return false;
  std::string_view place = std::string_view(path.native()).substr(objects.size());
  for (int level = 0; level < 2; ++level) {
    if (place.size() < 3 || place[2] != '/' || !IsHex(place.substr(0, 2))) return false;
    place.remove_prefix(3);
  }
  return IsArtifactName(place);
}

std::optional<std::uint64_t> BytesOfArtifact(const fs::path& artifact) {
  struct stat facts {};
  if (lstat(artifact.c_str(), &facts) != 0) return std::nullopt;
  if (S_ISREG(facts.st_mode)) return static_cast<std::uint64_t>(facts.st_size);
  if (!S_ISDIR(facts.st_mode)) return std::nullopt;
  std::uint64_t total = 0;
  std::error_code problem;
  for (fs::directory_iterator it(artifact, problem), end; !problem && it != end; it.increment(problem)) {
    const std::optional<std::uint64_t> bytes = BytesOfArtifact(it->path());
    if (!bytes) return std::nullopt;
    total += *bytes;
  }
  return problem ? std::nullopt : std::optional<std::uint64_t>(total);
}

void DropObject(const fs::path& cache, const fs::path& artifact) {
  if (!IsObject(cache, artifact) || !BelowRealFolders(artifact)) return;
  std::error_code ignored;
  fs::remove(RecordOf(artifact), ignored);
  fs::remove_all(artifact, ignored);
}

std::optional<CacheRecord> ReadRecord(const fs::path& file) {
  struct stat facts {};
  if (lstat(file.c_str(), &facts) != 0 || !S_ISREG(facts.st_mode) || !BelowRealFolders(file)) return std::nullopt;
  if (static_cast<std::uint64_t>(facts.st_size) > kLargestRecord) return std::nullopt;
  const Expected<std::string> text = ReadFile(file);
  if (!text) return std::nullopt;
  const Expected<nlohmann::json> value = FromCanonicalText(*text);
  if (!value || !value->is_object() || !value->contains("outcome")) return std::nullopt;
  Expected<StageOutcome> outcome = OutcomeFromJson(value->at("outcome"));
  if (!outcome) return std::nullopt;
  try {
    CacheRecord record{value->at("key").get<std::string>(), *std::move(outcome),
                       value->at("artifact").get<std::string>(), value->at("sha256").get<std::string>(),
                       value->at("bytes").get<std::uint64_t>()};
    const bool beside = IsArtifactName(record.artifact) && record.artifact.rfind(file.stem().native() + "-", 0) == 0;
    if (!record.artifact.empty() && !beside) return std::nullopt;
    return record;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

std::string RecordText(const CacheRecord& record) {
  return CanonicalText({{"key", record.key},
                        {"outcome", ToJson(record.outcome)},
                        {"artifact", record.artifact},
                        {"sha256", record.sha256},
                        {"bytes", record.bytes}}) +
         "\n";
}

void ForEachObject(const fs::path& cache, const std::function<void(const fs::path&)>& visit) {
  const auto is_level = [](const fs::path& path) {
    return path.filename().native().size() == 2 && IsHex(path.filename().native());
  };
  for (const fs::path& folder : Sorted(cache / "objects")) {
    if (!is_level(folder)) continue;
    for (const fs::path& entry : Sorted(folder)) {
      if (!is_level(entry)) continue;
      for (const fs::path& object : Sorted(entry)) {
        std::error_code none;
        if (IsOurName(object.filename().native()) && !fs::is_symlink(object, none)) visit(object);
      }
    }
  }
}

}  // namespace mocurate
