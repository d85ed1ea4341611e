#include <algorithm>
#include <map>
#include <set>

#include "core/base/file.h"
#include "ingest/folder_listing.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/file_names.h"

namespace mocurate {

std::optional<FramePattern> WriteFrames(const std::vector<std::string>& names, bool views, DeclarationWriter& writer) {
  std::optional<FramePattern> guessed = EstimateFramePattern(names, views);
  if (guessed && views && guessed->pattern.find("{camera}") == std::string::npos) guessed.reset();
  if (guessed) {
    writer.Value("files", YamlQuoted(guessed->pattern),
                 "from " + std::to_string(guessed->matching) + " of " + std::to_string(names.size()) +
                     " folders: files that differ in {camera} and {frame} alone are one clip");
    writer.Value("recording", YamlQuoted(guessed->recording ? "{recording}" : "recording"),
                 guessed->recording ? "the folder" : "a choice: all files are one recording");
  } else {
    writer.Unknown("files", views ? "the names of the files have no form in common that tells the camera"
                                  : "the names of the files have no form in common");
    writer.Unknown("recording", "what the files of a clip have in common");
  }
  return guessed;
}

namespace {

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

std::vector<std::string> FirstFiles(const Proposal& proposal, const std::string& ending) {
  std::set<std::string> folders;
  for (const InspectedClip* clip : proposal.source.clips()) folders.insert(Below(proposal.folder, clip->file));
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    const std::vector<std::string> files = FilesIn(proposal.folder, folder, {ending});
    if (!files.empty()) names.push_back(files.front());
  }
  return names;
}

void WriteCalibration(const Proposal& proposal, DeclarationWriter& writer) {
  const Inspection& inspection = proposal.inspection;
  const std::filesystem::path& path = proposal.folder;
  if (inspection.cameras.empty()) {
    writer.UnknownList("calibration",
                       "no file of cameras is in the folder: put it there, or give the folder that has both");
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

}  // namespace mocurate
