#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

using NameFields = std::map<std::string, std::string>;

/// A path pattern with fields: "a{action}_s{person}.txt". {name} matches one or more characters (as few as possible),
/// {name:4} exactly four; never a '/'. {name?/} is an optional folder, as in "{take?/}seq.json": where it is missing,
/// so is the field. A field that occurs twice must match the same text both times.
class NamePattern {
 public:
  /// Error kConfig: unbalanced braces, empty fields, or adjacent fields without a width.
  static Expected<NamePattern> Parse(const std::string& text, const std::string& where);

  /// The fields of a name; empty when it does not match.
  std::optional<NameFields> Match(std::string_view name) const { return OtherMatch(name, {}); }

  /// Another way to match the name, whose fields `differ`; empty where there is none. "old_female_punch" with
  /// "{person}_{pose}" has person `old` by Match and `old_female` by this.
  using FieldTest = std::function<bool(const NameFields&)>;
  std::optional<NameFields> OtherMatch(std::string_view name, const FieldTest& differ) const;

  /// Number of folders in the pattern: with the optional ones, and without.
  int depth() const { return depth_; }
  int least_depth() const { return least_depth_; }
  std::vector<std::string> FieldNames() const;
  const std::string& text() const { return text_; }

 private:
  struct Part {
    bool is_field = false;
    std::string text;       ///< literal text, or the name of the field
    std::size_t width = 0;  ///< of a field; 0: any
    bool folder = false;    ///< with its '/', and optional
  };
  /// Whether the parts from `part` on match `rest`, with fields that `accepted` holds of, if given.
  bool MatchFrom(std::size_t part, std::string_view rest, NameFields& fields, int& budget,
                 const FieldTest& accepted) const;
  std::vector<Part> parts_;
  std::string text_;
  int depth_ = 0;
  int least_depth_ = 0;
};

/// Letters and digits in lower case: what names are compared by.
std::string LettersAndDigits(const std::string& text);

/// The {field}s of a text, each once.
std::vector<std::string> FieldsOf(const std::string& text);

/// Replaces {field} and {folder?/} in `text`; a missing field becomes empty, a folder together with its '/'.
std::string FillFields(const std::string& text, const NameFields& fields);

}  // namespace mocurate
