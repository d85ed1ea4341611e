#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// Walks over text that is mostly numbers, once, without copying; counts lines (1-based). LF, CRLF and CR end a line.
class NumberScanner {
 public:
  enum class Token {
    kNumber,     ///< value() holds it, finite
    kNotFinite,  ///< "nan", "inf" or beyond the range of double; text() holds it
    kWord,       ///< anything else up to the next blank, comma or end of line; text() holds it
    kLineEnd,
    kEnd,
  };

  /// `comma_separates`: a comma counts as a blank; otherwise it is part of a word.
  NumberScanner(std::string_view bytes, bool comma_separates, int first_line = 1);

  /// Next token; blanks are skipped. After kLineEnd, line() is already the next line.
  Token Next();
  /// Appends numbers up to the first other token, and returns that token: the fast path for a row.
  Token Numbers(std::vector<double>& values);
  double value() const { return value_; }
  /// The number or word as written in the file; after Numbers() only of the token returned.
  std::string_view text() const { return text_; }
  int line() const { return line_; }
  /// What follows the last token.
  std::string_view rest() const { return {at_, static_cast<std::size_t>(end_ - at_)}; }

 private:
  bool Separates(char c) const;
  bool EndsAt(const char* at) const;
  Token Word();
  const char* at_;
  const char* end_;
  bool comma_separates_;
  int line_;
  double value_ = 0.0;
  std::string_view text_;
};

/// A table whose numbers have decimal commas, and ';' or tabs between them, with points for commas and blanks for
/// semicolons; empty where commas separate, or there are none. The first line that begins with a number and has a comma
/// decides. Error kMalformed "name:line" where blanks alone separate numbers with one comma each: both are possible.
/// Line ends stay where they are.
Expected<std::optional<std::string>> WithDecimalPoints(std::string_view bytes, const std::string& name);

}  // namespace mocurate
