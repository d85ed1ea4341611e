#pragma once

#include <filesystem>
#include <fstream>

#include "core/formats/png.h"

namespace mocurate {

/// Writes a depth image as PNG without fsync, unlike WriteFile. Error kCannotWrite.
inline Status WriteDepthImage(const DepthImage& image, const std::filesystem::path& path) {
  const Expected<std::string> bytes = EncodePng(image);
  if (!bytes) return Forward(bytes);
  std::ofstream file(path, std::ios::binary);
  file << *bytes;
  return file.flush() ? Status() : Fail(ErrorCode::kCannotWrite, "the image cannot be written", path.string());
}

}  // namespace mocurate
