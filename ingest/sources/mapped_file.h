#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/base/file.h"

namespace mocurate {

/// A file mapped into memory for the lifetime of this object.
class MappedFile {
 public:
  /// Error kUnreadable, kMalformed (the file is empty).
  static Expected<std::shared_ptr<const MappedFile>> Open(const std::filesystem::path& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();
  std::string_view bytes() const { return {static_cast<const char*>(bytes_), size_}; }

 private:
  MappedFile(void* bytes, std::size_t size) : bytes_(bytes), size_(size) {}
  void* bytes_;
  std::size_t size_;
};

/// The file that a process opened last, kept until another is asked for, or until the file is replaced. A pickle of
/// thousands of clips is mapped and parsed once. Kept is the offset of each array, 5 KB per video of UESTC.
template <class Opened>
class KeptOpen {
 public:
  /// `open(path)` gives an Expected<Opened>.
  template <class Open>
  Expected<std::shared_ptr<const Opened>> Get(const std::filesystem::path& path, Open open) {
    std::error_code unknown;
    const auto size = std::filesystem::file_size(path, unknown);
    const auto written = std::filesystem::last_write_time(path, unknown);
    if (opened_ && path == path_ && size == size_ && written == written_) return opened_;
    opened_.reset();
    Expected<Opened> opened = open(path);
    if (!opened) return Forward(opened);
    path_ = path;
    size_ = size;
    written_ = written;
    opened_ = std::make_shared<const Opened>(*std::move(opened));
    return opened_;
  }

 private:
  std::filesystem::path path_;
  std::uintmax_t size_ = 0;
  std::filesystem::file_time_type written_;
  std::shared_ptr<const Opened> opened_;
};

/// An archive that is read on demand, with the mapped bytes that it points into.
template <class Archive>
struct MappedArchive {
  std::shared_ptr<const MappedFile> file;
  Archive archive;

  /// Errors of MappedFile::Open and Archive::Open.
  static Expected<MappedArchive> Open(const std::filesystem::path& path) {
    auto bytes = MappedFile::Open(path);
    if (!bytes) return Forward(bytes);
    Expected<Archive> opened = Archive::Open((*bytes)->bytes(), DisplayPath(path.filename()));
    if (!opened) return Forward(opened);
    return MappedArchive{std::move(*bytes), std::move(*opened)};
  }
};

/// Error for an entry beyond the `count` clips of a container.
inline Status CheckEntry(std::int64_t entry, std::size_t count, const std::string& name) {
  if (entry >= 0 && static_cast<std::size_t>(entry) < count) return {};
  return Fail(ErrorCode::kInconsistent,
              "clip " + std::to_string(entry) + " does not exist, the file has " + std::to_string(count), name,
              "check that the files beside the container are of the same release");
}

}  // namespace mocurate
