#include <algorithm>
#include <map>
#include <set>

#include "core/base/file.h"
#include "ingest/folder_listing.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/file_names.h"

namespace mocurate {
namespace {

/// Pattern and recording of clips of many files, from one file of each folder.
std::optional<FramePattern> WriteFrames(const std::vector<std::string>& names, bool views, const std::string& prefix,
                                        DeclarationWriter& writer) {
  std::optional<FramePattern> guessed = EstimateFramePattern(names, views);
  if (guessed && views && guessed->pattern.find("{camera}") == std::string::npos) guessed.reset();
  if (guessed) {
    writer.Value("files", YamlQuoted(prefix + guessed->pattern),
                 "guessed from " + std::to_string(guessed->matching) + " of " + std::to_string(names.size()) +
                     " folders: files that differ in {camera} and {frame} alone are one clip");
    writer.Value("recording", YamlQuoted(guessed->recording ? "{recording}" : "recording"),
                 guessed->recording ? "guessed: the folder" : "a choice: all files are one recording");
  } else {
    writer.Unknown("files", views ? "the names of the files have no form in common that tells the camera"
                                  : "the names of the files have no form in common");
    writer.Unknown("recording", "what the files of a clip have in common");
  }
  return guessed;
}

/// Names of files directly in a folder below `path`, sorted.
std::vector<std::string> FilesIn(const std::filesystem::path& path, const std::string& folder,
                                 const std::set<std::string>& endings) {
  std::vector<std::string> names;
  for (const std::filesystem::path& entry : EntriesOf(path / folder)) {
    const std::string name = DisplayPath(entry.filename());
    if (endings.count(entry.extension().string()) != 0) names.push_back(folder.empty() ? name : folder + "/" + name);
  }
  return names;
}

/// The folder below `path` that an inspection's `file` names: one there, that of a file there, and "" for `path`
/// itself, which an inspection calls by its own name.
std::string Below(const std::filesystem::path& path, const std::string& file) {
  std::error_code unknown;
  if (file.empty() || file == ".") return "";
  if (std::filesystem::is_directory(path / file, unknown)) return file;
  if (!std::filesystem::exists(path / file, unknown)) return "";
  const std::size_t slash = file.rfind('/');
  return slash == std::string::npos ? "" : file.substr(0, slash);
}

}  // namespace

void WriteCalibration(const Inspection& inspection, const std::filesystem::path& path, DeclarationWriter& writer) {
  if (inspection.cameras.empty()) {
    writer.UnknownList("calibration", "no file of cameras is in the folder");
    writer.Unknown("axes", "up is unknown");
    return;
  }
  const InspectedCamera& first = inspection.cameras.front();
  const std::string folder = Below(path, first.file);
  if (first.format == "opencv_views") {
    std::vector<std::string> ids;
    for (const InspectedCamera& camera : inspection.cameras) {
      if (Below(path, camera.file) == folder) ids.push_back(camera.id);
    }
    const CameraNames names = NamesOfCameras(ids);
    writer.List("calibration", {(folder.empty() ? "" : folder + "/") + names.before + "{camera}" + names.after},
                "a file per camera");
  } else if (first.format == "opencv_rig") {
    writer.List("calibration", FilesIn(path, folder, {".yml", ".yaml", ".xml"}), "the files of cameras in the folder");
  } else {
    writer.List("calibration", {first.file}, "the first file of cameras in the folder");
  }
  if (first.reading.from == Provenance::kMeasured) {
    writer.Value("camera_pose", *first.reading.value, "measured: " + first.reading.evidence);
  }
  if (first.units.from == Provenance::kMeasured) {
    writer.Value("units", *first.units.value, "measured: " + first.units.evidence);
  }
  if (const auto axes = AxesFrom(first.up.value.value_or(""), true)) {
    writer.Value("axes", YamlQuoted(*axes),
                 "up from the cameras: " + first.up.evidence + "; which way is front is a choice");
  } else {
    writer.Unknown("axes", "the cameras do not agree which way is up");
  }
}

std::optional<std::string> AxesFrom(const std::string& up, bool right) {
  static const std::map<std::string, std::string> turned = {{"+y", "+x +y +z"}, {"-y", "+x -y -z"}, {"+z", "+x -z +y"},
                                                            {"-z", "+x +z -y"}, {"+x", "+y -x +z"}, {"-x", "-y +x +z"}};
  const auto axes = turned.find(up);
  if (axes == turned.end()) return std::nullopt;
  std::string text = axes->second;
  if (!right) text[0] = text[0] == '+' ? '-' : '+';
  return text;
}

void WriteGathered(const ClipConsensus& source, const Inspection& inspection, const std::filesystem::path& path,
                   const std::string& prefix, const std::string& format, DeclarationWriter& writer) {
  std::set<std::string> folders;
  for (const InspectedClip* clip : source.clips()) folders.insert(Below(path, clip->file));
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    const std::vector<std::string> files = FilesIn(path, folder, {".json"});
    if (!files.empty()) names.push_back(files.front());
  }
  const bool views = format == "openpose";
  const std::optional<FramePattern> guessed = WriteFrames(names, views, prefix, writer);
  const std::string depth =
      guessed && views ? EstimateDepthBeside(inspection, path, guessed->recording) : std::string();
  if (!depth.empty()) {
    writer.Value("depth_files", YamlQuoted(prefix + depth), "guessed from the names: depth cameras beside the others");
    writer.Value("depth_unit", "1 mm", "a choice: images do not declare it; most sensors write millimetres");
  }
  const int most = source.Ask(&InspectedClip::people).value.value_or(1);
  writer.Value("person", YamlQuoted("p{body}"), "unknown who it is; {body} tells several people of a recording apart");
  writer.Value("subjects", views ? "1" : std::to_string(std::max(1, most)),
               views
                   ? "a choice: in most files up to " + std::to_string(most) + " people are seen, bystanders among them"
                   : "measured: most bodies in a file");
  writer.Value("label", YamlQuoted(""), "unknown: the names do not declare it");
  if (!views) return;
  WriteCalibration(inspection, prefix.empty() ? path : path.parent_path(), writer);
  const Vote<std::string> layout = source.Ask(&InspectedClip::skeleton);
  writer.Value("keypoints", layout.value.value_or("measured"), layout.comment);
}

void WriteClouds(const Inspection& inspection, DeclarationWriter& writer) {
  std::map<std::string, std::string> first;  // of each folder
  for (const InspectedCloud& cloud : inspection.clouds) first.emplace(FolderOf(cloud.file), cloud.file);
  std::vector<std::string> names;
  for (const auto& [folder, file] : first) names.push_back(file);
  WriteFrames(names, false, "", writer);
  writer.Value("person", YamlQuoted("unknown"), "unknown: write who performs");
  writer.Value("label", YamlQuoted(""), "unknown: the names do not declare it");
  writer.Value("other_files", "ignore", "a choice: `error` refuses files that the pattern does not match");
  writer.Value("licence", "\"\"", "unknown: no file declares it");
  const Reported<std::string>& units = inspection.clouds.front().units;
  if (units.value)
    writer.Value("units", *units.value, "measured: " + units.evidence);
  else
    writer.Unknown("units", units.evidence);
  writer.Unknown("axes", "clouds do not declare up");
  writer.Unknown("rate", "clouds do not declare it");
}

}  // namespace mocurate
