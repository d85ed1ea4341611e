#include "core/store/pending_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "core/base/file.h"

namespace mocurate::store {
namespace {

namespace fs = std::filesystem;

/// The place that is written: the target of a link.
fs::path PlaceOf(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path target = fs::weakly_canonical(path, error);
  return error ? path : target;
}

}  // namespace

tl::unexpected<Error> CannotWriteFile(const fs::path& path, int error) {
  const char* reason = ::strerrordesc_np(error);
  return Fail(ErrorCode::kCannotWrite,
              "cannot be written: " + (reason != nullptr ? std::string(reason) : std::to_string(error)),
              DisplayPath(path), "free space there, or write to another folder");
}

bool PendingFile::Possible(const fs::path& path) {
  std::error_code error;
  return !fs::is_other(fs::status(path, error));
}

Expected<PendingFile> PendingFile::Create(const fs::path& path) {
  const fs::path place = PlaceOf(path);
  std::string name = ((place.has_parent_path() ? place.parent_path() : fs::path(".")) / ".tmp-written-XXXXXX").string();
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor >= 0) return PendingFile(place, name, descriptor);
  const int error = errno;
  // The message of WriteFile, where that fails too.
  Status possible = WriteFileWith(place, [&](const fs::path&) -> Status { return CannotWriteFile(path, error); });
  return tl::unexpected<Error>(possible.error());
}

PendingFile::PendingFile(PendingFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, fs::path())),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

PendingFile::~PendingFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

Status PendingFile::Publish() {
  return WriteFileWith(path_, [this](const fs::path& named) -> Status {
    struct ::stat facts = {};
    if (::stat(named.c_str(), &facts) != 0 || ::fchmod(descriptor_, facts.st_mode & 0777u) != 0 ||
        ::fsync(descriptor_) != 0 || ::rename(temporary_.c_str(), named.c_str()) != 0) {
      return CannotWriteFile(path_, errno);
    }
    temporary_.clear();
    return {};
  });
}

}  // namespace mocurate::store
