#include "core/base/file.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <system_error>
#include <utility>

#include "core/base/links.h"
#include "core/base/text.h"

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

bool IsSpecial(const fs::path& path) {
  std::error_code error;
  return fs::is_other(fs::status(path, error));
}

Status WriteSpecial(const fs::path& path, std::string_view bytes) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.is_open()) return CannotWriteFile(path, errno);
  if (const int error = WriteAll(file.number(), bytes); error != 0) return CannotWriteFile(path, error);
  return {};
}

}  // namespace

Status ReadFileInParts(const fs::path& path, const std::function<void(std::string_view part)>& take) {
  // A pipe in a folder of data would be waited for, a device be read for ever; the shell's pipes have names in /dev.
  if (IsSpecial(path) && path.native().rfind("/dev/fd/", 0) != 0 && path != "/dev/stdin" && path != "/dev/null") {
    return Fail(ErrorCode::kUnreadable, "is a device or a pipe, a file is expected", DisplayPath(path),
                "copy what it gives into a file");
  }
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
    return Fail(ErrorCode::kUnreadable, "is a device or a pipe, a file is expected", DisplayPath(path),
                "copy what it gives into a file");
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
      return Fail(ErrorCode::kUnreadable,
                  "is larger than " + std::to_string(most >> 20) + " MiB, the limit of its kind", DisplayPath(path),
                  "is this the right file? else split it");
    }
  }
}

tl::unexpected<Error> CannotWriteFile(const fs::path& path, int error) {
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

Expected<PendingFile> PendingFile::Create(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return CannotWriteFile(path, EISDIR);
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != sizeof number) return CannotWriteFile(path, errno);
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(number));
  std::string extension = path.extension().string();
  if (extension.size() > 32) extension.clear();
  fs::path temporary = FolderOf(path) / (std::string(".tmp-") + digits + extension);
  const int descriptor = ::open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) return CannotWriteFile(path, errno);
  return PendingFile(path, std::move(temporary), descriptor);
}

Expected<PendingFile> PendingFile::CreateOutput(const fs::path& named) {
  const Expected<fs::path> output = OutputOf(named);
  if (!output) return Forward(output);
  if (!IsSpecial(*output)) return Create(*output);
  return Fail(ErrorCode::kCannotWrite, "is a device or a pipe, a file is expected", DisplayPath(named));
}

PendingFile::PendingFile(PendingFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, fs::path())),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

PendingFile::~PendingFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

Status PendingFile::Write(std::string_view bytes) {
  if (const int error = WriteAll(descriptor_, bytes); error != 0) return CannotWriteFile(path_, error);
  return {};
}

Status PendingFile::PublishUnsynced() {
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) return CannotWriteFile(path_, errno);
  temporary_.clear();
  return {};
}

Status PendingFile::Publish() {
  if (::fsync(descriptor_) != 0 && errno != EINVAL) return CannotWriteFile(path_, errno);
  if (Status published = PublishUnsynced(); !published) return published;
  if (const int error = SyncPath(FolderOf(path_), O_DIRECTORY); error != 0 && error != EACCES) {
    return CannotWriteFile(path_, error);
  }
  return {};
}

Status WriteFile(const fs::path& path, std::string_view bytes) {
  const Expected<fs::path> output = OutputOf(path);
  if (!output) return Forward(output);
  if (IsSpecial(*output)) return WriteSpecial(*output, bytes);
  Expected<PendingFile> file = PendingFile::Create(*output);
  if (!file) return Forward(file);
  if (Status written = file->Write(bytes); !written) return written;
  return file->Publish();
}

Status WriteFileWith(const fs::path& path, const std::function<Status(const fs::path& temporary)>& write) {
  Expected<PendingFile> file = PendingFile::CreateOutput(path);
  if (!file) return Forward(file);
  if (Status written = write(file->temporary()); !written) return written;
  // The writer may have made a new file of that name.
  if (const int error = SyncPath(file->temporary(), 0); error != 0) return CannotWriteFile(path, error);
  return file->Publish();
}

Status MakeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) return CannotWriteFile(path, error.value());
  if (!fs::is_directory(path, error)) return CannotWriteFile(path, ENOTDIR);
  return {};
}

std::optional<std::size_t> FirstNotUtf8(std::string_view bytes) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  for (std::size_t i = 0; i < bytes.size();) {
    // Numbers of pickles are text of one and two bytes in no order: a branch on the length would be guessed wrong.
    while (i + 1 < bytes.size()) {
      const bool one = at(i) < 0x80;
      const bool two = (at(i) >= 0xC2) & (at(i) < 0xE0) & ((at(i + 1) & 0xC0) == 0x80);
      if (!(one | two)) break;
      i += one ? 1 : 2;
    }
    if (i == bytes.size()) break;
    const Character character = FirstCharacter(bytes.substr(i));
    if (character.kind == CharacterKind::kNotUtf8) return i;
    i += character.bytes;
  }
  return std::nullopt;
}

std::string DisplayPath(const std::filesystem::path& path) {
  const std::string& bytes = path.native();
  std::string text;
  for (std::size_t i = 0; i < bytes.size();) {
    const Character character = FirstCharacter(std::string_view(bytes).substr(i));
    const auto byte = static_cast<unsigned char>(bytes[i]);
    const bool utf8 = character.kind != CharacterKind::kNotUtf8;
    const bool looks_escaped = bytes[i] == '\\' && i + 1 < bytes.size() && bytes[i + 1] == 'x';
    if (!utf8 || byte < 0x20 || byte == 0x7F || looks_escaped) {
      text += EscapedByte(bytes[i]);
      ++i;
    } else {
      text.append(bytes, i, character.bytes);
      i += character.bytes;
    }
  }
  return text;
}

std::filesystem::path PathFromText(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i, 2) == "\\x" && i + 3 < text.size() && HexDigit(text[i + 2]) >= 0 && HexDigit(text[i + 3]) >= 0) {
      bytes += static_cast<char>(16 * HexDigit(text[i + 2]) + HexDigit(text[i + 3]));
      i += 3;
    } else {
      bytes += text[i];
    }
  }
  return bytes;
}

}  // namespace mocurate
