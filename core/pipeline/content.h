#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// What makes two files, or two folders, the same.
struct Content {
  std::string sha256;  ///< of a file: its bytes; of a folder: the relative names and bytes of all files below it
  std::uint64_t bytes = 0;
};

/// Error kNotFound, kUnreadable.
Expected<Content> ContentOf(const std::filesystem::path& path);

/// Size in bytes of a file, or of all files of a folder; 0 when it does not exist.
std::uint64_t BytesOf(const std::filesystem::path& path);

/// Forces a file, or all files of a folder, to the disk. Error kCannotWrite.
Status SyncContent(const std::filesystem::path& path);

/// Hashes of files that are asked for often; a file is read again when its time or size has changed.
class ContentMemo {
 public:
  Expected<std::string> Sha256Of(const std::filesystem::path& path);

 private:
  struct Known {
    std::int64_t modified_ns = 0;
    std::uint64_t bytes = 0;
    std::uint64_t inode = 0;
    std::string sha256;
  };
  std::map<std::string, Known> known_;
};

}  // namespace mocurate
