#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

struct FileToInspect {
  std::string name;
  std::filesystem::path path;
  bool regular = true;  ///< no pipe, device or link that leads nowhere
};

/// Appends the file, or the files of a folder, sorted by name. Error kUnreadable.
Status ListFiles(const std::filesystem::path& path, std::vector<FileToInspect>& files);

/// The first bytes, enough to tell the format. Error kUnreadable.
Expected<std::string> ReadHead(const std::filesystem::path& path);

/// Whether the end of an image's data stands in the last bytes, behind which cameras may put a few of their own.
bool EndsAsJpeg(const std::filesystem::path& path);

}  // namespace mocurate
