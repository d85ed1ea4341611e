#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

inline constexpr std::size_t kMostCounted = 10000;  ///< files of a folder that is not looked into

struct FolderFile {
  std::string name;  ///< below the folder, with '/', printable
  std::filesystem::path path;
  std::string problem = {};  ///< why it cannot be read: a link that leads nowhere, a pipe
};

/// What lies below a folder down to a depth.
struct FolderListing {
  std::vector<FolderFile> files;  ///< sorted by name
  std::map<std::string, std::size_t>
      folders_below;  ///< folders that are deeper (and links to folders) -> files in them
};

/// What to do about folders that may not be read.
enum class DeniedFolders { kError, kSkip };

/// Files down to `depth` folders below `folder`; of deeper ones their number, at most one more than kMostCounted. Links
/// to folders are not followed. Error kNotFound, kUnreadable.
Expected<FolderListing> ListFiles(const std::filesystem::path& folder, int depth,
                                  DeniedFolders denied = DeniedFolders::kError);

/// What is directly in a folder, sorted; nothing where it cannot be read.
std::vector<std::filesystem::path> EntriesOf(const std::filesystem::path& folder);

/// Regular files below a folder, in no order; what cannot be read is skipped.
std::vector<std::filesystem::path> FilesBelow(const std::filesystem::path& folder);

/// Folders that a name goes through.
int DepthOf(const std::string& name);

}  // namespace mocurate
