#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"

namespace mocurate {

/// A piece of a file for a message: printable ASCII, at most 40 characters.
std::string Shown(std::string_view text);

/// Whether two words are the same, letter case of ASCII aside.
bool SameWord(std::string_view a, std::string_view b);

/// Lines of a text without their ends (LF, CRLF, CR), counted from 1; a byte order mark is skipped.
class LineReader {
 public:
  LineReader(std::string_view bytes, std::string name);

  /// Next line that is not blank, trimmed; empty at the end.
  std::string_view Next();
  /// The same without moving on.
  std::string_view Peek() const;

  /// Of the line that Next() gave last.
  int number() const { return number_; }
  /// What follows that line.
  std::string_view rest() const { return rest_; }
  const std::string& name() const { return name_; }

  /// "name:line" of the line that Next() gave last.
  std::string Place() const { return Place(number_); }
  std::string Place(int line) const { return name_ + ":" + std::to_string(line); }
  /// Error kMalformed at that line.
  tl::unexpected<Error> Bad(std::string what, std::string hint = {}) const;
  /// Error kMalformed: the file ends where `wanted` is expected.
  tl::unexpected<Error> CutOff(const std::string& wanted) const;

 private:
  std::string_view rest_;
  std::string name_;
  int number_ = 0;
};

}  // namespace mocurate
