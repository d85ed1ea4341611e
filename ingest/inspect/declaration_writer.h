#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/table_text.h"
#include "core/base/text.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/clip_consensus.h"
#include "ingest/inspect/file_names.h"
#include "ingest/inspect/source_declaration.h"
#include "ingest/options.h"

namespace mocurate {

/// Lines of ingest.source, each value with a comment that says where it comes from.
class DeclarationWriter {
 public:
  DeclarationWriter(NamesOfClips names, WrittenDeclaration& out) : names_(names), out_(out) {}

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
  /// A name that no file declares: FILL_IN, or `otherwise` where the clips are only looked at.
  void Name(const std::string& key, const std::string& otherwise, const std::string& how) {
    if (names_ == NamesOfClips::kNone) return Value(key, YamlQuoted(otherwise), "no file declares it");
    Unknown(key, how);
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
  NamesOfClips names_;
  WrittenDeclaration& out_;
};

/// What a declaration is proposed from.
struct Proposal {
  const ClipConsensus& source;
  const Inspection& inspection;
  const FormatDriver& driver;
  std::filesystem::path asked;   ///< file or folder that was inspected
  std::filesystem::path folder;  ///< of the file, or the same
};

/// Axes of a source whose people face anywhere, from up and handedness: "+x -z +y" for "+z" in a right-handed frame.
std::optional<std::string> AxesFrom(const std::string& up, bool right);

/// Where the calibration of the cameras lies below the folder, what it means, and the axes of its world.
void WriteCalibration(const Proposal& proposal, DeclarationWriter& writer);

/// `files` with its fields and their values.
NamePatternEstimate WriteFiles(const Proposal& proposal, DeclarationWriter& writer);
/// `person` and `label`; `several`: people may be in a recording.
void WritePersonAndLabel(bool several, DeclarationWriter& writer);
/// `container` and `files` of a format of one file.
void WriteContainer(const Proposal& proposal, const char* files, DeclarationWriter& writer);
/// `files`, `person`, `label` and `recording` of clips of many files, whose names have a form in common; that of the
/// first file of each folder. `views`: they name the camera.
std::optional<FramePattern> WriteFrames(const std::vector<std::string>& names, bool views, DeclarationWriter& writer);
/// The first file with this ending in each folder of the clips.
std::vector<std::string> FirstFiles(const Proposal& proposal, const std::string& ending);

void WriteUnits(const Proposal& proposal, DeclarationWriter& writer);
void WriteAxes(const Proposal& proposal, DeclarationWriter& writer);
void WriteRate(const Proposal& proposal, DeclarationWriter& writer);
void WriteSkeleton(const Proposal& proposal, DeclarationWriter& writer);

/// The names of images as a pattern with {`field`} for the camera and, where they are numbered, {frame}: what most of
/// them follow. Empty where none names a camera.
std::string EstimateImages(const std::vector<std::string>& names, const std::vector<std::string>& cameras,
                           const std::string& field);
/// Pattern of depth images beside a detector's keypoints: {camera} of the inspection's cameras and {frame}, in the
/// folder of each {recording} where the keypoints are. Empty where there are none.
std::string EstimateDepthBeside(const Proposal& proposal, bool by_recording);
/// Pattern of the depth images of the sequences whose JSON are the files `names` below `path`: one that, with the
/// fields of `files` (the pattern of these), gives no image to two of them, and most of them images of all their views.
/// Error kNotFound where no name of an image is like a view's, kInconsistent where no pattern keeps the sequences'
/// images apart.
Expected<std::string> EstimateDepthFiles(const std::filesystem::path& path, const std::vector<std::string>& names,
                                         const std::string& files);

/// Whether the inspection is of depth images with cameras and nothing else.
bool IsDepthViews(const Inspection& inspection);
/// Names, cameras and rate of such a folder.
void ProposeDepthViews(const Proposal& proposal, DeclarationWriter& writer);

}  // namespace mocurate
