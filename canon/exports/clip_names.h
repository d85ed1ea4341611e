#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mocurate {

/// The parts of a clip's id, "source/person/recording#begin-end".
struct ClipIdParts {
  std::string source;
  std::string person;
  std::string recording;
  std::string span;  ///< "begin-end"
};

ClipIdParts PartsOfClipId(std::string_view id);

/// A text as the name of a file or folder: what a file system or a file pattern refuses (control characters, blanks at
/// the ends, / \ : * ? " < > | # { } and commas, a leading dot, bytes that are not UTF-8) becomes '_'; an empty text is
/// "_".
std::string NameForFile(std::string_view text);

/// Gives texts names for files: the same text the same name, two texts never one (case apart: "Walk", "walk~2").
class FileNames {
 public:
  const std::string& Of(const std::string& text);
  /// name -> text of all that were asked for.
  std::map<std::string, std::string> Texts() const;
  /// Whether all names are their texts.
  bool Plain() const;

 private:
  std::map<std::string, std::string> names_;  ///< by text
  std::set<std::string> taken_;               ///< in lower case
};

enum class RecordingNames {
  kOfPerson,  ///< no two clips of one person have the same name
  kOfSet,     ///< no two clips
};

/// How an export calls the person and the recording of each clip. The recording keeps its name where it is a name for a
/// file and the clip is the only one of it. Several clips of one recording get their spans, "walk.30-90"; where two
/// persons' names meet (kOfSet), the person goes before. Persons of several sources are "source.person".
class ClipNames {
 public:
  ClipNames(const std::vector<std::string>& ids, RecordingNames unique);

  /// The source where there is one alone, else "export".
  const std::string& source() const { return source_; }
  const std::string& Person(std::size_t position) const { return persons_[position]; }
  const std::string& Recording(std::size_t position) const { return recordings_[position]; }
  /// How many recordings are called otherwise than in the ids.
  std::size_t renamed() const { return renamed_; }

 private:
  std::string source_;
  std::vector<std::string> persons_;
  std::vector<std::string> recordings_;
  std::size_t renamed_ = 0;
};

}  // namespace mocurate
