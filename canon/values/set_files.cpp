#include "canon/values/set_files.h"

#include <numeric>
#include <set>

#include "canon/values/kept_fields.h"
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

ClipOrigin WholeClip(std::size_t file, std::size_t row, const std::vector<DatasetFile>& files) {
  return {file, row, 0, files[file].outline.clips[row].motion->frame_count()};
}

std::vector<ClipOrigin> WholeClips(const std::vector<std::size_t>& rows, const std::vector<DatasetFile>& files) {
  std::vector<ClipOrigin> origins;
  for (const std::size_t row : rows) origins.push_back(WholeClip(0, row, files));
  return origins;
}

std::vector<ClipOrigin> WholeClips(const std::vector<DatasetFile>& files) {
  std::vector<std::size_t> rows(files.front().outline.clips.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return WholeClips(rows, files);
}

Expected<std::vector<Finding>> WriteFromFiles(Dataset& made, const std::vector<ClipOrigin>& origins,
                                              const std::vector<DatasetFile>& files, const fs::path& to,
                                              const std::vector<std::pair<ClipOrigin, ClipOrigin>>& repeated) {
  KeptFields kept = KeepFields(made, origins, repeated, files);
  made.findings.insert(made.findings.end(), kept.findings.begin(), kept.findings.end());
  const auto has_frames = [](const Clip& clip) { return !clip.motion->joints.empty(); };
  std::vector<std::uint8_t> optional_fields;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const Clip& clip = made.clips[i];
    optional_fields.push_back(has_frames(clip) ? OptionalFieldsOf(*clip.motion)
                                               : files[origins[i].file].clips.OptionalFields(origins[i].row));
  }
  std::vector<std::string> of_frames;
  for (const auto& [path, field] : kept.fields) {
    if (!field.HasValues()) of_frames.push_back(path);
  }
  auto writer = DatasetWriter::Create(made, optional_fields, to, std::move(kept.fields));
  if (!writer) return Forward(writer);
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const ClipOrigin& origin = origins[i];
    const DatasetClips& clips = files[origin.file].clips;
    ExtraFields frames;
    for (const std::string& path : of_frames) {
      auto rows = clips.ReadOtherFrames(path, origin.row, origin.begin, origin.end);
      if (!rows) return Forward(rows);
      frames[path] = *std::move(rows);
    }
    const auto read = has_frames(made.clips[i]) ? Expected<Clip>(made.clips[i]) : clips.Read(origin.row);
    if (!read) return Forward(read);
    if (Status written = writer->Append(*read, frames); !written) return Forward(written);
  }
  if (Status finished = writer->Finish(); !finished) return Forward(finished);
  return std::move(kept.findings);
}

}  // namespace mocurate
