#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ingest/options.h"

namespace mocurate {

/// One kind of files that a source's declaration names below its folder.
struct ExpectedFile {
  std::string pattern;
  std::string what;
  std::size_t found = 0;  ///< files of that name
  // Where there is none:
  std::filesystem::path elsewhere;  ///< the folder below which such files would have their names, above or below
  std::size_t found_elsewhere = 0;
  std::size_t others = 0;  ///< files of the same ending and another name
  std::string other;       ///< one of them
};

/// Everything that a declaration names: clips, or what holds them, skeletons, depth images, annotations, tables, and
/// what ingest.expected lists. With `count` the files below ingest.path are counted. Error kConfig for a broken
/// pattern.
Expected<std::vector<ExpectedFile>> ExpectedFiles(const IngestOptions& ingest, bool count);

}  // namespace mocurate
