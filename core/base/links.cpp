#include "core/base/links.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "core/base/file.h"

namespace mocurate {
namespace {

constexpr int kMostLinks = 40;  // of one path, as Linux

const char* const kElsewhere = "remove it, or name another folder with -o (a cache: MOCURATE_CACHE)";

tl::unexpected<Error> NotPlain(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_symlink(path, unknown)) {
    return Fail(ErrorCode::kCannotWrite, "is a pipe or a device, a file is expected", DisplayPath(path), kElsewhere);
  }
  return Fail(ErrorCode::kCannotWrite,
              "is a link to '" + DisplayPath(std::filesystem::read_symlink(path, unknown)) +
                  "'; links are followed only in the path that you name, not below it",
              DisplayPath(path), kElsewhere);
}

}  // namespace

bool MadeByAnother(const std::filesystem::path& path) {
  struct ::stat entry = {}, folder = {};
  std::error_code unknown;
  if (::lstat(path.c_str(), &entry) != 0) return false;
  if (::stat(std::filesystem::absolute(path, unknown).parent_path().c_str(), &folder) != 0) return false;
  return (folder.st_mode & S_IWOTH) != 0 && entry.st_uid != ::geteuid() && entry.st_uid != folder.st_uid;
}

Expected<std::filesystem::path> OutputOf(const std::filesystem::path& named) {
  std::filesystem::path place = named;
  for (int links = 0; links < kMostLinks; ++links) {
    std::error_code unknown;
    const bool special = std::filesystem::is_other(std::filesystem::status(place, unknown));
    if (!special && !std::filesystem::is_symlink(place, unknown)) return place;
    if (MadeByAnother(place)) {
      return Fail(ErrorCode::kCannotWrite,
                  "is a link, a pipe or a device of another user in a folder that all users may write",
                  DisplayPath(place), "write to a folder of your own");
    }
    if (special) return place;  // by way of /dev/stdout, whose last link names no file
    const std::filesystem::path target = std::filesystem::read_symlink(place, unknown);
    if (unknown) return CannotWriteFile(place, unknown.value());
    place = place.parent_path() / target;
  }
  return CannotWriteFile(named, ELOOP);
}

Status CheckNotLink(const std::filesystem::path& path) {
  struct ::stat entry = {};
  if (::lstat(path.c_str(), &entry) != 0 || S_ISREG(entry.st_mode) || S_ISDIR(entry.st_mode)) return {};
  return NotPlain(path);
}

Status CheckNoLinks(const std::filesystem::path& path) {
  if (Status plain = CheckNotLink(path); !plain) return plain;
  std::error_code problem;
  if (!std::filesystem::is_directory(path, problem)) return {};
  for (std::filesystem::recursive_directory_iterator at(path, problem), end; !problem && at != end;
       at.increment(problem)) {
    if (Status plain = CheckNotLink(at->path()); !plain) return plain;
  }
  // A folder may go while others work here; what cannot be listed cannot be written below either.
  return {};
}

Expected<std::filesystem::path> FolderBelow(const std::filesystem::path& folder, const std::filesystem::path& name) {
  std::filesystem::path place = folder;
  for (const std::filesystem::path& part : name) {
    place /= part;
    if (Status plain = CheckNotLink(place); !plain) return Forward(plain);
  }
  if (Status made = place.empty() ? Status() : MakeFolder(place); !made) return Forward(made);
  return place;
}

Expected<std::filesystem::path> FileBelow(const std::filesystem::path& folder, const std::filesystem::path& name) {
  Expected<std::filesystem::path> place = FolderBelow(folder, name.parent_path());
  if (!place) return place;
  *place /= name.filename();
  if (Status plain = CheckNotLink(*place); !plain) return Forward(plain);
  return place;
}

Expected<int> OpenInPlace(const std::filesystem::path& path, int flags, bool written) {
  // O_NONBLOCK: a pipe without a reader must not be waited for.
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | flags, 0666);
  if (file < 0) {
    const int problem = errno;
    if (Status plain = CheckNotLink(path); !plain) return Forward(plain);
    return CannotWriteFile(path, problem);
  }
  struct ::stat opened = {};
  const bool known = ::fstat(file, &opened) == 0;
  if (known && S_ISREG(opened.st_mode) && (opened.st_nlink <= 1 || !written)) return file;
  ::close(file);
  if (!known || !S_ISREG(opened.st_mode)) return NotPlain(path);
  return Fail(ErrorCode::kCannotWrite, "has another name (a hard link), which a change here would reach",
              DisplayPath(path), kElsewhere);
}

}  // namespace mocurate
