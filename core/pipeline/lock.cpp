#include "core/pipeline/lock.h"

#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "core/base/file.h"
#include "core/base/links.h"

namespace mocurate {
namespace {

tl::unexpected<Error> CannotLock(const std::filesystem::path& file, int problem) {
  return Fail(ErrorCode::kCannotWrite, std::string("lock file cannot be used: ") + std::strerror(problem),
              DisplayPath(file), "choose a folder that can be written");
}

/// False when the locked file was removed or replaced while we waited: then the lock is worth nothing.
bool StillThere(int file, const std::filesystem::path& path) {
  struct stat ours {};
  struct stat there {};
  return fstat(file, &ours) == 0 && stat(path.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

}  // namespace

Expected<std::optional<FileLock>> FileLock::Try(const std::filesystem::path& path, int operation) {
  while (true) {
    const Expected<int> opened = OpenInPlace(path, 0, false);
    if (!opened) return Forward(opened);
    const int file = *opened;
    FileLock lock(file);
    int result = 0;
    do {
      result = flock(file, operation);
    } while (result != 0 && errno == EINTR);
    if (result != 0) {
      if (errno == EWOULDBLOCK) return std::optional<FileLock>();
      // File systems shared by nodes may be mounted without locks: then nothing tells two runs apart.
      if (errno == ENOLCK || errno == ENOSYS || errno == EOPNOTSUPP) return std::optional<FileLock>(std::move(lock));
      return CannotLock(path, errno);
    }
    if (StillThere(file, path)) return std::optional<FileLock>(std::move(lock));
  }
}

Expected<std::optional<FileLock>> FileLock::TryTake(const std::filesystem::path& file) {
  return Try(file, LOCK_EX | LOCK_NB);
}

Expected<FileLock> FileLock::Take(const std::filesystem::path& file) {
  Expected<std::optional<FileLock>> lock = Try(file, LOCK_EX);
  if (!lock) return Forward(lock);
  return std::move(**lock);
}

FileLock::FileLock(FileLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(file_, other.file_);
  return *this;
}

FileLock::~FileLock() {
  if (file_ >= 0) close(file_);
}

Status FileLock::WriteHolder(const std::string& text) const {
  struct stat facts {};
  if (fstat(file_, &facts) != 0 || facts.st_nlink > 1) {
    return Fail(ErrorCode::kCannotWrite, "the lock file has another name (a hard link), which a change would reach", {},
                "remove it, or choose another -o");
  }
  if (ftruncate(file_, 0) != 0 || pwrite(file_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
    return Fail(ErrorCode::kCannotWrite, std::string("lock file cannot be written: ") + std::strerror(errno));
  }
  return {};
}

}  // namespace mocurate
