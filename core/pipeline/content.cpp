#include "core/pipeline/content.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "core/base/file.h"
#include "core/base/sha256.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// Relative names of all files below `folder`, sorted by their bytes.
Expected<std::vector<fs::path>> FilesBelow(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code problem;
  for (fs::recursive_directory_iterator it(folder, problem), end; !problem && it != end; it.increment(problem)) {
    if (it->is_regular_file(problem)) files.push_back(it->path().lexically_relative(folder));
  }
  if (problem) {
    return Fail(ErrorCode::kUnreadable, "folder cannot be listed: " + problem.message(), DisplayPath(folder));
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) { return a.native() < b.native(); });
  return files;
}

Status SyncFile(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  const int problem = errno;
  if (file >= 0) close(file);
  if (!synced) return Fail(ErrorCode::kCannotWrite, std::string("fsync: ") + std::strerror(problem), DisplayPath(path));
  return {};
}

}  // namespace

Expected<Content> ContentOf(const fs::path& path) {
  std::error_code problem;
  if (!fs::is_directory(path, problem)) {
    if (fs::is_other(path, problem)) {
      return Fail(ErrorCode::kUnreadable, "is a device or a pipe, a file or folder is expected", DisplayPath(path));
    }
    Expected<std::string> sha256 = Sha256OfFile(path);
    if (!sha256) return Forward(sha256);
    return Content{*std::move(sha256), BytesOf(path)};
  }
  const Expected<std::vector<fs::path>> files = FilesBelow(path);
  if (!files) return Forward(files);
  Content content;
  Sha256 hasher;
  hasher.Add("folder\n");
  for (const fs::path& file : *files) {
    const Expected<std::string> sha256 = Sha256OfFile(path / file);
    if (!sha256) return Forward(sha256);
    hasher.Add(file.native()).Add(std::string_view("\0", 1)).Add(*sha256).Add("\n");
    content.bytes += BytesOf(path / file);
  }
  content.sha256 = hasher.Hex();
  return content;
}

std::uint64_t BytesOf(const fs::path& path) {
  std::error_code problem;
  if (!fs::is_directory(path, problem)) {
    const std::uint64_t bytes = fs::file_size(path, problem);
    return problem ? 0 : bytes;
  }
  std::uint64_t total = 0;
  for (const fs::path& file : FilesBelow(path).value_or(std::vector<fs::path>())) total += BytesOf(path / file);
  return total;
}

Status SyncContent(const fs::path& path) {
  std::error_code problem;
  if (!fs::is_directory(path, problem)) return SyncFile(path);
  const Expected<std::vector<fs::path>> files = FilesBelow(path);
  if (!files) return Forward(files);
  for (const fs::path& file : *files) {
    if (Status synced = SyncFile(path / file); !synced) return synced;
  }
  return {};
}

Expected<std::string> ContentMemo::Sha256Of(const fs::path& path) {
  struct stat now {};
  const bool plain = stat(path.c_str(), &now) == 0 && S_ISREG(now.st_mode);
  if (!plain) {
    const Expected<Content> content = ContentOf(path);
    if (!content) return Forward(content);
    return content->sha256;
  }
  const std::int64_t modified_ns = std::int64_t{now.st_mtim.tv_sec} * 1000000000 + now.st_mtim.tv_nsec;
  Known& known = known_[path.native()];
  const auto bytes = static_cast<std::uint64_t>(now.st_size);
  if (!known.sha256.empty() && known.modified_ns == modified_ns && known.bytes == bytes && known.inode == now.st_ino) {
    return known.sha256;
  }
  Expected<std::string> sha256 = Sha256OfFile(path);
  if (sha256) known = Known{modified_ns, bytes, now.st_ino, *sha256};
  return sha256;
}

}  // namespace mocurate
