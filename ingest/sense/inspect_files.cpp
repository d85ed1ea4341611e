#include "ingest/sense/inspect_files.h"

#include <algorithm>
#include <fstream>

#include "core/base/file.h"

namespace mocurate {
namespace {

constexpr int kDeepest = 6;  // folders below the one that is asked for
constexpr std::size_t kHeadBytes = 8192;

}  // namespace

Status ListFiles(const std::filesystem::path& path, std::vector<FileToInspect>& files) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    files.push_back({DisplayPath(path.filename()), path, fs::is_regular_file(path, error)});
    return {};
  }
  fs::recursive_directory_iterator at(path, fs::directory_options::skip_permission_denied, error);
  if (error) return Fail(ErrorCode::kUnreadable, error.message(), DisplayPath(path), "check its permissions");
  for (const fs::recursive_directory_iterator end; at != end;) {
    std::error_code unknown;
    if (at->is_directory(unknown) && at.depth() >= kDeepest) at.disable_recursion_pending();
    if (!at->is_directory(unknown)) {
      files.push_back({DisplayPath(at->path().lexically_relative(path)), at->path(), at->is_regular_file(unknown)});
    }
    at.increment(error);
    if (error) return Fail(ErrorCode::kUnreadable, error.message(), DisplayPath(path), "check its permissions");
  }
  std::sort(files.begin(), files.end(), [](const FileToInspect& a, const FileToInspect& b) { return a.name < b.name; });
  return {};
}

Expected<std::string> ReadHead(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return Fail(ErrorCode::kUnreadable, "the file cannot be opened", DisplayPath(path), "check its permissions");
  std::string head(kHeadBytes, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head;
}

bool EndsAsJpeg(const std::filesystem::path& path) {
  constexpr std::streamoff kTail = 4096;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  file.seekg(std::max<std::streamoff>(0, size - kTail));
  std::string tail(static_cast<std::size_t>(std::min(size, kTail)), '\0');
  file.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  return tail.find("\xFF\xD9") != std::string::npos;
}

}  // namespace mocurate
