#include "ingest/inspect/inspect_files.h"

#include <algorithm>
#include <fstream>

#include "core/base/file.h"
#include "ingest/inspect/file_kind.h"

namespace mocurate {
namespace {

constexpr int kDeepest = 6;  // folders below the one that is asked for

}  // namespace

Expected<std::vector<FolderFile>> FilesToInspect(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) {
    const bool regular = std::filesystem::is_regular_file(path, error);
    return std::vector<FolderFile>{{DisplayPath(path.filename()), path, regular ? "" : "is no regular file"}};
  }
  Expected<FolderListing> listing = ListFiles(path, kDeepest, DeniedFolders::kSkip);
  if (!listing) return Forward(listing);
  return std::move(listing->files);
}

Expected<std::string> ReadHead(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return Fail(ErrorCode::kUnreadable, "the file cannot be opened", DisplayPath(path), "check its permissions");
  std::string head(kKindHead, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head;
}

bool EndsAsJpeg(const std::filesystem::path& path) {
  constexpr std::streamoff kTail = 4096;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  file.seekg(std::max<std::streamoff>(0, size - kTail));
  std::string tail(static_cast<std::size_t>(std::min(size, kTail)), '\0');
  file.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  return tail.find("\xFF\xD9") != std::string::npos;
}

}  // namespace mocurate
