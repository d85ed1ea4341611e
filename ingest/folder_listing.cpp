#include "ingest/folder_listing.h"

#include <algorithm>

#include "core/base/file.h"

namespace mocurate {
namespace fs = std::filesystem;

namespace {

/// At most one more than kMostCounted.
std::size_t CountBelow(const fs::path& folder) {
  std::size_t count = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code unknown;
    if (!at->is_directory(unknown) && ++count > kMostCounted) break;
  }
  return count;
}

}  // namespace

Expected<FolderListing> ListFiles(const fs::path& folder, int depth, DeniedFolders denied) {
  std::error_code error;
  if (folder.empty() || !fs::exists(folder, error)) {
    return Fail(ErrorCode::kNotFound, folder.empty() ? "no folder with captures is given" : "the folder does not exist",
                folder.empty() ? "ingest.path" : DisplayPath(folder), "set ingest.path (--set ingest.path=DIR)");
  }
  if (!fs::is_directory(folder, error)) {
    return Fail(ErrorCode::kUnreadable, "is no folder", DisplayPath(folder),
                "ingest.path names the folder of the files, or one of them");
  }
  FolderListing listing;
  const bool skip = denied == DeniedFolders::kSkip;
  fs::recursive_directory_iterator at(
      folder, skip ? fs::directory_options::skip_permission_denied : fs::directory_options::none, error);
  if (error) return Fail(ErrorCode::kUnreadable, error.message(), DisplayPath(folder), "check its permissions");
  for (const fs::recursive_directory_iterator end; at != end;) {
    std::error_code unknown;
    const std::string name = DisplayPath(at->path().lexically_relative(folder));
    const bool link = at->is_symlink(unknown);
    if (at->is_directory(unknown)) {
      if (at.depth() >= depth) at.disable_recursion_pending();
      if (at.depth() >= depth || link) listing.folders_below[name] = CountBelow(at->path());
    } else if (link && !at->exists(unknown)) {
      const std::string target = DisplayPath(fs::read_symlink(at->path(), unknown));
      listing.files.push_back({name, at->path(), "is a link to '" + target + "', which does not exist"});
    } else {
      const bool regular = at->is_regular_file(unknown);
      listing.files.push_back({name, at->path(), regular ? "" : "is no regular file"});
    }
    at.increment(error);
    if (error) return Fail(ErrorCode::kUnreadable, error.message(), DisplayPath(folder), "check its permissions");
  }
  std::sort(listing.files.begin(), listing.files.end(), [](const FolderFile& a, const FolderFile& b) {
    return a.name != b.name ? a.name < b.name : a.path.native() < b.path.native();
  });
  return listing;
}

std::vector<fs::path> EntriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    entries.push_back(at->path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<fs::path> FilesBelow(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error);
  for (const fs::recursive_directory_iterator end; !error && at != end; at.increment(error)) {
    std::error_code unknown;
    if (at->is_regular_file(unknown)) files.push_back(at->path());
  }
  return files;
}

int DepthOf(const std::string& name) { return static_cast<int>(std::count(name.begin(), name.end(), '/')); }

}  // namespace mocurate
