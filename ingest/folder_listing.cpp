#include "ingest/folder_listing.h"

#include <algorithm>

#include "core/base/file.h"

namespace mocurate {
namespace {

/// At most one more than kMostCounted.
std::size_t FilesBelow(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::size_t count = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code unknown;
    if (!at->is_directory(unknown) && ++count > kMostCounted) break;
  }
  return count;
}

}  // namespace

Expected<Listing> ListFiles(const std::filesystem::path& folder, int depth) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (folder.empty() || !fs::exists(folder, error)) {
    return Fail(ErrorCode::kNotFound, folder.empty() ? "no folder with captures is given" : "the folder does not exist",
                folder.empty() ? "ingest.path" : DisplayPath(folder), "set ingest.path (--set ingest.path=DIR)");
  }
  if (!fs::is_directory(folder, error)) {
    return Fail(ErrorCode::kUnreadable, "is no folder", DisplayPath(folder),
                "ingest.path names the folder of the files");
  }
  Listing listing;
  fs::recursive_directory_iterator at(folder, error);
  if (error) return Fail(ErrorCode::kUnreadable, error.message(), DisplayPath(folder), "check its permissions");
  for (const fs::recursive_directory_iterator end; at != end;) {
    std::error_code unknown;
    const std::string name = DisplayPath(at->path().lexically_relative(folder));
    const bool link = at->is_symlink(unknown);
    if (at->is_directory(unknown)) {
      if (at.depth() >= depth) at.disable_recursion_pending();
      if (at.depth() >= depth || link) listing.folders_below[name] = FilesBelow(at->path());
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

DepthFiles::DepthFiles(const std::vector<FolderFile>& files, const NamePattern& pattern, const NamePattern& source) {
  const std::vector<std::string> own = source.FieldNames();
  for (const std::string& field : pattern.FieldNames()) {
    if (std::find(own.begin(), own.end(), field) != own.end()) common_.push_back(field);
  }
  for (const FolderFile& file : files) {
    if (const std::optional<NameFields> fields = pattern.Match(file.name)) of_[Key(*fields)].push_back(&file);
  }
}

void DepthFiles::AddTo(const NameFields& fields, ItemSpec& item) const {
  const auto found = of_.find(Key(fields));
  if (found == of_.end()) return;
  for (const FolderFile* file : found->second) item.inputs.push_back({"depth", file->name, file->path, ""});
}

std::vector<std::string> DepthFiles::Key(const NameFields& fields) const {
  std::vector<std::string> key;
  for (const std::string& field : common_) key.push_back(fields.count(field) > 0 ? fields.at(field) : "");
  return key;
}

}  // namespace mocurate
