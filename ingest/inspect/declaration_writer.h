#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/table_text.h"
#include "core/base/text.h"
#include "ingest/inspect/clip_consensus.h"
#include "ingest/inspect/file_names.h"
#include "ingest/inspect/source_declaration.h"
#include "ingest/options.h"

namespace mocurate {

/// Lines of ingest.source, each value with a comment that says where it comes from.
class DeclarationWriter {
 public:
  explicit DeclarationWriter(WrittenDeclaration& out) : out_(out) {}

  /// One line, whatever the texts of the files hold.
  void Line(const std::string& text) {
    for (const char c : text) out_.yaml += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    out_.yaml += '\n';
  }
  /// A long comment stands above the value.
  void Value(const std::string& key, const std::string& value, const std::string& comment) {
    const std::string line = "    " + key + ": " + value;
    if (comment.empty()) return Line(line);
    if (line.size() + comment.size() + 4 <= kTextWidth) return Line(line + "  # " + comment);
    Comment(comment);
    Line(line);
  }
  void Comment(const std::string& text) {
    std::string line = "    #";
    for (const std::string_view word : SplitBlanks(text)) {
      if (line.size() + word.size() + 1 > kTextWidth) {
        Line(line);
        line = "    #";
      }
      line += " " + std::string(word);
    }
    Line(line);
  }
  /// What was measured. `open`: how to fill in the part of it that is not known, FILL_IN; empty: all is known.
  void Measured(const std::string& key, const std::string& value, const std::string& how, const std::string& open) {
    if (!open.empty()) out_.unknown.push_back(key);
    Value(key, value, "measured: " + how + (open.empty() ? "" : "; " + std::string(kFillIn) + " is " + open));
  }
  /// What must be declared and is not known.
  void Unknown(const std::string& key, const std::string& why) {
    out_.unknown.push_back(key);
    Value(key, YamlQuoted(std::string(kFillIn) + ": nothing in the files tells it"), "unknown: " + why);
  }
  void UnknownList(const std::string& key, const std::string& why) {
    out_.unknown.push_back(key);
    List(key, {std::string(kFillIn)}, "unknown: " + why);
  }
  void List(const std::string& key, const std::vector<std::string>& texts, const std::string& comment) {
    Comment(comment);
    std::string line = "    " + key + ": [";
    if (texts.empty()) line += "]";
    for (std::size_t i = 0; i < texts.size(); ++i) {
      const bool plain = !texts[i].empty() && texts[i] == Trim(texts[i]) && texts[i][0] != '-' && texts[i][0] != '?' &&
                         texts[i].find_first_of(",[]{}#&*!|>'\"%@`\\$") == std::string::npos &&
                         (texts[i] + " ").find(": ") == std::string::npos;
      const std::string word = (plain ? texts[i] : YamlQuoted(texts[i])) + (i + 1 < texts.size() ? "," : "]");
      if (line.size() + word.size() + 1 > kTextWidth) {
        Line(line);
        line = "            ";
      }
      line += (line.back() == '[' || line.back() == ' ' ? "" : " ") + word;
    }
    Line(line);
  }

 private:
  static constexpr std::size_t kTextWidth = 116;
  WrittenDeclaration& out_;
};

/// Axes of a source whose people face anywhere, from up and handedness: "+x -z +y" for "+z" in a right-handed frame.
std::optional<std::string> AxesFrom(const std::string& up, bool right);

/// Where the calibration of the cameras lies below `path`, what it means, and the axes of its world.
void WriteCalibration(const Inspection& inspection, const std::filesystem::path& path, DeclarationWriter& writer);

/// Names, cameras and keypoints of a source whose clips are many files: of those in the folders that the inspection
/// names, which lie in `path`, which lies at `prefix` ("single/") below ingest.path.
void WriteGathered(const ClipConsensus& source, const Inspection& inspection, const std::filesystem::path& path,
                   const std::string& prefix, const std::string& format, DeclarationWriter& writer);

/// The names of images as a pattern with {`field`} for the camera and, where they are numbered, {frame}: what most of
/// them follow. Empty where none names a camera.
std::string EstimateImages(const std::vector<std::string>& names, const std::vector<std::string>& cameras,
                           const std::string& field);

/// Pattern of depth images beside a detector's keypoints: {camera} of the inspection's cameras and {frame}, in the
/// folder of each {recording} where the keypoints are. Empty where there are none.
std::string EstimateDepthBeside(const Inspection& inspection, const std::filesystem::path& path, bool by_recording);

/// Pattern of the depth images of the sequences whose JSON are the files `names` below `path`: one that, with the
/// fields of `files` (the pattern of these), gives no image to two of them, and most of them images of all their views.
/// Error kNotFound where no name of an image is like a view's, kInconsistent where no pattern keeps the sequences'
/// images apart.
Expected<std::string> EstimateDepthFiles(const std::filesystem::path& path, const std::vector<std::string>& names,
                                         const std::string& files);

/// Whether the inspection is of depth images with cameras and nothing else.
bool IsDepthViews(const Inspection& inspection);

/// The lines of ingest.source after name and format of such a folder.
void WriteDepthViews(const Inspection& inspection, const std::filesystem::path& path, DeclarationWriter& writer);
/// The same of a folder of point clouds.
void WriteClouds(const Inspection& inspection, DeclarationWriter& writer);

/// The folder that a source stands in: the one that was asked about, or the one above where that holds what belongs to
/// its clips.
struct SourceRoot {
  std::filesystem::path folder;
  std::string prefix;  ///< of the names below the folder that was asked about: empty, or "single/"
};

/// Of motions whose skeletons (fact "skeleton_file") lie in the folder above all of them.
SourceRoot RootOfSkeletons(const ClipConsensus& source, const std::filesystem::path& folder);

/// Where no cameras are in the inspection: those of the files directly in the folder above, added to it, if there are.
SourceRoot RootOfCameras(const std::filesystem::path& folder, Inspection& inspection);

/// What names tell: `files`, with what belongs to them (skeletons, images, the container), `person` and `label`.
/// `asked`: the file or folder that was inspected.
void WriteNames(const ClipConsensus& source, const std::string& format, const std::filesystem::path& asked,
                const SourceRoot& root, DeclarationWriter& writer);

}  // namespace mocurate
