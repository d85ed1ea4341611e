#include "canon/values/set_files.h"

#include <set>

#include "core/base/file.h"
#include "core/store/dataset_writer.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// The last `count` parts of a path.
std::string EndOf(const fs::path& path, std::size_t count) {
  std::vector<fs::path> parts(path.begin(), path.end());
  fs::path end;
  for (std::size_t i = parts.size() - std::min(count, parts.size()); i < parts.size(); ++i) end /= parts[i];
  return DisplayPath(end);
}

}  // namespace

std::vector<std::string> NamesOfFiles(const std::vector<fs::path>& paths) {
  std::size_t longest = 1;
  for (const fs::path& path : paths) {
    longest = std::max(longest, static_cast<std::size_t>(std::distance(path.begin(), path.end())));
  }
  std::vector<std::string> names;
  for (std::size_t count = 1; count <= longest; ++count) {
    names.clear();
    for (const fs::path& path : paths) {
      names.push_back(EndOf(path, path.filename() == "dataset.h5" ? std::max<std::size_t>(count, 2) : count));
    }
    if (std::set<std::string>(names.begin(), names.end()).size() == names.size()) break;
  }
  return names;
}

Expected<std::vector<DatasetFile>> OpenDatasetFiles(const std::vector<fs::path>& paths) {
  const std::vector<std::string> names = NamesOfFiles(paths);
  std::vector<DatasetFile> files;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    auto clips = DatasetClips::Open(paths[i], DatasetClips::Check::kHashes);
    if (!clips) return Forward(clips);
    auto outline = clips->Outline();
    if (!outline) return Forward(outline);
    files.push_back({names[i], std::move(*outline), std::move(*clips)});
  }
  return files;
}

Status WriteFromFiles(const Dataset& outline, const std::vector<std::pair<std::size_t, std::size_t>>& origins,
                      const std::vector<DatasetFile>& files, const fs::path& to) {
  std::vector<std::uint8_t> optional_fields;
  for (const auto& [file, row] : origins) optional_fields.push_back(files[file].clips.OptionalFields(row));
  auto writer = DatasetWriter::Create(outline, optional_fields, to);
  if (!writer) return Forward(writer);
  for (std::size_t i = 0; i < origins.size(); ++i) {
    auto clip = files[origins[i].first].clips.Read(origins[i].second);
    if (!clip) return Forward(clip);
    if (Status written = writer->Append(*clip); !written) return written;
  }
  return writer->Finish();
}

}  // namespace mocurate
