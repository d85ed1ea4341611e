#pragma once

#include <filesystem>
#include <optional>

#include "core/base/error.h"

namespace mocurate {

/// An exclusive lock on a file, made when missing; a link is refused. Held until destroyed or until the process ends,
/// however it ends.
class FileLock {
 public:
  /// Empty when another process holds it. Error kCannotWrite.
  static Expected<std::optional<FileLock>> TryTake(const std::filesystem::path& file);
  /// Waits for it. Error kCannotWrite.
  static Expected<FileLock> Take(const std::filesystem::path& file);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock();

  /// Replaces the text of the locked file, from which other processes can read the holder.
  Status WriteHolder(const std::string& text) const;

 private:
  explicit FileLock(int file) : file_(file) {}
  static Expected<std::optional<FileLock>> Try(const std::filesystem::path& file, int operation);
  int file_ = -1;
};

}  // namespace mocurate
