#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "ingest/folder_listing.h"

namespace mocurate {

/// The file, or the files of a folder down to six folders below it, sorted by name. Error kUnreadable.
Expected<std::vector<FolderFile>> FilesToInspect(const std::filesystem::path& path);

/// The first bytes, enough to tell the format. Error kUnreadable.
Expected<std::string> ReadHead(const std::filesystem::path& path);

/// Whether the end of an image's data stands in the last bytes, behind which cameras may put a few of their own.
bool EndsAsJpeg(const std::filesystem::path& path);

}  // namespace mocurate
