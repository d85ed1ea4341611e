#include "ingest/depth_files.h"

#include <algorithm>
#include <optional>

namespace mocurate {

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
