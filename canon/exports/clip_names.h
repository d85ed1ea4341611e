#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/motion/skeleton.h"

namespace mocurate {

/// The parts of a clip's id, "source/person/recording#begin-end".
struct ClipIdParts {
  std::string source;
  std::string person;
  std::string recording;
  std::string span;  ///< "begin-end"
};

ClipIdParts PartsOfClipId(std::string_view id);

/// A text as the name of a file or folder, at most 200 bytes. Characters that a file system, a file pattern, a shell or
/// a spreadsheet takes for something else (control characters, marks of direction, blanks at the ends, / \ : * ? " < >
/// | # { } and commas, a leading . - = + @, a last dot, bytes that are not UTF-8) become '_'; an empty text is "_".
/// Names of Windows' devices begin with '_'.
std::string NameForFile(std::string_view text);

/// The joints' names without control characters and those of `refused`, which become '_'; two joints never share one.
std::vector<std::string> JointNamesForFile(const Skeleton& skeleton, std::string_view refused);

/// Assigns file names to texts: the same text gets the same name, two texts never share one, even up to case: "Walk",
/// "walk~2".
class FileNames {
 public:
  /// `taken`: names that no text gets.
  explicit FileNames(const std::vector<std::string>& taken = {});
  const std::string& Of(const std::string& text);
  /// name -> text of all texts so far.
  std::map<std::string, std::string> Texts() const;
  /// Number of texts whose name differs.
  std::size_t renamed() const;

 private:
  std::map<std::string, std::string> names_;  ///< by text
  std::map<std::string, int> taken_;          ///< in lower case, and the next number of each
};

enum class RecordingNames {
  kOfPerson,  ///< no two clips of one person have the same name
  kOfSet,     ///< no two clips
};

/// Names of the person and the recording of each clip in an export. The recording keeps its name where that is a valid
/// file name and the clip is its only one. Several clips of one recording get their spans, "walk.30-90"; where names of
/// two persons collide (kOfSet), the person comes first. Persons of several sources are "source.person".
class ClipNames {
 public:
  ClipNames(const std::vector<std::string>& ids, RecordingNames unique);

  /// The source where there is only one, else "export".
  const std::string& source() const { return source_; }
  const std::string& Person(std::size_t position) const { return persons_[position]; }
  const std::string& Recording(std::size_t position) const { return recordings_[position]; }
  /// Number of recordings whose name differs from the id.
  std::size_t renamed() const { return renamed_; }
  /// Number of persons whose name differs from the id.
  std::size_t renamed_persons() const { return renamed_persons_; }

 private:
  std::string source_;
  std::vector<std::string> persons_;
  std::vector<std::string> recordings_;
  std::size_t renamed_ = 0;
  std::size_t renamed_persons_ = 0;
};

}  // namespace mocurate
