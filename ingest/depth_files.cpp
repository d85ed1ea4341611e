#include "ingest/depth_files.h"

#include <algorithm>
#include <optional>

#include "ingest/chosen_clips.h"

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

Status CheckOwnImages(const SourceOptions& source, const std::vector<ItemSpec>& items) {
  const Expected<NamePattern> pattern = NamePattern::Parse(source.depth_files, "ingest.source.depth_files");
  if (!pattern || source.depth_files.empty()) return {};
  std::map<std::string, const ItemSpec*> taken;
  for (const ItemSpec& item : items) {
    for (const StageInput& input : item.inputs) {
      if (input.role != "depth" || !pattern->Match(input.name)) continue;
      const ItemSpec& first = *taken.emplace(input.name, &item).first->second;
      if (first.inputs[0].name == item.inputs[0].name) continue;
      if (HasDepthBeside(source) && RecordingOf(first) == RecordingOf(item)) continue;
      return Fail(
          ErrorCode::kConfig,
          "the depth image '" + input.name + "' would be one of '" + first.inputs[0].name + "' and of '" +
              item.inputs[0].name + "'",
          "ingest.source.depth_files",
          "images are of the clip whose name has the same fields: write those fields of ingest.source.files ('" +
              source.files + "') that tell clips apart into '" + source.depth_files + "'");
    }
  }
  return {};
}

}  // namespace mocurate
