#include "ingest/synthetic/capture_files.h"

#include <map>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/sha256.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// Whether this names a file in a folder, and no other place: captures and lists of them may come from anybody.
bool IsPlainName(const std::string& name) {
  return !name.empty() && name != "." && name != ".." &&
         name.find_first_of(std::string_view("/\0", 2)) == std::string::npos;
}

Expected<nlohmann::json> ReadCapture(const fs::path& artifact) {
  const auto text = ReadFile(artifact);
  if (!text) return Forward(text);
  nlohmann::json capture = nlohmann::json::parse(*text, nullptr, false);
  if (!capture.is_object() || !capture.contains("files") || !capture["files"].is_object()) {
    return Fail(ErrorCode::kMalformed, "is not a capture", DisplayPath(artifact), "mocurate cache verify");
  }
  for (const auto& [name, content] : capture["files"].items()) {
    if (IsPlainName(name) && content.is_string()) continue;
    return Fail(ErrorCode::kMalformed, "a capture has a file with this name or without a text",
                DisplayPath(artifact) + ": " + DisplayPath(name), "make it again: mocurate cache prune");
  }
  return std::move(capture["files"]);
}

/// name -> SHA-256 of the written file; empty when the list is missing or unreadable.
std::map<std::string, std::string> ReadWritten(const fs::path& list) {
  const auto text = ReadFile(list);
  const nlohmann::json json = nlohmann::json::parse(text ? *text : std::string(), nullptr, false);
  std::map<std::string, std::string> written;
  if (!json.is_object()) return written;
  for (const auto& [name, sha256] : json.items()) {
    if (sha256.is_string() && IsPlainName(name)) written[name] = sha256.get<std::string>();
  }
  return written;
}

Status WriteList(const std::map<std::string, std::string>& written, const fs::path& list) {
  return WriteFile(list, nlohmann::json(written).dump(1) + "\n");
}

bool HoldsContent(const fs::path& file, const std::string& sha256) {
  const auto bytes = ReadFile(file);
  return bytes && Sha256Hex(*bytes) == sha256;
}

}  // namespace

Expected<std::set<std::string>> CaptureFileNames(const fs::path& artifact) {
  const auto files = ReadCapture(artifact);
  if (!files) return Forward(files);
  std::set<std::string> names;
  for (const auto& file : files->items()) names.insert(file.key());
  return names;
}

Status UnpackCapture(const fs::path& artifact, const fs::path& folder) {
  const auto files = ReadCapture(artifact);
  if (!files) return Forward(files);
  if (Status made = MakeFolder(folder); !made) return made;
  fs::path list = folder;
  list += ".json";
  const std::map<std::string, std::string> before = ReadWritten(list);
  std::map<std::string, std::string> now;
  for (const auto& [name, text] : files->items()) now[name] = Sha256Hex(text.get<std::string>());

  // The list names our files before they are written, so that a killed run can continue.
  std::map<std::string, std::string> both = now;
  both.insert(before.begin(), before.end());
  if (both != before) {
    for (const auto& [name, sha256] : now) {
      if (before.count(name) != 0 || !fs::exists(folder / name) || HoldsContent(folder / name, sha256)) continue;
      return Fail(ErrorCode::kCannotWrite, "another file has this name", DisplayPath(folder / name),
                  "move it away, or choose another run folder with -o");
    }
    if (Status listed = WriteList(both, list); !listed) return listed;
  }
  for (const auto& [name, text] : files->items()) {
    if (HoldsContent(folder / name, now[name])) continue;
    if (Status written = WriteFile(folder / name, text.get_ref<const std::string&>()); !written) return written;
  }
  for (const auto& [name, sha256] : before) {
    std::error_code left;
    if (now.count(name) == 0 && HoldsContent(folder / name, sha256)) fs::remove(folder / name, left);
  }
  return now == before ? Status() : WriteList(now, list);
}

}  // namespace mocurate
