#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canon/exports/layout.h"

namespace mocurate {

/// A clip in an export, under its names there.
struct WrittenClip {
  std::size_t position = 0;  ///< in ExportSet::ids
  std::string file;          ///< below the folder
  std::string person;
  std::string label;
  std::string fine_label;
  std::string licence;
  std::string role;
  int frames = 0;
  FrameRate rate;
  std::string origin;     ///< what height 0 of the file is (kHeightOrigin), where the layout states it
  double raised_m = 0.0;  ///< added to every height of the clip
};

WrittenClip WrittenClipOf(std::size_t position, const Clip& clip, std::string file);

/// Names of the files beside the clips.
inline constexpr const char* kClipTable = "clips.csv";
inline constexpr const char* kDeclarationFile = "source.yaml";
inline constexpr const char* kSkeletonFile = "skeleton.yaml";

/// clips.csv: file, clip, person, recording, label, class, fine_label, frames, rate_hz, of layouts that state it origin
/// and raised_m, and for each split a column "split_NAME" of train, validation, test or nothing. RFC 4180.
ExportedFile ClipTable(const ExportSet& set, const std::vector<WrittenClip>& clips);

/// Refuses a clip of another rate than the first one: the files have no rate, and the declaration has one for all.
class OneRate {
 public:
  Status Check(const Clip& clip);

 private:
  std::optional<FrameRate> rate_;
};

/// Texts in YAML, always quoted.
std::string YamlList(const std::vector<std::string>& texts);
std::string YamlMap(const std::map<std::string, std::string>& texts);

/// A layout's declaration of its files: options of ingest.source, except name, licence and skeleton, and their values
/// in YAML.
struct FileDeclaration {
  std::string name = kDeclarationFile;  ///< of its file
  std::string layout;
  std::string source;  ///< name
  std::vector<std::pair<std::string, std::string>> options;
  std::string role_split;    ///< split whose parts come back as roles of the clips, or empty
  bool has_tree = false;     ///< the files contain the tree of joints
  bool joint_table = false;  ///< read as joint tracks, which `run` fits
};

/// source.yaml, a job that reads the export again: classes in their order and the splits by person in `assemble`.
/// Beside it skeleton.yaml, where the skeleton is not built in and the files do not contain it. Notes name the splits
/// that it cannot declare.
void AddDeclaration(const ExportSet& set, const std::vector<WrittenClip>& clips, const FileDeclaration& declaration,
                    std::vector<std::string>& notes, std::vector<ExportedFile>& files);

/// A layout of one file per clip, named by its folders: LABEL/PERSON/RECORDING.ending, or with a fine label
/// LABEL/FINE_LABEL/PERSON/RECORDING.ending. Texts are converted to file names (canon/exports/clip_names.h); "_" means
/// no label.
struct LabelledFolder {
  std::string layout;
  std::string ending;  ///< ".csv"
  /// The file of a clip, or the error that prevents it.
  Expected<std::string> (*encode)(const Clip& clip, const ExportSet& set);
  /// Options of ingest.source, except those for names, and their values in YAML. `rate` is the first clip's. Null:
  /// mocurate does not read such files, and no source.yaml is written.
  std::vector<std::pair<std::string, std::string>> (*declare)(const ExportSet& set, const FrameRate& rate);
  bool holds_rate = false;              ///< each file states its rate
  bool declares_rate = true;            ///< the declaration must state the rate, even where the files do
  bool holds_tree = false;              ///< each file contains the tree of joints
  bool joint_table = false;             ///< read as joint tracks
  const char* not_in_joint_names = "";  ///< characters that the files' names of joints cannot hold
};

std::unique_ptr<LayoutWriter> MakeLabelledFolder(const ExportSet& set, const LabelledFolder& folder);

}  // namespace mocurate
