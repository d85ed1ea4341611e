#pragma once

#include <filesystem>

#include "core/base/error.h"

namespace mocurate::store {

/// A file that is written incrementally under a temporary name in its folder, and appears atomically.
class PendingFile {
 public:
  /// Whether `path` can be written so: a device or a pipe cannot.
  static bool Possible(const std::filesystem::path& path);
  /// Error kCannotWrite.
  static Expected<PendingFile> Create(const std::filesystem::path& path);

  PendingFile(PendingFile&& other) noexcept;
  PendingFile& operator=(PendingFile&&) = delete;
  /// What was not published is removed.
  ~PendingFile();

  /// Open for reading and writing.
  int descriptor() const { return descriptor_; }
  /// Syncs the file and gives it its name. Error kCannotWrite.
  Status Publish();

 private:
  PendingFile(std::filesystem::path path, std::filesystem::path temporary, int descriptor)
      : path_(std::move(path)), temporary_(std::move(temporary)), descriptor_(descriptor) {}

  std::filesystem::path path_, temporary_;
  int descriptor_;
};

/// Error kCannotWrite in words of the system's error.
tl::unexpected<Error> CannotWriteFile(const std::filesystem::path& path, int error);

}  // namespace mocurate::store
