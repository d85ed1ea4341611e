#pragma once

#include <cstdlib>
#include <filesystem>

#include "core/base/file.h"

namespace mocurate {

/// A temporary folder of a verb, removed with its contents.
class TemporaryFolder {
 public:
  /// Empty path when it cannot be created.
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "mocurate-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

  /// Error of a folder that could not be created.
  static Status Missing() {
    std::error_code unknown;
    return Fail(ErrorCode::kCannotWrite, "a folder for intermediate files cannot be created",
                DisplayPath(std::filesystem::temp_directory_path(unknown)), "free space there, or set TMPDIR");
  }

 private:
  std::filesystem::path path_;
};

}  // namespace mocurate
