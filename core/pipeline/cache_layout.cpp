#include "core/pipeline/cache_layout.h"

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

constexpr std::size_t kKeyDigits = 64;  ///< of a SHA-256

std::vector<fs::path> Sorted(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code problem;
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

fs::path OldRecordPath(const fs::path& cache, const std::string& key) {
  return cache / "objects" / key.substr(0, 2) / (key.substr(2) + ".json");
}

std::string KeyOfRecord(const fs::path& record) {
  const fs::path folder = record.parent_path();
  const std::string name = record.stem().string();
  if (name.size() == kKeyDigits - 2) return folder.filename().string() + name;
  return folder.parent_path().filename().string() + folder.filename().string() + name;
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
  return path.native().compare(0, objects.size(), objects) == 0;
}

void DropObject(const fs::path& artifact) {
  std::error_code ignored;
  fs::remove(RecordOf(artifact), ignored);
  fs::remove_all(artifact, ignored);
}

std::optional<CacheRecord> ReadRecord(const fs::path& file) {
  const Expected<std::string> text = ReadFile(file);
  if (!text) return std::nullopt;
  const Expected<nlohmann::json> value = FromCanonicalText(*text);
  if (!value || !value->is_object() || !value->contains("outcome")) return std::nullopt;
  Expected<StageOutcome> outcome = OutcomeFromJson(value->at("outcome"));
  if (!outcome) return std::nullopt;
  try {
    return CacheRecord{value->at("key").get<std::string>(), *std::move(outcome),
                       value->at("artifact").get<std::string>(), value->at("sha256").get<std::string>(),
                       value->at("bytes").get<std::uint64_t>()};
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
  for (const fs::path& folder : Sorted(cache / "objects")) {
    for (const fs::path& entry : Sorted(folder)) {
      if (entry.filename().native().size() > 2) {
        visit(entry);  // of a cache with one level
        continue;
      }
      for (const fs::path& object : Sorted(entry)) visit(object);
    }
  }
}

}  // namespace mocurate
