#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "ingest/folder_listing.h"
#include "ingest/options.h"
#include "ingest/sources/pattern.h"

namespace mocurate {

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

/// Error kConfig, with two clips of different files that have one depth image in common. People of one recording whose
/// keypoints lie apart may have: a camera beside the detector sees them all.
Status CheckOwnImages(const SourceOptions& source, const std::vector<ItemSpec>& items);

}  // namespace mocurate
