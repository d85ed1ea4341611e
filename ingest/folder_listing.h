#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "ingest/sources/pattern.h"

namespace mocurate {

inline constexpr std::size_t kMostCounted = 10000;  ///< files of a folder that is not looked into

struct FolderFile {
  std::string name;  ///< below the folder, with '/', printable
  std::filesystem::path path;
  std::string problem = {};  ///< why it cannot be read: a link that leads nowhere, a pipe
};

/// What lies below a folder down to a depth.
struct Listing {
  std::vector<FolderFile> files;  ///< sorted by name
  std::map<std::string, std::size_t>
      folders_below;  ///< folders that are deeper (and links to folders) -> files in them
};

/// Files down to `depth` folders below `folder`. Links to folders are not followed. Error kNotFound, kUnreadable.
Expected<Listing> ListFiles(const std::filesystem::path& folder, int depth);

/// Depth images by those fields of their names that the names of the source's files have too.
class DepthFiles {
 public:
  /// `files` must outlive it.
  DepthFiles(const std::vector<FolderFile>& files, const NamePattern& pattern, const NamePattern& source);
  DepthFiles(std::vector<FolderFile>&&, const NamePattern&, const NamePattern&) = delete;

  /// Adds the images of the file that has these fields.
  void AddTo(const NameFields& fields, ItemSpec& item) const;

 private:
  std::vector<std::string> Key(const NameFields& fields) const;

  std::vector<std::string> common_;
  std::map<std::vector<std::string>, std::vector<const FolderFile*>> of_;
};

}  // namespace mocurate
