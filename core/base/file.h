#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/error.h"

namespace mocurate {

/// Bytes that what a file of `bytes` bytes holds may take in memory, whatever it packs, repeats or declares. A number
/// of one digit and a blank gives a double of 8 bytes, one of uint8 as well: what is not packed stays below 16.
constexpr std::uint64_t MostUnpacked(std::uint64_t bytes) { return (std::uint64_t{64} << 20) + 16 * bytes; }

/// The whole file as bytes. Error kNotFound, kUnreadable.
Expected<std::string> ReadFile(const std::filesystem::path& path);

/// The same in parts of at most 1 MiB, in order, for files that need not fit in memory.
Status ReadFileInParts(const std::filesystem::path& path, const std::function<void(std::string_view part)>& take);

/// A whole file of at most `most` bytes. Error kUnreadable as well for more bytes, a device, and a pipe unless `pipes`:
/// without it the call never waits.
Expected<std::string> ReadSmallFile(const std::filesystem::path& path, std::size_t most, bool pipes = false);

/// A new file in the folder of `path`, which gets this name when it is complete. Until then its name is random and was
/// free (O_EXCL): neither a link nor a file of another user is opened. Mode by the umask. Removed unless
/// published.
class PendingFile {
 public:
  /// A link at `path` is not followed, it will be replaced. Error kCannotWrite.
  static Expected<PendingFile> Create(const std::filesystem::path& path);
  /// For a path that the user names, whose links are followed (OutputOf in links.h). Error kCannotWrite, also for a
  /// device or a pipe.
  static Expected<PendingFile> CreateOutput(const std::filesystem::path& named);

  PendingFile(PendingFile&& other) noexcept;
  PendingFile& operator=(PendingFile&&) = delete;
  ~PendingFile();

  /// Open for reading and writing.
  int descriptor() const { return descriptor_; }
  /// Present name, with the extension of `path`.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// Error kCannotWrite.
  Status Write(std::string_view bytes);
  /// fsync, rename, fsync of the folder. Error kCannotWrite.
  Status Publish();
  /// Without fsync: the name appears at once, a power cut may lose or cut the content. Error kCannotWrite.
  Status PublishUnsynced();

 private:
  PendingFile(std::filesystem::path path, std::filesystem::path temporary, int descriptor)
      : path_(std::move(path)), temporary_(std::move(temporary)), descriptor_(descriptor) {}

  std::filesystem::path path_, temporary_;
  int descriptor_;
};

/// Writes a file atomically, as a PendingFile that is published. Links are followed as in CreateOutput; a device or a
/// pipe is written directly. Error kCannotWrite; the temporary file is removed.
Status WriteFile(const std::filesystem::path& path, std::string_view bytes);

/// The same for a writer that needs a path: `write` opens the temporary file by its name and fills it. Where others may
/// write the folder, the sticky bit (as of /tmp) keeps them from replacing it in between. An error of `write` is passed
/// on.
Status WriteFileWith(const std::filesystem::path& path,
                     const std::function<Status(const std::filesystem::path& temporary)>& write);

/// Error kCannotWrite in words of a system's error.
tl::unexpected<Error> CannotWriteFile(const std::filesystem::path& path, int error);

/// Makes a folder and its parents. Error kCannotWrite.
Status MakeFolder(const std::filesystem::path& path);

/// Text of a path that is safe in messages and JSON: control characters and bytes that are not UTF-8 are written as
/// \xNN, and so is a backslash before an x, so that PathFromText gives the same path back.
std::string DisplayPath(const std::filesystem::path& path);

/// Inverse of DisplayPath.
std::filesystem::path PathFromText(std::string_view text);

/// Offset of the first byte that is not UTF-8 (surrogates and overlong forms are not); empty when all are.
std::optional<std::size_t> FirstNotUtf8(std::string_view bytes);

}  // namespace mocurate
