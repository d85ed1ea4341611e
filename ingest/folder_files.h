#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// Files of a folder that is not looked into are counted up to one more than this.
inline constexpr std::size_t kMostCounted = 10000;

struct FolderFile {
  std::string name;  ///< below the folder, with '/', printable
  std::filesystem::path path;
  std::string problem = {};  ///< why it cannot be read: a link that leads nowhere, a pipe
};

/// What lies below a folder down to a depth.
struct Listing {
  std::vector<FolderFile> files;                     ///< sorted by name
  std::map<std::string, std::size_t> folders_below;  ///< deeper folders (and links to folders) -> files in them
};

/// Files down to `depth` folders below `folder`. Links to folders are not followed. Error kNotFound, kUnreadable.
Expected<Listing> ListFiles(const std::filesystem::path& folder, int depth);

/// Folders in a name.
int DepthOf(const std::string& name);

}  // namespace mocurate
