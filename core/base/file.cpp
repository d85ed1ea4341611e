#include "core/base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <new>
#include <system_error>

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// An open file, closed at the end of its life.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }
  int Close() {
    const int closed = ::close(number_);
    number_ = -1;
    return closed;
  }

 private:
  int number_;
};

std::string ReasonOf(int error) {
  const char* text = ::strerrordesc_np(error);
  return text != nullptr ? text : "system error " + std::to_string(error);
}

tl::unexpected<Error> CannotRead(const fs::path& path, int error) {
  if (error == ENOENT || error == ENOTDIR) return Fail(ErrorCode::kNotFound, "no such file", DisplayPath(path));
  if (error == EISDIR) return Fail(ErrorCode::kUnreadable, "is a folder, a file is expected", DisplayPath(path));
  return Fail(ErrorCode::kUnreadable, "cannot be read: " + ReasonOf(error), DisplayPath(path));
}

tl::unexpected<Error> CannotWrite(const fs::path& path, int error) {
  const std::string what = "cannot be written: " + ReasonOf(error);
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return Fail(ErrorCode::kCannotWrite, what + ", the disk is full", DisplayPath(path),
                  "free space there, or write to another folder");
    case EROFS:
    case EACCES:
    case EPERM:
      return Fail(ErrorCode::kCannotWrite, what, DisplayPath(path), "write to a folder that you may change");
    case ENOENT:
      return Fail(ErrorCode::kCannotWrite, what, DisplayPath(path), "its folder does not exist");
    case EFBIG:
      return Fail(ErrorCode::kCannotWrite, what, DisplayPath(path),
                  "raise the limit on the size of files (ulimit -f), or write where there is more space");
    default:
      return Fail(ErrorCode::kCannotWrite, what, DisplayPath(path), "write to another folder");
  }
}

int WriteAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int SyncPath(const fs::path& path, int flags) {
  Descriptor file(::open(path.c_str(), flags | O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return errno;
  // Some file systems cannot sync a folder and return EINVAL.
  return ::fsync(file.number()) == 0 || errno == EINVAL ? 0 : errno;
}

fs::path FolderOf(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

/// Name beside `path` that no other thread, process or machine uses at the same time.
fs::path TemporaryBeside(const fs::path& path) {
  static std::atomic<unsigned> count{0};
  char host[256] = {};
  ::gethostname(host, sizeof(host) - 1);
  unsigned machine = 2166136261u;
  for (const char* c = host; *c != '\0'; ++c) machine = (machine ^ static_cast<unsigned char>(*c)) * 16777619u;
  std::string extension = path.extension().string();
  if (extension.size() > 32) extension.clear();
  return FolderOf(path) / (".tmp-" + std::to_string(machine) + "-" + std::to_string(::getpid()) + "-" +
                           std::to_string(count++) + extension);
}

/// The place that is really written: the target of a link.
fs::path TargetOf(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path target = fs::weakly_canonical(path, error);
  return error ? path : target;
}

bool IsSpecial(const fs::path& path) {
  std::error_code error;
  return fs::is_other(fs::status(path, error));
}

Status FillTemporary(const fs::path& temporary, const fs::path& path, std::string_view bytes) {
  Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file.is_open()) return CannotWrite(path, errno);
  if (const int error = WriteAll(file.number(), bytes); error != 0) return CannotWrite(path, error);
  if (::fsync(file.number()) != 0 && errno != EINVAL) return CannotWrite(path, errno);
  if (file.Close() != 0) return CannotWrite(path, errno);
  return {};
}

Status WriteSpecial(const fs::path& path, std::string_view bytes) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.is_open()) return CannotWrite(path, errno);
  if (const int error = WriteAll(file.number(), bytes); error != 0) return CannotWrite(path, error);
  return {};
}

/// `fill` writes and syncs the temporary file, which is then renamed to `path`.
Status Publish(const fs::path& path, const std::function<Status(const fs::path& temporary)>& fill) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return CannotWrite(path, EISDIR);
  const fs::path temporary = TemporaryBeside(path);
  ::unlink(temporary.c_str());  // left by a killed process that had our number
  if (Status filled = fill(temporary); !filled) {
    ::unlink(temporary.c_str());
    return filled;
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    const int error = errno;
    ::unlink(temporary.c_str());
    return CannotWrite(path, error);
  }
  if (const int error = SyncPath(FolderOf(path), O_DIRECTORY); error != 0 && error != EACCES) {
    return CannotWrite(path, error);
  }
  return {};
}

}  // namespace

Status ReadFileInParts(const fs::path& path, const std::function<void(std::string_view part)>& take) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return CannotRead(path, errno);
  std::string buffer(std::size_t{1} << 20, '\0');
  for (;;) {
    const ssize_t count = ::read(file.number(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return CannotRead(path, errno);
    if (count == 0) return {};
    take(std::string_view(buffer.data(), static_cast<std::size_t>(count)));
  }
}

Expected<std::string> ReadFile(const fs::path& path) {
  try {
    std::string bytes;
    struct ::stat facts = {};
    if (::stat(path.c_str(), &facts) == 0 && S_ISREG(facts.st_mode)) {
      bytes.reserve(static_cast<std::size_t>(facts.st_size));
    }
    if (Status read = ReadFileInParts(path, [&](std::string_view part) { bytes += part; }); !read) {
      return Forward(read);
    }
    return bytes;
  } catch (const std::bad_alloc&) {
    return Fail(ErrorCode::kUnreadable, "does not fit into memory", DisplayPath(path));
  }
}

Expected<std::string> ReadSmallFile(const fs::path& path, std::size_t most, bool pipes) {
  struct ::stat facts = {};
  if (::stat(path.c_str(), &facts) != 0) return CannotRead(path, errno);
  if (S_ISDIR(facts.st_mode)) return CannotRead(path, EISDIR);
  if (!S_ISREG(facts.st_mode) && !(pipes && S_ISFIFO(facts.st_mode))) {
    return Fail(ErrorCode::kUnreadable, "is a device or a pipe, a file is expected", DisplayPath(path));
  }
  // Without O_NONBLOCK the call would wait for the writer of a pipe that took the file's place.
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | (pipes ? 0 : O_NONBLOCK)));
  if (!file.is_open()) return CannotRead(path, errno);
  std::string bytes;
  std::string buffer(std::size_t{1} << 16, '\0');
  for (;;) {  // the size of a file may lie
    const ssize_t count = ::read(file.number(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return CannotRead(path, errno);
    if (count == 0) return bytes;
    bytes.append(buffer, 0, static_cast<std::size_t>(count));
    if (bytes.size() > most) {
      return Fail(ErrorCode::kUnreadable, "is larger than " + std::to_string(most >> 20) + " MiB", DisplayPath(path));
    }
  }
}

Status WriteFile(const fs::path& path, std::string_view bytes) {
  if (IsSpecial(path)) return WriteSpecial(path, bytes);
  const fs::path target = TargetOf(path);
  return Publish(target, [&](const fs::path& temporary) { return FillTemporary(temporary, target, bytes); });
}

Status WriteFileWith(const fs::path& path, const std::function<Status(const fs::path& temporary)>& write) {
  if (IsSpecial(path)) {
    return Fail(ErrorCode::kCannotWrite, "is a device or a pipe, a file is expected", DisplayPath(path));
  }
  const fs::path target = TargetOf(path);
  return Publish(target, [&](const fs::path& temporary) -> Status {
    // A folder that cannot be written gets our error message, not that of the writer's library.
    if (Status possible = FillTemporary(temporary, target, {}); !possible) return possible;
    if (Status written = write(temporary); !written) return written;
    if (const int error = SyncPath(temporary, 0); error != 0) return CannotWrite(target, error);
    return {};
  });
}

Status MakeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) return CannotWrite(path, error.value());
  if (!fs::is_directory(path, error)) return CannotWrite(path, ENOTDIR);
  return {};
}

}  // namespace mocurate
